#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

using namespace contacts;

// Larger coefficients are clamped to this, which keeps force limits finite.
constexpr float kMostFriction = 1e6f;

// The terms of the response matrices, summed over both bodies.
template <class Real>
struct Responses {
    Real normal[6] = {};    // (n, t1-, t2-)-rows: 00 01 02 11 12 22
    Real friction[6] = {};  // t1 t1, t2 t2, nn, t1 t2, t1 n, t2 n
    Real coupling[3][3] = {};

    FULCRUM_FORCE_INLINE void Add(const UniformInverseMass<Real>& inverse, const Vec3<Real>& arm, const Vec3<Real>& n,
                                  const Vec3<Real>& t1, const Vec3<Real>& t2) {
        const Vec3<Real> jn = Cross<Real>(arm, n), j1 = Cross<Real>(arm, t1), j2 = Cross<Real>(arm, t2);
        const Vec3<Real> in = inverse.inertia * jn, i1 = inverse.inertia * j1, i2 = inverse.inertia * j2;
        const Vec3<Real> it1 = inverse.inertia * t1, it2 = inverse.inertia * t2, itn = inverse.inertia * n;
        normal[0] += inverse.mass + Dot<Real>(jn, in);
        normal[1] += Dot<Real>(t1, in);
        normal[2] += Dot<Real>(t2, in);
        normal[3] += Dot<Real>(t1, it1);
        normal[4] += Dot<Real>(t1, it2);
        normal[5] += Dot<Real>(t2, it2);
        friction[0] += inverse.mass + Dot<Real>(j1, i1);
        friction[1] += inverse.mass + Dot<Real>(j2, i2);
        friction[2] += Dot<Real>(n, itn);
        friction[3] += Dot<Real>(j1, i2);
        friction[4] += Dot<Real>(j1, itn);
        friction[5] += Dot<Real>(j2, itn);
        const Vec3<Real> columns[3] = {i1, i2, itn};
        for (int k = 0; k < 3; ++k) {
            coupling[0][k] += Dot<Real>(jn, columns[k]);
            coupling[1][k] += Dot<Real>(t1, columns[k]);
            coupling[2][k] += Dot<Real>(t2, columns[k]);
        }
    }
};

// Relative to the response without locks: rows with a smaller one are under-relaxed.
constexpr float kLeastShare = 0.25f;

// Overlaps of bodies with less than kSmallShare of their mobility count as no deeper than this fraction of 1 /
// inverseSoftDepth.
constexpr float kDeepestGuided = 0.5f, kSmallShare = 0.5f;

// Sets ContactBatch::isGuided and `locks` from BodyMass::flags.
template <int N, bool kFixedB>
[[gnu::noinline, gnu::cold]] void SetLocks(ContactBatch<N, kFixedB>& batch, const Wide<N>& flagsA,
                                           const Wide<N>& flagsB) {
    batch.isGuided = true;
    for (int i = 0; i < N; ++i) {
        const int a = static_cast<int>(flagsA[i]) / BodyMass::kLockedX,
                  b = static_cast<int>(flagsB[i]) / BodyMass::kLockedX;
        batch.locks[i] = static_cast<uint8_t>(a | b << 3);
        batch.locksOfAll = i == 0 ? batch.locks[i] : batch.locksOfAll & batch.locks[i];
        batch.locksOfSome = i == 0 ? batch.locks[i] : batch.locksOfSome | batch.locks[i];
    }
}

// The mobility along n, t1 and t2 that locked translations take: m^-1 times the products of the vectors' components
// along them, summed over both bodies. Zero in lanes without locks.
template <class Real>
struct LockedMobility {
    Real nn{0.0f}, t1t1{0.0f}, t2t2{0.0f}, t1t2{0.0f}, nt1{0.0f}, nt2{0.0f};
};
template <int N, bool kFixedB>
LockedMobility<Wide<N>> LockedMobilityOf(const ContactBatch<N, kFixedB>& batch) {
    using Real = Wide<N>;
    LockedMobility<Real> locked;
    const auto add = [&](int side, const Real& inverseMass) {
        for (int k = 0; k < 3; ++k) {
            const Real mass = Select(LockedLanes<N>(batch.locks, 3 * side + k), inverseMass, Real(0.0f));
            const Real n = batch.normal[k], t1 = batch.tangent1[k], t2 = batch.tangent2[k];
            locked.nn += mass * n * n;
            locked.t1t1 += mass * t1 * t1;
            locked.t2t2 += mass * t2 * t2;
            locked.t1t2 += mass * t1 * t2;
            locked.nt1 += mass * n * t1;
            locked.nt2 += mass * n * t2;
        }
    };
    add(0, batch.inverseA.mass);
    if constexpr (!kFixedB) add(1, batch.sideB.inverse.mass);
    return locked;
}

template <int N, bool kFixedB>
[[gnu::noinline, gnu::cold]] void RemoveLocked(const ContactBatch<N, kFixedB>& batch, Responses<Wide<N>>& responses) {
    const LockedMobility<Wide<N>> locked = LockedMobilityOf(batch);
    responses.normal[0] -= locked.nn;
    responses.friction[0] -= locked.t1t1;
    responses.friction[1] -= locked.t2t2;
    responses.friction[3] -= locked.t1t2;
    responses.coupling[0][0] -= locked.nt1;
    responses.coupling[0][1] -= locked.nt2;
}

// The mobility of a point along a direction, and how much of it there is relative to that without locks: an average
// over the bodies, weighted by their mobility. offset: of the point from the manifold's center, m.
template <class Real>
struct GuidedMobility {
    Real all{0.0f}, share{0.0f};

    // The factor by which its row is under-relaxed.
    Real Relaxation() const { return Min(Real(1.0f), Real(share * Real(1.0f / kLeastShare))); }
};
template <int N, bool kFixedB>
GuidedMobility<Wide<N>> GuidedMobilityOf(const ContactBatch<N, kFixedB>& batch, const Vec3<Wide<N>>& direction,
                                         const Vec3<Wide<N>>& offset) {
    using Real = Wide<N>;
    GuidedMobility<Real> mobility;
    const auto add = [&](int side, const UniformInverseMass<Real>& inverse, const Vec3<Real>& arm) {
        const Vec3<Real> turned = Cross<Real>(Vec3<Real>(arm + offset), direction);
        const Real angular = Dot<Real>(turned, Vec3<Real>(inverse.inertia * turned));
        Real own = angular;
        for (int k = 0; k < 3; ++k)
            own += Select(LockedLanes<N>(batch.locks, 3 * side + k), Real(0.0f),
                          Real(inverse.mass * direction[k] * direction[k]));
        mobility.all += own;
        mobility.share += own * (own * InverseOrZero(Real(inverse.mass + angular)));  // the square may underflow
    };
    add(0, batch.inverseA, batch.armA);
    if constexpr (!kFixedB) add(1, batch.sideB.inverse, batch.sideB.arm);
    mobility.share = mobility.share * InverseOrZero(mobility.all);
    return mobility;
}
template <int N, bool kFixedB>
GuidedMobility<Wide<N>> GuidedMobilityOf(const ContactBatch<N, kFixedB>& batch,
                                         const typename ContactBatch<N, kFixedB>::Row& row) {
    using Real = Wide<N>;
    return GuidedMobilityOf(batch, batch.normal, Vec3<Real>(batch.tangent1 * row.a + batch.tangent2 * row.b));
}

// Where the locks leave bodies only a direction far off that of a row, such as a rotation by a short lever arm, they
// would have to move many times as fast as the point along it, and what rows that contradict each other do not solve
// would be many times as much energy. Such rows are under-relaxed. Lanes without locks stay bit-identical.
template <int N, bool kFixedB>
[[gnu::noinline, gnu::cold]] void RelaxGuidedRows(ContactBatch<N, kFixedB>& batch) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    const LockedMobility<Real> locked = LockedMobilityOf(batch);
    const auto relax = [&](const Real& taken, const GuidedMobility<Real>& mobility, Real& inverse, Real& impulse) {
        const auto isGuided = (taken > zero) & (inverse > zero);
        inverse = Select(isGuided, InverseOrZero(mobility.all) * mobility.Relaxation(), inverse);
        impulse = Select((taken > zero) & (inverse <= zero), zero, impulse);
    };
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        relax(locked.nn, GuidedMobilityOf(batch, row), row.inverseResponse, row.impulse);
    }
    const Vec3<Real> center(zero, zero, zero);
    const auto along1 = GuidedMobilityOf(batch, batch.tangent1, center),
               along2 = GuidedMobilityOf(batch, batch.tangent2, center);
    relax(locked.t1t1, along1, batch.frictionInverse[0], batch.frictionImpulse[0]);
    relax(locked.t2t2, along2, batch.frictionInverse[1], batch.frictionImpulse[1]);
    const Real most = Max(along1.Relaxation(), along2.Relaxation());
    batch.slideMass = Select(locked.t1t1 + locked.t2t2 > zero, batch.slideMass * most, batch.slideMass);
}

// Mask of the lanes whose numbers are all finite. Extreme masses, sizes and speeds may overflow a float when combined.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE WideMask<N> FiniteLanes(const ContactBatch<N, kFixedB>& batch, const Responses<Wide<N>>& responses,
                                             const Wide<N>& diagonals) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    // Zero times a number is zero if the number is finite, and NaN if it is not. The other responses lie between these.
    Real odd = (responses.normal[0] + responses.normal[3] + responses.normal[5] + diagonals) * zero;
    for (int k = 0; k < 3; ++k)
        odd += (batch.normal[k] + batch.armA[k]) * zero + (responses.friction[k] + batch.frictionImpulse[k]) * zero;
    for (int i = 0; i < batch.pointCount; ++i)
        odd += (batch.rows[i].startSeparation + batch.rows[i].impulse + batch.rows[i].a + batch.rows[i].b) * zero;
    if constexpr (kFixedB) {
        const auto& side = batch.sideB;
        for (int k = 0; k < 3; ++k)
            odd += (side.velocity.linear[k] + side.velocity.angular[k]) * zero + side.acceleration[k] * zero;
    }
    return odd == zero;
}

// Makes the other lanes inactive contacts.
template <int N, bool kFixedB>
[[gnu::noinline, gnu::cold]] void KeepLanes(ContactBatch<N, kFixedB>& batch, WideMask<N> kept) {
    using Real = Wide<N>;
    const auto keep = [&](Real& x) { x = Select(kept, x, Real(0.0f)); };
    const auto keepVector = [&](Vec3<Real>& v) {
        for (int k = 0; k < 3; ++k) keep(v[k]);
    };
    const auto keepMass = [&](UniformInverseMass<Real>& m) {
        for (Real* x :
             {&m.mass, &m.inertia.xx, &m.inertia.yy, &m.inertia.zz, &m.inertia.xy, &m.inertia.xz, &m.inertia.yz})
            keep(*x);
    };
    for (Vec3<Real>* v : {&batch.normal, &batch.tangent1, &batch.tangent2, &batch.armA}) keepVector(*v);
    keepMass(batch.inverseA);
    if constexpr (kFixedB) {
        for (Vec3<Real>* v : {&batch.sideB.velocity.linear, &batch.sideB.velocity.angular, &batch.sideB.acceleration})
            keepVector(*v);
    } else {
        keepVector(batch.sideB.arm);
        keepMass(batch.sideB.inverse);
    }
    for (int i = 0; i < batch.pointCount; ++i)
        for (Real* x : {&batch.rows[i].a, &batch.rows[i].b, &batch.rows[i].inverseResponse,
                        &batch.rows[i].startSeparation, &batch.rows[i].separation, &batch.rows[i].impulse})
            keep(*x);
    for (Real& x : batch.response) keep(x);
    for (int k = 0; k < 3; ++k) {
        for (Real* x : {&batch.frictionInverse[k], &batch.frictionResponse[k], &batch.frictionImpulse[k]}) keep(*x);
        for (Real& x : batch.coupling[k]) keep(x);
    }
    for (Real* x : {&batch.friction, &batch.twistRadius, &batch.slideMass}) keep(*x);
}

template <int N, bool kFixedB>
void PrepareBounces(ContactBatch<N, kFixedB>& batch, Wide<N> restitution, const ConstSolverBodies& bodies,
                    const ContactPrepareSettings& settings) {
    using Real = Wide<N>;
    Twists<N, kFixedB> twists;
    GatherVelocities(batch, bodies.states, twists);
    const Twist<Real> relative = RelativeTwist<BodyRow::Velocity>(batch, twists, 0);
    const Real vn = Dot<Real>(relative.linear, batch.normal);
    const Real w1 = Dot<Real>(relative.angular, batch.tangent1), w2 = Dot<Real>(relative.angular, batch.tangent2);
    Real left(0.0f);
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        const Real parting = vn + row.b * w1 - row.a * w2;
        // Points that separate after a bounce are not warm started: the impulses of the last step would accelerate the
        // bodies apart again, and the rows would not remove all of that.
        const auto parts = (restitution > Real(0.0f)) & (parting > Real(settings.restitutionSpeed));
        row.impulse = Select(parts, Real(0.0f), row.impulse);
        left += row.impulse;
    }
    const auto parts = (restitution > Real(0.0f)) & (left == Real(0.0f));
    for (Real& impulse : batch.frictionImpulse) impulse = Select(parts, Real(0.0f), impulse);
}

// Mask of lanes whose record has the mark.
template <int N>
WideMask<N> HaveSurfaceVelocity(const Wide<N>& marks) {
    using Real = Wide<N>;
    constexpr float kAlone = ContactRecord::kSurfaceVelocity,
                    kBoth = ContactRecord::kSurfaceVelocity | ContactRecord::kMassOverride;
    return (marks == Real(kAlone)) | (marks == Real(kBoth));
}

// Scales the inverse masses of contacts with a mass override. Lanes without one stay bit-identical.
template <int N, bool kFixedB>
[[gnu::noinline, gnu::cold]] void OverrideMasses(ContactBatch<N, kFixedB>& batch, const ContactRecord* records,
                                                 const MassOverride* overrides) {
    using Real = Wide<N>;
    alignas(64) float scales[4][N];
    for (int i = 0; i < N; ++i) {
        MassOverride o;
        if (records[batch.contact[i]].Has(ContactRecord::kMassOverride)) o = overrides[batch.contact[i]];
        scales[0][i] = o.inverseMassScaleA;
        scales[1][i] = o.inverseInertiaScaleA;
        scales[2][i] = o.inverseMassScaleB;
        scales[3][i] = o.inverseInertiaScaleB;
    }
    ScaleMass(batch.inverseA, Real::Load(scales[0]), Real::Load(scales[1]));
    if constexpr (!kFixedB) ScaleMass(batch.sideB.inverse, Real::Load(scales[2]), Real::Load(scales[3]));
}

// An angular velocity, rad/s, limited to a radian in dt seconds; smaller ones stay bit-identical.
template <class Real>
Vec3<Real> WithinARadian(const Vec3<Real>& w, float dt) {
    const Real most(1.0f / dt), squared = Dot<Real>(w, w), one(1.0f);
    return w * Select(squared <= most * most, one, most / Sqrt(Max(squared, Real(1e-30f))));
}

// m/s2, by which the velocity of a surface that turns, of itself or as its body, changes where the contact is. That
// goes along the surface with the first body, and turns with it about the normal, unless it hits the surface: a ball
// that rolls on a disc meets other points of it all the time. center: velocity of the second body's center of mass.
template <int N>
Vec3<Wide<N>> SurfaceAcceleration(const ContactBatch<N, true>& batch, const ConstSolverBodies& bodies,
                                  const Vec3<Wide<N>>& center, float dt) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    const Vec3<Real> none(zero, zero, zero);
    const auto& [linear, angular] = batch.sideB.velocity;
    if (!(Dot<Real>(angular, angular) > zero).Any()) return none;
    Twists<N, true> twists;
    GatherVelocities(batch, bodies.states, twists);
    const Vec3<Real>& n = batch.normal;
    const Vec3<Real> slip =
        Linear(twists.a) + Cross<Real>(Vec3<Real>(n * Dot<Real>(n, Angular(twists.a))), batch.armA) - linear;
    const Real onto = Dot<Real>(n, slip);
    const Vec3<Real> along = slip - n * onto;
    const auto goes = onto * onto <= Dot<Real>(along, along);
    return Cross<Real>(WithinARadian<Real>(angular, dt), Vec3<Real>(linear - center + ZeroUnless<Real>(goes, along))) +
           none;  // not -0
}

// Adds the surface velocities to the velocities of static and kinematic sides. Lanes without one stay bit-identical, so
// the result does not depend on the other lanes of the batch.
template <int N>
void AddSurfaceMotion(ContactBatch<N, true>& batch, const Wide<N>& marks, const SurfaceVelocity* surfaces) {
    using Real = Wide<N>;
    const SurfaceMotion<Real> surface = GatherSurfaceMotion(batch, surfaces);
    const Vec3<Real> linear = batch.tangent1 * surface.v1 + batch.tangent2 * surface.v2,
                     angular = batch.normal * surface.spin;
    const auto has = HaveSurfaceVelocity(marks);
    auto& side = batch.sideB;
    for (int k = 0; k < 3; ++k) {
        side.velocity.linear[k] = Select(has, side.velocity.linear[k] + linear[k], side.velocity.linear[k]);
        side.velocity.angular[k] = Select(has, side.velocity.angular[k] + angular[k], side.velocity.angular[k]);
    }
}

}  // namespace

template <int N, bool kFixedB>
uint32_t PrepareContacts(ContactBatch<N, kFixedB>& batch, const ContactRecord* records, const ConstSolverBodies& bodies,
                         const ContactPrepareSettings& settings) {
    using Real = Wide<N>;
    using Record = ContactRecord;
    const Real zero(0.0f);
    Real head[8], impulses[8];
    GatherRecordRow<N>(batch.contact, records, Record::kHead, head);
    const Real flagsA = GatherMass<N>(batch.bodyA, bodies.masses, batch.inverseA);
    Real flagsB = zero;
    if constexpr (!kFixedB) flagsB = GatherMass<N>(batch.bodyB, bodies.masses, batch.sideB.inverse);
    batch.isGuided = false;
    if (AnyLocked<N>(Max(flagsA, flagsB))) [[unlikely]]
        SetLocks(batch, flagsA, flagsB);
    const bool isMarked = HorizontalMax(head[Record::kMarks]) > 0.0f;
    if (isMarked && settings.massOverrides) [[unlikely]]
        OverrideMasses(batch, records, settings.massOverrides);
    GatherRecordRow<N>(batch.contact, records, Record::kImpulses, impulses);
    Real& pointCount = head[Record::kPointCount];
    pointCount = Select(pointCount <= Real(static_cast<float>(Record::kMaxPoints)), Max(pointCount, zero), zero);
    const Vec3<Real> between = GatherOffset<N>(batch.bodyA, batch.bodyB, bodies.poses);
    const Mat3<Real> rotation = ToMatrix(GatherRotation<N>(batch.bodyA, bodies.poses));
    const Mat3<Real> rotationB = ToMatrix(GatherRotation<N>(batch.bodyB, bodies.poses));

    const Vec3<Real> n = rotation * VectorAt<Record::kNormal>(head);
    const Vec3<Real> t1 = PerpendicularTo<Real>(n), t2 = Cross<Real>(n, t1);
    batch.normal = n;
    batch.tangent1 = t1;
    batch.tangent2 = t2;
    batch.friction = Min(head[Record::kFriction], Real(kMostFriction));
    batch.twistRadius = head[Record::kTwistRadius];
    batch.rotated = batch.slid = batch.unsolved = batch.hits = batch.gentle = 0;
    std::fill_n(batch.collisions, N, uint8_t{1});
    batch.hasCollidedAgain = false;
    batch.inverseSoftDepth = Real(1.0f / kSoftFraction) / GatherInnerRadius<N>(batch.bodyA, batch.bodyB, bodies.poses);
    batch.pointCount = static_cast<int32_t>(HorizontalMax(pointCount));
    batch.bounces = HorizontalMax(head[Record::kRestitution]) > 0.0f;
    batch.hasSurface =
        !kFixedB && isMarked && settings.surfaceVelocities && HaveSurfaceVelocity(head[Record::kMarks]).Any();

    // Contact points, halfway between the surfaces, and their center, where friction acts. The center is that of the
    // points that carried load in the last step: neither speculative points ahead nor those of a lifted side count.
    Vec3<Real> points[ContactRecord::kMaxPoints];
    Vec3<Real> center(zero, zero, zero);
    Real gap = zero, pressing = zero;
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto used = pointCount > Real(static_cast<float>(i));
        Real& impulse = batch.rows[i].impulse;
        impulse = Select(used, impulses[Record::kNormalImpulses + i] * Real(settings.impulseScale), zero);
        pressing += Select(impulse > zero, Real(1.0f), zero);
    }
    const auto anyPresses = pressing > zero;
    const Real perPoint = Real(1.0f) / Max(pointCount, Real(1.0f)),
               perPressing = Real(1.0f) / Max(pressing, Real(1.0f));
    Real floats[Record::PointRows(Record::kMaxPoints)][kRowFloats];
    for (int row = 0; row < Record::PointRows(batch.pointCount); ++row)
        GatherRecordRow<N>(batch.contact, records, Record::kPoints + row, floats[row]);
    for (int i = 0; i < batch.pointCount; ++i) {
        const Real* p = &floats[0][0] + Record::kPointFloats * i;
        const auto used = pointCount > Real(static_cast<float>(i));
        const Vec3<Real> onA = rotation * Vec3<Real>(p[Record::kOnA], p[Record::kOnA + 1], p[Record::kOnA + 2]);
        const Vec3<Real> onB =
            between + rotationB * Vec3<Real>(p[Record::kOnB], p[Record::kOnB + 1], p[Record::kOnB + 2]);
        const Real separation = Dot<Real>(n, Vec3<Real>(onB - onA));
        points[i] = onA + n * (separation * Real(0.5f));
        batch.rows[i].startSeparation = batch.rows[i].separation = Select(used, separation, zero);
        const Real share = Select(anyPresses, Select(batch.rows[i].impulse > zero, perPressing, zero), perPoint);
        for (int k = 0; k < 3; ++k) center[k] += Select(used, Real(points[i][k] * share), zero);
        gap += Select(used, Real(Max(separation, zero) * share), zero);
    }
    // At an impact the gap has closed: the point is on both surfaces. So it is for a single point, which presses only
    // once the gap has closed: friction on a ball acts at its radius.
    const auto closes = (head[Record::kRestitution] > zero) | (pointCount <= Real(1.0f));
    const Vec3<Real> toSurface = n * Select(closes, gap * Real(0.5f), zero);
    batch.armA = center - toSurface;

    Responses<Real> responses;
    responses.Add(batch.inverseA, batch.armA, n, t1, t2);
    const Vec3<Real> armB = center + toSurface - between;
    if constexpr (kFixedB) {
        const float* rows[N];
        for (int i = 0; i < N; ++i) rows[i] = bodies.states[batch.bodyB[i]].VelocityRow();
        Real velocity[8];
        GatherRows<N>(rows, velocity);
        batch.sideB.velocity.angular = Angular(velocity);
        batch.sideB.velocity.linear = Linear(velocity) + Cross<Real>(Angular(velocity), armB);
        if (isMarked && settings.surfaceVelocities)
            AddSurfaceMotion(batch, head[Record::kMarks], settings.surfaceVelocities);
        batch.sideB.acceleration = SurfaceAcceleration(batch, bodies, Linear(velocity), settings.dt);
    } else {
        batch.sideB.arm = armB;
        responses.Add(batch.sideB.inverse, armB, n, t1, t2);
    }

    if (batch.isGuided) [[unlikely]]
        RemoveLocked(batch, responses);
    for (int k = 0; k < 3; ++k) {
        batch.frictionInverse[k] = InverseOrZero(responses.friction[k]);
        batch.frictionResponse[k] = responses.friction[3 + k];
        for (int j = 0; j < 3; ++j) batch.coupling[j][k] = responses.coupling[j][k];
    }
    // The larger eigenvalue of the responses of t1 and t2.
    const Real mean = Real(0.5f) * (responses.friction[0] + responses.friction[1]),
               half = Real(0.5f) * (responses.friction[0] - responses.friction[1]), across = responses.friction[3];
    batch.slideMass = InverseOrZero(Real(mean + Sqrt(half * half + across * across)));
    const Vec3<Real> impulse = VectorAt<Record::kFrictionImpulse>(impulses);
    const Real scale(settings.impulseScale);
    batch.frictionImpulse[0] = Dot<Real>(impulse, t1) * scale;
    batch.frictionImpulse[1] = Dot<Real>(impulse, t2) * scale;
    batch.frictionImpulse[2] = impulses[Record::kTwistImpulse] * scale;

    // J of a point: n-row + b t1-row - a t2-row.
    const auto& g = responses.normal;
    Real diagonals = zero;
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        const Vec3<Real> offset = points[i] - center;
        row.a = Dot<Real>(offset, t1);
        row.b = Dot<Real>(offset, t2);
        const Real two(2.0f);
        const Real diagonal = g[0] + two * (row.b * g[1] - row.a * g[2]) + row.b * row.b * g[3] -
                              two * row.a * row.b * g[4] + row.a * row.a * g[5];
        diagonals += diagonal;
        const auto used = pointCount > Real(static_cast<float>(i));
        row.inverseResponse = Select(used, InverseOrZero(diagonal), zero);
        row.a = Select(used, row.a, zero);
        row.b = Select(used, row.b, zero);
        for (int j = 0; j < i; ++j) {
            const auto& other = batch.rows[j];
            batch.response[PairIndex(j, i)] = g[0] + (row.b + other.b) * g[1] - (row.a + other.a) * g[2] +
                                              row.b * other.b * g[3] - (row.a * other.b + row.b * other.a) * g[4] +
                                              row.a * other.a * g[5];
        }
    }
    if (batch.isGuided) [[unlikely]]
        RelaxGuidedRows(batch);
    const auto finite = FiniteLanes(batch, responses, diagonals);
    if (!finite.All()) KeepLanes(batch, finite);
    if (batch.bounces) PrepareBounces(batch, head[Record::kRestitution], bodies, settings);
    return (~finite).ToBits();
}

template <int N, bool kFixedB>
void LimitGuidedPushes(ContactBatch<N, kFixedB>& batch) {
    using Real = Wide<N>;
    const Real locked = LockedMobilityOf(batch).nn, zero(0.0f);
    const Real deepest = Real(-kDeepestGuided) / batch.inverseSoftDepth;
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        const Real share = GuidedMobilityOf(batch, row).share;
        const Real limited =
            Select(share < Real(kSmallShare), Max(row.separation, deepest), row.separation) * share * share;
        const auto limits = (locked > zero) & (row.separation < zero);
        row.startSeparation = row.separation = Select(limits, limited, row.separation);
    }
}

template <int N, bool kFixedB>
void StoreContacts(const ContactBatch<N, kFixedB>& batch, ContactRecord* records, float impulseScale) {
    const auto friction = batch.tangent1 * batch.frictionImpulse[0] + batch.tangent2 * batch.frictionImpulse[1];
    Wide<N> row[8];
    for (int i = 0; i < ContactRecord::kMaxPoints; ++i)
        row[ContactRecord::kNormalImpulses + i] = i < batch.pointCount ? batch.rows[i].impulse : Wide<N>(0.0f);
    SetVectorAt<ContactRecord::kFrictionImpulse>(row, friction);
    row[ContactRecord::kTwistImpulse] = batch.frictionImpulse[2];
    if (impulseScale != 1.0f)
        for (Wide<N>& x : row) x = x / Wide<N>(impulseScale);
    // An impulse that is not finite would be warm started in every later step.
    for (Wide<N>& x : row) x = Select(Abs(x) <= Wide<N>(std::numeric_limits<float>::max()), x, Wide<N>(0.0f));
    float* rows[N];
    for (int lane = 0; lane < N; ++lane) rows[lane] = records[batch.contact[lane]].impulse;
    ScatterRows<N>(rows, row, batch.count);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                          \
    template void LimitGuidedPushes(ContactBatch<lanes, fixedB>&);                                                  \
    template uint32_t PrepareContacts(ContactBatch<lanes, fixedB>&, const ContactRecord*, const ConstSolverBodies&, \
                                      const ContactPrepareSettings&);                                               \
    template void StoreContacts(const ContactBatch<lanes, fixedB>&, ContactRecord*, float);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
