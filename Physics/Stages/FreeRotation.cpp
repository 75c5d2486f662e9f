#include <Fulcrum/Physics/Stages/FreeRotation.h>

#include <Fulcrum/Math/WideDouble.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

// Number of substeps for a body that rotates by `angle` in the step, such that the rotation axis moves little in each;
// it moves the faster the more the principal moments differ. At most 256, to bound the cost, sufficient up to some 1500
// rad/s in steps of 1/60 s.
int RotationSubsteps(const BodyDynamics& d, float angle) {
    constexpr float kMost = 256;
    constexpr float kSmall = 0.1f;  // rad: errors of some 1e-8 per substep, like the rounding of the stored rotation
    const auto [low, high] = std::minmax({d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]});
    const float wandering = angle * (1.0f - low / high);
    return static_cast<int>(std::clamp(wandering / kSmall, 0.0f, kMost - 1)) + 1;
}

// The symmetry axis: the other two principal moments are equal; 3: none.
int SymmetryAxis(const BodyDynamics& d) {
    constexpr float kEqual = 1e-5f;
    for (int k = 0; k < 3; ++k) {
        const float a = d.inverseInertia[(k + 1) % 3], b = d.inverseInertia[(k + 2) % 3];
        if (std::fabs(a - b) <= kEqual * std::min(a, b)) return k;
    }
    return 3;
}

// Torque-free rotation of a body with given angular momentum L (kg m2/s, world axes). In double, because errors of
// rotation about the intermediate axis double every 2 radians, and float rounding of many substeps gave an error of a
// fiftieth of a revolution after ten revolutions.
template <class Real>
struct FreeTop {
    using Vector = Vec3<Real>;
    using Rotation = Quat<Real>;
    Vector inverse;  // of the principal moments
    Vector momentum;
    Rotation rotation;  // of the principal axes

    static Rotation Unit(const Rotation& q) {
        using detail::Sqrt;
        const Real scale = Real(1.0) / Sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
        return {q.x * scale, q.y * scale, q.z * scale, q.w * scale};
    }
    static Rotation Turned(const Vector& by, const Rotation& at) { return RotationFromVector<Real>(by) * at; }
    // Component-wise product.
    static Vector Scaled(const Vector& v, const Vector& by) {
        return Vector(v.x() * by.x(), v.y() * by.y(), v.z() * by.z());
    }
    Vector VelocityAt(const Rotation& at) const {
        const Mat3<Real> axes = ToMatrix<Real>(at);
        return axes * Scaled(axes.TransposeMultiply(momentum), inverse);
    }

    FreeTop(const Vector& inverseMoments, const Rotation& at, const Vector& angularVelocity)
        : inverse(inverseMoments), rotation(at) {
        using detail::Select;
        momentum = InverseRotate<Real>(rotation, angularVelocity);
        for (int k = 0; k < 3; ++k) {
            const auto turns = inverse[k] > Real(0.0);
            momentum[k] = Select(turns, momentum[k] / Select(turns, inverse[k], Real(1.0)), Real(0.0));
        }
        momentum = Rotate<Real>(rotation, momentum);
    }
    // Exact for a body of revolution: it rotates at constant rates about L and about its symmetry axis, since L / I and
    // the component of L along the axis are constant. `axis`: 1 for the component of the axis, else 0.
    void AdvanceSymmetric(const Vector& axis, const Real& along, const Real& across, const Real& h) {
        using detail::Select;
        const Vector inBody = InverseRotate<Real>(rotation, momentum);
        Vector spin;
        for (int k = 0; k < 3; ++k) spin[k] = Select(axis[k] > Real(0.0), inBody[k] * (along - across) * h, Real(0.0));
        rotation = Unit(Turned(momentum * (across * h), rotation) * RotationFromVector<Real>(spin));
    }
    // Fourth-order Lie group integrator with two exponentials (E. Celledoni, A. Marthinsen, B. Owren, Commutator-free
    // Lie group methods, Future Generation Computer Systems 19, 2003): dq/dt = (I(q)^-1 L) q / 2.
    void Advance(const Real& h) {
        const Vector w1 = VelocityAt(rotation);
        const Rotation half = Turned(w1 * (Real(0.5) * h), rotation);
        const Vector w2 = VelocityAt(half);
        const Vector w3 = VelocityAt(Turned(w2 * (Real(0.5) * h), rotation));
        const Vector w4 = VelocityAt(Turned((w3 - w1 * Real(0.5)) * h, half));
        const Vector middle = (w2 + w3) * Real(2.0);
        const Real part = h / Real(12.0);
        rotation = Unit(
            Turned((w4 * Real(3.0) + middle - w1) * part, Turned((w1 * Real(3.0) + middle - w4) * part, rotation)));
    }
};

Quat<double> Exact(const Quaternion& q) { return {q.x, q.y, q.z, q.w}; }

}  // namespace

bool IsSymmetric(const BodyDynamics& body) { return SymmetryAxis(body) < 3; }

void RotateFreely(FreeTurn& turn, float dt) {
    const BodyDynamics& d = *turn.body;
    if (IsSymmetric(d)) {
        FreeTurn* const alone[kTurnsTogether] = {&turn, nullptr, nullptr, nullptr};
        RotateTogether(alone, 1, dt);
        return;
    }
    using Top = FreeTop<double>;
    const Quat<double> principal = Top::Unit(Exact(d.PrincipalAxes()));
    Top top(Position(d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]),
            Top::Unit(Exact(turn.rotation)) * principal, turn.angularVelocity.cast<double>());
    const int substeps = RotationSubsteps(d, Length(turn.angularVelocity) * std::fabs(dt));
    const double h = static_cast<double>(dt) / substeps;
    const Position kick = turn.torque.cast<double>() * (0.5 * h);
    for (int i = 0; i < substeps; ++i) {
        top.momentum += kick;
        top.Advance(h);
        top.momentum += kick;
    }
    turn.angularVelocity = top.VelocityAt(top.rotation).cast<float>();
    const Quat<double> q = top.rotation * principal.Conjugate();
    turn.rotation = Normalized(
        Quaternion{static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)});
}

void RotateTogether(FreeTurn* const (&turns)[kTurnsTogether], int count, float dt) {
    using Top = FreeTop<WideDouble>;
    Quat<WideDouble> rotation, principal;
    Vec3<WideDouble> inverse, w, torque, axis;
    WideDouble along, across;
    for (int i = 0; i < kTurnsTogether; ++i) {
        const FreeTurn& turn = *turns[std::min(i, count - 1)];
        const BodyDynamics& d = *turn.body;
        const Quaternion &r = turn.rotation, p = d.PrincipalAxes();
        const float from[8] = {r.x, r.y, r.z, r.w, p.x, p.y, p.z, p.w};
        WideDouble* const to[8] = {&rotation.x,  &rotation.y,  &rotation.z,  &rotation.w,
                                   &principal.x, &principal.y, &principal.z, &principal.w};
        for (int k = 0; k < 8; ++k) to[k]->Set(i, double{from[k]});
        const int symmetry = SymmetryAxis(d);
        for (int k = 0; k < 3; ++k) {
            inverse[k].Set(i, double{d.inverseInertia[k]});
            w[k].Set(i, double{turn.angularVelocity[k]});
            torque[k].Set(i, double{turn.torque[k]});
            axis[k].Set(i, k == symmetry ? 1.0 : 0.0);
        }
        along.Set(i, double{d.inverseInertia[symmetry]});
        across.Set(i, double{d.inverseInertia[(symmetry + 1) % 3]});
    }
    principal = Top::Unit(principal);
    Top top(inverse, Top::Unit(rotation) * principal, w);
    const WideDouble h(double{dt});
    const Vec3<WideDouble> kick = torque * (WideDouble(0.5) * h);
    top.momentum += kick;
    top.AdvanceSymmetric(axis, along, across, h);
    top.momentum += kick;
    w = top.VelocityAt(top.rotation);
    const Quat<WideDouble> q = top.rotation * principal.Conjugate();
    for (int i = 0; i < count; ++i) {
        const auto part = [&](const WideDouble& x) { return static_cast<float>(x[i]); };
        turns[i]->angularVelocity = Vector3(part(w.x()), part(w.y()), part(w.z()));
        turns[i]->rotation = Normalized(Quaternion{part(q.x), part(q.y), part(q.z), part(q.w)});
    }
}

Vector3 VelocityAboutTwoAxes(const BodyDynamics& body, const Quaternion& before, const Quaternion& after,
                             const Vector3& angularVelocity) {
    const Vector3 momentum = AngularMomentum(body, before, angularVelocity);
    const Vector3 free = InverseOfFreeAxes(body, AxesOf(body, after)) * momentum;
    // Twice the energies.
    const float wanted = Dot(momentum, angularVelocity), reached = Dot(momentum, free);
    const float squared = wanted / reached;
    return squared > 0 && std::isfinite(squared) ? Vector3(free * std::sqrt(squared)) : angularVelocity;
}

void RotateAboutTwoAxes(FreeTurn& turn, float dt) {
    const BodyDynamics& d = *turn.body;
    const int count = RotationSubsteps(d, Length(turn.angularVelocity) * std::fabs(dt));
    const float h = dt / static_cast<float>(count);
    for (int i = 0; i < count; ++i) {
        Vector3& w = turn.angularVelocity;
        const Quaternion start = turn.rotation;
        const Quaternion middle = RotationFromVector(Vector3(w * (0.5f * h))) * start;
        const Vector3 mean = VelocityAboutTwoAxes(d, start, middle, w);
        turn.rotation = Normalized(RotationFromVector(Vector3(mean * h)) * start);
        w = VelocityAboutTwoAxes(d, start, turn.rotation, w);
    }
}

}  // namespace fulcrum
