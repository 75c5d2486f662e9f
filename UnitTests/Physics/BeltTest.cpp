// Conveyor belts (surface velocities), and what turns like one, against closed forms.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// One body is a belt that runs straight or about the world's vertical axis.
class OneBelt final : public ContactListener {
public:
    BodyId body;
    Vector3 velocity = Vector3::Zero();  // m/s
    Vector3 turning = Vector3::Zero();   // rad/s, about the origin

    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        if (contact.bodyA != body && contact.bodyB != body) return;
        change.MoveSurface(contact, body, velocity);
        change.RotateSurface(contact, body, Position::Zero(), turning);
    }
};

struct BeltWorld {
    TestWorld world;
    OneBelt belt;
    explicit BeltWorld(const SystemSettings& settings = NoSleep(), float friction = 0.5f) : world(settings) {
        belt.body = world.AddFloor({.friction = friction});
        world.System().SetContactListener(&belt);
    }
    BodyId AddBox(const Position& position, float friction = 0.5f) {
        return world.Add({.shape = CubeOf(0.5f), .position = position, .material = {.friction = friction}});
    }
};

TEST(Belt, TakesABoxAlongAfterItSlidByTheFormula) {
    for (float v : {2.0f, -3.0f}) {
        BeltWorld s;
        s.belt.velocity = {0, 0, v};
        const BodyId box = s.AddBox({0, 0.5, 0});
        // It reaches v after |v| / (mu g) seconds, ...
        const double speed = std::fabs(double{v}), time = speed / (0.5 * kGravity);
        const int before = static_cast<int>(time / kStep);
        s.world.Steps(before);
        const double expected = 0.5 * kGravity * before * kStep;
        EXPECT_NEAR(std::fabs(s.world.VelocityOf(box).z()), expected, 2e-3 * expected);
        s.world.Steps(2);
        EXPECT_NEAR(s.world.VelocityOf(box).z(), v, 2e-4 * speed);
        // ... v^2 / (2 mu g) behind the belt, less v h / 2 since speeds change at the beginning of a substep h, ...
        s.world.Run(4 - (before + 2) * kStep);
        const double slid = 4 * speed - std::fabs(s.world.PositionOf(box).z());
        EXPECT_NEAR(slid, speed * speed / (2 * 0.5 * kGravity) - 0.5 * speed * kStep / 4, 2e-3 * speed);
        // ... and is carried straight on, upright, exactly as fast as the belt: a float's rounding of v in each of some
        // substeps.
        const Position from = s.world.PositionOf(box);
        s.world.Run(5);
        EXPECT_NEAR(s.world.VelocityOf(box).z(), v, 1e-6 * speed);
        EXPECT_LT((s.world.PositionOf(box) - from - Position(0, 0, 5 * double{v})).norm(), 1e-5 * speed);
        EXPECT_LT(s.world.Bodies().GetAngularVelocity(box).norm(), 1e-5f);
    }
}

TEST(Belt, RollsABallThatItCannotHold) {
    // Rolling friction is none: the belt's pull at the bottom ends when the point of contact keeps up. From m v' = F
    // and (2/5) m r w' = F r the ball ends with v = (2/7) of the belt's speed.
    BeltWorld s;
    s.belt.velocity = {3.5f, 0, 0};
    const BodyId ball = s.world.Add({.shape = SphereOf(0.5f), .position = {0, 0.5, 0}});
    s.world.Run(2);
    EXPECT_NEAR(s.world.VelocityOf(ball).x(), 1, 2e-3);
    EXPECT_NEAR(s.world.Bodies().GetAngularVelocity(ball).z(), (3.5 - 1) / 0.5, 1e-2);
}

TEST(Belt, HoldsABoxAgainstASlopeAndCarriesItUp) {
    TestWorld world(NoSleep());
    const Quaternion tilt = RotationAbout({0, 0, 1}, 15 * kDegree);
    const Vector3 along = Rotate(tilt, Vector3(1, 0, 0)), up = Rotate(tilt, Vector3(0, 1, 0));
    OneBelt belt;
    belt.body = world.Add({.shape = BoxOf(50, 1, 5),
                           .motion = MotionType::Static,
                           .position = (up * -1.0f).cast<double>(),
                           .rotation = tilt,
                           .material = {.friction = 0.8f}});
    belt.velocity = along;
    world.System().SetContactListener(&belt);
    const BodyId box = world.Add({.shape = CubeOf(0.5f),
                                  .position = (up * 0.5f).cast<double>(),
                                  .rotation = tilt,
                                  .material = {.friction = 0.8f}});
    world.Run(1);
    const Position from = world.PositionOf(box);
    world.Run(10);
    EXPECT_LT((world.PositionOf(box) - from - (along * 10.0f).cast<double>()).norm(), 1e-3);
}

// Where a box is after a full turn about the origin, 3 m from it, on what turns with 0.8 rad/s.
Position AfterATurn(TestWorld& world) {
    // Already as fast as what is below: nothing slides. It needs w^2 r = 1.9 m/s2 of friction's 8.8.
    const BodyId box = world.Add({.shape = CubeOf(0.25f),
                                  .position = {3, 0.25, 0},
                                  .linearVelocity = {0, 0, -2.4f},
                                  .angularVelocity = {0, 0.8f, 0},
                                  .material = {.friction = 0.9f}});
    world.Run(2 * kPi / 0.8);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 0.8, 1e-3);
    return world.PositionOf(box);
}

TEST(Belt, ThatTurnsCarriesLikeATurntable) {
    BeltWorld s(NoSleep(), 0.9f);
    s.belt.turning = {0, 0.8f, 0};
    const Position onBelt = AfterATurn(s.world);
    TestWorld turntable(NoSleep());
    turntable.Add({.shape = BoxOf(100, 1, 100),
                   .motion = MotionType::Kinematic,
                   .position = {0, -1, 0},
                   .angularVelocity = {0, 0.8f, 0},
                   .material = {.friction = 0.9f}});
    const Position onTurntable = AfterATurn(turntable);
    EXPECT_LT((onBelt - onTurntable).norm(), 1e-3);
    // On the circle, but for a lag of at most half a substep h in a = w^2 r: a h / 2 for 2 pi / w seconds, 31 mm.
    const double lag = 0.64 * 3 * kStep / 4 / 2 * 2 * kPi / 0.8;
    EXPECT_NEAR(std::sqrt(onBelt.x() * onBelt.x() + onBelt.z() * onBelt.z()), 3, lag);
}

TEST(Belt, ThatTurnsSpinsABoxAtItsPivot) {
    BeltWorld s;
    s.belt.turning = {0, 2, 0};
    const BodyId box = s.AddBox({0, 0.5, 0});
    // Torque mu m g r of the mean radius r = 0.7652 a, I = 2/3 m a^2: see Friction.StopsASpinningBoxAtItsMeanRadius.
    const double rate = 0.5 * kGravity * 0.7652 * 0.5 / (2.0 / 3 * 0.25);
    s.world.Run(0.1);
    EXPECT_NEAR(s.world.Bodies().GetAngularVelocity(box).y(), rate * 0.1, 0.02);
    s.world.Run(0.9);
    EXPECT_NEAR(s.world.Bodies().GetAngularVelocity(box).y(), 2, 1e-4);
    EXPECT_LT((s.world.PositionOf(box) - Position(0, 0.5, 0)).norm(), 1e-3);
}

// A box on a sledge whose upper surface is a belt, and nothing holds the sledge: they part with the belt's speed, and
// their momentum stays zero.
void ExpectRecoil(bool sledgeFirst) {
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0, .frictionRule = CombineRule::Multiply});
    OneBelt belt;
    BodyId box{};
    const auto addBox = [&] { box = world.Add({.shape = CubeOf(0.25f), .position = {0, 0.65, 0}, .mass = 1}); };
    if (!sledgeFirst) addBox();
    belt.body = world.Add({.shape = BoxOf(6, 0.2f, 1), .position = {0, 0.2, 0}, .mass = 3});
    if (sledgeFirst) addBox();
    belt.velocity = {2, 0, 0};
    // The belt is above: what touches the floor does not move.
    class Above final : public ContactListener {
    public:
        Above(const OneBelt& belt_, BodyId load) : belt(belt_), box_(load) {}
        void ModifyContact(const ContactView& contact, ContactChange& change) const override {
            if (contact.bodyA == box_ || contact.bodyB == box_) belt.ModifyContact(contact, change);
        }
        const OneBelt& belt;
        BodyId box_;
    } above(belt, box);
    world.System().SetContactListener(&above);
    world.Run(1);
    EXPECT_NEAR(world.VelocityOf(box).x(), 2 * 3.0 / 4, 2e-3);
    EXPECT_NEAR(world.VelocityOf(belt.body).x(), -2 * 1.0 / 4, 2e-3);
    // The sledge tips by what its springs yield under the load, and the floor's push with it: 1e-5 of the weights for a
    // second.
    EXPECT_NEAR(world.VelocityOf(box).x() + 3 * world.VelocityOf(belt.body).x(), 0, 4 * kGravity * 1e-5);
}

TEST(Belt, OnABodyThatMovesPushesItBack) {
    ExpectRecoil(true);
    ExpectRecoil(false);
}

TEST(Belt, ThatTurnsOnABodyThatMovesConservesAngularMomentum) {
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0, .frictionRule = CombineRule::Multiply});
    OneBelt belt;
    belt.body = world.Add({.shape = BoxOf(1, 0.2f, 1), .position = {0, 0.2, 0}, .mass = 2});
    const BodyId box = world.Add({.shape = CubeOf(0.25f), .position = {0, 0.65, 0}, .mass = 4});
    belt.turning = {0, 3, 0};
    world.System().SetContactListener(&belt);
    world.Run(1);
    // I = m (a^2 + b^2) / 3: 4/3 of the sledge, 1/6 of the box. The floor's contact has a turning surface too, without
    // friction.
    const double share = (4.0 / 3) / (4.0 / 3 + 1.0 / 6);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 3 * share, 5e-3);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(belt.body).y(), -3 * (1 - share), 5e-3);
}

TEST(Belt, ThatIsSlowDoesNotPutToSleepWhatItCarries) {
    BeltWorld s{SystemSettings{}};
    s.belt.velocity = {0.02f, 0, 0};  // less than half of what counts as slow
    const BodyId box = s.AddBox({0, 0.5, 0});
    s.world.Run(3);
    EXPECT_TRUE(s.world.Bodies().IsAwake(box));
    EXPECT_NEAR(s.world.PositionOf(box).x(), 0.06, 1e-3);
    // Stopped, it lets go.
    s.belt.velocity.setZero();
    s.world.Run(1);
    EXPECT_FALSE(s.world.Bodies().IsAwake(box));
    // The listener is not called for sleeping bodies.
    s.belt.velocity = {1, 0, 0};
    s.world.Run(1);
    EXPECT_NEAR(s.world.PositionOf(box).x(), 0.06, 1e-3);
    ASSERT_TRUE(s.world.Bodies().Wake(box));
    s.world.Run(1);
    EXPECT_NEAR(s.world.VelocityOf(box).x(), 1, 1e-4);
}

TEST(Belt, RunsOnMeshesPlanesAndCompoundsAlike) {
    const Vector3 corners[] = {{-20, 0, -5}, {-20, 0, 5}, {20, 0, 5}, {20, 0, -5}};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    const auto mesh = TriangleMesh::Create({.vertices = corners, .indices = triangles});
    ASSERT_TRUE(mesh);
    const auto plane = Plane::Create(Vector3(0, 1, 0));
    ASSERT_TRUE(plane);
    const ShapePtr boxes = CompoundOf({{.shape = BoxOf(10, 0.5f, 5), .position = {-10, -0.5f, 0}},
                                       {.shape = BoxOf(10, 0.5f, 5), .position = {10, -0.5f, 0}}});
    for (const ShapePtr& shape : {ShapePtr(mesh.Value()), ShapePtr(plane.Value()), boxes}) {
        TestWorld world(NoSleep());
        OneBelt belt;
        belt.body = world.Add({.shape = shape, .motion = MotionType::Static});
        belt.velocity = {1.5f, 0, 0};
        world.System().SetContactListener(&belt);
        const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {-3, 0.5, 0}});
        const BodyId prism =
            world.Add({.shape = HullOf({{-0.4f, -0.3f, -0.4f}, {0.4f, -0.3f, -0.4f}, {0, -0.3f, 0.5f}, {0, 0.5f, 0}}),
                       .position = {0, 0.3, 2}});
        world.Run(4);
        EXPECT_NEAR(world.VelocityOf(box).x(), 1.5, 1e-4) << ShapeTypeName(shape->Type());
        EXPECT_NEAR(world.VelocityOf(prism).x(), 1.5, 1e-4) << ShapeTypeName(shape->Type());
    }
}

// A ball that rolls without slip on a disc that turns at W runs on a circle at 2 / 7 W, at constant speed, whatever its
// size (S. Earnshaw, Dynamics, 1844). Likewise where only the disc's surface turns.
class OnADisc : public ::testing::TestWithParam<bool> {};

TEST_P(OnADisc, ABallRunsOnACircle) {
    const bool surfaceTurns = GetParam();
    for (const double turn : {1.0, 4.0})
        for (const int substeps : {1, 4, 16}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = substeps;
            TestWorld world(settings);
            const Material rough{.friction = 1.5f};
            OneBelt surface;
            surface.turning = Vector3(0, static_cast<float>(turn), 0);
            surface.body = world.Add({.shape = Cylinder::Create(0.5f, 20).Value(),
                                      .motion = surfaceTurns ? MotionType::Static : MotionType::Kinematic,
                                      .position = {0, -0.5, 0},
                                      .angularVelocity = surfaceTurns ? Vector3::Zero() : surface.turning,
                                      .material = rough});
            if (surfaceTurns) world.System().SetContactListener(&surface);
            const double radius = 0.2, x = 0.5, z = -0.4, vx = 0.6, vz = 0.2;
            const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {x, radius, z}, .material = rough});
            // The velocity of the disc there, less the ball's, is that of the ball's lowest point by its rotation.
            const double slipX = turn * z - vx, slipZ = -turn * x - vz;
            ASSERT_TRUE(world.Bodies().SetVelocity(
                ball, {static_cast<float>(vx), 0, static_cast<float>(vz)},
                {static_cast<float>(-slipZ / radius), 0, static_cast<float>(slipX / radius)}));
            const double speed = std::hypot(vx, vz), k = 2.0 / 7 * turn;
            for (int i = 1; i <= 480; ++i) {
                world.Step();
                const double t = i * kStep, along = std::sin(k * t) / k, across = (1 - std::cos(k * t)) / k;
                const Position at = world.PositionOf(ball);
                const double off =
                    std::hypot(at.x() - (x + along * vx + across * vz), at.z() - (z + along * vz - across * vx));
                ASSERT_LT(off, 0.001 * 8 * speed) << turn << " at " << substeps << ", step " << i;
                ASSERT_NEAR(double{Length(world.VelocityOf(ball))} / speed, 1, 0.005)
                    << turn << " at " << substeps << ", step " << i;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(TurnsByItselfOrItsSurface, OnADisc, ::testing::Bool());

}  // namespace
}  // namespace fulcrum::testing
