#include <Fulcrum/Physics/Stages/EnergyLimit.h>

#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

// Rows rotate within a substep, and loads change their directions: a bridge that swings under a weight exceeds its
// energy by 1 to 3 % in some substeps, rarely by 10, and has less in others.
constexpr double kTolerance = 1.1;
// J/kg: what bodies at 0.1 m/s have. Of less, in a bridge that rests under its load, say, iterations need what they
// leave to converge from substep to substep.
constexpr double kLeastEnergy = 0.005;

template <class Batch>
concept JointsInLanes = requires(const Batch& batch) {
    batch.pushed;
};

// Rate of change of a row, J v, in m/s or rad/s. A side that is not dynamic counts as at rest.
template <class Vector>
double RateOf(const Vector& linear, const Vector& angular, int lane, const Vector3& v, const Vector3& w) {
    double rate = 0;
    for (int k = 0; k < 3; ++k)
        rate += double{linear[k][lane]} * double{v[k]} + double{angular[k][lane]} * double{w[k]};
    return rate;
}

// kg m2, of a body about its center of mass, world axes; of a mass in kg at a place in m about the origin; their sum.
Sym3<double> InertiaOf(const BodyDynamics& d, const Quaternion& rotation) {
    const Matrix3 axes = AxesOf(d, rotation);
    Mat3<double> wide;
    wide.x = axes.x.cast<double>(), wide.y = axes.y.cast<double>(), wide.z = axes.z.cast<double>();
    Position moments = Position::Zero();
    for (int k = 0; k < 3; ++k) moments[k] = d.inverseInertia[k] > 0 ? 1.0 / double{d.inverseInertia[k]} : 0.0;
    return RotatedDiagonal<double>(wide, moments);
}
Sym3<double> InertiaOf(double mass, const Position& at) {
    const double x = at.x(), y = at.y(), z = at.z();
    Sym3<double> s;
    s.xx = mass * (y * y + z * z), s.yy = mass * (x * x + z * z), s.zz = mass * (x * x + y * y);
    s.xy = -mass * x * y, s.xz = -mass * x * z, s.yz = -mass * y * z;
    return s;
}
Sym3<double> operator+(Sym3<double> a, const Sym3<double>& b) {
    a.xx += b.xx, a.yy += b.yy, a.zz += b.zz, a.xy += b.xy, a.xz += b.xz, a.yz += b.yz;
    return a;
}

// The solution of a x = b, by cofactors; zero if the matrix is singular.
Position SolveFor(const Sym3<double>& a, const Position& b) {
    Sym3<double> c;
    c.xx = a.yy * a.zz - a.yz * a.yz, c.xy = a.xz * a.yz - a.xy * a.zz, c.xz = a.xy * a.yz - a.xz * a.yy;
    c.yy = a.xx * a.zz - a.xz * a.xz, c.yz = a.xy * a.xz - a.xx * a.yz, c.zz = a.xx * a.yy - a.xy * a.xy;
    const double determinant = a.xx * c.xx + a.xy * c.xy + a.xz * c.xz;
    return determinant > 0 ? Position(c * b / determinant) : Position(Position::Zero());
}

}  // namespace

bool PushesJoints(const SolverLayout& layout, const SolverGroup& group) {
    bool pushes = false;
    if (!group.isLarge)
        VisitBatches(layout, group, [&]<class Batch>(const Batch& batch) {
            if constexpr (JointsInLanes<Batch>) pushes = pushes || batch.pushed != 0;
        });
    return pushes;
}

EnergyLimit::EnergyLimit(BodyStore& bodies, const JointStore& joints, const PairStore& pairs,
                         const SolverLayout& layout, const SolverGroup& group, std::span<uint32_t> parents,
                         std::span<uint32_t> islandOf, std::span<uint32_t> members, std::span<IslandEnergy> islands)
    : bodies_(bodies), joints_(joints), layout_(layout), group_(group), islandOf_(islandOf), members_(members) {
    std::copy_n(layout.bodies.begin() + group.bodiesBegin, members.size(), members.begin());
    std::ranges::sort(members);
    UnionFind sets(parents, members);
    VisitBatches(layout, group, [&]<class Batch>(const Batch& batch) {
        for (int lane = 0; lane < batch.count; ++lane) {
            const uint32_t a = batch.bodyA[lane], b = SecondBody(batch, lane);
            if (bodies.CanMove(a) && bodies.CanMove(b)) sets.Unite(a, b);
        }
    });
    size_t count = 0;
    for (const uint32_t body : members) {
        if (sets.Find(body) != body) continue;
        islandOf[body] = static_cast<uint32_t>(count);
        islands[count] = {};
        islands[count++].lowest = body;
    }
    islands_ = islands.first(count);
    for (const uint32_t body : members) {
        islandOf[body] = islandOf[sets.Find(body)];
        const float inverse = bodies.dynamics[body].inverseMass;
        if (inverse > 0) IslandOf(body).mass += 1.0 / double{inverse};
        if (bodies.dynamics[body].lockedAxes != LockedAxes::None) IslandOf(body).isHeld = true;
    }
    VisitBatches(layout, group, [&]<class Batch>(const Batch& batch) {
        for (int lane = 0; lane < batch.count; ++lane) {
            const uint32_t a = batch.bodyA[lane];
            IslandEnergy& island = IslandOf(bodies.CanMove(a) ? a : SecondBody(batch, lane));
            if constexpr (JointsInLanes<Batch>) {
                const uint32_t bit = 1u << lane;
                island.isPushed |= (batch.pushed & bit) != 0;
                island.isDriven |= ((batch.kinematicA | batch.kinematicB) & bit) != 0;
                island.isHeld |=
                    ((batch.fixedA | batch.fixedB) & bit) != 0 || joints.types[batch.joint[lane]]->ReactsOnWorld();
                if constexpr (requires { batch.overridesMass; })
                    island.isDriven |= batch.overridesMass && (batch.massScaleA[lane] != batch.massScaleB[lane] ||
                                                               batch.inertiaScaleA[lane] != batch.inertiaScaleB[lane] ||
                                                               batch.massScaleA[lane] != 1);
            } else {
                const ContactRecord& record = pairs.records[batch.contact[lane]];
                island.isDriven |=
                    record.Has(ContactRecord::kSurfaceVelocity) || record.Has(ContactRecord::kMassOverride);
                if constexpr (requires { batch.sideB.velocity; }) {
                    island.isHeld = true;
                    const auto& velocity = batch.sideB.velocity;
                    for (int k = 0; k < 3; ++k)
                        island.isDriven |= velocity.linear[k][lane] != 0 || velocity.angular[k][lane] != 0;
                }
            }
        }
    });
}

// That at which the solver has its inertia: bodies without joints keep that of the start of the step.
Quaternion EnergyLimit::RotationOf(uint32_t body) const {
    const Quaternion start = bodies_.RotationOf(body);
    if (!bodies_.dynamics[body].HasGyroscopicTorque() || !joints_.HasAny(body)) return start;
    const float* turn = bodies_.states[body].deltaRotation;
    return TurnOf({turn[0], turn[1], turn[2]}) * start;
}

// m, of the center of mass, relative to that of the lowest body of the island.
Position EnergyLimit::PlaceOf(uint32_t body) const {
    const uint32_t origin = IslandOf(body).lowest;
    Position place = bodies_.CenterOf(body) - bodies_.CenterOf(origin);
    for (int k = 0; k < 3; ++k)
        place[k] += double{bodies_.states[body].deltaPosition[k]} - double{bodies_.states[origin].deltaPosition[k]};
    return place;
}

// J, kinetic.
double EnergyLimit::EnergyOf(uint32_t body, const Velocity& velocity) const {
    const BodyDynamics& d = bodies_.dynamics[body];
    if (!(d.inverseMass > 0)) return 0;
    const Position v = velocity.linear.cast<double>();
    const Vector3 alongAxes = InverseRotate(RotationOf(body) * d.PrincipalAxes(), velocity.angular);
    return 0.5 * (Dot<double>(v, v) / double{d.inverseMass} + TwiceRotationalEnergy<double>(d, alongAxes));
}

void EnergyLimit::NoteFree() {
    for (IslandEnergy& island : islands_) island.free = 0;
    for (const uint32_t body : members_)
        if (IslandEnergy& island = IslandOf(body); IsLimited(island)) island.free += EnergyOf(body, FreeOf(body));
}

// The work of motors and springs. An impulse does the work of its mean velocity: from without to with all impulses of
// the substep.
void EnergyLimit::AddWork() {
    VisitBatches(layout_, group_, [&]<class Batch>(const Batch& batch) {
        if constexpr (requires { batch.rows[0].mostPush; }) {
            for (int lane = 0; lane < batch.count; ++lane) {
                const uint32_t a = batch.bodyA[lane], b = batch.bodyB[lane];
                const bool movesA = bodies_.CanMove(a), movesB = bodies_.CanMove(b);
                IslandEnergy& island = IslandOf(movesA ? a : b);
                if (!island.exceeds) continue;
                double work = 0;
                for (uint32_t i = 0; i < batch.rowCount; ++i) {
                    const auto& row = batch.rows[i];
                    if (row.slot[lane] == 0xFF || row.mostPush[lane] < JointRow::kUnlimited) continue;
                    const auto& j = row.part.GetJacobian();
                    double rate = 0;
                    const auto addSide = [&](uint32_t body, const auto& side, double sign) {
                        for (const Velocity& v : {FreeOf(body), SolvedOf(body)})
                            rate += sign * RateOf(side.linear, side.angular, lane, v.linear, v.angular);
                    };
                    if (movesA) addSide(a, j.a, -1);
                    if (movesB) addSide(b, j.b, 1);
                    work += 0.5 * double{row.part.GetTotalLambda()[lane]} * rate;
                }
                island.work += std::max(work, 0.0);
            }
        }
    });
}

void EnergyLimit::FindRigidMotion(IslandEnergy& island) const {
    island.rigid = {};
    if (island.isHeld) return;
    // Sums about the center of the lowest body: kg m, kg m/s, kg m2/s, kg m2.
    Position moment = Position::Zero(), momentum = Position::Zero(), angular = Position::Zero();
    Sym3<double> inertia;
    for (const uint32_t body : members_) {
        const BodyDynamics& d = bodies_.dynamics[body];
        if (&IslandOf(body) != &island || !(d.inverseMass > 0)) continue;
        const double mass = 1.0 / double{d.inverseMass};
        const Quaternion rotation = RotationOf(body);
        const Velocity velocity = SolvedOf(body);
        const Position p = velocity.linear.cast<double>() * mass, at = PlaceOf(body);
        moment += at * mass;
        momentum += p;
        angular += Cross<double>(at, p) + AngularMomentum(d, rotation, velocity.angular).cast<double>();
        inertia = inertia + InertiaOf(d, rotation) + InertiaOf(mass, at);
    }
    RigidMotion& rigid = island.rigid;
    rigid.center = moment / island.mass;
    rigid.linear = momentum / island.mass;
    angular -= Cross<double>(rigid.center, momentum);
    rigid.angular = SolveFor(inertia + InertiaOf(-island.mass, rigid.center), angular);
    rigid.energy = 0.5 * (Dot<double>(rigid.linear, momentum) + Dot<double>(rigid.angular, angular));
}

void EnergyLimit::Apply() {
    for (IslandEnergy& island : islands_) {
        island.solved = island.work = 0;
        island.scale = 1;
    }
    for (const uint32_t body : members_)
        if (IslandEnergy& island = IslandOf(body); IsLimited(island)) island.solved += EnergyOf(body, SolvedOf(body));
    bool anyExceeds = false;
    for (IslandEnergy& island : islands_)
        anyExceeds |= island.exceeds = IsLimited(island) && island.solved > island.free;
    if (!anyExceeds) return;
    AddWork();
    for (IslandEnergy& island : islands_) {
        if (!island.exceeds) continue;
        FindRigidMotion(island);
        const double allowed = std::max(island.free - island.rigid.energy, 0.0) + island.work,
                     energy = island.solved - island.rigid.energy;
        if (energy > kTolerance * allowed && energy > kLeastEnergy * island.mass)
            island.scale = static_cast<float>(std::sqrt(allowed / energy));
    }
    for (const uint32_t body : members_) {
        const IslandEnergy& island = IslandOf(body);
        if (island.scale >= 1) continue;
        const RigidMotion& rigid = island.rigid;
        const Velocity before = SolvedOf(body);
        const auto scaled = [&](const Vector3& v, const Position& ofAll) {
            const Vector3 kept = ofAll.cast<float>();
            return Vector3(kept + (v - kept) * island.scale);
        };
        const Position arm = island.isHeld ? Position::Zero() : Position(PlaceOf(body) - rigid.center);
        const Velocity after{scaled(before.linear, rigid.linear + Cross<double>(rigid.angular, arm)),
                             scaled(before.angular, rigid.angular)};
        // It is no constraint impulse: the next substep's warm start must not repeat it.
        float* row = bodies_.unconstrained[body].row;
        for (int k = 0; k < 3; ++k) {
            row[BodyState::kLinear + k] += after.linear[k] - before.linear[k];
            row[BodyState::kAngular + k] += after.angular[k] - before.angular[k];
        }
        bodies_.SetVelocity(body, after.linear, after.angular);
    }
}

}  // namespace fulcrum
