#include <Fulcrum/Physics/Stages/DirectIsland.h>

#include <Fulcrum/Constraints/Joints/JointKernels.h>
#include <Fulcrum/Physics/Stages/DirectRows.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

using namespace direct;
using namespace joints;

// Softness of rows that are hard: gamma as a fraction of J M^-1 J^T. A joint gives way to a load by that part of the
// load's own motion times the ratio of masses, and a heavy one then whirls light links: a ball of 3 10^5 times the mass
// of its chain's links tears it at 1e-7. Where loops or contacts contradict joints, impulses grow with its inverse.
constexpr double kFreeSoftness = 1e-8, kSoftness = 1e-6;
// Unbalanced impulse over mass that is left, as a part of g h: with contacts less, since their forces are reported.
constexpr double kTolerance = 1e-4, kContactTolerance = 1e-5;
// The same by limits of friction, see DirectSettings.
constexpr double kLimitTolerance = 1e-2;
// As a part of g h^2, of corrections of poses.
constexpr double kPoseTolerance = 1e-3;
// As a part of g h, what a contact gives way: columns of a hundred boxes lean by ten times as much with three times
// that. No less than half of what the grid of positions resolves, with the usual `baumgarte` that is where contacts at
// rest are.
constexpr double kGive = 1e-4, kLeastGive = 0.1;
// Of a substep, on average, and as many at least as of so many substeps: more than that take longer than iterations in
// the substeps that a load asks for. They balance nothing else.
constexpr uint32_t kMostFactorizations = 8, kLeastSubsteps = 4;
// Of a solution with contacts: more than that takes what would not be solved so for long.
constexpr uint32_t kMostWithContacts = 40;
// Geometric stiffness acts where h^2 k / m exceeds this.
constexpr double kResolved = 0.3;

double Dot6(const double (&j)[6], const Twist<float>& v) {
    return (j[0] * double{v.linear.x()} + j[1] * double{v.linear.y()} + j[2] * double{v.linear.z()}) +
           (j[3] * double{v.angular.x()} + j[4] * double{v.angular.y()} + j[5] * double{v.angular.z()});
}

// Fills rows from batches, in the order in which Reader reads them.
class Filler {
public:
    Filler(const BodyStore& bodies, std::span<const uint32_t> localOf, std::span<const DirectBody> island,
           std::span<DirectRow> rows, std::span<DirectRow> across, std::span<DirectStiffness> stiffness, double h,
           double softness)
        : bodies_(bodies),
          localOf_(localOf),
          island_(island),
          rows_(rows),
          across_(across),
          stiffness_(stiffness),
          h_(h),
          softness_(softness) {}

    void Add(JointBatch<kLanes>& batch) {
        WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
            using Real = Wide<kLanes>;
            constexpr LinearLock kLinear = linear;
            constexpr AngularLock kAngular = angular;
            // By unit motions of A and of B.
            LockImpulses<Real> unit[12];
            for (int k = 0; k < 12; ++k) {
                Twist<Real> motion[2];
                (k % 6 < 3 ? motion[k / 6].linear : motion[k / 6].angular)[k % 3] = Real(1.0f);
                unit[k] = LockMotion<kLinear, kAngular>(batch, motion[0], motion[1]);
            }
            Real impulses[JointRowList::kMaxRows];
            RowImpulses(batch, impulses);
            for (int lane = 0; lane < batch.count; ++lane) {
                const bool fixedA = batch.fixedA >> lane & 1u, fixedB = batch.fixedB >> lane & 1u;
                const Sides sides{fixedA ? DirectRow::kNone : localOf_[batch.bodyA[lane]],
                                  fixedB ? DirectRow::kNone : localOf_[batch.bodyB[lane]]};
                // Of kinematic bodies.
                const auto known = [&](const DirectRow& row) {
                    double speed = 0;
                    if (fixedA) speed += Dot6(row.ja, VelocityOf(batch.bodyA[lane]));
                    if (fixedB) speed += Dot6(row.jb, VelocityOf(batch.bodyB[lane]));
                    return speed;
                };
                const auto addLocks = [&](auto& part, Vec3<Real> LockImpulses<Real>::*which,
                                          const Vec3<Real>& reaction) {
                    for (int k = 0; k < part.GetBias().size(); ++k) {
                        DirectRow& row = Next(sides);
                        for (int i = 0; i < 6; ++i) {
                            row.ja[i] = double{(unit[i].*which)[k][lane]};
                            row.jb[i] = double{(unit[6 + i].*which)[k][lane]};
                        }
                        row.c = double{part.GetBias()[k][lane]} + known(row);
                        row.impulse = double{part.GetTotalLambda()[k][lane]};
                        if (batch.rowCount > 0) row.impulse += double{reaction[k][lane]};
                        SetHard(row);
                    }
                };
                const size_t first = rowCount;
                if constexpr (kLinear != LinearLock::None)
                    addLocks(LinearPart<kLinear>(batch), &LockImpulses<Real>::linear, batch.reactionLinear);
                if constexpr (kLinear == LinearLock::Point)
                    AddArms(sides, Vector(rows_[first].impulse, rows_[first + 1].impulse, rows_[first + 2].impulse),
                            InDouble(batch.point.GetArm1(), lane), InDouble(batch.point.GetArm2(), lane));
                if constexpr (kAngular != AngularLock::None)
                    addLocks(AngularPart<kAngular>(batch), &LockImpulses<Real>::angular, batch.reactionAngular);
                for (uint32_t i = 0; i < batch.rowCount; ++i) {
                    const JointRows<kLanes>& from = batch.rows[i];
                    const RowJacobian<Real>& j = from.part.GetJacobian();
                    DirectRow& row = Next(sides);
                    Set(row.ja, -InDouble(j.a.linear, lane), -InDouble(j.a.angular, lane));
                    Set(row.jb, InDouble(j.b.linear, lane), InDouble(j.b.angular, lane));
                    row.lo = Limit(from.lowest[lane]);
                    row.hi = Limit(from.highest[lane]);
                    row.impulse = double{impulses[i][lane]};
                    const auto target = from.part.TargetOf();
                    const double stiffness = double{target.softMass[lane]}, scale = double{target.impulseScale[lane]};
                    if (from.slot[lane] == 0xFF || !(stiffness > 0)) {
                        row.lo = row.hi = row.impulse = 0;
                        continue;
                    }
                    row.c = double{target.biasImpulse[lane]} / stiffness + known(row);
                    SetHard(row);
                    if (scale > 0) row.inverseGamma = std::min(row.inverseGamma, stiffness / scale);
                    else if (from.radial[lane] > 0.5f && row.impulse != 0)
                        AddAcross(row, InDouble(batch.radialOffset, lane));
                }
            }
        });
    }

    size_t rowCount = 0, acrossCount = 0, stiffnessCount = 0;

private:
    struct Sides {
        uint32_t a, b;
    };

    DirectRow& Next(const Sides& sides) {
        DirectRow& row = rows_[rowCount++];
        row = DirectRow{};
        row.a = sides.a;
        row.b = sides.b;
        return row;
    }
    Twist<float> VelocityOf(uint32_t body) const {
        return {bodies_.LinearVelocityOf(body), bodies_.AngularVelocityOf(body)};
    }

    static double Limit(float x) {
        return std::abs(x) < JointRow::kUnlimited ? double{x} : x > 0 ? DirectRow::kUnlimited : -DirectRow::kUnlimited;
    }

    void SetHard(DirectRow& row) const {
        const double k = ResponseOf(island_, row);
        row.inverseGamma = k > 0 ? 1 / (softness_ * k) : 0;
    }

    // The torque r x f of an impulse f at an arm r turns with its body; of the matrix of that stiffness the positive
    // part, as far as the substep does not resolve it.
    void AddArms(const Sides& sides, const Vector& impulse, const Vector& armA, const Vector& armB) {
        AddArm(sides.a, -impulse, armA);
        AddArm(sides.b, impulse, armB);
    }
    void AddArm(uint32_t body, const Vector& f, const Vector& r) {
        if (body == DirectRow::kNone) return;
        // K = f.r - (f r^T + r f^T) / 2 has the eigenvalues (f.r - |f| |r|) / 2 along f / |f| + r / |r|, (f.r + |f|
        // |r|) / 2 along their difference, and f.r across.
        const double along = Dot<double>(f, r), size = std::sqrt(Dot<double>(f, f) * Dot<double>(r, r));
        if (!(size > 0)) return;
        const double per = size / Dot<double>(r, r);  // |f| / |r|
        const Vector e = along >= 0 ? Vector(f + r * per) : Vector(f - r * per);
        const double times = 0.5 * (along >= 0 ? size - along : size + along) / Dot<double>(e, e);
        // Each element is a sum of products in the order in which it is written.
        const auto outer = [](const Vector& a, const Vector& b) {
            return Eigen::Matrix3d(Eigen::Vector3d(a.x(), a.y(), a.z()) * Eigen::RowVector3d(b.x(), b.y(), b.z()));
        };
        Eigen::Matrix3d k = times * outer(e, e);
        if (along >= 0) k += along * Eigen::Matrix3d::Identity() - 0.5 * (outer(f, r) + outer(r, f));
        const double* inverse = island_[body].inverseInertia;
        const double elements[6] = {k(0, 0), k(1, 1), k(2, 2), k(0, 1), k(0, 2), k(1, 2)};
        double trace = 0;
        for (int i = 0; i < 3; ++i) trace += inverse[i] * elements[i] + 2 * inverse[3 + i] * elements[3 + i];
        const double ratio = 0.5 * h_ * trace;
        if (!(ratio > kResolved)) return;
        DirectStiffness& added = stiffness_[stiffnessCount++];
        added.body = body;
        for (int i = 0; i < 6; ++i) added.k[i] = elements[i] * (h_ * (1 - kResolved / ratio));
    }

    // The same of a tensed distance: its impulse resists what moves the centers across.
    void AddAcross(const DirectRow& along, const Vector& offset) {
        const Vector n(along.jb[0], along.jb[1], along.jb[2]);
        const double length = std::sqrt(Dot<double>(offset, offset));
        // Pulled together: the impulse on B is against the offset.
        const double tension = -along.impulse * Dot<double>(n, offset) / length;
        if (!(length > 1e-6) || !(tension > 0)) return;
        const double ratio = h_ * tension / (length * softness_ * along.inverseGamma);
        if (!(ratio > kResolved)) return;
        const Vector t1 = PerpendicularTo<double>(n), t2 = Cross<double>(n, t1);
        for (const Vector& t : {t1, t2}) {
            DirectRow& row = across_[acrossCount++];
            row = DirectRow{};
            row.a = along.a;
            row.b = along.b;
            Set(row.ja, -t, Vector(0, 0, 0));
            Set(row.jb, t, Vector(0, 0, 0));
            row.inverseGamma = h_ * (1 - kResolved / ratio) * tension / length;
        }
    }

    const BodyStore& bodies_;
    std::span<const uint32_t> localOf_;
    std::span<const DirectBody> island_;
    std::span<DirectRow> rows_, across_;
    std::span<DirectStiffness> stiffness_;
    double h_, softness_;
};

// Writes impulses back to the batches, in the order of Filler.
class Reader {
public:
    explicit Reader(std::span<const DirectRow> rows) : rows_(rows) {}

    void Read(JointBatch<kLanes>& batch) {
        WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
            constexpr LinearLock kLinear = linear;
            constexpr AngularLock kAngular = angular;
            for (int lane = 0; lane < batch.count; ++lane) {
                float locks[6];
                int count = 0;
                if constexpr (kLinear != LinearLock::None) count += LinearPart<kLinear>(batch).GetBias().size();
                if constexpr (kAngular != AngularLock::None) count += AngularPart<kAngular>(batch).GetBias().size();
                for (int k = 0; k < count; ++k) locks[k] = Next();
                ReadRows(batch, lane);
                int next = 0;
                const auto set = [&](auto& part, const auto& reaction) {
                    auto total = part.GetTotalLambda();
                    for (int k = 0; k < total.size(); ++k)
                        total[k].Set(lane, locks[next++] - (batch.rowCount > 0 ? reaction[k][lane] : 0.0f));
                    part.SetTotalLambda(total);
                };
                if constexpr (kLinear != LinearLock::None) set(LinearPart<kLinear>(batch), batch.reactionLinear);
                if constexpr (kAngular != AngularLock::None) set(AngularPart<kAngular>(batch), batch.reactionAngular);
            }
        });
    }

private:
    float Next() { return static_cast<float>(rows_[next_++].impulse); }

    // Impulses of rows, and the reaction of the locks to them, which is part of the locks' impulses.
    void ReadRows(JointBatch<kLanes>& batch, int lane) {
        float own[JointRowList::kMaxRows];
        for (uint32_t i = 0; i < batch.rowCount; ++i) own[i] = Next();
        // Likewise of rows that are locks, see RowImpulses: a row's own impulse is its total less what those after it
        // have given it, by their totals.
        for (uint32_t i = 0; i < (batch.lockRowCount > 0 ? batch.rowCount : 0); ++i)
            for (uint32_t k = 0; k < batch.lockRowCount; ++k)
                if (k != i && batch.rows[k].isLock[lane] > 0.5f) own[k] -= batch.rows[i].lockRows[k][lane] * own[i];
        for (int k = 0; k < 3; ++k) {
            float linear = 0, angular = 0;
            for (uint32_t i = 0; i < batch.rowCount; ++i) {
                linear += batch.rows[i].lockLinear[k][lane] * own[i];
                angular += batch.rows[i].lockAngular[k][lane] * own[i];
            }
            batch.reactionLinear[k].Set(lane, linear);
            batch.reactionAngular[k].Set(lane, angular);
        }
        for (uint32_t i = 0; i < batch.rowCount; ++i) {
            auto total = batch.rows[i].part.GetTotalLambda();
            total.Set(lane, own[i]);
            batch.rows[i].part.SetTotalLambda(total);
        }
    }

    std::span<const DirectRow> rows_;
    size_t next_ = 0;
};

template <class Visit>
void VisitJoints(SolverLayout& layout, const SolverGroup& group, Visit&& visit) {
    VisitBatches(layout, group, [&](auto& batch) {
        if constexpr (requires { visit(batch); }) visit(batch);
    });
}

// Takes the change by an impulse along a row back from the velocity.
void TakeBack(DirectBody& body, const double (&j)[6], double impulse) {
    const double *i = body.inverseInertia, x = j[3] * impulse, y = j[4] * impulse, z = j[5] * impulse;
    for (int k = 0; k < 3; ++k)
        if (!(body.lockedAxes >> k & 1u)) body.velocity[k] -= body.inverseMass * (j[k] * impulse);
    body.velocity[3] -= (i[0] * x + i[3] * y) + i[4] * z;
    body.velocity[4] -= (i[3] * x + i[1] * y) + i[5] * z;
    body.velocity[5] -= (i[4] * x + i[5] * y) + i[2] * z;
}

}  // namespace

DirectIsland::DirectIsland(BodyStore& bodies, SolverLayout& layout, const SolverGroup& group, float h, float gravity,
                           std::span<uint32_t> localOf, ScratchArena& scratch)
    : bodies_(bodies),
      layout_(layout),
      group_(group),
      h_(double{h}),
      speed_(std::max(double{gravity}, kLeastGravity) * h_),
      localOf_(localOf),
      contacts_(bodies, layout, group, localOf, h_, std::max(kGive * speed_, kLeastGive * kPositionGrid / h_), scratch),
      pattern_(layout.PatternOf(group)),
      factor_(MakeDirectFactor(pattern_, scratch)) {
    size_t lanes = 0, rows = 0;
    VisitJoints(layout, group, [&](const JointBatch<kLanes>& batch) {
        lanes += static_cast<size_t>(batch.count);
        rows += static_cast<size_t>(batch.count) * batch.rowCount;
    });
    tolerance_ = (group.isLoaded ? kContactTolerance : kTolerance) * speed_;
    const size_t count = group.bodiesEnd - group.bodiesBegin;
    island_ = scratch.Allocate<DirectBody>(count);
    rows_ = scratch.Allocate<DirectRow>(6 * lanes + 3 * rows + contacts_.MostRows());
    across_ = scratch.Allocate<DirectRow>(2 * rows);
    corrections_ = scratch.Allocate<DirectRow>(6 * lanes + contacts_.MostRows());
    stiffness_ = scratch.Allocate<DirectStiffness>(2 * lanes);
    solved_ = scratch.Allocate<DirectVelocity>(count);
    places_ = scratch.Allocate<Twist<float>>(count);
    for (uint32_t i = 0; i < count; ++i) localOf[layout.bodies[group.bodiesBegin + i]] = i;
}

void DirectIsland::SetBodies(From from) {
    for (size_t i = 0; i < island_.size(); ++i) {
        const uint32_t index = layout_.bodies[group_.bodiesBegin + i];
        const BodyMass& mass = bodies_.masses[index];
        DirectBody& body = island_[i];
        const float* row =
            from == From::Unconstrained ? bodies_.unconstrained[index].row : bodies_.states[index].VelocityRow();
        for (int k = 0; k < 3; ++k) {
            body.velocity[k] = double{row[BodyState::kLinear + k]};
            body.velocity[3 + k] = double{row[BodyState::kAngular + k]};
        }
        body.inverseMass = double{mass.inverseMass};
        for (int k = 0; k < 6; ++k) body.inverseInertia[k] = double{mass.inverseInertia[k]};
        body.lockedAxes = static_cast<uint32_t>(mass.flags) >> 1;
    }
}

size_t DirectIsland::AddJoints() {
    Filler filler(bodies_, localOf_, island_, rows_, across_, stiffness_, h_,
                  group_.mayContradict ? kSoftness : kFreeSoftness);
    VisitJoints(layout_, group_, [&](JointBatch<kLanes>& batch) { filler.Add(batch); });
    acrossCount_ = filler.acrossCount;
    stiffnessCount_ = filler.stiffnessCount;
    return filler.rowCount;
}

bool DirectIsland::Solve(std::span<DirectRow> rows, ScratchArena& scratch) {
    const DirectProblem problem{island_, rows, contacts_.Patches(), stiffness_.first(stiffnessCount_),
                                group_.isResting};
    const DirectSettings how{
        .tolerance = tolerance_,
        .limitTolerance = kLimitTolerance * speed_,
        .speed = speed_,
        .mostFactorizations = group_.isLoaded ? kMostWithContacts : DirectSettings{}.mostFactorizations};
    const DirectResult result = SolveDirectly(problem, pattern_, how, factor_, solved_, scratch);
    isFactorCurrent_ |= result.factorizations > 0;
    factorizations_ += result.factorizations;
    return result.outcome == DirectResult::Outcome::Solved;
}

void DirectIsland::WriteVelocities() {
    for (size_t i = 0; i < island_.size(); ++i) {
        BodyState& state = bodies_.states[layout_.bodies[group_.bodiesBegin + i]];
        for (int k = 0; k < 3; ++k) {
            state.linearVelocity[k] = static_cast<float>(solved_[i].v[k]);
            state.angularVelocity[k] = static_cast<float>(solved_[i].v[3 + k]);
        }
    }
    Reader reader(rows_);
    VisitJoints(layout_, group_, [&](JointBatch<kLanes>& batch) { reader.Read(batch); });
}

bool DirectIsland::SolveJoints(From from, ScratchArena& scratch) {
    SetBodies(from);
    size_t count = AddJoints();
    for (const DirectRow& row : across_.first(acrossCount_)) rows_[count++] = row;
    const std::span<DirectRow> rows = rows_.first(count);
    if (from == From::Current)
        for (const DirectRow& row : rows) {
            if (row.a != DirectRow::kNone) TakeBack(island_[row.a], row.ja, row.impulse);
            if (row.b != DirectRow::kNone) TakeBack(island_[row.b], row.jb, row.impulse);
        }
    if (!Solve(rows, scratch)) return false;
    WriteVelocities();
    return true;
}

bool DirectIsland::MaySolveContacts(const PairStore& pairs) const {
    const auto mayBe = [&](uint32_t body) { return MayBeSolvedDirectly(bodies_, body, contacts_.Count()); };
    return contacts_.MayBeSolvedDirectly(pairs) && std::ranges::all_of(layout_.BodiesOf(group_), mayBe);
}

bool DirectIsland::NoteMisses() {
    const bool areFew = contacts_.Count() <= kFewContacts;
    const uint32_t times = areFew ? 0 : factorizations_ / (kMostFactorizations * std::max(solutions_, kLeastSubsteps));
    bool areMany = false;
    for (const uint32_t body : layout_.BodiesOf(group_)) {
        BodyCold& cold = bodies_.cold[body];
        uint8_t& misses = cold.directMisses;
        if (times > 0) misses = static_cast<uint8_t>(std::min<uint32_t>(misses + times, kMostMisses));
        else if (misses > 0) --misses;
        cold.wasDirect = true;
        areMany |= !areFew && misses == kMostMisses;
    }
    if (areMany) contacts_.ForgetImpulses();
    return areMany;
}

bool DirectIsland::SolveContacts(const ContactSolveSettings& settings, ScratchArena& scratch) {
    ++solutions_;
    SetBodies(From::Unconstrained);
    size_t count = 0;
    if (!contacts_.AddRows(island_, settings, rows_, count)) return false;
    const std::span<DirectRow> rows = rows_.first(count);
    // Where impulses turn out to be larger than the last ones, once more with rows as stiff as they ask for.
    do {
        if (!Solve(rows, scratch)) return false;
    } while (contacts_.Stiffen(rows));
    WriteVelocities();
    contacts_.ReadImpulses(rows);
    return true;
}

namespace {

Twist<float> DisplacementOf(const BodyState& state) {
    const float *x = state.deltaPosition, *r = state.deltaRotation;
    return {Vector3(x[0], x[1], x[2]), Vector3(r[0], r[1], r[2])};
}

}  // namespace

void DirectIsland::NotePlaces(const ContactSolveSettings& settings) {
    if (group_.isLoaded) contacts_.UpdateSeparations(settings);
    for (size_t i = 0; i < places_.size(); ++i)
        places_[i] = DisplacementOf(bodies_.states[layout_.bodies[group_.bodiesBegin + i]]);
}

void DirectIsland::CorrectPoses(const ContactSolveSettings& settings, ScratchArena& scratch) {
    // With the Jacobians of the velocities, which must be those of the factor: others would find what it does not hold.
    factor_.isValid &= isFactorCurrent_;
    isFactorCurrent_ = false;
    size_t row = 0, count = 0;
    VisitJoints(layout_, group_, [&](const JointBatch<kLanes>& batch) {
        WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
            constexpr LinearLock kLinear = linear;
            constexpr AngularLock kAngular = angular;
            for (int lane = 0; lane < batch.count; ++lane) {
                const auto correct = [&](const auto& part) {
                    for (int k = 0; k < part.GetBias().size(); ++k) {
                        DirectRow& correction = corrections_[count++] = rows_[row++];
                        const double wanted = double{part.GetBias()[k][lane]};
                        correction.c = wanted - std::clamp(wanted, -kRounding, kRounding);
                        correction.impulse = 0;
                    }
                };
                if constexpr (kLinear != LinearLock::None) correct(LinearPart<kLinear>(batch));
                if constexpr (kAngular != AngularLock::None) correct(AngularPart<kAngular>(batch));
                row += batch.rowCount;
            }
        });
    });
    for (size_t i = 0; i < places_.size(); ++i) {
        const Twist<float> now = DisplacementOf(bodies_.states[layout_.bodies[group_.bodiesBegin + i]]);
        for (int k = 0; k < 3; ++k) {
            island_[i].velocity[k] = double{now.linear[k] - places_[i].linear[k]};
            island_[i].velocity[3 + k] = double{now.angular[k] - places_[i].angular[k]};
        }
    }
    if (group_.isLoaded && !contacts_.AddCorrections(rows_, settings, corrections_, count)) return;
    const DirectProblem problem{island_, corrections_.first(count), {}, {}};
    const DirectSettings how{.tolerance = kPoseTolerance * speed_ * h_, .speed = speed_ * h_};
    const bool isFound = group_.isLoaded ? SolveDirectly(problem, pattern_, how, factor_, solved_, scratch).outcome ==
                                               DirectResult::Outcome::Solved
                                         : StepDirectly(problem, pattern_, factor_, solved_, scratch);
    if (!isFound) return;
    // Of bodies that are wedged, no row resists a motion along the wedge: none moves farther than all rows together ask
    // for.
    double part = 1;
    if (group_.isLoaded) {
        double wanted = 0, most = 0;
        for (const DirectRow& each : problem.rows) wanted += std::abs(each.c);
        for (size_t i = 0; i < island_.size(); ++i)
            for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(solved_[i].v[k] - island_[i].velocity[k]));
        if (most > wanted) part = wanted / most;
    }
    for (size_t i = 0; i < places_.size(); ++i) {
        BodyState& state = bodies_.states[layout_.bodies[group_.bodiesBegin + i]];
        const double *to = solved_[i].v, *from = island_[i].velocity;
        const auto change = [&](int k) { return static_cast<float>(part * (to[k] - from[k])); };
        const Vector3 way(change(0), change(1), change(2)), turn(change(3), change(4), change(5));
        const Vector3 w(state.angularVelocity[0], state.angularVelocity[1], state.angularVelocity[2]),
            turned = Rotate(TurnOf(turn), w);
        const Vector3 before = DisplacementOf(state).angular;
        const Vector3 rotation = TurnedSlightly<float>(before, Vec2<float>(state.halfTurn[0], state.halfTurn[1]), turn);
        for (int k = 0; k < 3; ++k) {
            state.deltaPosition[k] += way[k];
            state.deltaRotation[k] = rotation[k];
            state.angularVelocity[k] = turned[k];
        }
        const float* r = state.deltaRotation;
        const Vec2<float> half = HalfTurnOf<float>(Vector3(r[0], r[1], r[2]));
        state.halfTurn[0] = half.x();
        state.halfTurn[1] = half.y();
    }
    if (group_.isLoaded) contacts_.UpdateSeparations(settings);
}

}  // namespace fulcrum
