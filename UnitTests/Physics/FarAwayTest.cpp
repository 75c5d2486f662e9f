// A scene behaves wherever it stands: a stack, a chain and a ragdoll on every kind of ground, at up to 10^9 m from the
// origin. Positions are double: at 10^9 m their steps are 1.2e-7 m. Bounds are float, rounded outwards: there their
// steps are 64 m.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <string>

namespace fulcrum::testing {
namespace {

constexpr double kDistances[] = {1e4, 1e6, 1e7, 1e9};  // m

using Ids = std::vector<BodyId>;

// Grounds, their surface at y = 0. Meshes and height fields have cells of half a meter.
constexpr uint32_t kCells = 24;

ShapePtr MeshGround() {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (uint32_t z = 0; z <= kCells; ++z)
        for (uint32_t x = 0; x <= kCells; ++x)
            vertices.emplace_back(0.5f * static_cast<float>(x) - 6, 0.0f, 0.5f * static_cast<float>(z) - 6);
    for (uint32_t z = 0; z < kCells; ++z)
        for (uint32_t x = 0; x < kCells; ++x) {
            const uint32_t corner = z * (kCells + 1) + x, next = corner + kCells + 1;
            indices.insert(indices.end(), {corner, next, corner + 1, corner + 1, next, next + 1});
        }
    return TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
}

ShapePtr FieldGround() {
    const std::vector<float> heights((kCells + 1) * (kCells + 1), 0.0f);
    return HeightField::Create({.sampleCountX = kCells + 1,
                                .sampleCountZ = kCells + 1,
                                .heights = heights,
                                .cellSizeX = 0.5f,
                                .cellSizeZ = 0.5f,
                                .origin = {-6, 0, -6}})
        .Value();
}

struct Ground {
    std::string name;
    ShapePtr shape;
    Position offset = Position::Zero();
};
std::vector<Ground> Grounds() {
    return {{"box", BoxOf(100, 1, 100), {0, -1, 0}},
            {"mesh", MeshGround()},
            {"height field", FieldGround()},
            {"plane", Plane::Create(Vector3(0, 1, 0), 0).Value()}};
}

Ids AddStack(TestWorld& world, const Position& origin) {
    Ids stack;
    for (int i = 0; i < 6; ++i)
        stack.push_back(
            world.Add({.shape = CubeOf(0.5f), .position = origin + Position(0.01 * (i % 2), 0.6 + 1.1 * i, 0.2)}));
    return stack;
}

// Twelve capsules, hooked at one end, that swing down from level and come to lie on the ground in part.
Ids AddChain(TestWorld& world, const Position& origin) {
    Ids links;
    BodyId last =
        world.Add({.shape = SphereOf(0.02f), .motion = MotionType::Static, .position = origin + Position(-1, 1, 0)});
    for (int i = 0; i < 12; ++i) {
        const BodyId link = world.Add({.shape = CapsuleOf(0.07f, 0.04f),
                                       .position = origin + Position(-0.9 + 0.2 * i, 1, 0),
                                       .rotation = RotationAbout(Vector3(0, 0, 1), kPi / 2),
                                       .mass = 0.5f,
                                       .linearDamping = 0.5f,
                                       .angularDamping = 0.5f});
        PointJointSettings joint;
        joint.bodyA = last;
        joint.bodyB = link;
        joint.anchorA.point = origin + Position(-1 + 0.2 * i, 1, 0);
        EXPECT_TRUE(world.System().Joints().Create(joint));
        links.push_back(last = link);
    }
    return links;
}

// Damped: its joints have no friction, and an arm that lies on its hand would swing for long.
Ids AddRagdoll(TestWorld& world, const Position& origin) {
    RagdollSettings settings = Humanoid();
    for (RagdollPart& part : settings.parts) part.body.angularDamping = 1;
    const auto ragdoll =
        Ragdoll::Create(world.System(), settings, {origin + Position(0, 1.2, 0), RotationAbout(Vector3(1, 0, 0), 0.3)});
    EXPECT_TRUE(ragdoll);
    if (!ragdoll) return {};
    return {ragdoll.Value().Bodies().begin(), ragdoll.Value().Bodies().end()};
}

struct Outcome {
    std::vector<Position> positions;  // relative to the origin of the scene
    uint64_t sleepStep = 0;
    uint32_t mostPairs = 0;
};

using Fill = Ids (*)(TestWorld&, const Position&);

Outcome RunAt(const Ground& ground, Fill fill, const Position& origin) {
    TestWorld world;
    world.Add({.shape = ground.shape, .motion = MotionType::Static, .position = origin + ground.offset});
    const Ids bodies = fill(world, origin);
    Outcome outcome;
    for (int i = 0; i < 900 && outcome.sleepStep == 0; ++i) {
        world.Step();
        outcome.mostPairs = std::max(outcome.mostPairs, world.Report().pairs);
        if (world.Report().awakeBodies == 0) outcome.sleepStep = world.Report().step;
    }
    for (BodyId id : bodies) outcome.positions.push_back(world.PositionOf(id) - origin);
    return outcome;
}

void BehavesEverywhere(Fill fill, const Position& direction) {
    for (const Ground& ground : Grounds()) {
        const Outcome near = RunAt(ground, fill, Position::Zero());
        EXPECT_NE(near.sleepStep, 0u) << ground.name;
        const uint32_t count = static_cast<uint32_t>(near.positions.size());
        for (double distance : kDistances) {
            const Outcome far = RunAt(ground, fill, direction * distance);
            double most = 0;
            for (size_t i = 0; i < count; ++i) most = std::max(most, (far.positions[i] - near.positions[i]).norm());
            EXPECT_LT(most, 1e-3) << ground.name << " at " << distance << " m";
            EXPECT_EQ(far.sleepStep, near.sleepStep) << ground.name << " at " << distance << " m";
            EXPECT_LE(far.mostPairs, count * (count + 1)) << ground.name << " at " << distance << " m";
        }
    }
}

TEST(FarAway, AStackStandsAndSleepsAsAtTheOrigin) { BehavesEverywhere(AddStack, {1, 0, 0}); }
TEST(FarAway, AChainSwingsAndSleepsAsAtTheOrigin) { BehavesEverywhere(AddChain, {0, 0, 1}); }
TEST(FarAway, ARagdollFallsAndSleepsAsAtTheOrigin) { BehavesEverywhere(AddRagdoll, {1, 0, 0}); }

}  // namespace
}  // namespace fulcrum::testing
