// Data that the stages of a step pass on to each other, and that they keep from step to step. All other state belongs
// to the world.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Stages/ErrorMeter.h>
#include <Fulcrum/Physics/Stages/EventBuffers.h>
#include <Fulcrum/Physics/Stages/SavedEfforts.h>
#include <Fulcrum/Physics/Stages/SensorSearch.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/Stages/StepContext.h>
#include <Fulcrum/Physics/Stages/SweepStore.h>
#include <Fulcrum/Physics/StepReport.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>
#include <cstring>

namespace fulcrum {

// An additional manifold of a pair with a surface, not stored in a slot yet.
struct MoreManifold {
    uint32_t pair;
    uint32_t order;  // index among those of the pair
    SurfaceManifold contact;
};

// The contact of a pair that had none, without a place yet.
struct NewContact {
    PairContact contact;
    ContactRecord record;
};

// A contact whose normal turned, of bodies that may have several contacts with each other: see TurnsFromOthers.
struct TurnedNormal {
    uint32_t bodyA, bodyB;
    Vector3 before;  // what the normal was: unit, world axes, from A to B
};

// A body that a contact will deflect within the step, and by how much if the contact stops the approach of its two
// bodies where they meet.
struct Deflection {
    uint32_t body, otherBody;
    Vector3 linear, angular;  // m/s and rad/s, world axes
    float size;               // m/s: of both, at its outer radius
};

// One worker's results of a stage; merged in an order that does not depend on the distribution of work.
struct alignas(64) WorkerFindings {
    Array<uint32_t> colliders;         // UpdateBounds: those that left their fat bounds
    Array<uint32_t> outsideFatBounds;  // Continuous: those that the solver moved out of them
    Array<uint64_t> pairs;             // FindPairs: keys of new or resting pairs
    uint32_t deepPairs = 0;            // FindPairs: how many of these pairs overlap deeply
    Array<uint32_t> putInto;           // FindPairs: sleeping bodies into which something was put
    Array<uint32_t> deepOverlaps;      // Collide: bodies that overlap another deeply, once for each such overlap
    Array<uint32_t> crowdedOverlaps;   // Collide: crowded bodies and their levels, for each contact
    SurfaceContacts surface;           // Collide: temporary
    Array<uint32_t> surfacePlaces, surfaceLeft, surfaceTouched;  // Collide: likewise
    Array<MoreManifold> more;                                    // Collide: manifolds without a slot yet
    Array<NewContact> newContacts;                               // Collide
    Array<TurnedNormal> turnedNormals;                           // Collide
    Array<Deflection> deflections;                               // Collide
    Array<SweepHit> sweepHits;                                   // Continuous
    Array<uint64_t> sensorCandidates;                            // Sense
    Array<SensorVisit> sensorVisits;                             // likewise
    uint32_t sensorTests = 0;                                    // likewise
    Array<uint32_t> eventPairs;                                  // Events
    CollideCounters libccd;
    uint32_t contacts = 0, points = 0, kept = 0;
    float deepest = 0;  // largest penetration, m
    uint32_t deepestPair = ~0u;
    uint32_t clamped = 0, frozen = 0;
    uint32_t firstFrozen = ~0u;
    uint32_t sleepCandidates = 0;  // bodies that have been slow for long enough
    bool loadsChanged = false;     // Store: some load level changed, see ContactLoads.h
    bool strainsBegan = false;     // Store: some joint began to be strained or past a limit, see JointStrain.h
    JointFindings joints;          // Prepare
};

size_t HeapBytes(const WorkerFindings& findings);

// A body that deeply overlapped many others and disperses (Stages/Crowd.h): until there is free space it neither
// collides with dynamic bodies nor feels gravity, and it moves with `push` in addition to its own velocity.
struct DispersingBody {
    uint32_t body;
    Vector3 direction;      // of the push if it has no target position; length 0..1, as a fraction of the largest push
    bool hasPlace = false;  // whether it moves to `place`
    Position place = Position::Zero();                              // m
    float secondsLeft = 0;                                          // until it should arrive; negative afterwards
    uint64_t startStep = 0;                                         // the step in which it started
    Vector3 push = Vector3::Zero(), ownVelocity = Vector3::Zero();  // m/s, of this step
};

// Change of an active pair found by Collide, which later stages handle. Ended: its contact is not solved any more, or
// has no points any more.
enum class PairChange : uint8_t { None, Began, Ended, Dead, WakesOther };

// Results of FindPairs and Collide about pairs of this step.
struct PairUpdates {
    Array<uint64_t> found;              // FindPairs: keys of new and of resting pairs, sorted
    Array<uint32_t> activated;          // FindPairs: pairs that it made active
    Array<PairChange> changes;          // Collide: by pair; None for those that are not active
    Array<MoreManifold> moreManifolds;  // Collide
    // Collide: the deflected bodies, one entry each, and their pairs, with what had changed of them before.
    Array<Deflection> deflections;
    Array<uint32_t> deflectedPairs;
    Array<PairChange> changesBefore;
    bool hadManyNewContacts = false;  // Collide: in a step, see AddNewContacts
};

size_t HeapBytes(const PairUpdates& updates);

// A crowded body that overlaps others by so little that this may be its load (Stages/CrowdContacts.h).
struct SettlingBody {
    uint32_t body;
    float seconds;  // for how long so far
};

// Bodies of crowds (Stages/Crowd.h).
struct CrowdState {
    // Collide: bodies, ascending, once for each deep overlap; empty if none has many.
    Array<uint32_t> deepOverlaps;
    Array<DispersingBody> dispersing;  // by body, ascending
    Array<uint32_t> crowded;           // bodies, those of `dispersing` last
    Array<SettlingBody> settling;      // by body, ascending
    Array<SettlingBody> settled;       // scratch memory
};

size_t HeapBytes(const CrowdState& crowd);

struct StepState {
    FULCRUM_WORLD_MEMORY

    float lastSubstepDt = 0;  // s, of the last step
    float stiffnessDt = 0;    // s, of the last step: see StepContext

    StepReport report;
    Array<WorkerFindings> findings;  // by worker
    ScratchArena scratch;
    Array<ScratchArena> ofWorkers;  // by worker

    PairUpdates pairs;
    CrowdState crowd;
    Array<uint32_t> began;  // Color: pairs that began to touch
    Array<uint32_t> seams;  // RemoveSeamContacts: pairs without their points, in the last step
    SolverLayout solver;
    SavedEfforts savedEfforts;     // restored by a snapshot, for BuildIslands
    uint32_t sleepCandidates = 0;  // Store: bodies that have been slow for long enough
    SweepStore sweeps;
    SensorSearch sensing;
    EventBuffers events;
    ErrorMeter errors;
};

size_t HeapBytes(const StepState& step);

// Visits the pairs with a change, in ascending order; usually few.
template <class Visitor>
void VisitChanges(std::span<const PairChange> changes, Visitor&& visit) {
    const size_t count = changes.size();
    for (size_t i = 0; i < count;) {
        uint64_t eight = 0;
        if (i + 8 <= count) {
            std::memcpy(&eight, &changes[i], 8);
            if (eight == 0) {
                i += 8;
                continue;
            }
        }
        for (const size_t end = std::min(i + 8, count); i < end; ++i)
            if (changes[i] != PairChange::None) visit(static_cast<uint32_t>(i));
    }
}

}  // namespace fulcrum
