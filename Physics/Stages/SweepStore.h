// The motion of bodies within a step: for continuous collision, which ends sweeps at hits, and for sensors. Kept only
// if some body needs it. Written by Store and Continuous.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/StepEvents.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/HeapBytes.h>

#include <cstdint>

namespace fulcrum {

// The difference as float; the positions themselves need doubles.
inline Vector3 Between(const Position& from, const Position& to) { return (to - from).cast<float>(); }

// A body's path from some time of the step to its end: its center of mass moves along a line, and it rotates at a
// constant rate. Times are fractions of the step, 0..1. All positions are on the grid, like those of bodies.
struct Sweep {
    Pose start;                              // of the center frame, at `from`
    Vector3 displacement = Vector3::Zero();  // m, until the end
    Vector3 turn = Vector3::Zero();          // rad, rotation vector, until the end of the step
    float from = 0;
    uint32_t body = 0;
    bool turns = false;    // casts include its rotation, however small
    bool isCut = false;    // something was hit
    bool waits = false;    // stays at its pose at `from` until the end of the step, and keeps its velocity
    bool changed = false;  // changed in the current round
    bool moves = false;    // its end is the body's new pose
    // Hits since the time of the first of them, of those that follow each other closely (CountHit).
    int crowdedHits = 0;
    float crowdedSince = 0;

    // A body among shapes far larger than its motion, or wedged between them, may be hit again and again while time
    // hardly advances. After this many hits in a thousandth of a step it stays where it is until the next step.
    static constexpr int kMostCrowdedHits = 8;
    void CountHit(float time) {
        constexpr float kCrowded = 1e-3f;  // of a step
        if (!(time - crowdedSince <= kCrowded)) {
            crowdedSince = time;
            crowdedHits = 0;
        }
        ++crowdedHits;
    }
    bool IsCrowdedWithHits() const { return crowdedHits >= kMostCrowdedHits; }

    // Likewise where casts end undecided this many times in a step, each after all the effort that a cast may take.
    static constexpr int kMostUndecided = 8;
    int undecided = 0;

    float PartAt(float time) const { return from < 1 ? (time - from) / (1 - from) : 0.0f; }
    Position PositionAt(float time) const {
        return start.position + OnGrid((displacement * PartAt(time)).cast<double>());
    }
    Quaternion RotationAt(float time) const {
        if (turn.isZero(0)) return start.rotation;
        return Normalized(RotationFromVector(Vector3(turn * PartAt(time))) * start.rotation);
    }
    Pose PoseAt(float time) const { return {PositionAt(time), RotationAt(time)}; }
    // Scaled to a whole step.
    Vector3 DisplacementRate() const {
        return from < 1 ? Vector3(displacement * (1 / (1 - from))) : Vector3(Vector3::Zero());
    }
    Vector3 TurnRate() const { return from < 1 ? Vector3(turn * (1 / (1 - from))) : Vector3(Vector3::Zero()); }
};

// The first hit of a swept body with another one.
struct SweepHit {
    static constexpr int kMaxPoints = 4;
    float time = 1;
    uint32_t body = 0, other = 0;
    uint32_t collider = 0, otherCollider = 0;
    uint32_t triangle = 0;  // if the other is a surface: triangle of the deepest point
    uint8_t material = 0;   // of the other's palette
    float friction = 0, restitution = 0;
    Vector3 surfaceVelocity = Vector3::Zero();  // m/s, of the other's surface relative to its body
    MassOverride massOverride;                  // with with the body as A, the other as B
    // Neither has continuous collision: the body was cast only because it was hit, and waits for the next step.
    bool isBlocked = false;
    int pointCount = 0;                               // 0: undecided; there is no touch before `time`
    Vector3 normal = Vector3::Zero();                 // unit, from the body towards the other
    Position center = Position::Zero();               // m, of the body's mass at the hit
    Vector3 arms[kMaxPoints], otherArms[kMaxPoints];  // m, from the centers of mass to the points, world axes
};

// Data of a hit for contact events.
struct ReportedHit {
    uint32_t body = 0, other = 0;
    uint32_t collider = 0, otherCollider = 0;
    float time = 0, approachSpeed = 0;
    ContactEvent::Manifold manifold;  // the body as A
};

struct SweepStore {
    // Where the first round searches the candidates of a fast body.
    enum class SearchBy : uint8_t {
        None,
        Pairs,  // its path is inside its fat bounds: all candidates have a pair
        Trees,
    };
    static constexpr uint32_t kNone = ~0u;
    struct Start {
        Pose pose;
        uint64_t step = 0;  // the step for which it is valid
    };

    bool isKept = false;  // continuous collision or sensors need it in this step
    float dt = 0;         // s, of the step
    Array<Start> starts;  // by body: pose at the start of the step
    Array<SearchBy>
        searchBy;        // by body; None except for bodies with continuous collision that moved too far without a cast
    Array<Sweep> swept;  // sweeps that were cast or changed
    Array<uint32_t> places;        // by body: index into `swept`, or kNone
    Array<Sweep> ended;            // sweeps ended by a hit, in the order of the hits
    Array<float> endedAt;          // times
    Array<uint32_t> active, next;  // indices into `swept`, of this round and the next
    Array<SweepHit> hits;          // of a round; afterwards those postponed to the next
    Array<SweepHit> keptHits;      // temporary
    // Colliders whose fat bounds the stage enlarged, and a tree of these bounds without sensors. The trees of the world
    // are updated at its end, so that queries may read them meanwhile.
    Array<uint32_t> enlarged;
    BoundsTree enlargedTree;
    bool reportsHits = false;     // whether contact events are on in this step
    Array<ReportedHit> reported;  // hits that stopped or deflected a body in this step

    // Whether the body's start pose is that of this step: it was awake at its start.
    bool IsOfStep(uint32_t body, uint64_t step) const { return body < starts.size() && starts[body].step == step; }
};

inline size_t HeapBytes(const SweepStore& store) {
    const auto& [isKept, dt, starts, searchBy, swept, places, ended, endedAt, active, next, hits, keptHits, enlarged,
                 enlargedTree, reportsHits, reported] = store;
    return HeapBytes(isKept, dt, starts, searchBy, swept, places, ended, endedAt, active, next, hits, keptHits,
                     enlarged, enlargedTree, reportsHits, reported);
}

}  // namespace fulcrum
