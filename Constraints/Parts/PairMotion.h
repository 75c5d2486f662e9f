// Relative motion of two bodies, and the effect of impulses on them, at a common point or for rotation only; shared by
// the block parts. Template parameters kSide as in BodySide.h. Free functions, no state.
//
//   r1, r2  from the centers of mass to the point at which an impulse acts on each body (the same point, if momentum
//           is to be kept)
//   Point:    J v = v2 + w2 x r2 - v1 - w1 x r1,  K = 1/m1 + 1/m2 + sum of [r]x I^-1 [r]x^T
//   Angular:  J v = w2 - w1,                      K = I1^-1 + I2^-1
// Impulses are subtracted, with zeros where `applied` is false, which keeps inactive lanes bit-identical (ZeroUnless).
#pragma once

#include <Fulcrum/Constraints/Parts/BodySide.h>

namespace fulcrum {

// m/s, or m for displacements.
template <class Real>
inline Vec3<Real> PointMotion(const Twist<Real>& motion1, const Twist<Real>& motion2, const Vec3<Real>& r1,
                              const Vec3<Real>& r2) {
    const Vec3<Real> at1 = motion1.linear + Cross<Real>(motion1.angular, r1);
    const Vec3<Real> at2 = motion2.linear + Cross<Real>(motion2.angular, r2);
    return at2 - at1;
}

// rad/s, or rad.
template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic, class Real>
inline Vec3<Real> AngularMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) {
    Vec3<Real> of1(Real(0.0f), Real(0.0f), Real(0.0f)), of2 = of1;
    if constexpr (HasVelocity(kSide1)) of1 = motion1.angular;
    if constexpr (HasVelocity(kSide2)) of2 = motion2.angular;
    return of2 - of1;
}

// impulse: N s, on body 2; body 1 gets the opposite.
template <class Real>
inline void AddPointImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                            const InverseMass<Real>& mass2, const Vec3<Real>& r1, const Vec3<Real>& r2,
                            const Vec3<Real>& impulse, MaskOf<Real> applied) {
    const Vec3<Real> linear1 = impulse.cwiseProduct(mass1.mass), angular1 = mass1.inertia * Cross<Real>(r1, impulse);
    motion1.linear -= ZeroUnless<Real>(applied, linear1);
    motion1.angular -= ZeroUnless<Real>(applied, angular1);
    const Vec3<Real> linear2 = impulse.cwiseProduct(-mass2.mass), angular2 = mass2.inertia * Cross<Real>(impulse, r2);
    motion2.linear -= ZeroUnless<Real>(applied, linear2);
    motion2.angular -= ZeroUnless<Real>(applied, angular2);
}

// impulse: N m s, on body 2; body 1 gets the opposite.
template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic, class Real>
inline void AddAngularImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                              const InverseMass<Real>& mass2, const Vec3<Real>& impulse, MaskOf<Real> applied) {
    if constexpr (HasMass(kSide1)) {
        const Vec3<Real> angular = mass1.inertia * impulse;
        motion1.angular -= ZeroUnless<Real>(applied, angular);
    }
    if constexpr (HasMass(kSide2)) {
        const Vec3<Real> angular = -(mass2.inertia * impulse);
        motion2.angular -= ZeroUnless<Real>(applied, angular);
    }
}

template <class Real>
inline Sym3<Real> operator+(const Sym3<Real>& a, const Sym3<Real>& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}

// 1/m + [r]x I^-1 [r]x^T of one body: the velocity that an impulse at r gives to the point r.
template <class Real>
inline Sym3<Real> PointInverseMass(const InverseMass<Real>& mass, const Vec3<Real>& r) {
    const Sym3<Real>& i = mass.inertia;
    const Real x = r.x(), y = r.y(), z = r.z();
    const Real xx = x * x, yy = y * y, zz = z * z, xy = x * y, xz = x * z, yz = y * z;
    const Real two(2.0f);
    Sym3<Real> k;
    k.xx = mass.mass.x() + (zz * i.yy - two * (yz * i.yz) + yy * i.zz);
    k.yy = mass.mass.y() + (zz * i.xx - two * (xz * i.xz) + xx * i.zz);
    k.zz = mass.mass.z() + (yy * i.xx - two * (xy * i.xy) + xx * i.yy);
    k.xy = xz * i.yz + yz * i.xz - zz * i.xy - xy * i.zz;
    k.xz = yz * i.xy + xy * i.yz - xz * i.yy - yy * i.xz;
    k.yz = xz * i.xy + xy * i.xz - yz * i.xx - xx * i.yz;
    return k;
}
// Sum over both bodies.
template <class Real>
inline Sym3<Real> PointInverseMass(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const Vec3<Real>& r1,
                                   const Vec3<Real>& r2) {
    return PointInverseMass(mass1, r1) + PointInverseMass(mass2, r2);
}
template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic, class Real>
inline Sym3<Real> AngularInverseMass(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2) {
    Sym3<Real> k1, k2;
    if constexpr (HasMass(kSide1)) k1 = mass1.inertia;
    if constexpr (HasMass(kSide2)) k2 = mass2.inertia;
    return k1 + k2;
}

// a . K b
template <class Real>
inline Real Between(const Vec3<Real>& a, const Sym3<Real>& k, const Vec3<Real>& b) {
    return Dot<Real>(a, k * b);
}

}  // namespace fulcrum
