#include <Fulcrum/UnitTests/Support/GuidedScene.h>

#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

namespace fulcrum::testing {

namespace {

constexpr int kSteps = 90;

}  // namespace

uint64_t HashOfGuidedScene(uint32_t threads) {
    TestWorld world({}, threads);
    world.AddFloor({.friction = 0.5f});
    world.Add({.shape = BoxOf(3, 0.1f, 3),
               .motion = MotionType::Kinematic,
               .position = {0, 0.2, 0},
               .angularVelocity = {0, 1, 0}});
    const ShapePtr shapes[] = {
        SphereOf(0.35f), BoxOf(0.4f, 0.2f, 0.3f), CapsuleOf(0.3f, 0.2f),
        HullOf({{0.4f, -0.2f, 0}, {-0.3f, -0.2f, 0.3f}, {-0.3f, -0.2f, -0.3f}, {0, 0.4f, 0}}),
        CompoundOf({{.shape = BoxOf(0.4f, 0.1f, 0.1f)}, {.shape = SphereOf(0.2f), .position = {0.4f, 0, 0}}})};
    RandomPoses random(5);
    std::vector<BodyId> bodies;
    std::vector<Position> starts;
    for (int i = 0; i < 320; ++i) {
        const double y = 0.6 + 0.9 * (i / 64);
        const Position at(0.9 * (i % 8 - 3.5), y, 0.9 * (i / 8 % 8 - 3.5));
        const float spin = random.Between(-3, 3), restitution = i % 7 == 0 ? 0.5f : 0.0f;
        BodySettings body{.shape = shapes[i % 5],
                          .position = at,
                          .rotation = random.Rotation(),
                          .linearVelocity = random.InBox(2),
                          .angularVelocity = Vector3(spin, -spin, 0.5f * spin),
                          .density = i % 3 == 0 ? 100.0f : 1000.0f,
                          .material = {.restitution = restitution},
                          .lockedAxes = static_cast<LockedAxes>(i * 29 % 64)};
        bodies.push_back(world.Add(body));
        starts.push_back(world.Bodies().GetCenterOfMass(bodies.back()));
    }
    for (size_t i = 0; i + 1 < bodies.size(); i += 9) {
        const BodyId a = bodies[i], b = bodies[i + 1];
        const Position middle = (world.Bodies().GetPose(a).position + world.Bodies().GetPose(b).position) * 0.5;
        JointSettings between = Between(a, b, middle, Vector3(0, 0, 1));
        between.anchorB = between.anchorA;
        if (i % 2 == 0) Join(world, Of<PointJointSettings>(between));
        else Join(world, Of<HingeJointSettings>(between));
    }
    world.Steps(kSteps);
    for (size_t i = 0; i < bodies.size(); ++i) {
        const Position moved = world.Bodies().GetCenterOfMass(bodies[i]) - starts[i];
        for (int k = 0; k < 3; ++k) {
            const bool isLocked = static_cast<unsigned>(world.Bodies().GetLockedAxes(bodies[i])) >> k & 1;
            EXPECT_NEAR(isLocked ? moved[k] : 0, 0, 1e-6) << i;
        }
        EXPECT_LT(Length(world.Bodies().GetAngularVelocity(bodies[i])), 50) << i;
    }
    return world.System().HashState();
}

}  // namespace fulcrum::testing
