// What the events of a step are listed in, and what was said of bodies in the last one. Written by the stages that list
// events; the arrays are the user's until the next step.
#pragma once

#include <Fulcrum/Physics/StepEvents.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/IndexSet.h>

#include <vector>

namespace fulcrum {

// An event before its manifolds are looked up.
struct ListedContact {
    BodyId bodyA, bodyB;
    uint32_t childA = 0, childB = 0;
    ContactEvent::Kind kind = ContactEvent::Kind::Begin;
    float time = 1;
    uint32_t source = 0;  // of Begin and Stay the pair, of a Hit its place in SweepStore::reported
    uint32_t firstManifold = 0, manifoldCount = 0;
};

// A place in the order of events.
struct ContactOrder {
    uint64_t bodies;  // indices, A << 32 | B
    uint32_t listed;  // place in EventBuffers::listed
};

// A body as the last step ended.
struct ReportedBody {
    Position position = Position::Zero();  // m, of the center of mass
    Quaternion rotation{};
    uint32_t generation = ~0u;  // of another one: nothing is known of the body
    bool isAwake = false;
};

// Whether the contacts of two bodies are events. reports: BodyStore's.
inline bool AreReported(const IndexSet& reports, uint32_t bodyA, uint32_t bodyB) {
    return reports.Contains(bodyA) || reports.Contains(bodyB);
}

struct EventBuffers {
    StepEvents events;

    std::vector<ListedContact> listed;
    std::vector<ContactOrder> order;
    std::vector<ContactEvent> contacts;
    std::vector<ContactEvent::Manifold> manifolds;

    std::vector<ReportedBody> bodies;              // by index; empty without EventSettings::bodies
    std::vector<uint64_t> awakeWords, movedWords;  // bodies as bits
    std::vector<BodyId> awake, moved, woke, fellAsleep;

    std::vector<BrokenJoint> broken;
};

inline size_t HeapBytes(const EventBuffers& buffers) {
    const auto& [events, listed, order, contacts, manifolds, bodies, awakeWords, movedWords, awake, moved, woke,
                 fellAsleep, broken] = buffers;
    return HeapBytes(events, listed, order, contacts, manifolds, bodies, awakeWords, movedWords, awake, moved, woke,
                     fellAsleep, broken);
}

}  // namespace fulcrum
