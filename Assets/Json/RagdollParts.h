// Ragdolls within another document, whose limits they share. Called by SceneFile.cpp; one thread.
#pragma once

#include <Fulcrum/Assets/Json/JsonReader.h>
#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

namespace fulcrum {

// Both take of the budget. Names of files in it are relative to the document's folder, or to that of the file.
Result<RagdollSettings> ReadRagdollParts(const Json& node, const std::filesystem::path& folder, JsonBudget& budget);
Result<RagdollSettings> ReadRagdollFile(const std::filesystem::path& file, JsonBudget& budget);

}  // namespace fulcrum
