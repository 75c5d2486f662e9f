// Time of impact of two convex shapes, one moving, known by their support functions alone. Called by the ray casts and
// shape casts; the base of continuous collision. Allocates nothing; thread-safe.
//
// Every advance is conservative: until then a plane separates the shapes by more than the target distance, so there is
// no tunneling however thin or fast they are. The search ends when the closest points are within the tolerance of the
// target distance; after too many iterations the time reached so far is returned, which is early rather than late.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>

namespace fulcrum {

// Poses of the shapes at a fraction of a motion.
struct CorePoses {
    double fraction = 0;
    Quaternion rotation;     // of B, in the motion's axes
    Quaternion rotationOfA;  // likewise
    RelativePose bInA;       // in A's axes at that time
};

// The motion of shape B relative to the center of shape A, in A's axes at the start. The center moves along a line;
// each shape rotates at a constant rate about an axis through its center.
struct CoreMotion {
    Position position;                       // of B's center at the start, m
    Quaternion rotation{};                   // of B at the start, unit
    Vector3 displacement = Vector3::Zero();  // m, over the whole motion
    Vector3 turn = Vector3::Zero();          // of B: rotation vector over the whole motion, rad
    Vector3 turnOfA = Vector3::Zero();       // likewise
    bool IsTurning() const { return !turn.isZero(0) || !turnOfA.isZero(0); }

    Position PositionAt(double fraction) const { return position + displacement.cast<double>() * fraction; }
    CorePoses At(double fraction) const;
};

struct CoreCastLimits {
    double maxFraction = 1;  // of the motion, >= 0
    float separation = 0;    // m, >= 0: the target distance: closer shapes count as touching
    float tolerance = 0;     // m, >= 0: allowed additional separation at a hit; at least the rounding error
};

struct CoreCastResult {
    enum class Status : uint8_t {
        Miss,  // farther apart than the separation until maxFraction
        Hit,
        Early,    // iteration limit reached: separated until that time, close to each other then
        AtStart,  // no farther apart than the separation at the start
    };
    Status status = Status::Miss;
    double fraction = 0;
    Vector3 normal = Vector3::Zero();  // unit, A's frame, from A towards B. AtStart with overlapping cores: not set
    Vector3 onA = Vector3::Zero();     // m, A's frame: the point of A's core; not set if the normal is not
    bool coresOverlap = false;         // AtStart
    bool IsHit() const { return status != Status::Miss; }
};

// Source of the search: G. van den Bergen, "Ray Casting against General Convex Objects with Application to Continuous
// Collision Detection", 2004: GJK on a moving difference, which keeps its simplex between advances.
CoreCastResult CastLinear(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                          const CoreCastLimits& limits);

// The same for rotating shapes, by conservative advancement: GJK at each time, and an advance by a second-order bound
// on the approach of their points along the axis found.
CoreCastResult CastTurning(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                           const CoreCastLimits& limits);

// Against the fixed half space normal . x <= offset; B may rotate.
CoreCastResult CastToPlane(const Vector3& normal, double offset, const ConvexShape& b, const CoreMotion& motion,
                           const CoreCastLimits& limits);

// The same, with or without rotation, by conservative advancement with libccd: it decides whether the shapes, rounded
// by the separation, overlap, and finds a separating axis along which the motion advances.
CoreCastResult CastByLibccd(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                            const CoreCastLimits& limits);

inline CoreCastResult CastCore(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                               const CoreCastLimits& limits, NarrowPhaseMethod method = NarrowPhaseMethod::Automatic) {
    if (method == NarrowPhaseMethod::Libccd) return CastByLibccd(a, b, motion, limits);
    return motion.IsTurning() ? CastTurning(a, b, motion, limits) : CastLinear(a, b, motion, limits);
}

}  // namespace fulcrum
