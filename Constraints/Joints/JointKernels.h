// Shared by the joint kernels: dispatch by a batch's locks, set-up and solve of the parts.
#pragma once

#include <Fulcrum/Constraints/Joints/JointLanes.h>

#include <cmath>

namespace fulcrum::joints {

// Calls f(std::integral_constant<LinearLock, ...>, std::integral_constant<AngularLock, ...>) with the batch's locks.
template <class F>
FULCRUM_FORCE_INLINE void WithLocks(LinearLock linear, AngularLock angular, F&& f) {
    const auto withAngular = [&](auto l) {
        switch (angular) {
            case AngularLock::None: f(l, std::integral_constant<AngularLock, AngularLock::None>()); break;
            case AngularLock::Axis: f(l, std::integral_constant<AngularLock, AngularLock::Axis>()); break;
            case AngularLock::All: f(l, std::integral_constant<AngularLock, AngularLock::All>()); break;
        }
    };
    switch (linear) {
        case LinearLock::None: withAngular(std::integral_constant<LinearLock, LinearLock::None>()); break;
        case LinearLock::Line: withAngular(std::integral_constant<LinearLock, LinearLock::Line>()); break;
        case LinearLock::Point: withAngular(std::integral_constant<LinearLock, LinearLock::Point>()); break;
    }
}

// The point at which a point lock's impulse and its reaction act, as a fraction of the offset from A's anchor to B's.
// Both act at the same point, which conserves angular momentum: halfway, or at the anchor of the only dynamic body.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> ImpulsePointFraction(uint32_t fixedA, uint32_t fixedB) {
    Wide<N> share(0.5f);
    if ((fixedA | fixedB) != 0)
        for (int i = 0; i < N; ++i)
            if ((fixedA | fixedB) >> i & 1u) share.Set(i, fixedA >> i & 1u ? 1.0f : 0.0f);
    return share;
}

// The gap of a lock, no longer than the longer arm. Farther out no impulse acts: lever arms as long as a long gap would
// spin up small bodies. There angular momentum is not conserved.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> WithinArms(const Vec3<Real>& gap, const Vec3<Real>& armA, const Vec3<Real>& armB) {
    const Real squared = Dot<Real>(gap, gap), most = Max(Dot<Real>(armA, armA), Dot<Real>(armB, armB));
    const auto isLong = squared > most;
    if (!isLong.Any()) [[likely]]
        return gap;
    return gap * Select(isLong, Sqrt(most / Select(isLong, squared, Real(1.0f))), Real(1.0f));
}

// The part of an error that a position iteration corrects: all of it where the priority is high, so that those after
// which it is solved do not matter.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> PartCorrected(uint32_t high, const JointSolveSettings& settings) {
    Wide<N> part(settings.baumgarte);
    if (high != 0) [[unlikely]]
        for (int i = 0; i < N; ++i)
            if (high >> i & 1u) part.Set(i, 1.0f);
    return part;
}

// The correction of an error in a position iteration.
template <class Real>
FULCRUM_FORCE_INLINE Real Corrected(const Real& error, const Real& part, const JointSolveSettings& settings) {
    const Real most(settings.maxPushSpeed * settings.substepDt);
    return Clamp(Real(error * part), -most, most);
}

// The solver stores no displacement of kinematic bodies: it is velocity times time.
template <int N>
FULCRUM_FORCE_INLINE void AddKinematicMotion(Twist<Wide<N>>& displacement, const Twist<Wide<N>>& velocity,
                                             uint32_t kinematic, float elapsed) {
    if (kinematic == 0) return;
    Wide<N> time(0.0f);
    for (int i = 0; i < N; ++i)
        if (kinematic >> i & 1u) time.Set(i, elapsed);
    displacement.linear += velocity.linear * time;
    displacement.angular += velocity.angular * time;
}

template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Zero() {
    return Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));
}

// The normal orthogonalized against the axis and normalized, so that it rotates with the axis without twist.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Straightened(const Vec3<Real>& normal, const Vec3<Real>& axis) {
    const Vec3<Real> flat = normal - axis * Dot<Real>(axis, normal);
    return flat * (Real(1.0f) / Sqrt(Max(Dot<Real>(flat, flat), Real(1e-12f))));
}

// The locks' own impulses plus their reaction to the rows. Lanes without rows, whose reaction is +0, stay bit-identical
// to a batch without rows; adding that zero would turn -0 into +0.
template <class Lambda, class Real>
FULCRUM_FORCE_INLINE void AddReaction(Lambda& lambda, const Vec3<Real>& reaction) {
    for (int k = 0; k < lambda.size(); ++k) lambda[k] -= Real(0.0f) - reaction[k];
}

// As RotationFromVector.
template <class Real>
FULCRUM_FORCE_INLINE Quat<Real> RotationOf(const Vec3<Real>& v) {
    const Vec2<Real> half = HalfTurnOf<Real>(v);
    return {v.x() * half.x(), v.y() * half.x(), v.z() * half.x(), half.y()};
}

// Anchors and axes of a batch, at the start of the step or displaced.
template <class Real>
struct JointPlace {
    Vec3<Real> armA, armB, offset;
    Vec3<Real> line, lineNormal;
    Vec3<Real> axisA, axisB, normal;
    Vec3<Real> rotationError;  // rad, see RotationEulerPart.h
};

// The residuals of the locks.
template <class Real>
struct JointErrors {
    Vec3<Real> point = Zero<Real>();
    Vec2<Real> line = Vec2<Real>(Real(0.0f), Real(0.0f));
    Vec3<Real> rotation = Zero<Real>();
    Vec2<Real> hinge = Vec2<Real>(Real(0.0f), Real(0.0f));
};

// The least mobility that translation, or rotation, alone gives in any direction: 0 if an axis is locked in both
// bodies, or in the only dynamic one.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> LeastTranslation(const JointBatch<N>& batch) {
    const Vec3<Wide<N>> masses = batch.massA.mass + batch.massB.mass;
    return Min(Min(masses.x(), masses.y()), masses.z());
}
template <int N>
FULCRUM_FORCE_INLINE Wide<N> LeastRotation(const JointBatch<N>& batch) {
    const Sym3<Wide<N>> all = AngularInverseMass(batch.massA, batch.massB);
    return Min(Min(all.xx, all.yy), all.zz);
}

template <class Real>
FULCRUM_FORCE_INLINE bool IsLocked(const Real& least) {
    return (least <= Real(0.0f)).Any();
}

// An eigenvalue of an inverse mass below about this part of the trace is next to none where axes are locked.
constexpr float kLeastMobility = 1e-4f;

// In lanes where an axis is locked: the inverse of k with x / (x + damping)^2 instead of 1 / x for each eigenvalue x,
// if some is smaller than about the damping. inverse: of k, as it stays in other lanes. least: see above. trace: of the
// matrix of which k is a part, to which its rounding errors are relative. Locked axes leave directions in which a joint
// has next to no mobility. To move along one its bodies would have to move many times as fast, and impulses along it
// grow, without effect, until the direction has rotated, and they have one. Damped least squares as in C. W. Wampler,
// "Manipulator Inverse Kinematic Solutions Based on Vector Formulations and Damped Least-Squares Methods", whose
// 1 / (x + damping) is multiplied by x over that: where nothing can move there is no impulse.
template <class Real>
[[gnu::noinline, gnu::cold]] Sym3<Real> InverseWhereLocked(const Sym3<Real>& k, const Sym3<Real>& inverse,
                                                           const Real& trace, const Real& least) {
    const Real damping = trace * Real(kLeastMobility);
    const Sym3<Real> known = SymmetricInverse(k, Vec3<Real>(trace, trace, trace), Real(0.0f));
    Sym3<Real> damped = k;
    damped.xx += damping;
    damped.yy += damping;
    damped.zz += damping;
    damped = SymmetricInverse(damped);
    const Vec3<Real> x(damped.xx, damped.xy, damped.xz), y(damped.xy, damped.yy, damped.yz),
        z(damped.xz, damped.yz, damped.zz);
    const Vec3<Real> kx = k * x, ky = k * y, kz = k * z;
    const auto isLocked = least <= Real(0.0f), isSmall = Max(Max(known.xx, known.yy), known.zz) * damping > Real(1.0f);
    const auto choose = [&](const Real& small, const Real& usual, const Real& before) {
        return Select(isLocked, Select(isSmall, small, usual), before);
    };
    Sym3<Real> result;
    result.xx = choose(Dot<Real>(x, kx), known.xx, inverse.xx);
    result.yy = choose(Dot<Real>(y, ky), known.yy, inverse.yy);
    result.zz = choose(Dot<Real>(z, kz), known.zz, inverse.zz);
    result.xy = choose(Dot<Real>(x, ky), known.xy, inverse.xy);
    result.xz = choose(Dot<Real>(x, kz), known.xz, inverse.xz);
    result.yz = choose(Dot<Real>(y, kz), known.yz, inverse.yz);
    return result;
}
// As of a matrix whose third direction cannot move.
template <class Real>
[[gnu::noinline, gnu::cold]] Sym2<Real> InverseWhereLocked(const Sym2<Real>& k, const Sym2<Real>& inverse,
                                                           const Real& trace, const Real& least) {
    const auto widened = [](const Sym2<Real>& m) {
        Sym3<Real> wide;
        wide.xx = m.xx;
        wide.yy = m.yy;
        wide.xy = m.xy;
        return wide;
    };
    const Sym3<Real> result = InverseWhereLocked<Real>(widened(k), widened(inverse), trace, least);
    return {result.xx, result.yy, result.xy};
}

// Sets the parts up, hard and without bias, and returns the errors.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE JointErrors<Wide<N>> SetUpParts(JointBatch<N>& batch, const JointPlace<Wide<N>>& place) {
    using Real = Wide<N>;
    JointErrors<Real> errors;
    if constexpr (kAngular == AngularLock::All) {
        errors.rotation = place.rotationError;
        batch.rotation.CalculateProperties(batch.massA, batch.massB);
    }
    if constexpr (kAngular == AngularLock::Axis) {
        const Vec3<Real> b = Straightened<Real>(place.normal, place.axisB);
        const Vec3<Real> c = Cross<Real>(place.axisB, b);
        errors.hinge = HingeError<Real>(place.axisA, b, c);
        batch.hinge.CalculateProperties(batch.massA, batch.massB, b, c);
        if (const Real least = LeastRotation(batch); IsLocked(least)) [[unlikely]] {
            const Sym3<Real> all = AngularInverseMass(batch.massA, batch.massB);
            const Sym2<Real> k{Between(c, all, c), Between(b, all, b), -Between(c, all, b)};
            batch.hinge.SetEffectiveMass(
                InverseWhereLocked(k, batch.hinge.GetEffectiveMass(), Real(all.xx + all.yy + all.zz), least));
        }
    }
    if constexpr (kLinear == LinearLock::Point) {
        const Real share = ImpulsePointFraction<N>(batch.fixedA, batch.fixedB);
        errors.point = place.offset;
        const Vec3<Real> between = WithinArms<Real>(place.offset, place.armA, place.armB);
        batch.point.CalculateProperties(batch.massA, batch.massB, Vec3<Real>(place.armA + between * share),
                                        Vec3<Real>(place.armB - between * (Real(1.0f) - share)));
        if (const Real least = LeastTranslation(batch); kAngular == AngularLock::None && IsLocked(least)) [[unlikely]] {
            const Sym3<Real> k =
                PointInverseMass(batch.massA, batch.massB, batch.point.GetArm1(), batch.point.GetArm2());
            batch.point.SetEffectiveMass(
                InverseWhereLocked(k, batch.point.GetEffectiveMass(), Real(k.xx + k.yy + k.zz), least));
        }
    }
    if constexpr (kLinear == LinearLock::Line) {
        const Vec3<Real> n1 = Straightened<Real>(place.lineNormal, place.line);
        const Vec3<Real> n2 = Cross<Real>(place.line, n1);
        errors.line = Vec2<Real>(Dot<Real>(place.offset, n1), Dot<Real>(place.offset, n2));
        const Vec3<Real> across = n1 * errors.line.x() + n2 * errors.line.y(),
                         onLine = place.armA + place.offset - across,
                         armA = onLine + WithinArms<Real>(across, onLine, place.armB);
        batch.line.CalculateProperties(batch.massA, batch.massB, {armA, place.armB, n1, n2});
        if (const Real least = LeastTranslation(batch); kAngular == AngularLock::None && IsLocked(least)) [[unlikely]] {
            const Sym3<Real> all = PointInverseMass(batch.massA, batch.massB, armA, place.armB);
            const Sym2<Real> k{Between(n1, all, n1), Between(n2, all, n2), Between(n1, all, n2)};
            batch.line.SetEffectiveMass(
                InverseWhereLocked(k, batch.line.GetEffectiveMass(), Real(all.xx + all.yy + all.zz), least));
        }
    }
    return errors;
}

// Calls f(axis, index) for the axes of the angular lock's rows.
template <AngularLock kAngular, int N, class F>
FULCRUM_FORCE_INLINE void VisitAngularRows(const JointBatch<N>& batch, F&& f) {
    using Real = Wide<N>;
    const Real zero(0.0f), one(1.0f);
    if constexpr (kAngular == AngularLock::All) {
        f(Vec3<Real>(one, zero, zero), 0);
        f(Vec3<Real>(zero, one, zero), 1);
        f(Vec3<Real>(zero, zero, one), 2);
    }
    if constexpr (kAngular == AngularLock::Axis) {
        f(Vec3<Real>(-batch.hinge.GetC2()), 0);
        f(batch.hinge.GetB2(), 1);
    }
}

template <LinearLock kLinear, AngularLock kAngular>
inline constexpr bool kCoupled = kLinear != LinearLock::None&& kAngular != AngularLock::None;

template <LinearLock kLinear, class Batch>
FULCRUM_FORCE_INLINE auto& LinearPart(Batch& batch) {
    if constexpr (kLinear == LinearLock::Line) return batch.line;
    else return batch.point;
}
template <AngularLock kAngular, class Batch>
FULCRUM_FORCE_INLINE auto& AngularPart(Batch& batch) {
    if constexpr (kAngular == AngularLock::Axis) return batch.hinge;
    else return batch.rotation;
}

// After SetUpParts: the coupling of the two locks.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SetUpCoupling(JointBatch<N>& batch) {
    using Real = Wide<N>;
    if constexpr (kCoupled<kLinear, kAngular>) {
        constexpr int kColumns = kAngular == AngularLock::All ? 3 : 2;
        Vec3<Real> armA, armB;
        if constexpr (kLinear == LinearLock::Point) {
            armA = batch.point.GetArm1();
            armB = batch.point.GetArm2();
        } else {
            armA = batch.line.GetFrame().r1PlusU;
            armB = batch.line.GetFrame().r2;
        }
        VisitAngularRows<kAngular>(batch, [&](const Vec3<Real>& axis, int k) {
            const Vec3<Real> turnA = batch.massA.inertia * axis, turnB = batch.massB.inertia * axis;
            const Vec3<Real> column = Cross<Real>(turnA, armA) + Cross<Real>(turnB, armB);
            if constexpr (kLinear == LinearLock::Point) {
                batch.cross[k] = column;
            } else {
                const auto& frame = batch.line.GetFrame();
                batch.cross[k] = Vec3<Real>(Dot<Real>(frame.axis1, column), Dot<Real>(frame.axis2, column), Real(0.0f));
            }
        });
        const auto& angularMass = AngularPart<kAngular>(batch).GetEffectiveMass();
        // S = K - sum of C_k (K_angular^-1 C^T)_k
        Sym3<Real> s = PointInverseMass(batch.massA, batch.massB, armA, armB);
        // Its rounding errors are relative to this, those along a line to all axes.
        Vec3<Real> scale(s.xx, s.yy, s.zz);
        if constexpr (kLinear == LinearLock::Line) {
            const auto& frame = batch.line.GetFrame();
            const Sym3<Real> point = s;
            scale.x() = scale.y() = s.xx + s.yy + s.zz;
            s.xx = Between(frame.axis1, point, frame.axis1);
            s.yy = Between(frame.axis2, point, frame.axis2);
            s.xy = Between(frame.axis1, point, frame.axis2);
        }
        const Vec3<Real>(&c)[3] = batch.cross;
        Vec3<Real> weighted[3];
        if constexpr (kColumns == 3) {
            const auto& m = angularMass;
            weighted[0] = c[0] * m.xx + c[1] * m.xy + c[2] * m.xz;
            weighted[1] = c[0] * m.xy + c[1] * m.yy + c[2] * m.yz;
            weighted[2] = c[0] * m.xz + c[1] * m.yz + c[2] * m.zz;
        } else {
            const auto& m = angularMass;
            weighted[0] = c[0] * m.xx + c[1] * m.xy;
            weighted[1] = c[0] * m.xy + c[1] * m.yy;
        }
        for (int k = 0; k < kColumns; ++k) {
            s.xx -= c[k].x() * weighted[k].x();
            s.yy -= c[k].y() * weighted[k].y();
            s.xy -= c[k].x() * weighted[k].y();
            if constexpr (kLinear == LinearLock::Point) {
                s.zz -= c[k].z() * weighted[k].z();
                s.xz -= c[k].x() * weighted[k].z();
                s.yz -= c[k].y() * weighted[k].z();
            }
        }
        // Translation alone: what locks of axes leave of it.
        const Real least = LeastTranslation(batch);
        if constexpr (kLinear == LinearLock::Point) {
            batch.coupledPoint = SymmetricInverse(s, scale, least);
            if (IsLocked(least)) [[unlikely]]
                batch.coupledPoint =
                    InverseWhereLocked(s, batch.coupledPoint, Real(scale.x() + scale.y() + scale.z()), least);
        } else {
            const Sym2<Real> flat{s.xx, s.yy, s.xy};
            batch.coupledLine = SymmetricInverse(flat, Vec2<Real>(scale.x(), scale.y()), least);
            if (IsLocked(least)) [[unlikely]]
                batch.coupledLine = InverseWhereLocked(flat, batch.coupledLine, scale.x(), least);
        }
    }
}

// Impulses of the locks, one component per row of the parts.
template <class Real>
struct LockImpulses {
    Vec3<Real> linear = Zero<Real>(), angular = Zero<Real>();
};

// K^-1 (linear, angular) with K of both locks. Unused components are zero.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE LockImpulses<Wide<N>> SolveBlock(JointBatch<N>& batch, const Vec3<Wide<N>>& linear,
                                                      const Vec3<Wide<N>>& angular) {
    using Real = Wide<N>;
    LockImpulses<Real> x;
    const auto timesAngular = [&](const Vec3<Real>& v) {
        if constexpr (kAngular == AngularLock::All) {
            return Vec3<Real>(batch.rotation.GetEffectiveMass() * v);
        } else {
            const Vec2<Real> two = batch.hinge.GetEffectiveMass() * Vec2<Real>(v.x(), v.y());
            return Vec3<Real>(two.x(), two.y(), Real(0.0f));
        }
    };
    const auto timesLinear = [&](const Vec3<Real>& v) {
        if constexpr (kLinear == LinearLock::Point) {
            if constexpr (kCoupled<kLinear, kAngular>) return Vec3<Real>(batch.coupledPoint * v);
            else return Vec3<Real>(batch.point.GetEffectiveMass() * v);
        } else {
            const Vec2<Real> flat(v.x(), v.y());
            Vec2<Real> two;
            if constexpr (kCoupled<kLinear, kAngular>) two = batch.coupledLine * flat;
            else two = batch.line.GetEffectiveMass() * flat;
            return Vec3<Real>(two.x(), two.y(), Real(0.0f));
        }
    };
    if constexpr (kCoupled<kLinear, kAngular>) {
        constexpr int kColumns = kAngular == AngularLock::All ? 3 : 2;
        const Vec3<Real> alone = timesAngular(angular);
        Vec3<Real> rest = linear;
        for (int k = 0; k < kColumns; ++k) rest -= batch.cross[k] * alone[k];
        x.linear = timesLinear(rest);
        Vec3<Real> left = angular;
        for (int k = 0; k < kColumns; ++k) left[k] -= Dot<Real>(batch.cross[k], x.linear);
        x.angular = timesAngular(left);
    } else if constexpr (kLinear != LinearLock::None) {
        x.linear = timesLinear(linear);
    } else if constexpr (kAngular != AngularLock::None) {
        x.angular = timesAngular(angular);
    }
    return x;
}

template <class Rows, class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Widened(const Rows& rows, Real zero) {
    if constexpr (Rows::size() == 3) return rows;
    else return Vec3<Real>(rows.x(), rows.y(), zero);
}

// L v: the velocities of the locks' rows.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE LockImpulses<Wide<N>> LockMotion(JointBatch<N>& batch, const Twist<Wide<N>>& a,
                                                      const Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    LockImpulses<Real> motion;
    if constexpr (kLinear != LinearLock::None)
        motion.linear = Widened(LinearPart<kLinear>(batch).RelativeMotion(a, b), Real(0.0f));
    if constexpr (kAngular != AngularLock::None)
        motion.angular = Widened(AngularPart<kAngular>(batch).RelativeMotion(a, b), Real(0.0f));
    return motion;
}

// Adds M^-1 L^T impulses.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void AddLockMotion(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b,
                                        const LockImpulses<Wide<N>>& x) {
    using Real = Wide<N>;
    const auto add = [&](const auto& part, const Vec3<Real>& impulse) {
        auto rows = part.GetTotalLambda();
        for (int k = 0; k < rows.size(); ++k) rows[k] = impulse[k];
        part.AddImpulse(a, b, batch.massA, batch.massB, rows, Real(0.0f) < Real(1.0f));
    };
    if constexpr (kAngular != AngularLock::None) add(AngularPart<kAngular>(batch), x.angular);
    if constexpr (kLinear != LinearLock::None) add(LinearPart<kLinear>(batch), x.linear);
}

// Rotates a row with both bodies (JointRow::Pivot), where its axis is well-defined.
template <int N>
FULCRUM_FORCE_INLINE void PivotRow(JointRows<N>& row, const Mat3<Wide<N>>& turnA, const Mat3<Wide<N>>& turnB) {
    using Real = Wide<N>;
    // Sine squared of a swing, the narrower ones having no direction, and square of the sum of nearly opposite axes.
    constexpr float kLeastAcross = kLimitSlop * kLimitSlop, kLeastBetween = 0.01f;
    const Real half(0.5f), zero(0.0f), one(1.0f);
    row.ofA = turnA * row.ofA;
    row.ofB = turnB * row.ofB;
    const Vec3<Real> across = Cross<Real>(row.ofA, row.ofB), between = row.ofA + row.ofB;
    Vec3<Real> axis;
    for (int k = 0; k < 3; ++k) axis[k] = Select(row.across > half, across[k], between[k]);
    const Real squared = Dot<Real>(axis, axis);
    const auto pivots = (row.across + row.between > half) &
                        (squared > Select(row.across > half, Real(kLeastAcross), Real(kLeastBetween)));
    RowJacobian<Real> j = row.part.GetJacobian();
    const Real length = one / Sqrt(Select(pivots, squared, one));
    axis = axis * Select(Dot<Real>(axis, j.b.angular) < zero, -length, length);
    for (int k = 0; k < 3; ++k) {
        j.a.angular[k] = Select(pivots, axis[k], j.a.angular[k]);
        j.b.angular[k] = Select(pivots, axis[k], j.b.angular[k]);
    }
    row.part.SetJacobian(j);
}

// Updates the rows' errors and directions after the bodies moved. Errors are integrated incrementally with the rotated
// directions: a direction that is not rotated would eventually act against the locks.
template <int N>
FULCRUM_FORCE_INLINE void MoveRows(JointBatch<N>& batch, const Twist<Wide<N>>& a, const Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    // The rotation from one rotation vector to another: the left Jacobian of rotations times their difference.
    const auto between = [](const Vec3<Real>& from, const Vec3<Real>& to) {
        const Vec3<Real> across = Cross<Real>(from, to);
        const Real squared = Dot<Real>(from, from);
        // (1 - cos t) / t^2 and (t - sin t) / t^3 for an angle t.
        Real first = Real(0.5f) - squared * (Real(1.0f / 24) - squared * Real(1.0f / 720));
        Real second = Real(1.0f / 6) - squared * (Real(1.0f / 120) - squared * Real(1.0f / 5040));
        const auto isFar = squared > Real(0.25f);
        if (isFar.Any()) [[unlikely]] {
            const Real angle = Sqrt(squared), per = Real(1.0f) / Max(squared, Real(0.25f));
            const SineCosine<Real> at = SinCos<Real>(Min(angle, Real(kFarthestTurn)));
            first = Select(isFar, (Real(1.0f) - at.cosine) * per, first);
            second = Select(isFar, (angle - at.sine) * per / Max(angle, Real(0.5f)), second);
        }
        const auto isUsual = squared <= Real(kFarthestTurn * kFarthestTurn);
        const Vec3<Real> more = across * first + Cross<Real>(from, across) * second;
        Vec3<Real> sum = to - from;
        for (int k = 0; k < 3; ++k) sum[k] = Select(isUsual, Real(sum[k] + more[k]), Real(sum[k]));
        return sum;
    };
    const Twist<Real> moreA{a.linear - batch.wayA.linear, between(batch.wayA.angular, a.angular)};
    const Twist<Real> moreB{b.linear - batch.wayB.linear, between(batch.wayB.angular, b.angular)};
    batch.wayA = a;
    batch.wayB = b;
    const Mat3<Real> turn = ToMatrix(RotationOf<Real>(moreA.angular));
    Mat3<Real> turnB;
    if (batch.pivots) turnB = ToMatrix(RotationOf<Real>(moreB.angular));
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& row = batch.rows[i];
        const Real error = row.error, before = RelativeMotion<>(row.part.GetJacobian(), moreA, moreB);
        row.error = error + before;
        if (!batch.rowsTurnWithA) continue;
        const auto turns = row.turnsWithA > Real(0.5f);
        RowJacobian<Real> j = row.part.GetJacobian();
        for (Vec3<Real>* v : {&j.a.linear, &j.a.angular, &j.b.linear, &j.b.angular}) {
            const Vec3<Real> turned = turn * *v;
            for (int k = 0; k < 3; ++k) (*v)[k] = Select(turns, turned[k], (*v)[k]);
        }
        row.part.SetJacobian(j);
        if (!batch.pivots) continue;
        PivotRow(row, turn, turnB);
        // Along a circle about the pivot the error does not change.
        const Real after = RelativeMotion<>(row.part.GetJacobian(), moreA, moreB);
        row.error = Select(row.across + row.between > Real(0.5f), error + (before + after) * Real(0.5f), row.error);
    }
}

// The line between the anchors, if they are apart; else the previous direction.
template <int N>
FULCRUM_FORCE_INLINE void RotateRadialRow(const JointBatch<N>& batch, JointRows<N>& row,
                                          const JointPlace<Wide<N>>& place) {
    using Real = Wide<N>;
    const Real squared = Dot<Real>(place.offset, place.offset), one(1.0f);
    const auto turns = (row.radial > Real(0.5f)) & (squared > Real(1e-10f));
    const Real inverse = one / Sqrt(Select(turns, squared, one));
    Vec3<Real> n = place.offset * inverse;
    // Rows of an upper limit of the distance have the opposite sign.
    const RowJacobian<Real>& before = row.part.GetJacobian();
    const Real sign = Select(Dot<Real>(n, before.b.linear) < Real(0.0f), -one, one);
    n = n * sign;
    const RowJacobian<Real> along = AxisJacobian<Real>({place.armA + place.offset, place.armB, n});
    const auto choose = [&](const Vec3<Real>& turned, const Vec3<Real>& as) {
        return Vec3<Real>(Select(turns, turned.x(), as.x()), Select(turns, turned.y(), as.y()),
                          Select(turns, turned.z(), as.z()));
    };
    row.part.SetJacobian({{choose(along.a.linear, before.a.linear), choose(along.a.angular, before.a.angular)},
                          {choose(along.b.linear, before.b.linear), choose(along.b.angular, before.b.angular)}});
    const Real start = Sqrt(Dot<Real>(batch.startOffset, batch.startOffset));
    row.error = Select(turns, row.startError + sign * (squared * inverse - start), row.error);
}

// Rotates radial rows with the line between the anchors, if they are apart.
template <int N>
FULCRUM_FORCE_INLINE void RotateRadialRows(JointBatch<N>& batch, const JointPlace<Wide<N>>& place) {
    batch.radialArmA = place.armA;
    batch.radialArmB = place.armB;
    batch.radialOffset = place.offset;
    for (uint32_t i = 0; i < batch.rowCount; ++i) RotateRadialRow(batch, batch.rows[i], place);
}

// Adds the reaction of the rows that are locks to the responses of the others, and of those before it to each of them.
template <int N>
FULCRUM_FORCE_INLINE void AddLockRowReactions(JointBatch<N>& batch) {
    using Real = Wide<N>;
    const Real half(0.5f), zero(0.0f);
    const auto react = [&](JointRows<N>& row, uint32_t count, const WideMask<N>& lanes) {
        RowResponse<Real> response = row.part.GetResponse();
        const auto add = [](const WideMask<N>& acts, Vec3<Real>& v, const Vec3<Real>& unit, const Real& impulse) {
            for (int k = 0; k < 3; ++k) v[k] = Select(acts, Real(v[k] + unit[k] * impulse), v[k]);
        };
        for (uint32_t k = 0; k < count; ++k) {
            const JointRows<N>& lock = batch.rows[k];
            const auto acts = lanes & (lock.isLock > half);
            const RowResponse<Real>& unit = lock.part.GetResponse();
            const Real motion = RelativeMotion<>(lock.part.GetJacobian(), response.a, response.b);
            const Real impulse = Select(acts, Real(-motion * lock.part.GetEffectiveMass()), zero);
            add(acts, response.a.linear, unit.a.linear, impulse);
            add(acts, response.a.angular, unit.a.angular, impulse);
            add(acts, response.b.linear, unit.b.linear, impulse);
            add(acts, response.b.angular, unit.b.angular, impulse);
            add(acts, row.lockLinear, lock.lockLinear, impulse);
            add(acts, row.lockAngular, lock.lockAngular, impulse);
            row.lockRows[k] = Select(acts, impulse, row.lockRows[k]);
        }
        row.part.SetResponse(response);
    };
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        batch.rows[i].freeMass = batch.rows[i].part.GetEffectiveMass();
        for (uint32_t k = 0; k < batch.lockRowCount; ++k) batch.rows[i].lockRows[k] = zero;
    }
    for (uint32_t i = 1; i < batch.lockRowCount; ++i) react(batch.rows[i], i, batch.rows[i].isLock > half);
    for (uint32_t i = 0; i < batch.rowCount; ++i)
        react(batch.rows[i], batch.lockRowCount, batch.rows[i].isLock <= half);
}

// The impulses of the rows in the last substep, of locks with their reaction.
template <int N>
FULCRUM_FORCE_INLINE void RowImpulses(const JointBatch<N>& batch, Wide<N> (&impulses)[JointRowList::kMaxRows]) {
    using Real = Wide<N>;
    const Real half(0.5f);
    for (uint32_t i = 0; i < batch.rowCount; ++i) impulses[i] = batch.rows[i].part.GetTotalLambda();
    for (uint32_t i = batch.lockRowCount > 0 ? batch.rowCount : 0; i-- > 0;) {
        const JointRows<N>& row = batch.rows[i];
        // By a lock at the impulse that those after it have given it; lanes where row i is none come first.
        for (uint32_t k = 0; k < batch.lockRowCount; ++k) {
            if (k == i) continue;
            const auto acts = batch.rows[k].isLock > half;
            impulses[k] = Select(acts, Real(impulses[k] + row.lockRows[k] * impulses[i]), impulses[k]);
        }
    }
}

// In lanes where an axis is locked, deactivates rows to which what is locked leaves next to no mobility.
template <int N>
[[gnu::noinline, gnu::cold]] void DeactivateLockedRows(JointBatch<N>& batch, const Wide<N>& least) {
    using Real = Wide<N>;
    const auto all = [](const Twist<Real>& j, const InverseMass<Real>& m) {
        return Dot<Real>(j.linear, j.linear) * (m.mass.x() + m.mass.y() + m.mass.z()) +
               Dot<Real>(j.angular, j.angular) * (m.inertia.xx + m.inertia.yy + m.inertia.zz);
    };
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        RowPart<Real>& part = batch.rows[i].part;
        const Real trace = all(part.GetJacobian().a, batch.massA) + all(part.GetJacobian().b, batch.massB);
        part.Deactivate((least <= Real(0.0f)) & (part.GetEffectiveMass() * trace * Real(kLeastMobility) > Real(1.0f)));
    }
}

// After the set-up of the locks: responses and effective masses of the rows, and the reaction of the locks to their
// impulses.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SetUpRows(JointBatch<N>& batch) {
    using Real = Wide<N>;
    batch.reactionLinear = batch.reactionAngular = Zero<Real>();
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& row = batch.rows[i];
        row.part.CalculateProperties(batch.massA, batch.massB);
        row.lockLinear = row.lockAngular = Zero<Real>();
        if constexpr (kLinear != LinearLock::None || kAngular != AngularLock::None) {
            RowResponse<Real> response = row.part.GetResponse();
            const LockImpulses<Real> motion = LockMotion<kLinear, kAngular>(batch, response.a, response.b);
            LockImpulses<Real> x = SolveBlock<kLinear, kAngular>(batch, motion.linear, motion.angular);
            x.linear = -x.linear;
            x.angular = -x.angular;
            AddLockMotion<kLinear, kAngular>(batch, response.a, response.b, x);
            row.lockLinear = x.linear;
            row.lockAngular = x.angular;
            row.part.SetResponse(response);
        }
    }
    if (batch.lockRowCount > 0) AddLockRowReactions(batch);
    if (const Real least = Min(LeastTranslation(batch), LeastRotation(batch)); IsLocked(least)) [[unlikely]]
        DeactivateLockedRows(batch, least);
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& row = batch.rows[i];
        batch.reactionLinear += row.lockLinear * row.part.GetTotalLambda();
        batch.reactionAngular += row.lockAngular * row.part.GetTotalLambda();
    }
}

// m/s or rad/s: the limit of what a row pushes back. A motor of limited force drives no faster than it can brake on the
// way that is left: v^2 = 2 f / m C.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> LargestPush(const JointRows<N>& row) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    const auto isMotor = (row.pushRate > zero) & (row.mostPush < Real(JointRow::kUnlimited));
    if (!isMotor.Any()) [[likely]]
        return row.mostPush;
    const Real acceleration =
        Max(row.highest, Real(-row.lowest)) * row.gapRate / Max(row.part.GetEffectiveMass(), Real(1e-30f));
    return Select(isMotor, Min(row.mostPush, Sqrt(Real(2.0f) * acceleration * Abs(row.error))), row.mostPush);
}

// After SetUpRows: bias and softness of the rows. Errors of locks and limits are corrected in the poses
// (CorrectJoints); springs keep their bias, which is their force, and motors of limited force drive by theirs. states:
// velocities at the start of a substep.
template <int N>
FULCRUM_FORCE_INLINE void SetRowBias(JointBatch<N>& batch, const BodyState* states) {
    using Real = Wide<N>;
    Twist<Real> a, b;
    if (batch.springs) {
        const Velocities<N> v(batch, states);
        a = v.a;
        b = v.b;
    }
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& row = batch.rows[i];
        const RowSoftness<Real>&closed = row.softness, &open = row.openSoftness;
        const Real most = LargestPush(row);
        Real force = Clamp(Real(row.pushRate * row.error), -most, most);
        if (batch.springs) force += row.speedPart * RelativeMotion<>(row.part.GetJacobian(), a, b);
        const Real gap = open.massScale * (row.error * row.gapRate);
        const auto isOpen = row.error > row.openAbove;
        row.part.SetBias(
            Select(isOpen, gap, Real(force - closed.massScale * row.speed)),
            {Select(isOpen, open.massScale, closed.massScale), Select(isOpen, open.impulseScale, closed.impulseScale)});
    }
}

// What velocities of two bodies turn in a substep beyond their first order: locks aim at the end of the substep, so
// that bodies move along the chords of their arcs.
template <class Real>
struct Arcs {
    Twist<Real> a, b;
    Real h;  // s
    // Faster bodies aim at less: all products of two velocities are scaled by the square of this, which is 1 up to an
    // angle of half a radian in the substep, and then falls with it. What an aim changes of a velocity changes the aim
    // of the next pass by as much as the angle: beyond a fraction of a radian passes would diverge.
    Real part;
    Vec3<Real> turnA, turnB;  // rad/s: angular velocities times `part`

    FULCRUM_FORCE_INLINE Arcs(const Twist<Real>& ofA, const Twist<Real>& ofB, float substepDt)
        : a(ofA), b(ofB), h(substepDt) {
        constexpr float kLargest = 0.25f;  // rad, squared
        const Real most(kLargest), squaredA = Dot<Real>(a.angular, a.angular) * (h * h),
                                   squaredB = Dot<Real>(b.angular, b.angular) * (h * h);
        turnA = a.angular;
        turnB = b.angular;
        part = Real(1.0f);
        if (const Real larger = Max(squaredA, squaredB); (larger > most).Any()) [[unlikely]] {
            part = Sqrt(most / Max(larger, most));
            turnA *= part;
            turnB *= part;
        }
        const auto set = [&](const Real& squared, Real& sine, Real& cosine) FULCRUM_FORCE_INLINE_LAMBDA {
            const Real t = Min(squared, most);
            sine = -t * (Real(1.0f / 6) - t * Real(1.0f / 120)) * part;
            cosine = (Real(0.5f) - t * (Real(1.0f / 24) - t * Real(1.0f / 720))) * h;
        };
        set(squaredA, sineA_, cosineA_);
        set(squaredB, sineB_, cosineB_);
    }

    // Of an arm of A or of B, m, per second: ((R(w h) - 1) r - h w x r) / h.
    FULCRUM_FORCE_INLINE Vec3<Real> OfA(const Vec3<Real>& arm) const { return Of(turnA, arm, sineA_, cosineA_); }
    FULCRUM_FORCE_INLINE Vec3<Real> OfB(const Vec3<Real>& arm) const { return Of(turnB, arm, sineB_, cosineB_); }

private:
    // (sin(t) / t - 1) w x r + h (1 - cos t) / t^2 w x (w x r) for the angle t = |w| h.
    FULCRUM_FORCE_INLINE static Vec3<Real> Of(const Vec3<Real>& w, const Vec3<Real>& arm, const Real& sine,
                                              const Real& cosine) {
        const Vec3<Real> along = Cross<Real>(w, arm);
        return along * sine + Cross<Real>(w, along) * cosine;
    }

    Real sineA_, cosineA_, sineB_, cosineB_;
};

// The rows that act along the line between the anchors: locks and limits only, springs keep their force. With L the
// distance: h v^2 / 2L of the velocity v across the line, and the anchors' own arcs along it.
template <int N>
FULCRUM_FORCE_INLINE void AimRadialRows(JointBatch<N>& batch, const Arcs<Wide<N>>& arcs) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    const Vec3<Real> way = arcs.OfB(batch.radialArmB) - arcs.OfA(batch.radialArmA);
    const Vec3<Real> v = PointMotion(arcs.a, arcs.b, batch.radialArmA, batch.radialArmB) * arcs.part;
    const Real squared = Dot<Real>(batch.radialOffset, batch.radialOffset);
    const auto isApart = squared > Real(1e-10f);
    const Real inverse = Select(isApart, Real(1.0f) / Sqrt(Select(isApart, squared, Real(1.0f))), zero);
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& row = batch.rows[i];
        // Opposite to the line for an upper limit.
        const Vec3<Real>& n = row.part.GetJacobian().b.linear;
        const Real along = Dot<Real>(v, n), across = Max(Dot<Real>(v, v) - along * along, zero),
                   outward = Dot<Real>(n, batch.radialOffset);
        const Real curve = arcs.h * Real(0.5f) * across * inverse;
        const auto aims = (row.radial > Real(0.5f)) & row.IsCorrected();
        const Real gap = Max(row.error, zero) * row.gapRate;
        const Real bias = gap + Dot<Real>(n, way) + Select(outward < zero, -curve, curve);
        row.part.SetHardBias(bias, aims);
    }
}

// The bias of a line lock. The line turns with A while the anchor of B moves along it.
template <int N>
FULCRUM_FORCE_INLINE Vec2<Wide<N>> LineAim(const JointBatch<N>& batch, const Arcs<Wide<N>>& arcs) {
    using Real = Wide<N>;
    const auto& frame = batch.line.GetFrame();
    const Vec3<Real> apart = PointMotion(arcs.a, arcs.b, frame.r1PlusU, frame.r2),
                     way = arcs.OfB(frame.r2) - arcs.OfA(frame.r1PlusU) -
                           Cross<Real>(arcs.turnA, apart) * (arcs.h * arcs.part);
    return Vec2<Real>(Dot<Real>(frame.axis1, way), Dot<Real>(frame.axis2, way));
}

// Sets the biases of the locks and of radial rows for these velocities.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void AimAtEnd(JointBatch<N>& batch, const Twist<Wide<N>>& a, const Twist<Wide<N>>& b,
                                   const JointSolveSettings& settings) {
    using Real = Wide<N>;
    if constexpr (kAngular == AngularLock::All) batch.rotation.SetBias(Zero<Real>(), {});
    constexpr bool kAims = kLinear != LinearLock::None || kAngular == AngularLock::Axis;
    if (!kAims && !batch.radial) return;
    const Arcs<Real> arcs(a, b, settings.substepDt);
    if constexpr (kLinear == LinearLock::Point)
        batch.point.SetBias(arcs.OfB(batch.point.GetArm2()) - arcs.OfA(batch.point.GetArm1()), {});
    if constexpr (kLinear == LinearLock::Line) batch.line.SetBias(LineAim(batch, arcs), {});
    if constexpr (kAngular == AngularLock::Axis) {
        const Vec3<Real>&b2 = batch.hinge.GetB2(), &c2 = batch.hinge.GetC2(), axis = Cross<Real>(b2, c2);
        const Vec3<Real> axisWay = arcs.OfA(axis), axisMotion = Cross<Real>(arcs.turnA, axis) + axisWay;
        const auto aim = [&](const Vec3<Real>& across) FULCRUM_FORCE_INLINE_LAMBDA {
            const Vec3<Real> way = arcs.OfB(across), motion = Cross<Real>(arcs.turnB, across) + way;
            return Dot<Real>(axisWay, across) + Dot<Real>(axis, way) + Dot<Real>(axisMotion, motion) * arcs.h;
        };
        batch.hinge.SetBias(Vec2<Real>(aim(b2), aim(c2)), {});
    }
    if (batch.radial) AimRadialRows(batch, arcs);
}

// squared: m2 or rad2, by lane; the first `count` lanes are the joints with these indices.
template <int N>
inline void NoteLargest(const uint32_t (&joints)[N], int count, const Wide<N>& squared, float& largest,
                        uint32_t& joint) {
    if (!(squared >= Wide<N>(largest * largest)).Any()) return;
    for (int lane = 0; lane < count; ++lane) {
        const float error = std::sqrt(squared[lane]);
        if (!(error >= largest) || (error == largest && joints[lane] >= joint)) continue;
        largest = error;
        joint = joints[lane];
    }
}

}  // namespace fulcrum::joints
