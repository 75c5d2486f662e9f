#include <Fulcrum/UnitTests/Support/GuidedScene.h>

#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <algorithm>
#include <vector>

namespace fulcrum::testing {

namespace {

constexpr int kSteps = 90;

void AddPlate(TestWorld& world) {
    world.Add({.shape = BoxOf(3, 0.1f, 3),
               .motion = MotionType::Kinematic,
               .position = {0, 0.2, 0},
               .angularVelocity = {0, 1, 0}});
}

std::vector<BodyId> AddBodies(TestWorld& world, uint32_t seed, bool hasPlate = true) {
    world.AddFloor({.friction = 0.5f});
    if (hasPlate) AddPlate(world);
    const ShapePtr shapes[] = {
        SphereOf(0.35f), BoxOf(0.4f, 0.2f, 0.3f), CapsuleOf(0.3f, 0.2f),
        HullOf({{0.4f, -0.2f, 0}, {-0.3f, -0.2f, 0.3f}, {-0.3f, -0.2f, -0.3f}, {0, 0.4f, 0}}),
        CompoundOf({{.shape = BoxOf(0.4f, 0.1f, 0.1f)}, {.shape = SphereOf(0.2f), .position = {0.4f, 0, 0}}})};
    RandomPoses random(seed);
    std::vector<BodyId> bodies;
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
    }
    for (size_t i = 0; i + 1 < bodies.size(); i += 9) {
        const BodyId a = bodies[i], b = bodies[i + 1];
        const Position middle = (world.Bodies().GetPose(a).position + world.Bodies().GetPose(b).position) * 0.5;
        JointSettings between = Between(a, b, middle, Vector3(0, 0, 1));
        between.anchorB = between.anchorA;
        if (i % 2 == 0) Join(world, Of<PointJointSettings>(between));
        else Join(world, Of<HingeJointSettings>(between));
    }
    return bodies;
}

}  // namespace

uint64_t HashOfGuidedScene(uint32_t threads) {
    TestWorld world({}, threads);
    const std::vector<BodyId> bodies = AddBodies(world, 5);
    std::vector<Position> starts;
    for (const BodyId id : bodies) starts.push_back(world.Bodies().GetCenterOfMass(id));
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

float FastestOfGuidedScene(uint32_t seed) {
    TestWorld world;
    const std::vector<BodyId> bodies = AddBodies(world, seed);
    float fastest = 0;
    for (int i = 0; i < 240; ++i) {
        world.Step();
        for (const BodyId id : bodies) fastest = std::max(fastest, Length(world.VelocityOf(id)));
    }
    return fastest;
}

double EnergyRiseOfGuidedScene(uint32_t seed) {
    TestWorld world;
    const std::vector<BodyId> bodies = AddBodies(world, seed, false);
    const auto energy = [&] {
        double sum = 0;
        for (const BodyId id : bodies)
            sum += double{world.Bodies().GetKineticEnergy(id)} +
                   kGravity * double{world.Bodies().GetMass(id)} * world.Bodies().GetCenterOfMass(id).y();
        return sum;
    };
    const double start = energy();
    double least = start, rise = 0;
    for (int i = 0; i < 240; ++i) {
        world.Step();
        const double now = energy();
        least = std::min(least, now);
        rise = std::max(rise, now - least);
    }
    return rise / start;
}

}  // namespace fulcrum::testing
