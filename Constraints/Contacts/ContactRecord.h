// Solver input of one contact manifold, and the impulses kept for warm starting: rows of eight floats, so that Prepare
// can gather the contacts of a batch into lanes. Written by the Collide stage, impulses by Store.
#pragma once

#include <Fulcrum/Constraints/Parts/RowPlaces.h>

#include <cstdint>

namespace fulcrum {

struct alignas(32) ContactRecord {
    static constexpr int kMaxPoints = 4;

    struct Point {
        float onA[3] = {0, 0, 0};  // m, in A's center frame
        // m, in B's center frame; the separation is (onB - onA) . normal at the current poses
        float onB[3] = {0, 0, 0};
    };

    float normal[3] = {0, 1, 0};  // unit, from A to B, in A's center frame
    float pointCount = 0;         // 0..4
    float friction = 0;           // Coulomb coefficient
    float restitution = 0;        // 0..1
    float twistRadius = 0;        // m: mean distance of the contact patch from its center
    float marks = 0;              // sum of its Marks
    // Second row: impulses of the last substep.
    float impulse[kMaxPoints] = {0, 0, 0, 0};  // N s along the normal, by point
    float frictionImpulse[3] = {0, 0, 0};      // N s, world axes, on B
    float twistImpulse = 0;                    // N m s about the normal
    Point points[kMaxPoints];                  // four in three rows

    enum Rows { kHead, kImpulses, kPoints };
    static constexpr int kPointFloats = 6;
    // Rows that contain so many points.
    static constexpr int PointRows(int count) {
        return (kPointFloats * count + static_cast<int>(kRowFloats) - 1) / static_cast<int>(kRowFloats);
    }
    const float* Row(int row) const {
        return reinterpret_cast<const float*>(this) + kRowFloats * static_cast<size_t>(row);
    }
    // Indices in the first row, in the second, and in a point's floats.
    enum Places {
        kNormal = 0,
        kPointCount = 3,
        kFriction = 4,
        kRestitution = 5,
        kTwistRadius = 6,
        kMarks = 7,
        kNormalImpulses = 0,
        kFrictionImpulse = 4,
        kTwistImpulse = 7,
        kOnA = 0,
        kOnB = 3
    };

    // N s along the normal, of the points in use: impulses beyond them are those of earlier steps.
    float TotalImpulse() const {
        float total = 0;
        for (int i = 0; i < static_cast<int>(pointCount); ++i) total += impulse[i];
        return total;
    }

    void ForgetFriction() {
        for (float& f : frictionImpulse) f = 0;
        twistImpulse = 0;
    }
    void ForgetImpulses() {
        for (float& f : impulse) f = 0;
        ForgetFriction();
    }

    // Features that few contacts have, as bits.
    enum Mark { kSurfaceVelocity = 1, kMassOverride = 2, kSensed = 4, kRecollided = 8, kApart = 16 };
    // kSensed: the contact is an event, but not solved
    // kRecollided: it was found again within the step, and its rows are to be replaced; kApart: it was not found
    static constexpr int kAllMarks = kSurfaceVelocity | kMassOverride | kSensed | kRecollided | kApart;
    // The bits, none if `marks` is not finite.
    int Marks() const { return marks >= 0 && marks <= kAllMarks ? static_cast<int>(marks) : 0; }
    bool Has(Mark mark) const { return (Marks() & mark) != 0; }
    void Set(Mark mark, bool has) { marks = static_cast<float>(has ? Marks() | mark : Marks() & ~mark); }
};
static_assert(sizeof(ContactRecord) == 160 &&
              sizeof(ContactRecord::Point) == sizeof(float) * ContactRecord::kPointFloats);
FULCRUM_CHECK_PLACE(ContactRecord, normal, ContactRecord::kHead, ContactRecord::kNormal);
FULCRUM_CHECK_PLACE(ContactRecord, pointCount, ContactRecord::kHead, ContactRecord::kPointCount);
FULCRUM_CHECK_PLACE(ContactRecord, friction, ContactRecord::kHead, ContactRecord::kFriction);
FULCRUM_CHECK_PLACE(ContactRecord, restitution, ContactRecord::kHead, ContactRecord::kRestitution);
FULCRUM_CHECK_PLACE(ContactRecord, twistRadius, ContactRecord::kHead, ContactRecord::kTwistRadius);
FULCRUM_CHECK_PLACE(ContactRecord, marks, ContactRecord::kHead, ContactRecord::kMarks);
FULCRUM_CHECK_PLACE(ContactRecord, impulse, ContactRecord::kImpulses, ContactRecord::kNormalImpulses);
FULCRUM_CHECK_PLACE(ContactRecord, frictionImpulse, ContactRecord::kImpulses, ContactRecord::kFrictionImpulse);
FULCRUM_CHECK_PLACE(ContactRecord, twistImpulse, ContactRecord::kImpulses, ContactRecord::kTwistImpulse);
FULCRUM_CHECK_PLACE(ContactRecord, points, ContactRecord::kPoints, 0);
FULCRUM_CHECK_PLACE(ContactRecord::Point, onA, 0, ContactRecord::kOnA);
FULCRUM_CHECK_PLACE(ContactRecord::Point, onB, 0, ContactRecord::kOnB);

// Surface velocity of B relative to A in addition to the motion of the bodies, world axes, of contacts with
// kSurfaceVelocity; zero for others.
struct SurfaceVelocity {
    float linear[3] = {0, 0, 0};   // m/s, at the contact's center
    float angular[3] = {0, 0, 0};  // rad/s
};

// Mean distance from the origin over the area of a convex polygon that contains it; `x`, `y` are its corners in any
// order, at most 4. Over the triangle (0, P, Q) it is 2/3 of the mean over the edge PQ, which Simpson's rule gives to
// 1e-3. Two corners: a segment through the origin. This times mu N is the largest friction torque under uniform
// pressure.
float MeanDistance(const float* x, const float* y, int count);

}  // namespace fulcrum
