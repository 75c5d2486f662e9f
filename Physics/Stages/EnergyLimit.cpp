#include <Fulcrum/Physics/Stages/EnergyLimit.h>
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

std::span<const uint32_t> BodiesOf(const SolverLayout& layout, const SolverGroup& group) {
    return std::span(layout.bodies).subspan(group.bodiesBegin, group.bodiesEnd - group.bodiesBegin);
}

// Calls visit(batch) for all batches of a group, which is not the one with the constraints without a color.
template <class Visit>
void VisitBatches(const SolverLayout& layout, const SolverGroup& group, Visit&& visit) {
    for (uint32_t c = group.colorsBegin; c < group.colorsEnd; ++c)
        ForEachBatchList(layout, [&](const auto& list, BatchKind kind) {
            const BatchRange& range = layout.colors[c].of[kind];
            for (uint32_t i = range.begin; i < range.end; ++i) visit(list.batches[i]);
        });
}

template <class Batch>
concept JointsInLanes = requires(const Batch& batch) {
    batch.pushed;
};

template <int N>
uint32_t SecondBody(const ContactBatch<N, true>& batch, int lane) {
    return batch.bodyA[lane];
}
template <class Batch>
uint32_t SecondBody(const Batch& batch, int lane) {
    return batch.bodyB[lane];
}

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
Position Solve(const Sym3<double>& a, const Position& b) {
    Sym3<double> c;
    c.xx = a.yy * a.zz - a.yz * a.yz, c.xy = a.xz * a.yz - a.xy * a.zz, c.xz = a.xy * a.yz - a.xz * a.yy;
    c.yy = a.xx * a.zz - a.xz * a.xz, c.yz = a.xy * a.xz - a.xx * a.yz, c.zz = a.xx * a.yy - a.xy * a.xy;
    const double determinant = a.xx * c.xx + a.xy * c.xy + a.xz * c.xz;
    return determinant > 0 ? Position(c * b / determinant) : Position(Position::Zero());
}

// The motion as a rigid body with the same momentum and angular momentum.
RigidMotion RigidMotionOf(const IslandMotion& motion) {
    RigidMotion rigid;
    rigid.center = motion.moment / motion.mass;
    rigid.linear = motion.momentum / motion.mass;
    const Position angular = motion.angular - Cross<double>(rigid.center, motion.momentum);
    rigid.angular = Solve(motion.inertia + InertiaOf(-motion.mass, rigid.center), angular);
    rigid.energy = 0.5 * (Dot<double>(rigid.linear, motion.momentum) + Dot<double>(rigid.angular, angular));
    return rigid;
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
                         std::span<uint32_t> islandOf, std::span<IslandEnergy> islands)
    : bodies_(bodies), layout_(layout), group_(group), islandOf_(islandOf) {
    const std::span<const uint32_t> members = BodiesOf(layout, group);
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

// m, of the center of mass, relative to the lowest body of the island.
Position EnergyLimit::PlaceOf(uint32_t body) const {
    const uint32_t origin = IslandOf(body).lowest;
    Position place = bodies_.CenterOf(body) - bodies_.CenterOf(origin);
    for (int k = 0; k < 3; ++k)
        place[k] += double{bodies_.states[body].deltaPosition[k]} - double{bodies_.states[origin].deltaPosition[k]};
    return place;
}

template <class VelocityOf>
void EnergyLimit::Sum(IslandMotion IslandEnergy::*motion, VelocityOf&& velocityOf) {
    for (IslandEnergy& island : islands_) island.*motion = {};
    for (const uint32_t body : BodiesOf(layout_, group_)) {
        const BodyDynamics& d = bodies_.dynamics[body];
        IslandEnergy& island = IslandOf(body);
        if (!IsLimited(island) || !(d.inverseMass > 0)) continue;
        const float* turn = bodies_.states[body].deltaRotation;
        Quaternion rotation = bodies_.RotationOf(body);
        if (d.HasGyroscopicTorque()) rotation = RotationFromVector(Vector3(turn[0], turn[1], turn[2])) * rotation;
        const Velocity velocity = velocityOf(body);
        const Position v = velocity.linear.template cast<double>();
        const double mass = 1.0 / double{d.inverseMass};
        IslandMotion& sum = island.*motion;
        sum.mass += mass;
        sum.energy += 0.5 * mass * Dot<double>(v, v) + RotationalEnergy(d, rotation, velocity.angular);
        if (!island.isHeld) {
            const Position p = v * mass, at = PlaceOf(body);
            sum.moment += at * mass;
            sum.momentum += p;
            sum.angular +=
                Cross<double>(at, p) + AngularMomentum(d, rotation, velocity.angular).template cast<double>();
            sum.inertia = sum.inertia + InertiaOf(d, rotation) + InertiaOf(mass, at);
        }
    }
}

void EnergyLimit::NoteFree() {
    Sum(&IslandEnergy::free, [&](uint32_t body) { return FreeOf(body); });
}

void EnergyLimit::Apply() {
    const std::span<const uint32_t> members = BodiesOf(layout_, group_);
    Sum(&IslandEnergy::solved, [&](uint32_t body) { return SolvedOf(body); });
    for (IslandEnergy& island : islands_) {
        island.work = 0;
        island.scale = 1;
    }
    // An impulse does the work of its mean velocity: from without to with all impulses of the substep.
    VisitBatches(layout_, group_, [&]<class Batch>(const Batch& batch) {
        if constexpr (requires { batch.rows[0].mostPush; }) {
            for (int lane = 0; lane < batch.count; ++lane) {
                const uint32_t a = batch.bodyA[lane], b = batch.bodyB[lane];
                const bool movesA = bodies_.CanMove(a), movesB = bodies_.CanMove(b);
                IslandEnergy& island = IslandOf(movesA ? a : b);
                if (!IsLimited(island)) continue;
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
    for (IslandEnergy& island : islands_) {
        if (!IsLimited(island) || !(island.solved.mass > 0)) continue;
        const RigidMotion free = island.isHeld ? RigidMotion{} : RigidMotionOf(island.free);
        island.rigid = island.isHeld ? RigidMotion{} : RigidMotionOf(island.solved);
        const double allowed = std::max(island.free.energy - free.energy, 0.0) + island.work,
                     energy = island.solved.energy - island.rigid.energy;
        if (energy > kTolerance * allowed && energy > kLeastEnergy * island.solved.mass)
            island.scale = static_cast<float>(std::sqrt(allowed / energy));
    }
    for (const uint32_t body : members) {
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
