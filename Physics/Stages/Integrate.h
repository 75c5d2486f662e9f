// Integration of bodies with constraints in a substep. Called by Solve, for disjoint sets of bodies from any number of
// threads at once. In lanes, except for bodies that need special treatment.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// Applies forces, damping, locked axes and speed limits for h seconds. `again`: not the first substep of the step; the
// velocities are then warm started by the change that constraints made in the last one.
void IntegrateVelocities(BodyStore& store, const JointStore& joints, std::span<const uint32_t> bodies, float h,
                         bool again, WorkerFindings& findings);

// Inputs of IntegratePoses, and the bodies, which it moves. Colliders and pairs are used for the contacts of dispersing
// bodies.
struct MovedBodies {
    const SystemSettings& settings;
    const ColliderStore& colliders;
    const PairStore& pairs;
    const JointStore& joints;
    BodyStore& store;
};

// Integrates displacements for h seconds, within speed limits; for jointed bodies also the inertia and the gyroscopic
// torque. Bodies without constraint impulses move by v h - a h^2 / 2, which is exact; the correction is applied by the
// next substep or, if isLast, by this one. pseudo: pseudo-velocities by body (PullJoints), also limited; or null.
void IntegratePoses(const MovedBodies& moved, std::span<const uint32_t> bodies, float h, bool isLast,
                    const BodyState* pseudo, WorkerFindings& findings);

// The angular velocity after h seconds of gyroscopic torque, at the principal axes then reached: Euler's equations in
// the frame of the body, by the implicit midpoint rule. It conserves energy, and the spin of a body of revolution about
// its axis; an integrator that conserves momentum in world axes lets the spin of a thin rod grow without bound.
// inverseInertia: principal, 1/(kg m2). other: the change of angular velocity by constraints in the same time, rad/s,
// which is added elsewhere: a joint counteracts most of a body's gyroscopic torque, and without its share the midpoint
// velocity would be that of a free body, which may be ten times as large. Real: float, or lanes.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> AddGyroscopicTorque(const Vec3<Real>& inverseInertia, const Mat3<Real>& axes,
                                                    const Vec3<Real>& w, Real h,
                                                    const Vec3<Real>& other = Vec3<Real>(Real(0.0f), Real(0.0f),
                                                                                         Real(0.0f))) {
    // Only ratios of the moments matter: (1 / iy - 1 / iz) ix = ix^2 (iz - iy) / (ix iy iz), and so on.
    const Vec3<Real> i =
        inverseInertia * (Real(1.0f) / Max(Max(inverseInertia.x(), inverseInertia.y()), inverseInertia.z()));
    const Real product = i[0] * i[1] * i[2];
    const Real scale = h / product;
    const Vec3<Real> rate(scale * (i[0] * i[0] * (i[2] - i[1])), scale * (i[1] * i[1] * (i[0] - i[2])),
                          scale * (i[2] * i[2] * (i[1] - i[0])));
    const Vec3<Real> inertia(i[1] * i[2], i[2] * i[0], i[0] * i[1]);  // moments times the product
    const Vec3<Real> start(Dot<Real>(axes.x, w), Dot<Real>(axes.y, w), Dot<Real>(axes.z, w));
    // A large change is not a reaction to gyroscopic torque and is ignored.
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
    // Changes within rounding are ignored: their bias would accumulate.
    const Real ratio = energy / energyOf(end, end);
    const Real keeping = Select(Abs(ratio - Real(1.0f)) < Real(1e-6f), Real(1.0f), Sqrt(ratio));
    // Only the change is transformed by the axes: they are not exactly of unit length, and w would grow or shrink with
    // each substep.
    const Vec3<Real> turned = w + axes * Vec3<Real>((end * keeping - added) - start);
    // No torque if a moment is infinite, or if the ratio of moments overflows a float.
    const auto isKnown = (product > Real(0.0f)) & ((turned[0] + turned[1] + turned[2]) * Real(0.0f) == Real(0.0f));
    Vec3<Real> result;
    for (int k = 0; k < 3; ++k) result[k] = Select(isKnown, Real(turned[k]), Real(w[k]));
    return result;
}

}  // namespace fulcrum
