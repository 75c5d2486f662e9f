#include <Fulcrum/UnitTests/Physics/BadInput/Room.h>

namespace fulcrum::testing {

Room::Room() {
    floor = world.AddFloor();
    body = world.Add({.shape = ball, .position = {0, 0.4, 0}});
    other = world.Add({.shape = CubeOf(0.4f), .position = {1.5, 0.4, 0}});
    driven = world.Add({.shape = BoxOf(1, 0.1f, 0.1f), .motion = MotionType::Kinematic, .position = {0, 3, 3}});
    sensor = world.Add({.shape = CubeOf(1), .motion = MotionType::Static, .position = {0, 1, 0}, .isSensor = true});
    const CompoundShape::ChildSettings children[] = {{.shape = SphereOf(0.3f)},
                                                     {.shape = CubeOf(0.2f), .position = {0.5f, 0, 0}}};
    compound = world.Add({.shape = MutableCompound::Create(children).Value(), .position = {0, 0.5, -2}});
    child = world.Bodies().GetChildren(compound)->IdOf(1);
    HingeJointSettings settings;
    settings.bodyA = body;
    settings.bodyB = other;
    settings.anchorA = {.point = {0.7, 0.4, 0}, .axis = {0, 0, 1}};
    settings.angle = {.limited = true, .limits = {-1, 1}};
    hinge = system.Joints().Create(settings).Value();
    PointJointSettings point;
    point.bodyA = kWorldBody;
    point.bodyB = compound;
    point.anchorA.point = {0, 1, -2};
    toWorld = system.Joints().Create(point).Value();
    // What was there once.
    const BodyId goneBody = world.Add({.shape = ball, .position = {9, 5, 9}});
    point.bodyB = goneBody;
    const JointId goneJoint = system.Joints().Create(point).Value();
    EXPECT_TRUE(world.Bodies().Remove(goneBody));
    world.Steps(5);
    bad.bodies = {BodyId{}, goneBody, {body.index, body.generation + 1}, {5000, 0}, {0xFFFFFFFEu, 0}};
    bad.joints = {JointId{}, goneJoint, {hinge.index, hinge.generation + 1}, {5000, 0}, {0xFFFFFFFEu, 0}};
    const BodyId two[] = {body, other};
    EXPECT_TRUE(system.SaveBodies(two, some));
    Keep();
}

void Room::Keep() {
    EXPECT_TRUE(system.SaveSnapshot(snapshot));
    system.VisitBodies([&](BodyId id) { shapes_.push_back(world.Bodies().GetShape(id)); });
    hash_ = system.HashState();
}

void Room::Restore() {
    const Status restored = system.RestoreSnapshot(snapshot, {.shapes = shapes_});
    ASSERT_TRUE(restored) << restored.GetError().message;
    ASSERT_EQ(system.HashState(), hash_);
}

std::string Room::WrongAfterSteps() {
    for (int step = 0; step < 2; ++step) {
        if (const Status status = system.Update(kStep); !status) return status.GetError().message;
        std::string wrong;
        system.VisitBodies([&](BodyId id) {
            const BodyInterface& bodies = world.Bodies();
            const Pose pose = bodies.GetPose(id);
            if (!IsFinite(pose.position) || !IsFinite(pose.rotation) || !IsFinite(bodies.GetLinearVelocity(id)) ||
                !IsFinite(bodies.GetAngularVelocity(id)))
                wrong = "body " + std::to_string(id.index) + " is not finite";
            if (bodies.IsFrozen(id)) wrong = "body " + std::to_string(id.index) + " is frozen";
        });
        if (!wrong.empty()) return wrong;
    }
    return {};
}

}  // namespace fulcrum::testing
