// Continuous collision: nothing passes through anything, however fast it is; what hits something in the middle of a
// step bounces there, as mechanics says; what only comes near is left alone.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr Material kBouncy{.friction = 0, .restitution = 1};
constexpr Material kDull{.friction = 0, .restitution = 0};
constexpr ContinuousCollision kLinear = ContinuousCollision::Linear, kTurning = ContinuousCollision::LinearAndAngular;

// Bodies of layer 1 do not meet each other.
SystemSettings Shots() {
    SystemSettings settings = NoGravity();
    settings.layerCollides[1] &= ~2u;
    return settings;
}

// Shoots from x = 0 .. 3 at a wall whose front is at x = 10; how many have passed it after so many steps.
int PassedThrough(const ShapePtr& wall, const ShapePtr& shape, float speed, int shots, ContinuousCollision continuous,
                  double dt = kStep) {
    TestWorld world(Shots());
    world.Add({.shape = wall, .motion = MotionType::Static, .position = {10, 0, 0}, .material = kDull});
    RandomPoses random(static_cast<uint32_t>(speed));
    std::vector<BodyId> bodies;
    for (int i = 0; i < shots; ++i) {
        const Vector3 from = random.InCube(), to = random.InCube(), spin = random.InCube();
        const Quaternion rotation = random.Rotation();
        const Vector3 start(1.5f + 1.5f * from.x(), 5 * from.y(), 5 * from.z()), aim(10, 8 * to.y(), 8 * to.z());
        bodies.push_back(world.Add({.shape = shape,
                                    .position = start.cast<double>(),
                                    .rotation = rotation,
                                    .linearVelocity = Normalized(Vector3(aim - start)) * speed,
                                    .angularVelocity = spin * 20.0f,
                                    .material = kBouncy,
                                    .layer = 1,
                                    .continuous = continuous}));
    }
    const int steps = static_cast<int>(20 / (speed * dt)) + 2;
    int passed = 0;
    for (int i = 0; i < steps; ++i) {
        world.Step(dt);
        passed = 0;
        for (const BodyId body : bodies) passed += !(world.PositionOf(body).x() < 10);
    }
    return passed;
}

// Half extents of half the thickness, its front at the origin.
ShapePtr WallOf(float thickness) {
    return CompoundOf({{.shape = BoxOf(0.5f * thickness, 12, 12), .position = {0.5f * thickness, 0, 0}}});
}

ShapePtr SheetOf(bool twoSided) {
    const Vector3 corners[] = {{0, -12, -12}, {0, 12, -12}, {0, -12, 12}, {0, 12, 12}};
    const uint32_t indices[] = {0, 2, 1, 1, 2, 3};
    return TriangleMesh::Create({.vertices = corners, .indices = indices, .isTwoSided = twoSided}).Value();
}

// 10^4 aims for each speed and thickness.
TEST(Continuous, NoBulletTunnelsThroughAThinWall) {
    constexpr int kShots = 10000;
    for (const float thickness : {0.1f, 0.01f})
        for (const float speed : {200.0f, 600.0f, 1000.0f})
            EXPECT_EQ(PassedThrough(WallOf(thickness), SphereOf(0.1f), speed, kShots, kLinear), 0)
                << speed << " " << thickness;
}

TEST(Continuous, NoShapePassesWallsSheetsAndPlanes) {
    const ShapePtr shapes[] = {
        BoxOf(0.1f, 0.2f, 0.05f),
        CapsuleOf(0.2f, 0.05f),
        HullOf({{0.2f, -0.1f, 0}, {-0.1f, -0.1f, 0.1f}, {-0.1f, -0.1f, -0.1f}, {0, 0.2f, 0}}),
        Cylinder::Create(0.05f, 0.1f).Value(),
        CompoundOf({{.shape = BoxOf(0.2f, 0.02f, 0.02f)}, {.shape = SphereOf(0.05f), .position = {0.2f, 0, 0}}}),
    };
    const ShapePtr walls[] = {WallOf(0.01f), SheetOf(false), SheetOf(true),
                              Plane::Create(Vector3(-1, 0, 0), 0).Value()};
    for (const ShapePtr& shape : shapes)
        for (const ShapePtr& wall : walls)
            for (const ContinuousCollision continuous : {kLinear, kTurning})
                EXPECT_EQ(PassedThrough(wall, shape, 400, 100, continuous), 0)
                    << ShapeTypeName(shape->Type()) << " " << ShapeTypeName(wall->Type()) << " " << int(continuous);
}

TEST(Continuous, TheModeCanBeChanged) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .linearVelocity = {1000, 0, 0}});
    world.Step();
    EXPECT_EQ(world.Report().sweptBodies, 0u);
    ASSERT_TRUE(world.Bodies().SetContinuous(ball, kLinear));
    EXPECT_EQ(world.Bodies().GetContinuous(ball), kLinear);
    world.Step();
    EXPECT_EQ(world.Report().sweptBodies, 1u);
    ASSERT_TRUE(world.Bodies().SetContinuous(ball, ContinuousCollision::Off));
    world.Step();
    EXPECT_EQ(world.Report().sweptBodies, 0u);
}

// A ball between two walls: its way folded up. The cast may stop by a fiftieth of its radius before it touches, at each
// bounce.
TEST(Continuous, ABallBetweenWallsIsWhereItsReflectedPathEnds) {
    TestWorld world(NoGravity());
    constexpr double kHalf = 4, kRadius = 0.25, kFree = kHalf - kRadius;
    for (const double side : {-1.0, 1.0})
        world.Add({.shape = BoxOf(0.5f, 5, 5),
                   .motion = MotionType::Static,
                   .position = {side * (kHalf + 0.5), 0, 0},
                   .material = kBouncy});
    const BodyId ball = world.Add(
        {.shape = SphereOf(kRadius), .linearVelocity = {700, 0, 0}, .material = kBouncy, .continuous = kLinear});
    int bounces = 0;
    for (int step = 1; step <= 120; ++step) {
        world.Step();
        bounces += static_cast<int>(world.Report().sweptHits);
        EXPECT_NEAR(std::fabs(world.VelocityOf(ball).x()), 700, 0.01);
        const double way = std::fmod(700 * kStep * step + kFree, 4 * kFree),
                     folded = way < 2 * kFree ? way - kFree : 3 * kFree - way;
        ASSERT_NEAR(world.PositionOf(ball).x(), folded, 2 * 0.02 * kRadius * bounces + 1e-3) << step;
    }
    EXPECT_EQ(bounces, static_cast<int>((700 * 2.0 + kFree) / (2 * kFree)));
}

// Energy of a fall with bounces of e = 1: m g h + m v^2 / 2 stays, however the step cuts the fall. The tolerance: the
// cast may stop 2 % of the radius above the ground, once a bounce.
TEST(Continuous, BouncesKeepTheEnergyUnderGravity) {
    TestWorld world;
    world.AddFloor(kBouncy);
    constexpr float kRadius = 0.02f;
    const BodyId ball = world.Add({.shape = SphereOf(kRadius),
                                   .position = {0, 10, 0},
                                   .linearVelocity = {0, -30, 0},
                                   .material = kBouncy,
                                   .continuous = kLinear});
    const auto energy = [&] {
        const double v = world.VelocityOf(ball).y();
        return kGravity * world.PositionOf(ball).y() + 0.5 * v * v;
    };
    const double start = energy();
    int bounces = 0;
    for (int i = 0; i < 1200; ++i) {
        world.Step();
        bounces += static_cast<int>(world.Report().sweptHits);
        ASSERT_NEAR(energy(), start, 1e-4 * start + kGravity * 0.02 * kRadius * bounces) << i;
    }
    EXPECT_GE(bounces, 2);
}

TEST(Continuous, EqualBallsThatMeetInFlightExchangeTheirVelocities) {
    TestWorld world(NoGravity());
    const BodyId a = world.Add({.shape = SphereOf(0.1f),
                                .position = {-3, 0, 0},
                                .linearVelocity = {400, 0, 0},
                                .material = kBouncy,
                                .continuous = kLinear});
    const BodyId b = world.Add({.shape = SphereOf(0.1f),
                                .position = {3, 0, 0},
                                .linearVelocity = {-200, 0, 0},
                                .material = kBouncy,
                                .continuous = kLinear});
    world.Step();
    EXPECT_NEAR(world.VelocityOf(a).x(), -200, 0.01);
    EXPECT_NEAR(world.VelocityOf(b).x(), 400, 0.01);
    // They meet after 5.8 m / (600 m/s); the cast may end 2 mm early.
    const double meet = 5.8 / 600, rest = kStep - meet;
    EXPECT_NEAR(world.PositionOf(a).x(), -3 + 400 * meet - 200 * rest, 0.01);
    EXPECT_NEAR(world.PositionOf(b).x(), 3 - 200 * meet + 400 * rest, 0.01);
    world.Steps(10);
    EXPECT_NEAR(world.VelocityOf(a).x(), -200, 0.01);
}

TEST(Continuous, ABulletWakesWhatItHitsAndSharesItsMomentum) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {20, 0.5, 0}, .mass = 100, .startAsleep = true});
    const BodyId bullet = world.Add({.shape = SphereOf(0.02f),
                                     .position = {0, 0.5, 0},
                                     .linearVelocity = {900, 0, 0},
                                     .mass = 0.5f,
                                     .gravityFactor = 0,
                                     .continuous = kLinear});
    world.Step();
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    world.Step();
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    // e = 0: both at m v / (m + M), from when it has flown 19.48 m.
    const double rest = 2 * kStep - 19.48 / 900;
    EXPECT_NEAR(world.PositionOf(box).x(), 20 + 450 / 100.5 * rest, 2e-3);
    EXPECT_LT(world.PositionOf(bullet).x(), world.PositionOf(box).x() - 0.5);
    EXPECT_NEAR(world.VelocityOf(box).x(), 450 / 100.5, 0.02);
    EXPECT_NEAR(world.VelocityOf(bullet).x(), 450 / 100.5, 0.02);
}

// A rod of 2 m turns by 96 degrees a step towards a post that stands 0.7 m from its middle. J (1 / m + r^2 / I) = (1 +
// e) w r.
TEST(Continuous, ATurningRodDoesNotTunnelThroughAPost) {
    for (const float restitution : {0.0f, 1.0f}) {
        const auto turn = [&](ContinuousCollision continuous, Vector3& v, Vector3& w) {
            TestWorld world(NoGravity());
            const Material material{.friction = 0, .restitution = restitution};
            world.Add({.shape = CapsuleOf(1, 0.02f),
                       .motion = MotionType::Static,
                       .position = {0, 0, -0.7},
                       .material = material});
            const BodyId rod = world.Add({.shape = BoxOf(1, 0.02f, 0.02f),
                                          .rotation = RotationAbout({0, 1, 0}, 10 * kDegree),
                                          .angularVelocity = {0, 100, 0},
                                          .mass = 3,
                                          .material = material,
                                          .continuous = continuous});
            world.Step();
            v = world.VelocityOf(rod);
            w = world.Bodies().GetAngularVelocity(rod);
        };
        Vector3 v, w;
        turn(ContinuousCollision::Off, v, w);
        EXPECT_NEAR(w.y(), 100, 1e-3);
        for (const ContinuousCollision continuous : {kLinear, kTurning}) {
            turn(continuous, v, w);
            // The side of the rod touches, so that the arm is 0.7 m but for the widths of rod and post; I = m (2^2 +
            // 0.04^2) / 12.
            const double inertia = 3 * (4 + 0.0016) / 12, r = 0.7,
                         impulse = (1 + double{restitution}) * 100 * r / (1 / 3.0 + r * r / inertia);
            EXPECT_NEAR(w.y(), 100 - impulse * r / inertia, 2);
            EXPECT_NEAR(Length(v), impulse / 3, 2);
        }
    }
}

// A post in the way of a rod on a hinge, in any pose: on which side of the post the rod is never changes.
TEST(Continuous, AThousandRodsNeverSweepOverThinPosts) {
    constexpr LockedAxes kAllButYaw = LockedAxes::TranslationX | LockedAxes::TranslationY | LockedAxes::TranslationZ |
                                      LockedAxes::RotationX | LockedAxes::RotationZ;
    TestWorld world(Shots());
    RandomPoses random(3);
    std::vector<BodyId> rods;
    for (int i = 0; i < 1000; ++i) {
        const float at = random.Between(0.3f, 0.9f), angle = random.Between(0.2f, 2.9f),
                    speed = random.Between(50, 250);
        const Position middle(5.0 * (i % 40), 0, 5.0 * (i / 40));
        world.Add({.shape = CapsuleOf(1, 0.01f),
                   .motion = MotionType::Static,
                   .position = middle + Position(double{at}, 0, 0),
                   .material = kBouncy});
        // Turns down onto the post from the side of -z; an end-point of it, at first at angle `angle`, comes to 0.
        rods.push_back(world.Add({.shape = BoxOf(1, 0.01f, 0.01f),
                                  .position = middle,
                                  .rotation = RotationAbout({0, 1, 0}, double{angle}),
                                  .angularVelocity = {0, -speed, 0},
                                  .material = kBouncy,
                                  .lockedAxes = kAllButYaw,
                                  .layer = 1,
                                  .continuous = kTurning}));
    }
    for (int step = 0; step < 30; ++step) {
        world.Step();
        for (size_t i = 0; i < rods.size(); ++i) {
            const Vector3 end = Rotate(world.Bodies().GetPose(rods[i]).rotation, Vector3(1, 0, 0));
            // The half of the rod beyond the post is symmetric: it swings between 0 and 180 degrees, as seen by either
            // end.
            ASSERT_LT(end.z(), 0.05f) << "rod " << i << " in step " << step;
        }
    }
}

// 1 cm beside the edge of a wall: the same bits as without the wall.
TEST(Continuous, ABodyThatFliesPastAnEdgeIsNotSlowed) {
    const auto fly = [](bool wall, ContinuousCollision continuous) {
        TestWorld world;
        if (wall) world.Add({.shape = BoxOf(0.05f, 5, 5), .motion = MotionType::Static, .position = {20, -4.9, 0}});
        const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                       .position = {0, 0.215, 0},
                                       .linearVelocity = {500, 0, 0},
                                       .gravityFactor = 0,
                                       .continuous = continuous});
        world.Steps(20);
        return BitsOf(world, ball);
    };
    EXPECT_EQ(fly(true, kLinear), fly(false, kLinear));
    EXPECT_EQ(fly(true, kTurning), fly(false, kTurning));
}

// Over the seams of flush boxes, and the inner edges of a mesh: no hit, no loss.
TEST(Continuous, SlidingFastOverSeamsLosesNothing) {
    for (const bool mesh : {false, true})
        for (const ContinuousCollision continuous : {kLinear, kTurning}) {
            TestWorld world;
            if (mesh) {
                std::vector<Vector3> vertices;
                std::vector<uint32_t> indices;
                for (uint32_t i = 0; i <= 200; ++i)
                    for (uint32_t k = 0; k < 2; ++k) {
                        vertices.emplace_back(static_cast<float>(i) - 2, 0.0f, k == 0 ? -2.0f : 2.0f);
                        if (i < 200 && k == 0)
                            indices.insert(indices.end(),
                                           {2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3});
                    }
                world.Add({.shape = TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value(),
                           .motion = MotionType::Static,
                           .material = kDull});
            } else {
                for (int i = 0; i < 200; ++i)
                    world.Add({.shape = BoxOf(0.5f, 0.5f, 2),
                               .motion = MotionType::Static,
                               .position = {i - 1.5, -0.5, 0},
                               .material = kDull});
            }
            const BodyId box = world.Add({.shape = CubeOf(0.2f),
                                          .position = {0, 0.2, 0},
                                          .linearVelocity = {100, 0, 0},
                                          .material = kDull,
                                          .continuous = continuous});
            for (int i = 0; i < 90; ++i) {
                world.Step();
                ASSERT_NEAR(world.VelocityOf(box).x(), 100, 0.1) << mesh << " step " << i;
                ASSERT_NEAR(world.PositionOf(box).y(), 0.2, 2e-3) << mesh << " step " << i;
            }
            EXPECT_NEAR(world.PositionOf(box).x(), 150, 0.3);
        }
}

TEST(Continuous, AFastPaddlePushesWhatItWouldPass) {
    TestWorld world(NoGravity());
    world.Add({.shape = BoxOf(0.02f, 1, 1),
               .motion = MotionType::Kinematic,
               .position = {-2, 0, 0},
               .linearVelocity = {300, 0, 0},
               .material = kDull,
               .continuous = kLinear});
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .material = kDull});
    world.Steps(3);
    EXPECT_NEAR(world.VelocityOf(ball).x(), 300, 0.5);
}

TEST(Continuous, SettledStepsWithFastBodiesAllocateNothing) {
    for (const uint32_t threads : {1u, 2u}) {
        TestWorld world(NoGravity(), threads);
        for (const double side : {-1.0, 1.0})
            world.Add({.shape = BoxOf(0.1f, 9, 9),
                       .motion = MotionType::Static,
                       .position = {side * 4, 0, 0},
                       .material = kBouncy});
        for (int i = 0; i < 64; ++i)
            world.Add({.shape = SphereOf(0.1f),
                       .position = {0, i % 8 - 3.5, i / 8 - 3.5},
                       .linearVelocity = {300, 0, 0},
                       .material = kBouncy,
                       .continuous = i % 2 ? kLinear : kTurning});
        world.Steps(60);
        const uint64_t before = AllocationCount();
        for (int i = 0; i < 60; ++i) {
            const Status status = world.System().Update(kStep);
            if (!status) ADD_FAILURE();
        }
        EXPECT_EQ(AllocationCount() - before, 0u) << threads;
    }
}

// A wall that lets pass what flies towards +x, a mask, and a restitution of the listener's own.
TEST(Continuous, FiltersAndListenersApply) {
    class OneWay final : public ContactListener {
    public:
        void ModifyContact(const ContactView& contact, ContactChange& change) const override {
            change.ignore = contact.normal.x() > 0;
            change.restitution = 0.5f;
        }
    } oneWay;
    const auto shoot = [&](float velocity, uint64_t mask, const ContactListener* listener) {
        TestWorld world(NoGravity());
        world.System().SetContactListener(listener);
        world.Add({.shape = BoxOf(0.01f, 5, 5), .motion = MotionType::Static, .material = kDull});
        const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                       .position = {velocity > 0 ? -8.0 : 8.0, 0, 0},
                                       .linearVelocity = {velocity, 0, 0},
                                       .material = kDull,
                                       .mask = mask,
                                       .continuous = kLinear});
        world.Steps(3);
        return world.VelocityOf(ball).x();
    };
    EXPECT_NEAR(shoot(500, ~0ull, nullptr), 0, 1e-3);
    EXPECT_EQ(shoot(500, 2, nullptr), 500);
    EXPECT_EQ(shoot(500, ~0ull, &oneWay), 500);
    EXPECT_NEAR(shoot(-500, ~0ull, &oneWay), 250, 1e-2);
}

// As between steps: where the turn of a surface is no number, its velocity does not count either.
TEST(Continuous, ASurfaceOfWhichTheTurnIsNotFiniteStands) {
    class Belt final : public ContactListener {
    public:
        float turn = 0;
        void ModifyContact(const ContactView&, ContactChange& change) const override {
            change.surfaceVelocity = Vector3(0, 30, 0);
            change.surfaceAngularVelocity = Vector3(turn, 0, 0);
        }
    };
    const auto shoot = [](const ContactListener* listener) {
        TestWorld world(NoGravity());
        world.System().SetContactListener(listener);
        world.Add({.shape = BoxOf(0.01f, 5, 5), .motion = MotionType::Static, .material = {.friction = 1}});
        const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                       .position = {-8, 0, 0},
                                       .linearVelocity = {500, 0, 0},
                                       .material = {.friction = 1},
                                       .continuous = kLinear});
        world.Step();
        return world.VelocityOf(ball);
    };
    Belt runs, wrong;
    wrong.turn = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(shoot(&wrong), shoot(nullptr));
    EXPECT_GT(std::fabs(shoot(&runs).y()), 1);
}

TEST(Continuous, RefusesShapesThatCannotBeCast) {
    TestWorld world;
    const BodySettings plane{
        .shape = Plane::Create(Vector3(0, 1, 0), 0).Value(), .motion = MotionType::Static, .continuous = kLinear};
    const Result<BodyId> body = world.Bodies().Create(plane);
    ASSERT_FALSE(body);
    EXPECT_EQ(body.GetError().code, ErrorCode::Unsupported);
    const BodyId ball = world.Add({.shape = SphereOf(1)});
    EXPECT_EQ(world.Bodies().SetContinuous(ball, static_cast<ContinuousCollision>(7)).GetError().code,
              ErrorCode::OutOfRange);
    EXPECT_EQ(world.Bodies().SetContinuous({99, 0}, kLinear).GetError().code, ErrorCode::UnknownId);
}

}  // namespace
}  // namespace fulcrum::testing
