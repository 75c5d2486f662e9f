#include <Fulcrum/Physics/World/TargetChanges.h>

#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

bool IsAsked(float target) { return target < std::numeric_limits<float>::infinity(); }

// By how many levels the same error is higher with the new target; rounded up, so that the effort is never too small. 0
// for a looser one: there efforts fall as when loads become less. What nobody has asked for has not been noted.
int RiseOf(float before, float after) {
    if (!(after < before) || !IsAsked(before)) return 0;
    int exponent = 0;
    constexpr float kMost = 1e30f;
    const float fraction = std::frexp(std::min(before / after, kMost), &exponent);
    return fraction == 0.5f ? exponent - 1 : exponent;
}

void Raise(LoadLevel& load, int by) {
    const auto raised = [by](uint8_t level) {
        return level == 0 ? uint8_t(0) : static_cast<uint8_t>(std::min(level + by, kMostLevel));
    };
    load.level = raised(load.level);
    load.recent = raised(load.recent);
    load.steps = 0;
}

// targetBefore(body): its own.
template <class TargetBefore>
void ChangeSinks(WorldState& world, const TargetBefore& targetBefore, float systemBefore) {
    const auto targetOf = [&](uint32_t body) { return world.bodies.cold[body].penetrationTarget; };
    for (uint32_t i = 0; i < world.pairs.pairs.size(); ++i) {
        const Pair& pair = world.pairs.pairs[i];
        if (!pair.exists) continue;
        const float before = PenetrationTargetOf(targetBefore(pair.bodyA), targetBefore(pair.bodyB), systemBefore),
                    after = PenetrationTargetOf(targetOf(pair.bodyA), targetOf(pair.bodyB),
                                                world.settings.accuracy.penetration);
        if (before == after) continue;
        if (IsAsked(after)) Raise(world.pairs.loads[i], RiseOf(before, after));
        else world.pairs.loads[i] = {};
    }
}

struct JointTarget {
    float gap = 0, drift = 0;  // m, m/s
    bool operator==(const JointTarget&) const = default;
};

JointTarget TargetOf(const Joint& joint, const AccuracyTarget& accuracy) {
    return {joint.errorTarget > 0 ? joint.errorTarget : accuracy.jointError, accuracy.drift};
}

void ChangeGap(GapLevel& gap, const JointTarget& before, const JointTarget& after) {
    if (before == after) return;
    gap.trial = {};
    // Levels of a drift are of its square.
    if (IsAsked(after.gap) || IsAsked(after.drift))
        Raise(gap.load, std::max(RiseOf(before.gap, after.gap), 2 * RiseOf(before.drift, after.drift)));
    else gap.load = {};
}

}  // namespace

void ChangePenetrationTarget(WorldState& world, uint32_t body, float target) {
    const float own = world.bodies.cold[body].penetrationTarget;
    world.bodies.SetPenetrationTarget(body, target);
    ChangeSinks(
        world, [&](uint32_t other) { return other == body ? own : world.bodies.cold[other].penetrationTarget; },
        world.settings.accuracy.penetration);
    world.coloring.Invalidate();
}

void ChangeErrorTarget(WorldState& world, uint32_t joint, float target) {
    const AccuracyTarget& accuracy = world.settings.accuracy;
    const JointTarget before = TargetOf(world.joints.joints[joint], accuracy);
    world.joints.SetErrorTarget(joint, target);
    ChangeGap(world.joints.gaps[joint], before, TargetOf(world.joints.joints[joint], accuracy));
    world.coloring.Invalidate();
}

void ChangeAccuracy(WorldState& world, const AccuracyTarget& accuracy) {
    const AccuracyTarget before = world.settings.accuracy;
    world.settings.accuracy = accuracy;
    if (before.penetration != accuracy.penetration)
        ChangeSinks(
            world, [&](uint32_t body) { return world.bodies.cold[body].penetrationTarget; }, before.penetration);
    for (uint32_t i = 0; i < world.joints.joints.size(); ++i)
        ChangeGap(world.joints.gaps[i], TargetOf(world.joints.joints[i], before),
                  TargetOf(world.joints.joints[i], accuracy));
}

}  // namespace fulcrum
