// Three rows that lock the rotation of two bodies against each other: fixed joints and sliders. Called by joints, which
// gather the bodies' lanes before and scatter them after. One thread per part.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (fixed joint); the error is our own.
//   q1, q2  rotations of the bodies     q0 = q1^-1 q2  where the constraint holds, constant
//   d = q2 q0^-1 q1^-1                  rotation error of body 2, world space: q2 = d q1 q0
//   Constraint:  C = rotation vector of d, the shortest, |C| <= pi
//   Derivative:  dC/dt = w2 - w1 for small C and, for any C, for rotations about C itself
//   Jacobian:    J = [0, -1, 0, 1]
//   K = J M^-1 J^T = I1^-1 + I2^-1
// C is the angle itself, not the imaginary part of d, which is the sine of half the angle: the correction works from
// 180 degrees, too.
#pragma once

#include <Fulcrum/Constraints/Parts/BlockPart.h>
#include <Fulcrum/Math/Trigonometry.h>

namespace fulcrum {

namespace detail {

// The rotation with these columns, orthonormal. Source: S. W. Shepperd, "Quaternion from Rotation Matrix", 1978:
// divides by the largest of the four components, for accuracy.
inline Quaternion RotationFromColumns(const Matrix3& m) {
    const float xx = m.x.x(), yy = m.y.y(), zz = m.z.z(), trace = xx + yy + zz;
    Quaternion q;
    if (trace >= xx && trace >= yy && trace >= zz)
        q = {m.y.z() - m.z.y(), m.z.x() - m.x.z(), m.x.y() - m.y.x(), 1.0f + trace};
    else if (xx >= yy && xx >= zz) q = {1.0f + xx - yy - zz, m.x.y() + m.y.x(), m.x.z() + m.z.x(), m.y.z() - m.z.y()};
    else if (yy >= zz) q = {m.x.y() + m.y.x(), 1.0f + yy - zz - xx, m.y.z() + m.z.y(), m.z.x() - m.x.z()};
    else q = {m.x.z() + m.z.x(), m.y.z() + m.z.y(), 1.0f + zz - xx - yy, m.x.y() - m.y.x()};
    return Normalized(q);
}

}  // namespace detail

// The rotation that maps the x and z axes to the given directions, which must be perpendicular. axisX: unit.
inline Quaternion RotationFromAxesXZ(const Vector3& axisX, const Vector3& axisZ) {
    const Vector3 z = Normalized(axisZ);
    return detail::RotationFromColumns({axisX, Cross(z, axisX), z});
}
// The same for the x and y axes, unit vectors which must not be parallel; the second is orthogonalized against the
// first.
inline Quaternion RotationFromAxesXY(const Vector3& axisX, const Vector3& axisY) {
    return RotationFromAxesXZ(axisX, Vector3(Cross(axisX, axisY)));
}

// q0^-1 for which frames f1 and f2, each in its body's own space, point the same way in the world: q1 f1 = q2 f2.
// With frames in world space it applies to rotations relative to the poses at that time.
template <class Real>
inline Quat<Real> InverseInitialOrientation(const Quat<Real>& frame1, const Quat<Real>& frame2) {
    return frame2 * frame1.Conjugate();
}

// The frame of body 2 for which the constraint holds at the current poses, q1 f1 = q2 f2; used to create joints.
// relative: q1^-1 q2.
inline Quaternion InitialFrame2(const Quaternion& relative, const Quaternion& frame1) {
    return Normalized(relative.Conjugate() * frame1);
}

// C, rad, world space.
template <class Real>
inline Vec3<Real> RotationError(const Quat<Real>& rotation1, const Quat<Real>& rotation2,
                                const Quat<Real>& inverseInitial) {
    return RotationVectorOf<Real>(rotation2 * inverseInitial * rotation1.Conjugate());
}

// kSide1, kSide2: how the bodies move, if known at compile time (BodySide.h).
template <class Real, BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
class RotationEulerPart : public BlockPart<RotationEulerPart<Real, kSide1, kSide2>, Real, 3> {
public:
    using typename BlockPart<RotationEulerPart, Real, 3>::Vector;
    using typename BlockPart<RotationEulerPart, Real, 3>::Mask;

    // Once per substep.
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2) {
        this->SetInverseEffectiveMass(AngularInverseMass<kSide1, kSide2>(mass1, mass2));
    }

    // J applied to velocities (rad/s), or to displacements: the change of C to first order (rad).
    Vector RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        return AngularMotion<kSide1, kSide2>(motion1, motion2);
    }

    // Adds M^-1 J^T lambda, where `applied`.
    void AddImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                    const InverseMass<Real>& mass2, const Vector& lambda, Mask applied) const {
        AddAngularImpulse<kSide1, kSide2>(motion1, motion2, mass1, mass2, lambda, applied);
    }
};

}  // namespace fulcrum
