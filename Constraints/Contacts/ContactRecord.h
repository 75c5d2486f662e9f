// What the solver needs to know of one contact manifold, and what it keeps from step to step: rows of eight floats, so
// that Prepare can gather the contacts of a batch into lanes. Written by the Collide stage, impulses by Store.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <cstdint>

namespace fulcrum {

struct alignas(32) ContactRecord {
    static constexpr int kMaxPoints = 4;

    struct Point {
        float onA[3] = {0, 0, 0};  // m, in A's center frame
        float surfaceA = 0;        // see SetSurfaceVelocity
        float onB[3] = {0, 0, 0};  // m, in B's center frame; the separation is (onB - onA) . normal at the poses of now
        float surfaceB = 0;
    };

    float normal[3] = {0, 1, 0};  // unit, from A to B, in A's center frame
    float pointCount = 0;         // 0..4
    float friction = 0;           // Coulomb coefficient
    float restitution = 0;        // 0..1
    float twistRadius = 0;        // m: mean distance of the contact patch from its center
    float surfaceMoves = 0;       // 1: it has a surface velocity
    // Second row: impulses of the last substep.
    float impulse[kMaxPoints] = {0, 0, 0, 0};  // N s along the normal, by point
    float frictionImpulse[3] = {0, 0, 0};      // N s, world axes, on B
    float twistImpulse = 0;                    // N m s about the normal
    Point points[kMaxPoints];

    // B's surface moves so against A's, beyond the motion of the bodies: m/s at the contact's center and rad/s, world
    // axes. Few contacts have one: it has no row of its own but what is spare in those of the first three points.
    void SetSurfaceVelocity(const Vector3& linear, const Vector3& angular) {
        surfaceMoves = linear.isZero(0) && angular.isZero(0) ? 0.0f : 1.0f;
        float* const spares[6] = {&points[0].surfaceA, &points[0].surfaceB, &points[1].surfaceA,
                                  &points[1].surfaceB, &points[2].surfaceA, &points[2].surfaceB};
        for (int k = 0; k < 3; ++k) {
            *spares[k] = linear[k];
            *spares[3 + k] = angular[k];
        }
    }
};
static_assert(sizeof(ContactRecord) == 192);

// Mean distance of a convex polygon's points from the origin, the origin inside; `x`, `y` are its corners in any order,
// at most 4. Over the triangle (0, P, Q) it is 2/3 of the mean over the edge PQ, which Simpson's rule gives to 1e-3.
// Two corners: a segment through the origin. This times mu N is the torque that friction under even pressure can hold.
float MeanDistance(const float* x, const float* y, int count);

}  // namespace fulcrum
