// Scenes as files: what SceneDescription.h describes, as JSON to read and edit, or as CBOR (RFC 8949), which is smaller
// and faster to read, with the same names of fields, in SI units and radians. A field that is left out has its default.
// Docs/SceneFiles.md explains the format, Assets/scene.schema.json is its JSON Schema. Free functions, any thread.
//
// {"fulcrumScene": 1, "steps": 300,
//  "settings": {"gravity": [0, -9.81, 0], "solver": {"substeps": 8}},
//  "shapes": {"crate": {"kind": "Box", "halfExtents": [0.5, 0.5, 0.5]}},
//  "bodies": [{"name": "floor", "shape": {"kind": "Plane"}, "motion": "Static"},
//             {"name": "lid", "shape": "crate", "position": [0, 2, 0]}],
//  "joints": [{"kind": "Hinge", "bodyA": "world", "bodyB": "lid", "anchorA": {"point": [0, 2, 0.5], "axis": [1, 0,
//  0]}}], "ragdolls": [{"file": "humanoid.json", "origin": {"position": [3, 0, 0]}}]}
#pragma once

#include <Fulcrum/Assets/SceneDescription.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace fulcrum {

inline constexpr int kSceneFileVersion = 1;

// Names of other files in it are relative to `folder`. Errors name the path in the document, such as
// `bodies[1].shape.radius: of type string; it must be a number`, or the line of a syntax error; OutOfRange: more than
// is read (Docs/SceneFiles.md says how much), or than there is memory for.
Result<SceneDescription> SceneFromJson(std::string_view text, const std::filesystem::path& folder = {});
Result<SceneDescription> SceneFromCbor(std::string_view bytes, const std::filesystem::path& folder = {});
// Writes only what differs from the defaults; shapes of several bodies once. Reading it gives the same scene, bit by
// bit. Errors: Unsupported (a custom shape, a group filter, a number that is none, an enumerator that does not exist, a
// name that two have), NonPositive (steps, dt), OutOfRange (a number of a body).
Result<std::string> SceneToJson(const SceneDescription& scene);

// JSON or CBOR, by what is in the file. Errors also if it cannot be read.
Result<SceneDescription> ReadScene(const std::filesystem::path& file);
// CBOR where the name ends in .cbor, else JSON. Errors also if it cannot be written: a file that was there is then as
// it was.
Status WriteScene(const std::filesystem::path& file, const SceneDescription& scene);

}  // namespace fulcrum
