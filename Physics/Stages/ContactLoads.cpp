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

// Filters the level of this step over time and returns the persistent level.
uint8_t NextLevel(LoadLevel& load, uint32_t level, const SinkScale& scale) {
    load.steps = level > load.level ? static_cast<uint8_t>(std::min(load.steps + 1, 255)) : uint8_t(0);
    const uint32_t lasting = std::min<uint32_t>(level, load.recent);
    load.recent = static_cast<uint8_t>(level);
    const bool lasts = load.steps >= scale.stepsOfLoad;
    if (!lasts && !(scale.forgets && lasting + 1 < load.level)) return load.level;
    load.steps = 0;
    return static_cast<uint8_t>(lasts ? std::max<uint32_t>(lasting, load.level) : load.level - 1);
}

// Lanes with this squared anchor distance, m^2.
template <class Batch, class Real>
bool NoteSquaredGaps(const Batch& batch, const Real& squared, const GapScale& scale, JointStore& joints) {
    Real target(scale.target);
    if (joints.targetCount > 0)
        for (int lane = 0; lane < batch.count; ++lane)
            if (const float own = joints.joints[batch.joint[lane]].errorTarget; own > 0) target.Set(lane, own);
    const uint32_t beyond = (squared > target * target).ToBits();
    bool began = false;
    for (int lane = 0; lane < batch.count; ++lane) {
        Joint& joint = joints.joints[batch.joint[lane]];
        if (joint.isBeyondTarget) continue;
        joint.stepsBeyond = beyond >> lane & 1u ? static_cast<uint8_t>(joint.stepsBeyond + 1) : uint8_t(0);
        joint.isBeyondTarget = joint.stepsBeyond >= scale.stepsOfLoad;
        began |= joint.isBeyondTarget;
    }
    return began;
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
        if (!(part > target)) continue;
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
    Real impulse(0.0f);
    for (int i = 0; i < batch.pointCount; ++i) impulse += batch.rows[i].impulse;
    Real inverseMass = batch.inverseA.mass, squaredSize = SquaredSizeOf(batch.inverseA);
    if constexpr (!kFixedB) {
        inverseMass = Max(inverseMass, batch.sideB.inverse.mass);
        squaredSize = Min(squaredSize, SquaredSizeOf(batch.sideB.inverse));
    }
    const Real sink = impulse * Real(scale.inverseDt * scale.softness) * inverseMass;
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
        const uint8_t level = NextLevel(load, LevelOf(part[lane]), scale);
        if (level == load.level || IsLeftOut(bodies, joints, pairs.PairOf(batch.contact[lane]))) continue;
        load.level = level;
        changed = true;
    }
    return changed;
}

template <int N>
bool NoteGaps(const JointBatch<N>& batch, const GapScale& scale, JointStore& joints) {
    using Real = Wide<N>;
    if (batch.linear == LinearLock::None) return false;
    Vec3<Real> gap = batch.startOffset;
    if (batch.linear == LinearLock::Line) gap = gap - batch.startLine * Dot<Real>(gap, batch.startLine);
    return NoteSquaredGaps(batch, Dot<Real>(gap, gap), scale, joints);
}
template <int N>
bool NoteGaps(const BallBatch<N>& batch, const GapScale& scale, JointStore& joints) {
    return NoteSquaredGaps(batch, Dot<Wide<N>>(batch.startOffset, batch.startOffset), scale, joints);
}

#define FULCRUM_INSTANTIATE(lanes)                                                  \
    template bool NoteGaps(const JointBatch<lanes>&, const GapScale&, JointStore&); \
    template bool NoteGaps(const BallBatch<lanes>&, const GapScale&, JointStore&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                             \
    template bool NoteSinks(const ContactBatch<lanes, fixedB>&, const SinkScale&, const BodyStore&, const JointStore&, \
                            PairStore&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
