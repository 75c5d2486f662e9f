// Shared by the joint kernels: lanes from and to the bodies, choosing the code by a batch's locks, setting the parts up.
#pragma once

#include <Fulcrum/Constraints/Joints/JointBatch.h>

namespace fulcrum::joints {

enum class Of { Velocity, Displacement };

// Calls f(std::integral_constant<LinearLock, ...>, std::integral_constant<AngularLock, ...>) with the batch's.
template <class F>
[[gnu::always_inline]] inline void WithLocks(LinearLock linear, AngularLock angular, F&& f) {
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

template <int N>
struct Motion {
    using Real = Wide<N>;
    float* rows[N];
    Real row[8];

    template <Of kOf>
    [[gnu::always_inline]] void Gather(const uint32_t (&bodies)[N], BodyState* states) {
        for (int i = 0; i < N; ++i) rows[i] = kOf == Of::Velocity ? states[bodies[i]].VelocityRow() : states[bodies[i]].PoseRow();
        GatherRows<N>(reinterpret_cast<const float* const(&)[N]>(rows), row);
    }
    [[gnu::always_inline]] Twist<Real> Get() const {
        return {Vec3<Real>(row[0], row[1], row[2]), Vec3<Real>(row[3], row[4], row[5])};
    }
    // Lanes of bodies that are not dynamic are written nowhere.
    [[gnu::always_inline]] void Scatter(const Twist<Real>& motion, int count, uint32_t fixed) {
        for (int k = 0; k < 3; ++k) {
            row[k] = motion.linear[k];
            row[3 + k] = motion.angular[k];
        }
        alignas(32) float nowhere[8];
        if (fixed != 0)
            for (int i = 0; i < N; ++i)
                if (fixed >> i & 1u) rows[i] = nowhere;
        ScatterRows<N>(rows, row, count);
    }
};

// Of a kinematic body the solver keeps no displacement: it is its velocity times the time.
template <int N>
[[gnu::always_inline]] inline void AddKinematicMotion(Twist<Wide<N>>& displacement, const Twist<Wide<N>>& velocity,
                                                      uint32_t kinematic, float elapsed) {
    if (kinematic == 0) return;
    Wide<N> time(0.0f);
    for (int i = 0; i < N; ++i)
        if (kinematic >> i & 1u) time.Set(i, elapsed);
    displacement.linear += velocity.linear * time;
    displacement.angular += velocity.angular * time;
}

template <class Real>
[[gnu::always_inline]] inline Vec3<Real> Zero() {
    return Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));
}

// The normal without its part along the axis, of length 1: where the axis turns, it turns no more than it must.
template <class Real>
[[gnu::always_inline]] inline Vec3<Real> Straightened(const Vec3<Real>& normal, const Vec3<Real>& axis) {
    const Vec3<Real> flat = normal - axis * Dot<Real>(axis, normal);
    return flat * (Real(1.0f) / Sqrt(Max(Dot<Real>(flat, flat), Real(1e-12f))));
}

// The places and axes of a batch, at the start of the step or displaced.
template <class Real>
struct JointPlace {
    Vec3<Real> armA, armB, offset;
    Vec3<Real> line, lineNormal;
    Vec3<Real> axisA, axisB, normal;
    Quat<Real> twist;
};

// What the locks miss.
template <class Real>
struct JointErrors {
    Vec3<Real> point = Zero<Real>();
    Vec2<Real> line = Vec2<Real>(Real(0.0f), Real(0.0f));
    Vec3<Real> rotation = Zero<Real>();
    Vec2<Real> hinge = Vec2<Real>(Real(0.0f), Real(0.0f));
};

// Sets the parts up, hard and without bias, and returns the errors.
template <LinearLock kLinear, AngularLock kAngular, int N>
[[gnu::always_inline]] inline JointErrors<Wide<N>> SetUpParts(JointBatch<N>& batch, const JointPlace<Wide<N>>& place) {
    using Real = Wide<N>;
    const Vec2<Real> none(Real(0.0f), Real(0.0f));
    JointErrors<Real> errors;
    if constexpr (kAngular == AngularLock::All) {
        errors.rotation = RotationVectorOf<Real>(place.twist);
        batch.rotation.CalculateProperties(batch.massA, batch.massB, Zero<Real>());
    }
    if constexpr (kAngular == AngularLock::Axis) {
        const Vec3<Real> b = Straightened<Real>(place.normal, place.axisB);
        const Vec3<Real> c = Cross<Real>(place.axisB, b);
        errors.hinge = HingeError<Real>(place.axisA, b, c);
        batch.hinge.CalculateProperties(batch.massA, batch.massB, b, c, none);
    }
    if constexpr (kLinear == LinearLock::Point) {
        errors.point = place.offset;
        batch.point.CalculateProperties(batch.massA, batch.massB, place.armA, place.armB, Zero<Real>());
    }
    if constexpr (kLinear == LinearLock::Line) {
        const Vec3<Real> n1 = Straightened<Real>(place.lineNormal, place.line);
        const Vec3<Real> n2 = Cross<Real>(place.line, n1);
        errors.line = Vec2<Real>(Dot<Real>(place.offset, n1), Dot<Real>(place.offset, n2));
        batch.line.CalculateProperties(batch.massA, batch.massB, {Vec3<Real>(place.armA + place.offset), place.armB, n1, n2}, none);
    }
    return errors;
}

// The push that the next velocity iterations give.
template <LinearLock kLinear, AngularLock kAngular, int N>
[[gnu::always_inline]] inline void Soften(JointBatch<N>& batch, const JointErrors<Wide<N>>& errors, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const RowSoftness<Real> softness{Real(settings.softness.massScale), Real(settings.softness.impulseScale)};
    const auto push = [&](const auto& error) {
        auto bias = error;
        for (int k = 0; k < bias.size(); ++k)
            bias[k] = Clamp<Real>(error[k] * Real(settings.pushRate), Real(-settings.maxPushSpeed), Real(settings.maxPushSpeed));
        return bias;
    };
    const auto soften = [&](auto& part, const auto& error) {
        part.SetBias(push(error));
        part.SetSoftness(softness);
    };
    if constexpr (kAngular == AngularLock::All) soften(batch.rotation, errors.rotation);
    if constexpr (kAngular == AngularLock::Axis) soften(batch.hinge, errors.hinge);
    if constexpr (kLinear == LinearLock::Point) soften(batch.point, errors.point);
    if constexpr (kLinear == LinearLock::Line) soften(batch.line, errors.line);
}

}  // namespace fulcrum::joints
