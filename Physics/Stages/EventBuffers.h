// Buffers of a step's events, and the reported state of bodies in the last step. Written by the stages that list
// events; the arrays are visible to the user until the next step.
#pragma once

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/StepEvents.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/IndexSet.h>

namespace fulcrum {

// An event without its manifolds.
struct ListedContact {
    BodyId bodyA, bodyB;
    uint32_t childA = 0, childB = 0;
    ContactEvent::Kind kind = ContactEvent::Kind::Begin;
    float time = 1;
    uint32_t source = 0;  // for Begin and Stay the pair, for Hit the index in SweepStore::reported
    uint32_t firstManifold = 0, manifoldCount = 0;
};

// Sort key of an event.
struct ContactOrder {
    uint64_t bodies;  // indices, A << 32 | B
    uint32_t listed;  // index in EventBuffers::listed
};

// State of a body at the end of the last step.
struct ReportedBody {
    Position position = Position::Zero();  // m, of the center of mass
    Quaternion rotation{};
    uint32_t generation = ~0u;  // if it differs from the body's: unknown
    bool isAwake = false;
};

// Whether the contacts of two bodies are reported. reports: BodyStore's.
inline bool AreReported(const IndexSet& reports, uint32_t bodyA, uint32_t bodyB) {
    return reports.Contains(bodyA) || reports.Contains(bodyB);
}

struct EventBuffers {
    StepEvents events;

    Array<ListedContact> listed;
    Array<ContactOrder> order;
    Array<ContactEvent> contacts;
    Array<ContactEvent::Manifold> manifolds;

    Array<ReportedBody> bodies;              // by index; empty without EventSettings::bodies
    Array<uint64_t> awakeWords, movedWords;  // one bit per body
    Array<BodyId> awake, moved, woke, fellAsleep;

    Array<BrokenJoint> broken;
};

inline size_t HeapBytes(const EventBuffers& buffers) {
    const auto& [events, listed, order, contacts, manifolds, bodies, awakeWords, movedWords, awake, moved, woke,
                 fellAsleep, broken] = buffers;
    return HeapBytes(events, listed, order, contacts, manifolds, bodies, awakeWords, movedWords, awake, moved, woke,
                     fellAsleep, broken);
}

}  // namespace fulcrum
