// Position passes (Baumgarte) take the stated part of an error, add no speed, and hold what soft rows hold.
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <limits>
#include <vector>

namespace fulcrum::testing {
namespace {

SystemSettings Baumgarte(SystemSettings settings, int substeps, int velocity, int position) {
    settings.solver.substeps = substeps;
    settings.solver.velocityIterations = velocity;
    settings.solver.positionIterations = position;
    settings.solver.positionCorrection = PositionCorrection::Baumgarte;
    settings.solver.baumgarteSlop = 0;
    return settings;
}

double SpeedOf(TestWorld& world, BodyId id) {
    return double{Length(world.VelocityOf(id)) + Length(world.Bodies().GetAngularVelocity(id))};
}

// One point, no gravity: each pass leaves 1 - baumgarte of the overlap, whatever the substeps.
TEST(PositionCorrection, APassTakesItsPartOfAnOverlap) {
    for (const float part : {0.1f, 0.2f, 0.7f, 1.0f})
        for (const int substeps : {1, 4})
            for (const int passes : {1, 2, 5}) {
                SystemSettings settings = Baumgarte(NoGravity(), substeps, 2, passes);
                settings.solver.baumgarte = part;
                settings.sleep.enabled = false;
                TestWorld world(settings);
                world.AddFloor();
                const double overlap = 0.005;
                const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {0, 0.5 - overlap, 0}});
                world.Step();
                const double left = overlap * std::pow(1 - double{part}, substeps * passes);
                EXPECT_NEAR(world.PositionOf(ball).y(), 0.5 - left, 1e-6) << part << " " << substeps << " " << passes;
                EXPECT_LT(SpeedOf(world, ball), 1e-9);
            }
}

// The slop is left alone: the error is what is beyond it.
TEST(PositionCorrection, LeavesTheSlop) {
    SystemSettings settings = Baumgarte(NoGravity(), 1, 1, 1);
    settings.solver.baumgarteSlop = 0.002f;
    TestWorld world(settings);
    world.AddFloor();
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {0, 0.495, 0}});
    world.Step();
    EXPECT_NEAR(world.PositionOf(ball).y(), 0.495 + 0.2 * 0.003, 1e-6);
}

// The same of joints: ball joints (a kernel of their own), locks of translation and rotation together, and limits.
template <class Settings>
void ExpectPartOfGap(Settings settings, int passes) {
    TestWorld world(Baumgarte(NoGravity(), 1, 2, passes));
    const BodyId a = world.Add({.shape = CubeOf(0.5f), .position = {0, 0, 0}}),
                 b = world.Add({.shape = CubeOf(0.3f), .position = {2, 0, 0}});
    settings.bodyA = a;
    settings.bodyB = b;
    settings.space = JointSpace::Body;
    settings.anchorA.point = {1, 0, 0};
    const double gap = 0.01;
    settings.anchorB = JointAnchor{{-1 + gap, 0, 0}};
    const Result<JointId> joint = world.System().Joints().Create(settings);
    ASSERT_TRUE(joint);
    world.Step();
    const double distance = world.PositionOf(b).x() - world.PositionOf(a).x();
    EXPECT_NEAR(distance, 2 - gap * (1 - std::pow(0.8, passes)), 2e-6);
    // By the masses: 1 to 0.216.
    EXPECT_NEAR(world.PositionOf(a).x() * 1, (2 - world.PositionOf(b).x()) * 0.216, 1e-6);
    EXPECT_LT(SpeedOf(world, a) + SpeedOf(world, b), 1e-9);
}

TEST(PositionCorrection, APassTakesItsPartOfAJointsGap) {
    for (const int passes : {1, 3}) {
        ExpectPartOfGap(PointJointSettings{}, passes);
        ExpectPartOfGap(FixedJointSettings{}, passes);
        ExpectPartOfGap(HingeJointSettings{}, passes);
        DistanceJointSettings rod;
        rod.minDistance = rod.maxDistance = 0.0f;
        ExpectPartOfGap(rod, passes);
        SliderJointSettings slider;
        slider.slide.limited = true;
        slider.slide.limits = {0, 0, {}};
        ExpectPartOfGap(slider, passes);
    }
}

// An angle: a hinge whose limit was passed by 0.1 rad, and a fixed joint that is twisted by as much.
// left: by a pass, of each radian.
template <class Settings>
void ExpectPartOfAngle(Settings settings, int passes, double left) {
    TestWorld world(Baumgarte(NoGravity(), 1, 2, passes));
    const BodyId post = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static});
    const BodyId door =
        world.Add({.shape = CubeOf(0.5f), .position = {0, 3, 0}, .rotation = RotationFromVector(Vector3(0, 0.1f, 0))});
    settings.bodyA = post;
    settings.bodyB = door;
    settings.space = JointSpace::Body;
    settings.anchorA = {{0, 3, 0}, Vector3(0, 1, 0), Vector3(0, 0, 1)};
    settings.anchorB = JointAnchor{{0, 0, 0}, Vector3(0, 1, 0), Vector3(0, 0, 1)};
    ASSERT_TRUE(world.System().Joints().Create(settings));
    world.Step();
    const Vector3 turned = RotationVectorOf(world.Bodies().GetPose(door).rotation);
    EXPECT_NEAR(double{turned.y()}, 0.1 * std::pow(left, passes), 2e-6);
    EXPECT_LT(SpeedOf(world, door), 1e-9);
}

TEST(PositionCorrection, APassTakesItsPartOfAnAngle) {
    for (const int passes : {1, 3}) {
        ExpectPartOfAngle(FixedJointSettings{}, passes, 0.8);
        HingeJointSettings hinge;
        hinge.angle.limited = true;
        hinge.angle.limits = {-1, 0, {}};
        ExpectPartOfAngle(hinge, passes, 0.5);
    }
}

// Boxes created in each other come apart at the largest correction, and not faster than they were.
TEST(PositionCorrection, CreatedOverlapsComeApartWithoutSpeed) {
    SystemSettings settings = Baumgarte(NoGravity(), 1, 10, 4);
    settings.sleep.enabled = false;
    TestWorld world(settings);
    std::vector<BodyId> boxes;
    for (int i = 0; i < 5; ++i) boxes.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0.6 * i, 0, 0}}));
    double fastest = 0;
    for (int step = 0; step < 240; ++step) {
        world.Step();
        for (const BodyId box : boxes) fastest = std::max(fastest, SpeedOf(world, box));
    }
    EXPECT_LT(fastest, 1e-4);
    EXPECT_LT(world.Report().largestPenetration, 1e-3f);
    for (size_t i = 0; i + 1 < boxes.size(); ++i)
        EXPECT_GT(world.PositionOf(boxes[i + 1]).x() - world.PositionOf(boxes[i]).x(), 0.999);
}

// A wall of ten layers, 30 s. Measured in mm, top too low / sideways: with one substep of ten iterations soft rows 8.3
// / 3.4; position passes 6.1 / 4.5, of which each of ten layers leaves its slop of 1. Without a slop contacts come and
// go, and the top was 173 aside.
struct WallTop {
    double sink, aside;  // m
};
WallTop TopOfWall(const SolverSettings& solver) {
    SystemSettings settings = NoSleep();
    settings.solver = solver;
    settings.accuracy.penetration = std::numeric_limits<float>::infinity();  // no more effort than this
    TestWorld world(settings);
    world.AddFloor();
    BodyId top;
    for (int layer = 0; layer < 10; ++layer)
        for (int i = 0; i < 10 - layer; ++i)
            top = world.Add({.shape = CubeOf(0.5f), .position = {i + 0.5 * layer, 0.5 + layer, 0}});
    const Position start = world.PositionOf(top);
    world.Run(30);
    const Position moved = start - world.PositionOf(top);
    return {moved.y(), std::hypot(moved.x(), moved.z())};
}

TEST(PositionCorrection, HoldsAWallAtFewSubsteps) {
    SolverSettings solver;
    const int efforts[][3] = {{1, 10, 2}, {1, 20, 4}, {2, 8, 2}, {4, 1, 1}, {8, 2, 1}};
    for (const auto& effort : efforts) {
        solver.substeps = effort[0];
        solver.velocityIterations = effort[1];
        solver.positionIterations = effort[2];
        solver.positionCorrection = PositionCorrection::Baumgarte;
        const WallTop top = TopOfWall(solver);
        EXPECT_LT(top.sink, 0.01) << effort[0] << " " << effort[1];
        EXPECT_GT(top.sink, -0.001) << effort[0] << " " << effort[1];
        EXPECT_LT(top.aside, 0.005) << effort[0] << " " << effort[1];
        if (effort[1] > 10 || effort[0] > 1) continue;
        solver.positionCorrection = PositionCorrection::SoftRelax;
        EXPECT_LT(top.sink, 0.73 * TopOfWall(solver).sink);
    }
}

TEST(PositionCorrection, SameBitsOnAnyNumberOfThreads) {
    const auto hashOf = [](uint32_t threads) {
        SystemSettings settings = Baumgarte({}, 2, 4, 2);
        TestWorld world(settings, threads);
        MixedScene scene(world);
        for (int step = 0; step < 120; ++step) {
            scene.BeforeStep(step);
            world.Step();
        }
        EXPECT_TRUE(world.AllFinite());
        return world.System().HashPoses();
    };
    const uint64_t one = hashOf(1);
    EXPECT_EQ(hashOf(2), one);
    EXPECT_EQ(hashOf(4), one);
}

}  // namespace
}  // namespace fulcrum::testing
