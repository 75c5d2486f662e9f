// The table of PublicCalls.h as functions that write the arguments of a call and play it. Pure functions.
#pragma once

#include <Fulcrum/Physics/Recording/CallCodec.h>

#include <span>
#include <vector>

namespace fulcrum {

// What a call has created.
struct CreatedIds {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    std::vector<ChildId> children;
    friend bool operator==(const CreatedIds&, const CreatedIds&) = default;
};

template <class Archive>
void Describe(Archive& archive, CreatedIds& ids) {
    archive.Field("bodies", ids.bodies);
    archive.Field("joints", ids.joints);
    archive.Field("children", ids.children);
}

struct CallRow {
    const char* name;
    const void* tag;  // as CallObserver::BeginCall gets it
    uint64_t layout;  // of its arguments
    void (*write)(CallWriter& writer, std::span<const void* const> arguments);
    void (*noteCreated)(const void* value, CreatedIds& created);  // null: it creates nothing
    // Returns what was refused, which is no failure: the call that was recorded may have been refused, too. `recorded`:
    // what it created then. Does not call if the reader is not content, or not at its end.
    MaybeError (*play)(PhysicsSystem& system, CallReader& reader, const CreatedIds& recorded, CreatedIds& created);
};

std::span<const CallRow> CallRows();

// Gives the user-defined joints of a batch what makes their types.
void GiveMakers(std::span<BodyBatch::Joint> joints, std::span<const JointId> recorded, const ReplaySources& sources);

// Rows that need special care.
const void* StepTag();
const void* BatchTag();
const void* RestoreTag();
const void* CreateTag();

}  // namespace fulcrum
