// Bodies that are created, placed or grown in each other come apart at depenetrationSpeed, and keep no speed of that.
// They left at up to 20 m/s: the pushes of many contacts add up, and one relaxing pass leaves much of that in the
// velocities.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace fulcrum::testing {
namespace {

// (substeps, the part of the size by which bodies overlap)
class CreatedOverlap : public ::testing::TestWithParam<std::tuple<int, float>> {
protected:
    int Substeps() const { return std::get<0>(GetParam()); }
    float Part() const { return std::get<1>(GetParam()); }
    SystemSettings Settings(bool hasGravity) const {
        SystemSettings settings;
        settings.solver.substeps = Substeps();
        if (!hasGravity) settings.gravity.setZero();
        return settings;
    }
};

struct Result {
    double fastest = 0;  // m/s, of all bodies in all steps
    double left = 0;     // m of overlap at the end
};

Result RunFor(TestWorld& world, std::span<const BodyId> ids, double seconds) {
    Result result;
    for (int i = 0; i < static_cast<int>(seconds / kStep); ++i) {
        world.Step();
        for (const BodyId id : ids) result.fastest = std::max<double>(result.fastest, Length(world.VelocityOf(id)));
    }
    result.left = world.Report().largestPenetration;
    return result;
}

TEST_P(CreatedOverlap, OfTwoBodiesInSpaceLeavesNoSpeed) {
    for (const ShapePtr& shape : {SphereOf(0.5f), CubeOf(0.5f), CapsuleOf(0.5f, 0.3f)}) {
        TestWorld world(Settings(false));
        const float size = 2 * shape->InnerRadius();
        const BodyId ids[] = {world.Add({.shape = shape}),
                              world.Add({.shape = shape, .position = {(1 - Part()) * size, 0.01, 0.02}})};
        const Result result = RunFor(world, ids, 3);
        EXPECT_LT(result.fastest, 0.1) << ShapeTypeName(shape->Type());
        EXPECT_LT(result.left, 0.02 * size) << ShapeTypeName(shape->Type());
    }
}

TEST_P(CreatedOverlap, OfAStackOnAFloorLeavesLittleSpeed) {
    TestWorld world(Settings(true));
    world.AddFloor();
    std::vector<BodyId> ids;
    const float height = 1 - 0.9f * Part();
    for (int i = 0; i < 4; ++i)
        ids.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + double{height} * i, 0}}));
    const Result result = RunFor(world, ids, 6);
    if (Part() <= 0.5f) EXPECT_LT(result.fastest, 0.8);
    else EXPECT_LT(result.fastest, 5);  // what was in one place falls down beside it
    EXPECT_LT(result.left, 0.02);
}

TEST_P(CreatedOverlap, OfAPyramidLeavesLittleSpeed) {
    if (Part() > 0.5f) return;  // a heap in one place disperses
    for (const bool hasGravity : {false, true}) {
        TestWorld world(Settings(hasGravity));
        if (hasGravity) world.AddFloor();
        std::vector<BodyId> ids;
        const double size = 1 - 0.9 * double{Part()};
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8 - i; ++j)
                ids.push_back(
                    world.Add({.shape = CubeOf(0.5f), .position = {size * (j + 0.5 * i), 0.5 + size * i, 0}}));
        const Result result = RunFor(world, ids, 8);
        // At one substep a box may come to fall from the top.
        const double most = Substeps() == 1 ? 10 : 2;
        EXPECT_LT(result.fastest, hasGravity ? most : 0.5);
        EXPECT_LT(result.left, Substeps() == 1 ? 0.08 : 0.02);  // what its weight presses in
    }
}

// Overlaps of all depths are separated slowly up to the end, also in short steps, with much effort: what was left at
// 1 % of the size was pushed out at full stiffness, and 64 spheres left at up to 1.9 m/s, with 0.4 % at up to 1.7.
TEST_P(CreatedOverlap, OfAGridInShortStepsLeavesLittleSpeed) {
    for (const ShapePtr& shape : {SphereOf(0.5f), CubeOf(0.5f)}) {
        TestWorld world(Settings(false));
        std::vector<BodyId> ids;
        const double size = 1 - 0.2 * double{Part()};
        for (int i = 0; i < 64; ++i)
            ids.push_back(
                world.Add({.shape = shape, .position = {size * (i % 4), size * (i / 4 % 4), size * (i / 16)}}));
        const double dt = kStep / 4;
        double fastest = 0;
        for (int step = 0; step < 480; ++step) {
            world.Step(dt);
            for (const BodyId id : ids) fastest = std::max<double>(fastest, Length(world.VelocityOf(id)));
        }
        EXPECT_LT(fastest, 0.2) << ShapeTypeName(shape->Type());
        EXPECT_LT(world.Report().largestPenetration, 0.01f) << ShapeTypeName(shape->Type());
    }
}

// The energy of chains that lie across each other does not grow: ragdolls of a heap gained 1.9 kJ in their first step
// with 4 substeps and 7.9 kJ with 64.
TEST_P(CreatedOverlap, OfJointedBodiesLeavesLittleSpeed) {
    if (Part() > 0.5f) return;  // axes in one plane: pushed to both sides
    TestWorld world(Settings(false));
    std::vector<BodyId> ids;
    const float radius = 0.1f, half = 0.3f;
    for (int chain = 0; chain < 6; ++chain) {
        const double along = 0.35 * (chain / 2);
        const bool isAcross = chain % 2 == 1;
        const Quaternion rotation = isAcross ? Quaternion{0, 0, std::sqrt(0.5f), std::sqrt(0.5f)}
                                             : Quaternion{std::sqrt(0.5f), 0, 0, std::sqrt(0.5f)};
        for (int i = 0; i < 4; ++i) {
            const double at = 0.8 * (i - 1.5);
            const Position position(isAcross ? at : along, 2 * (1 - Part()) * radius * isAcross, isAcross ? along : at);
            ids.push_back(world.Add({.shape = CapsuleOf(half, radius), .position = position, .rotation = rotation}));
            if (i == 0) continue;
            PointJointSettings joint;
            joint.bodyA = ids[ids.size() - 2];
            joint.bodyB = ids.back();
            joint.anchorA.point = position - (isAcross ? Position(0.4, 0, 0) : Position(0, 0, 0.4));
            ASSERT_TRUE(world.System().Joints().Create(joint));
        }
    }
    EXPECT_LT(RunFor(world, ids, 2).fastest, 0.8);
}

// It comes to rest, and falls asleep.
TEST(CreatedOverlaps, OfAPyramidFallAsleep) {
    TestWorld world;
    world.AddFloor();
    std::vector<BodyId> ids;
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12 - i; ++j)
            ids.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0.95 * (j + 0.5 * i), 0.45 + 0.95 * i, 0}}));
    world.Run(10);
    EXPECT_TRUE(std::ranges::none_of(ids, [&](BodyId id) { return world.Bodies().IsAwake(id); }));
}

// All points are pushed as fast, however deep each is: what comes out tilted falls back onto the floor from there.
TEST_P(CreatedOverlap, WithAFloorLeavesLittleSpeed) {
    TestWorld world(Settings(true));
    world.AddFloor();
    const BodyId id = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 - double{Part()} * 0.9, 0}});
    const Result result = RunFor(world, {&id, 1}, 4);
    EXPECT_LT(result.fastest, 0.7);
    EXPECT_NEAR(world.PositionOf(id).y(), 0.5, 0.01);
}

// What rests is woken by a body that is put into it, and by one that grows.
TEST_P(CreatedOverlap, OfBodiesThatArePlacedOrGrowLeavesLittleSpeed) {
    for (const bool grows : {false, true}) {
        TestWorld world(Settings(true));
        world.AddFloor();
        const BodyId ids[] = {world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}}),
                              world.Add({.shape = CubeOf(0.25f), .position = {grows ? 0.76 : 10, 0.25, 0}})};
        world.Steps(120);
        if (grows) {
            ASSERT_TRUE(world.Bodies().SetShape(ids[1], BoxOf(0.25f + 0.5f * Part(), 0.25f, 0.25f)));
        } else {
            ASSERT_TRUE(world.Bodies().SetPose(ids[1], {0.75 - 0.5 * double{Part()}, 0.25, 0}, {}));
        }
        const Result result = RunFor(world, ids, 4);
        EXPECT_LT(result.fastest, 0.8) << grows;
        EXPECT_LT(result.left, 0.01) << grows;
    }
}

INSTANTIATE_TEST_SUITE_P(Efforts, CreatedOverlap,
                         ::testing::Combine(::testing::Values(1, 4, 16, 64), ::testing::Values(0.25f, 0.5f, 1.0f)));

// Its contacts push it to both sides, and their normals turn round as it turns: what one carried to the next step threw
// it out with 25 times its energy.
TEST(CreatedOverlaps, OfACompoundInAThinFloorAddNoEnergy) {
    const ShapePtr jack = CompoundOf({{.shape = BoxOf(1.2f, 0.2f, 0.2f)},
                                      {.shape = BoxOf(0.2f, 1.2f, 0.2f), .position = {0.3f, 0, 0.2f}},
                                      {.shape = CapsuleOf(0.9f, 0.2f), .position = {-0.3f, 0.2f, 0}}});
    for (uint32_t seed = 0; seed < static_cast<uint32_t>(Cases(200)); ++seed) {
        RandomPoses random(seed);
        TestWorld world;
        for (const double height : {-0.6, 0.6})
            world.Add({.shape = BoxOf(20, 0.02f, 20), .motion = MotionType::Static, .position = {0, height, 0}});
        const Vector3 spin = random.InBox(60), speed = random.InBox(40);
        const BodyId id =
            world.Add({.shape = jack, .rotation = random.Rotation(), .linearVelocity = speed, .angularVelocity = spin});
        const auto energy = [&] { return world.Bodies().GetKineticEnergy(id); };
        const double before = energy(), mass = world.Bodies().GetMass(id);
        double most = 0;
        for (int step = 0; step < 120; ++step) {
            world.Step();
            most = std::max<double>(most, energy() + mass * kGravity * world.PositionOf(id).y());
        }
        EXPECT_LT(most, 1.05 * before + 2 * mass) << "seed " << seed;
    }
}

// What has no room is held by its container, and does not move about in it.
TEST(CreatedOverlaps, WithoutRoomStayInside) {
    for (const int substeps : {1, 4, 16}) {
        SystemSettings settings;
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        const float half = 1.8f, thick = 0.25f, outer = half + 2 * thick;
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) {
                Vector3 size(outer, outer, outer);
                size[axis] = thick;
                Position at(Position::Zero());
                at[axis] = side * double{half + thick};
                world.Add({.shape = BoxOf(size.x(), size.y(), size.z()), .motion = MotionType::Static, .position = at});
            }
        std::vector<BodyId> ids;
        for (int i = 0; i < 64; ++i)
            ids.push_back(
                world.Add({.shape = SphereOf(0.5f),
                           .position = {-1.2 + 0.8 * (i % 4), -1.2 + 0.8 * (i / 4 % 4), -1.2 + 0.8 * (i / 16)}}));
        RunFor(world, ids, 10);
        for (const BodyId id : ids) EXPECT_LT(world.PositionOf(id).cwiseAbs().maxCoeff(), half) << substeps;
        EXPECT_LT(RunFor(world, ids, 1).fastest, 0.5) << substeps;
    }
}

// The speed is a setting.
TEST(CreatedOverlaps, ComeApartAtTheSpeedThatIsSet) {
    for (const float speed : {0.1f, 0.5f, 2.0f}) {
        SystemSettings settings = NoGravity();
        settings.depenetrationSpeed = speed;
        TestWorld world(settings);
        world.Add({.shape = SphereOf(0.5f)});
        const BodyId other = world.Add({.shape = SphereOf(0.5f), .position = {0.4, 0, 0}});
        world.Steps(12);
        EXPECT_NEAR(world.PositionOf(other).x(), 0.4 + 0.5 * double{speed} * 12 * kStep, 0.03 * double{speed});
    }
}

}  // namespace
}  // namespace fulcrum::testing
