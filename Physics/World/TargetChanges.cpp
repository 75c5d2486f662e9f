#include <Fulcrum/Physics/World/TargetChanges.h>

namespace fulcrum {

namespace {

void StartAgain(Joint& joint) {
    joint.isBeyondTarget = false;
    joint.stepsBeyond = 0;
}

}  // namespace

void ChangePenetrationTarget(WorldState& world, uint32_t body, float target) {
    world.bodies.SetPenetrationTarget(body, target);
    world.coloring.Invalidate();
}

void ChangeErrorTarget(WorldState& world, uint32_t joint, float target) {
    if (world.joints.joints[joint].errorTarget == target) return;
    world.joints.SetErrorTarget(joint, target);
    StartAgain(world.joints.joints[joint]);
    ++world.joints.strainVersion;
    world.coloring.Invalidate();
}

void ChangeAccuracy(WorldState& world, const AccuracyTarget& accuracy) {
    if (world.settings.accuracy.jointError != accuracy.jointError) {
        for (Joint& joint : world.joints.joints)
            if (!(joint.errorTarget > 0)) StartAgain(joint);
        ++world.joints.strainVersion;
    }
    world.settings.accuracy = accuracy;
}

}  // namespace fulcrum
