#include <Fulcrum/Physics/Stages/ContactLoads.h>

#include <Fulcrum/Physics/Stages/FindIslands.h>

#include <algorithm>
#include <bit>

namespace fulcrum {

namespace {

// Safety factor of weights. With N substeps of P iterations, a load of r times its support's mass comes to rest if N^2
// P > 2 r, approximately; the allowed penetration of a cube of 1 m alone would give 1.5 r. The rest limits the rebound
// when such a load is removed to 1 mm for loads of up to 200 times.
constexpr float kMargin = 1.75f;

// 0 below 1, then 1 + floor(log2 x).
uint32_t LevelOf(float x) {
    if (!(x >= 1)) return 0;
    return std::min((std::bit_cast<uint32_t>(x) >> 23) - 126, static_cast<uint32_t>(kMostLevel));
}

// Filters the level of this step over time and returns the persistent level. isSure: accept it at once. scale:
// SinkScale or GapScale.
template <class Scale>
uint8_t NextLevel(LoadLevel& load, uint32_t level, bool isSure, const Scale& scale) {
    load.steps = level > load.level ? static_cast<uint8_t>(std::min(load.steps + 1, 255)) : uint8_t(0);
    const bool lasts = load.steps >= scale.stepsOfLoad || (isSure && level > load.level);
    const uint32_t lasting = isSure ? level : std::min<uint32_t>(level, load.recent);
    // Of long and short steps that alternate the one kind may ask for more than the other.
    const uint32_t wanted = scale.isOfOtherLength ? std::max<uint32_t>(level, load.recent) : lasting;
    load.recent = static_cast<uint8_t>(level);
    if (!lasts && !(scale.forgets && wanted + 1 < load.level)) return load.level;
    load.steps = 0;
    return static_cast<uint8_t>(lasts ? std::max<uint32_t>(lasting, load.level) : load.level - 1);
}

// An effort is in vain if the error of a joint remains above this part of what it was, and of its maximum over two
// times as many steps as a load must persist for, though substeps are half as long: by the square law it would be a
// quarter. What lands, swings or rattles does not keep its error for so long.
constexpr float kInVain = 0.9f, kShorter = 0.51f;
constexpr uint32_t kWindows = 2;
// Beyond these parts of the error for which effort was in vain it is tried again.
constexpr float kLeastChange = 0.5f, kMostChange = 1.5f;

// The level that a joint asks for. gapPart: its gap by GapScale::PerLevel; driftPart: what its drift asks for,
// likewise.
uint8_t NextLevel(GapLevel& gap, float gapPart, float driftPart, const GapScale& scale) {
    auto& [load, trial] = gap;
    const float error = gapPart * scale.impulseScale * scale.impulseScale;  // in quarters of the target
    const uint32_t wantedByGap = LevelOf(gapPart), wantedByDrift = LevelOf(driftPart);
    if (trial.isInVain) {
        const bool isSame = error >= kLeastChange * trial.error && error <= kMostChange * trial.error;
        trial.steps = isSame ? uint16_t(0) : static_cast<uint16_t>(trial.steps + 1);
        const uint32_t most = trial.level;
        if (trial.steps < scale.stepsOfLoad)
            return NextLevel(load, std::max(std::min(wantedByGap, most), wantedByDrift), false, scale);
        trial = {};
    }
    if (trial.error > 0) {
        trial.least = std::min(trial.least, error);
        trial.most = std::max(trial.most, error);
        if (++trial.steps >= kWindows * scale.stepsOfLoad) {
            const bool isConstant = trial.least >= kInVain * trial.most;
            trial.steps = 0;
            trial.least = trial.most = error;
            if (error < kInVain * trial.error) trial = {};
            else if (isConstant && scale.impulseScale <= kShorter * trial.effort) {
                trial.isInVain = true;
                return trial.level;
            }
        }
    }
    const uint8_t level = NextLevel(load, std::max(wantedByGap, wantedByDrift), false, scale);
    if (trial.error == 0 && level > load.level && wantedByGap > load.level)
        trial = {.error = error, .effort = scale.impulseScale, .least = error, .most = error, .level = load.level};
    return level;
}

template <int N>
Twist<Wide<N>> VelocitiesOf(const uint32_t (&bodies)[N], const BodyStore& store) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = store.states[bodies[i]].VelocityRow();
    Wide<N> row[8];
    GatherRows<N>(rows, row);
    return {VectorAt<BodyState::kLinear>(row), VectorAt<BodyState::kAngular>(row)};
}

// m2/s2: the squares of how fast anchors part along what joints lock, where the last pass has set the parts up.
template <int N>
Wide<N> SquaredPartings(const BallBatch<N>& batch, const BodyStore& bodies) {
    const Vec3<Wide<N>> parting =
        PointMotion(VelocitiesOf<N>(batch.bodyA, bodies), VelocitiesOf<N>(batch.bodyB, bodies), batch.armA, batch.armB);
    return Dot<Wide<N>>(parting, parting);
}
template <int N>
Wide<N> SquaredPartings(const JointBatch<N>& batch, const BodyStore& bodies) {
    const Twist<Wide<N>> a = VelocitiesOf<N>(batch.bodyA, bodies), b = VelocitiesOf<N>(batch.bodyB, bodies);
    if (batch.linear == LinearLock::Point) {
        const Vec3<Wide<N>> parting = batch.point.RelativeMotion(a, b);
        return Dot<Wide<N>>(parting, parting);
    }
    const auto across = batch.line.RelativeMotion(a, b);
    return across[0] * across[0] + across[1] * across[1];
}

// Level of lanes with this squared anchor distance, m^2.
template <class Batch, class Real>
bool NoteSquaredGaps(const Batch& batch, const Real& squared, const GapScale& scale, const BodyStore& bodies,
                     JointStore& joints) {
    Real gapPart = Sqrt(squared) * Real(scale.PerLevel(scale.target)), driftPart(0.0f);
    if (joints.targetCount > 0)
        for (int lane = 0; lane < batch.count; ++lane) {
            const float target = joints.joints[batch.joint[lane]].errorTarget;
            if (target > 0) gapPart.Set(lane, std::sqrt(squared[lane]) * scale.PerLevel(target));
        }
    // Effort makes gaps less by the square of what it makes speeds less.
    if (scale.drift < std::numeric_limits<float>::infinity()) {
        const Real ratio = Sqrt(SquaredPartings(batch, bodies)) * Real(1 / scale.drift);
        driftPart = ratio * ratio * Real(1 / kUnnotedFraction);
    }
    const uint32_t noted = scale.forgets ? ~0u : (Max(gapPart, driftPart) >= Real(1.0f)).ToBits();
    if (noted == 0) return false;
    bool changed = false;
    for (int lane = 0; lane < batch.count; ++lane) {
        if (!(noted >> lane & 1u)) continue;
        GapLevel& gap = joints.gaps[batch.joint[lane]];
        gap.load.stiffness = scale.stiffness;
        const uint8_t level = NextLevel(gap, gapPart[lane], driftPart[lane], scale);
        changed |= level != gap.load.level;
        gap.load.level = level;
    }
    return changed;
}

template <class Real>
Real SquaredSizeOf(const UniformInverseMass<Real>& inverse) {
    return SquaredSize<Real>(inverse.mass, inverse.inertia.xx + inverse.inertia.yy + inverse.inertia.zz);
}

// Excludes jointed bodies, whose size is undefined, and bodies created inside each other, which are not a load.
bool IsLeftOut(const BodyStore& bodies, const JointStore& joints, const Pair& pair) {
    const auto isLeftOut = [&](uint32_t body) { return joints.HasAny(body) || bodies.dynamics[body].crowded; };
    return isLeftOut(pair.bodyA) || isLeftOut(pair.bodyB);
}

// A contact that began, by its pair.
struct BegunContact {
    uint32_t upper, lower;
    float down;  // m/s2: gravity along the normal
};
BegunContact ContactOf(const Vector3& gravity, const BodyStore& bodies, const PairStore& pairs, uint32_t index) {
    const Pair& pair = pairs.pairs[index];
    const float* n = pairs.RecordOf(pair).normal;
    const float down = Dot(Rotate(bodies.RotationOf(pair.bodyA), Vector3(n[0], n[1], n[2])), gravity);
    return down < 0 ? BegunContact{pair.bodyB, pair.bodyA, -down} : BegunContact{pair.bodyA, pair.bodyB, down};
}

// What the contacts that began carry, in a structure that begins at rest: the upper body and what that carries, by
// equal parts on all that it lies on. What falls together carries nothing.
class Carried {
public:
    Carried(const StepContext& step, const BodyStore& bodies, const PairStore& pairs, std::span<const uint32_t> began,
            ScratchArena& scratch)
        : bodies_(bodies), calm_(Length(step.settings.gravity) * step.dt), order_(began) {
        // Where nothing lies on what lies on something, as in most steps, bodies carry themselves alone.
        const auto isOfTwo = [&](uint32_t index) {
            const Pair& pair = pairs.pairs[index];
            return bodies.dynamics[pair.bodyA].inverseMass > 0 && bodies.dynamics[pair.bodyB].inverseMass > 0;
        };
        if (began.size() < 2 || !std::ranges::any_of(began, isOfTwo)) return;
        const Vector3 g = step.settings.gravity;
        // From top to bottom.
        struct Place {
            double depth;
            uint32_t pair;
            auto operator<=>(const Place&) const = default;
        };
        std::span<Place> places = scratch.Allocate<Place>(began.size());
        std::span<uint32_t> order = scratch.Allocate<uint32_t>(began.size());
        loads_ = scratch.Allocate<Load>(bodies.dynamics.size());
        std::ranges::fill(loads_, Load{});
        for (size_t i = 0; i < began.size(); ++i) {
            const uint32_t upper = ContactOf(g, bodies, pairs, began[i]).upper;
            const Position at = bodies.CenterOf(upper);
            places[i] = {at.x() * double{g.x()} + at.y() * double{g.y()} + at.z() * double{g.z()}, began[i]};
            ++loads_[upper].supports;
        }
        std::ranges::sort(places);
        std::transform(places.begin(), places.end(), order.begin(), [](const Place& place) { return place.pair; });
        order_ = order;
    }

    // In which MassOn is to be called.
    std::span<const uint32_t> Order() const { return order_; }
    float MassOn(const BegunContact& contact) {
        if (loads_.empty() || Length(bodies_.LinearVelocityOf(contact.upper)) > calm_) return 0;
        const Load& above = loads_[contact.upper];
        const float mass =
            (1 / bodies_.dynamics[contact.upper].inverseMass + above.mass) / static_cast<float>(above.supports);
        loads_[contact.lower].mass += mass;
        return mass;
    }

private:
    struct Load {
        float mass;  // kg
        uint32_t supports;
    };
    const BodyStore& bodies_;
    float calm_;  // m/s
    std::span<const uint32_t> order_;
    std::span<Load> loads_;  // by body; empty: nothing lies on what lies on something
};

}  // namespace

void NoteWeights(const StepContext& step, std::span<const uint32_t> began, const BodyStore& bodies,
                 const JointStore& joints, PairStore& pairs, ScratchArena& scratch) {
    if (!AdaptsToLoads(step.settings, bodies)) return;
    const float softness = LoadSoftnessOf(step);
    Carried carried(step, bodies, pairs, began, scratch);
    for (uint32_t index : carried.Order()) {
        const BegunContact contact = ContactOf(step.settings.gravity, bodies, pairs, index);
        const BodyDynamics &upper = bodies.dynamics[contact.upper], &lower = bodies.dynamics[contact.lower];
        if (!(upper.inverseMass > 0) || IsLeftOut(bodies, joints, pairs.pairs[index])) continue;
        const BodyDynamics& lighter = lower.inverseMass > upper.inverseMass ? lower : upper;
        const float mass = std::max(kMargin / upper.inverseMass, carried.MassOn(contact));
        const float part = contact.down * lighter.inverseMass * mass * softness / SizeOf(lighter);
        const float target =
            PenetrationTargetOf(bodies, contact.upper, contact.lower, step.settings.accuracy.penetration);
        const float springs = IsLoad(upper, lower, target, step) ? kLoadedSubstep * kLoadedSubstep : 1;
        if (!(springs * part > target)) continue;
        const uint32_t level = LevelOf(part / LargestUnnoted(target));
        LoadLevel& load = pairs.loads[index];
        if (level <= load.level) continue;
        load.level = load.recent = static_cast<uint8_t>(level);
        ++pairs.loadVersion;
    }
}

void NoteForces(const StepContext& step, const ConstraintColoring& coloring, const BodyStore& bodies,
                const JointStore& joints, PairStore& pairs) {
    if (!AdaptsToLoads(step.settings, bodies)) return;
    using Kind = ConstraintColoring::Kind;
    const float softness = LoadSoftnessOf(step);
    const auto note = [&](uint32_t, const ConstraintColoring::Entry& entry) {
        const float impulse = pairs.records[entry.constraint].TotalImpulse();
        const uint32_t index = pairs.contacts[entry.constraint].pair;
        const Pair& pair = pairs.pairs[index];
        const BodyDynamics &a = bodies.dynamics[pair.bodyA], &b = bodies.dynamics[pair.bodyB];
        const BodyDynamics& lighter = b.inverseMass > a.inverseMass ? b : a;
        const float part = impulse / step.lastSubstepDt * lighter.inverseMass * softness / SizeOf(lighter);
        const float target = PenetrationTargetOf(bodies, pair.bodyA, pair.bodyB, step.settings.accuracy.penetration);
        const uint32_t level = LevelOf(part / LargestUnnoted(target));
        LoadLevel& load = pairs.loads[index];
        load.stiffness = 0;  // the springs of the shorter step were stiffer than any of this one
        if (level <= load.level || IsLeftOut(bodies, joints, pair)) return;
        load.level = load.recent = static_cast<uint8_t>(level);
        load.steps = 0;
    };
    VisitEntries(coloring, Kind::Moving, note);
    VisitEntries(coloring, Kind::Fixed, note);
    ++pairs.loadVersion;
}

template <int N, bool kFixedB>
bool NoteSinks(const ContactBatch<N, kFixedB>& batch, const SinkScale& scale, const BodyStore& bodies,
               const JointStore& joints, PairStore& pairs) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    Real impulse(0.0f);
    for (int i = 0; i < batch.pointCount; ++i) impulse += batch.rows[i].impulse;
    Real force = impulse * Real(scale.inverseDt), squaredSize = SquaredSizeOf(batch.inverseA);
    Real inverseMass = batch.inverseA.mass;
    WideMask<N> unseen = zero > zero;
    if constexpr (!kFixedB) {
        inverseMass = Max(batch.inverseA.mass, batch.sideB.inverse.mass);
        squaredSize = Min(squaredSize, SquaredSizeOf(batch.sideB.inverse));
        // If the penetration grows beyond what the impulses explain, the contact does not yet carry its final load:
        // impulses of a heavy body on a light one build up slowly.
        Real depth = zero;
        for (int i = 0; i < batch.pointCount; ++i) {
            const auto& row = batch.rows[i];
            const auto sinks =
                (row.separation < row.startSeparation) & (row.inverseResponse > zero);  // only points in use
            depth = Max(depth, Select(sinks, -row.separation, zero));
        }
        unseen = depth * Real(scale.depthScale) > Real(2.0f) * force * inverseMass * Real(scale.softness);
        const Real along = -Dot<Real>(
            batch.normal, Vec3<Real>(Real(scale.gravity.x()), Real(scale.gravity.y()), Real(scale.gravity.z())));
        const Real weight = Abs(along) / Select(along > zero, batch.sideB.inverse.mass, batch.inverseA.mass);
        force = Select(unseen, Max(force, weight), force);
    }
    const Real sink = force * inverseMass * Real(scale.loadSoftness);
    Real part = sink * Real(1 / LargestUnnoted(scale.target)) / Sqrt(squaredSize);
    if (bodies.targetCount > 0)
        for (int lane = 0; lane < batch.count; ++lane) {
            const Pair& pair = pairs.PairOf(batch.contact[lane]);
            const float target = PenetrationTargetOf(bodies, pair.bodyA, pair.bodyB, scale.target);
            part.Set(lane, sink[lane] * (1 / LargestUnnoted(target)) / std::sqrt(squaredSize[lane]));
        }
    // Contacts with little load are only processed when levels may decrease; each lane independently, so that the
    // result does not depend on the other lanes of a batch.
    const uint32_t loaded = scale.forgets ? ~0u : (part >= Real(1.0f)).ToBits();
    if (loaded == 0) return false;
    bool changed = false;
    for (int lane = 0; lane < batch.count; ++lane) {
        if (!(loaded >> lane & 1u)) continue;
        LoadLevel& load = pairs.loads[pairs.contacts[batch.contact[lane]].pair];
        load.stiffness = scale.stiffness;
        const uint8_t level = NextLevel(load, LevelOf(part[lane]), unseen[lane], scale);
        if (level == load.level || IsLeftOut(bodies, joints, pairs.PairOf(batch.contact[lane]))) continue;
        load.level = level;
        changed = true;
    }
    return changed;
}

template <int N>
bool NoteGaps(const JointBatch<N>& batch, const GapScale& scale, const BodyStore& bodies, JointStore& joints) {
    using Real = Wide<N>;
    if (batch.linear == LinearLock::None) return false;
    Vec3<Real> gap = batch.startOffset;
    if (batch.linear == LinearLock::Line) gap = gap - batch.startLine * Dot<Real>(gap, batch.startLine);
    return NoteSquaredGaps(batch, Dot<Real>(gap, gap), scale, bodies, joints);
}
template <int N>
bool NoteGaps(const BallBatch<N>& batch, const GapScale& scale, const BodyStore& bodies, JointStore& joints) {
    return NoteSquaredGaps(batch, Dot<Wide<N>>(batch.startOffset, batch.startOffset), scale, bodies, joints);
}

#define FULCRUM_INSTANTIATE(lanes)                                                                    \
    template bool NoteGaps(const JointBatch<lanes>&, const GapScale&, const BodyStore&, JointStore&); \
    template bool NoteGaps(const BallBatch<lanes>&, const GapScale&, const BodyStore&, JointStore&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                             \
    template bool NoteSinks(const ContactBatch<lanes, fixedB>&, const SinkScale&, const BodyStore&, const JointStore&, \
                            PairStore&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
