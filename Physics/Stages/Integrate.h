// What a substep does to the bodies that constraints touch, apart from the constraints. Called by Solve, for disjoint
// sets of bodies from any number of threads at once. In lanes where a body has nothing that needs a look of its own.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// Forces, damping, locked axes and largest speeds, for h seconds. `again`: not the first substep of its step; the
// bodies then get the change of velocity that constraints gave them in the last one.
void IntegrateVelocities(BodyStore& store, std::span<const uint32_t> bodies, float h, bool again,
                         WorkerFindings& findings);

// What IntegratePoses reads, and the bodies, which it moves. Colliders and pairs: of the contacts of dispersing bodies.
struct MovedBodies {
    const SystemSettings& settings;
    const ColliderStore& colliders;
    const PairStore& pairs;
    const JointStore& joints;
    BodyStore& store;
};

// Displacements, for h seconds, at the largest speeds at most; of jointed bodies the inertia and the gyroscopic torque,
// too. Bodies that no constraint pushed move by v h - a h^2 / 2, which is exact; the next substep takes that off, or,
// where isLast, this. pseudo: by body, what moves it besides its velocity (PullJoints), likewise at the largest speeds
// at most; or null.
void IntegratePoses(const MovedBodies& moved, std::span<const uint32_t> bodies, float h, bool isLast,
                    const BodyState* pseudo, WorkerFindings& findings);

// The angular velocity after h seconds of gyroscopic torque, at the principal axes then reached: Euler's equations in
// the frame of the body, by the implicit midpoint rule. As there, the energy stays, and a body of revolution keeps the
// spin about its axis; a rule that keeps the momentum in world axes lets the spin of a thin rod grow without end.
// inverseInertia: principal, 1/(kg m2). other: what else changes the angular velocity meanwhile, rad/s, and is added
// elsewhere: a joint holds a body against most of its gyroscopic torque, and without the joint's share the velocity in
// the middle would be that of a body that turns freely, which may be ten times as fast. Real: float, or lanes.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> AddGyroscopicTorque(const Vec3<Real>& inverseInertia, const Mat3<Real>& axes,
                                                    const Vec3<Real>& w, Real h,
                                                    const Vec3<Real>& other = Vec3<Real>(Real(0.0f), Real(0.0f),
                                                                                         Real(0.0f))) {
    // Of the moments only ratios count: (1 / iy - 1 / iz) ix = ix^2 (iz - iy) / (ix iy iz), and so on.
    const Vec3<Real> i =
        inverseInertia * (Real(1.0f) / Max(Max(inverseInertia.x(), inverseInertia.y()), inverseInertia.z()));
    const Real product = i[0] * i[1] * i[2];
    const Real scale = h / product;
    const Vec3<Real> rate(scale * (i[0] * i[0] * (i[2] - i[1])), scale * (i[1] * i[1] * (i[0] - i[2])),
                          scale * (i[2] * i[2] * (i[1] - i[0])));
    const Vec3<Real> inertia(i[1] * i[2], i[2] * i[0], i[0] * i[1]);  // times the product
    const Vec3<Real> start(Dot<Real>(axes.x, w), Dot<Real>(axes.y, w), Dot<Real>(axes.z, w));
    // What is no small change, as a pull from afar, is no answer to gyroscopic torque.
    const Real part = Select(Dot<Real>(other, other) < Real(0.0625f) * Dot<Real>(w, w), Real(1.0f), Real(0.0f));
    const Vec3<Real> added =
        Vec3<Real>(Dot<Real>(axes.x, other), Dot<Real>(axes.y, other), Dot<Real>(axes.z, other)) * part;
    const auto energyOf = [&](const Vec3<Real>& u, const Vec3<Real>& v) {
        return inertia.x() * u.x() * v.x() + inertia.y() * u.y() * v.y() + inertia.z() * u.z() * v.z();
    };
    Vec3<Real> end = start + added;
    Vec3<Real> middle = start;
    constexpr int kIterations = 3;
    for (int n = 0; n < kIterations; ++n) {
        middle = (start + end) * Real(0.5f);
        end = start + added +
              Vec3<Real>(rate.x() * middle.y() * middle.z(), rate.y() * middle.z() * middle.x(),
                         rate.z() * middle.x() * middle.y());
    }
    // Gyroscopic torque does no work: twice the energy changes by 2 I middle . added.
    const Real energy = Max(energyOf(start, start) + Real(2.0f) * energyOf(middle, added), Real(0.0f));
    // Rounding is left alone: it would have a sign, substep after substep.
    const Real ratio = energy / energyOf(end, end);
    const Real keeping = Select(Abs(ratio - Real(1.0f)) < Real(1e-6f), Real(1.0f), Sqrt(ratio));
    // The change alone goes through the axes: these are not quite of unit length, and w would grow or shrink with each
    // substep.
    const Vec3<Real> turned = w + axes * Vec3<Real>((end * keeping - added) - start);
    // A moment without end has no torque, and where moments differ by more than floats hold, nothing is known of it.
    const auto isKnown = (product > Real(0.0f)) & ((turned[0] + turned[1] + turned[2]) * Real(0.0f) == Real(0.0f));
    Vec3<Real> result;
    for (int k = 0; k < 3; ++k) result[k] = Select(isKnown, Real(turned[k]), Real(w[k]));
    return result;
}

}  // namespace fulcrum
