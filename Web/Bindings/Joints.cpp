// Joints: create, drive, read.
#include <Fulcrum/Web/Bindings/Exchange.h>

namespace fulcrum::web {

namespace {

bool TakeJoint(const Result<JointId>& id) {
    if (!id) return Fail(id.GetError()) != 0;
    PutId(id.Value().index, id.Value().generation);
    return true;
}

}  // namespace

// Input: kind and settings. The numbers before: the two bodies' ids. The numbers after: the joint's id.
FULCRUM_FOR_JAVASCRIPT int fulcrum_createJoint(World* world, uint32_t indexA, uint32_t generationA, uint32_t indexB,
                                               uint32_t generationB) {
    AnyJointSettings settings;
    if (!ReadInput("joint", [&](JsonReader& fields) { fields.ReadJoint(settings); })) return 0;
    return std::visit(
        [&](auto& joint) {
            joint.bodyA = {indexA, generationA};
            joint.bodyB = {indexB, generationB};
            return TakeJoint(world->System().Joints().Create(joint));
        },
        settings);
}

// Input: anchor, target, spring, maxForce. Likewise.
FULCRUM_FOR_JAVASCRIPT int fulcrum_createTarget(World* world, uint32_t index, uint32_t generation) {
    TargetJointSettings settings;
    settings.body = {index, generation};
    if (!ReadInput("target joint", [&](JsonReader& fields) {
            fields.Field("anchor", settings.anchor);
            fields.Field("target", settings.target);
            fields.Field("spring", settings.spring);
            fields.Field("maxForce", settings.maxForce);
        }))
        return 0;
    return TakeJoint(world->System().Joints().CreateTarget(settings));
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_setTarget(World* world, uint32_t index, uint32_t generation, double x, double y,
                                             double z) {
    return Outcome(world->System().Joints().SetTarget({index, generation}, Position(x, y, z)));
}

FULCRUM_FOR_JAVASCRIPT int fulcrum_removeJoint(World* world, uint32_t index, uint32_t generation) {
    return Outcome(world->System().Joints().Remove({index, generation}));
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_jointExists(World* world, uint32_t index, uint32_t generation) {
    return world->System().Joints().Exists({index, generation});
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_setJointEnabled(World* world, uint32_t index, uint32_t generation, int enabled) {
    return Outcome(world->System().Joints().SetEnabled({index, generation}, enabled != 0));
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_isJointEnabled(World* world, uint32_t index, uint32_t generation) {
    return world->System().Joints().IsEnabled({index, generation});
}

// Input: what is to change of the motor of an axis, 0 .. 5 as JointAxis.
FULCRUM_FOR_JAVASCRIPT int fulcrum_setMotor(World* world, uint32_t index, uint32_t generation, int axis) {
    JointInterface& joints = world->System().Joints();
    const AxisControl* control = joints.GetControl({index, generation}, static_cast<JointAxis>(axis));
    JointMotor motor = control ? control->motor : JointMotor();
    if (!ReadInput("motor", [&](JsonReader& fields) { Describe(fields, motor); })) return 0;
    return Outcome(joints.SetMotor({index, generation}, static_cast<JointAxis>(axis), motor));
}
// Input: limits, or null for none.
FULCRUM_FOR_JAVASCRIPT int fulcrum_setLimits(World* world, uint32_t index, uint32_t generation, int axis) {
    JointInterface& joints = world->System().Joints();
    if (Shared().input == "null")
        return Outcome(joints.SetLimits({index, generation}, static_cast<JointAxis>(axis), std::nullopt));
    JointLimits limits;
    if (!ReadInput("limits", [&](JsonReader& fields) { Describe(fields, limits); })) return 0;
    return Outcome(joints.SetLimits({index, generation}, static_cast<JointAxis>(axis), limits));
}
FULCRUM_FOR_JAVASCRIPT double fulcrum_jointCoordinate(World* world, uint32_t index, uint32_t generation, int axis) {
    return world->System().Joints().GetCoordinate({index, generation}, static_cast<JointAxis>(axis));
}

// The numbers: force 3, torque 3, distance, angle, position of frame A and of frame B 3 each.
FULCRUM_FOR_JAVASCRIPT int fulcrum_readJoint(World* world, uint32_t index, uint32_t generation) {
    const JointInterface& joints = world->System().Joints();
    const JointId id = {index, generation};
    if (!joints.Exists(id)) return Fail({ErrorCode::UnknownId, "there is no such joint"});
    const Vector3 force = joints.GetForce(id), torque = joints.GetTorque(id);
    const Position a = joints.GetFrameA(id).position, b = joints.GetFrameB(id).position;
    const JointError error = joints.GetError(id);
    double* n = Shared().numbers.data();
    for (int k = 0; k < 3; ++k) {
        n[k] = force[k];
        n[3 + k] = torque[k];
        n[8 + k] = a[k];
        n[11 + k] = b[k];
    }
    n[6] = error.distance;
    n[7] = error.angle;
    return 1;
}

}  // namespace fulcrum::web
