// The Jacobian of one row, and the effect of impulses along it on the two bodies. Free functions and plain data.
//
//   v1, w1, v2, w2  velocities of the bodies, linear and angular        m, I  their masses and inertias
//   Jacobian:       J = [-a, b], a and b linear and angular:  J v = b . (v2, w2) - a . (v1, w1)
//   Response:       M^-1 J^T, the change of velocities by a unit of impulse: (-a/m1, -I1^-1 a) and (b/m2, I2^-1 b)
#pragma once

#include <Fulcrum/Constraints/Parts/BodySide.h>

namespace fulcrum {

// World axes.
template <class Real>
struct RowJacobian {
    Twist<Real> a, b;  // J = [-a, b]
};

// J applied to velocities (m/s or rad/s), or to displacements: the change of C to first order (m or rad).
template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic, class Real>
FULCRUM_FORCE_INLINE Real RelativeMotion(const RowJacobian<Real>& j, const Twist<Real>& motion1,
                                         const Twist<Real>& motion2) {
    if constexpr (HasVelocity(kSide1) && HasVelocity(kSide2))
        return Dot<Real>(j.b.linear, motion2.linear) + Dot<Real>(j.b.angular, motion2.angular) -
               Dot<Real>(j.a.linear, motion1.linear) - Dot<Real>(j.a.angular, motion1.angular);
    else if constexpr (HasVelocity(kSide2))
        return Dot<Real>(j.b.linear, motion2.linear) + Dot<Real>(j.b.angular, motion2.angular);
    else if constexpr (HasVelocity(kSide1))
        return -Dot<Real>(j.a.linear, motion1.linear) - Dot<Real>(j.a.angular, motion1.angular);
    else return Real(0.0f);
}

// Changes of velocity of the two bodies.
template <class Real>
struct RowResponse {
    Twist<Real> a, b;
};

// M^-1 J^T.
template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic, class Real>
FULCRUM_FORCE_INLINE RowResponse<Real> ResponseOf(const RowJacobian<Real>& j, const InverseMass<Real>& mass1,
                                                  const InverseMass<Real>& mass2) {
    RowResponse<Real> response;
    if constexpr (HasMass(kSide1)) response.a = {j.a.linear.cwiseProduct(-mass1.mass), -(mass1.inertia * j.a.angular)};
    if constexpr (HasMass(kSide2)) response.b = {j.b.linear.cwiseProduct(mass2.mass), mass2.inertia * j.b.angular};
    return response;
}

// Adds response times lambda where lambda is not zero; NaN counts as zero, so that one bad constraint cannot spread NaN
// to bodies, and lanes without an impulse stay bit-identical (ZeroUnless). Returns the lanes in which it was added.
template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic, class Real>
FULCRUM_FORCE_INLINE MaskOf<Real> AddResponse(const RowResponse<Real>& response, const Real& lambda,
                                              Twist<Real>& motion1, Twist<Real>& motion2) {
    const MaskOf<Real> applied = Abs(lambda) > Real(0.0f);
    const auto add = [&](Vec3<Real>& to, const Vec3<Real>& by)
                         FULCRUM_FORCE_INLINE_LAMBDA { to -= ZeroUnless<Real>(applied, Vec3<Real>(by * -lambda)); };
    if constexpr (HasMass(kSide1)) {
        add(motion1.linear, response.a.linear);
        add(motion1.angular, response.a.angular);
    }
    if constexpr (HasMass(kSide2)) {
        add(motion2.linear, response.b.linear);
        add(motion2.angular, response.b.angular);
    }
    return applied;
}

}  // namespace fulcrum
