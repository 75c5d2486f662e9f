// How bodies moved within a step: for continuous collision, which cuts their sweeps short where they hit something, and
// for sensors, which see what passed in between. Kept only while a body asks for it. Written by Store and Continuous.
#pragma once

#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/StepEvents.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/HeapBytes.h>

#include <cstdint>
#include <vector>

namespace fulcrum {

// In float, of which the places themselves are too far from zero for it.
inline Vector3 Between(const Position& from, const Position& to) { return (to - from).cast<float>(); }

// A body's path from some time of the step to its end: its center of mass moves straight, it turns at a constant rate.
// Times are fractions of the step, 0 .. 1. All positions are on the grid, as those of the step are.
struct Sweep {
    Pose start;                              // of the center frame, at `from`
    Vector3 displacement = Vector3::Zero();  // m, until the end
    Vector3 turn = Vector3::Zero();          // rad, rotation vector, until the end
    float from = 0;
    uint32_t body = 0;
    bool turns = false;    // it is cast with its turn, however small
    bool isCut = false;    // something was hit
    bool waits = false;    // stays until the step's end where it was at `from`, with the velocity of then
    bool changed = false;  // in the present round

    float PartAt(float time) const { return from < 1 ? (time - from) / (1 - from) : 0.0f; }
    Position PositionAt(float time) const {
        return start.position + OnGrid((displacement * PartAt(time)).cast<double>());
    }
    Quaternion RotationAt(float time) const {
        if (turn.isZero(0)) return start.rotation;
        return Normalized(RotationFromVector(Vector3(turn * PartAt(time))) * start.rotation);
    }
    Pose PoseAt(float time) const { return {PositionAt(time), RotationAt(time)}; }
    // Of a whole step's length.
    Vector3 DisplacementRate() const {
        return from < 1 ? Vector3(displacement * (1 / (1 - from))) : Vector3(Vector3::Zero());
    }
    Vector3 TurnRate() const { return from < 1 ? Vector3(turn * (1 / (1 - from))) : Vector3(Vector3::Zero()); }
};

// Where a swept body first meets another one that it would overlap.
struct SweepHit {
    static constexpr int kMaxPoints = 4;
    float time = 1;
    uint32_t body = 0, other = 0;
    uint32_t collider = 0, otherCollider = 0;
    uint32_t triangle = 0;  // of the other, where it is a surface: of the deepest point
    uint8_t material = 0;   // of the other's palette
    float friction = 0, restitution = 0;
    Vector3 surfaceVelocity = Vector3::Zero();  // m/s, of the other's surface against its body
    MassOverride massOverride;                  // the body as A, the other as B
    // Neither has continuous collision: the body is cast because it was hit, and waits for the next step.
    bool isBlocked = false;
    int pointCount = 0;                               // 0: the cast was not decided; nothing is touched before `time`
    Vector3 normal = Vector3::Zero();                 // unit, from the body towards the other
    Position center = Position::Zero();               // m, of the body's mass, where it touches
    Vector3 arms[kMaxPoints], otherArms[kMaxPoints];  // m, from the centers of mass to the points, world axes
};

// What contact events say of a hit.
struct ReportedHit {
    uint32_t body = 0, other = 0;
    uint32_t collider = 0, otherCollider = 0;
    float time = 0, approachSpeed = 0;
    ContactEvent::Manifold manifold;  // the body as A
};

struct SweepStore {
    // Where the first round looks for what a fast body may hit.
    enum class SearchBy : uint8_t {
        None,
        Pairs,  // its path lies inside its fat bounds: there is a pair for all that it may hit
        Trees,
    };
    static constexpr uint32_t kNone = ~0u;
    struct Start {
        Pose pose;
        uint64_t step = 0;  // the one that it is of
    };

    bool isKept = false;        // continuous collision or sensors ask for it in this step
    float dt = 0;               // s, of the step
    std::vector<Start> starts;  // by body: where it was when the step began
    std::vector<SearchBy>
        searchBy;  // by body; None for all but continuous ones that moved farther than they may without a cast
    std::vector<Sweep> swept;            // sweeps that were searched anew, or changed
    std::vector<uint32_t> places;        // by body: index into `swept`, or kNone
    std::vector<Sweep> ended;            // sweeps that a hit has ended, in the order of the hits
    std::vector<float> endedAt;          // times
    std::vector<uint32_t> active, next;  // indices into `swept`, of this round and the next
    std::vector<SweepHit> hits;          // of a round; afterwards those that wait for the next
    std::vector<SweepHit> keptHits;      // room for those
    bool reportsHits = false;            // contact events ask for it in this step
    std::vector<ReportedHit> reported;   // those that stopped or deflected something in this step

    // Whether the body's start is that of this step: it was awake as it began.
    bool IsOfStep(uint32_t body, uint64_t step) const { return body < starts.size() && starts[body].step == step; }
};

inline size_t HeapBytes(const SweepStore& store) {
    const auto& [isKept, dt, starts, searchBy, swept, places, ended, endedAt, active, next, hits, keptHits, reportsHits,
                 reported] = store;
    return HeapBytes(isKept, dt, starts, searchBy, swept, places, ended, endedAt, active, next, hits, keptHits,
                     reportsHits, reported);
}

}  // namespace fulcrum
