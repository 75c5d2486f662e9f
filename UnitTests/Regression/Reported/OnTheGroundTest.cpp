// Reported of bodies on the ground elsewhere: belts that do not hold, boxes that turn as they slide, balls that roll
// otherwise along the diagonals, cubes that fall over too slowly, boxes that hang on a shuttle as it turns back.
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

// Moves the surface of one body.
class Belt : public ContactListener {
public:
    Belt(BodyId belt, const Vector3& velocity) : belt_(belt), velocity_(velocity) {}
    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        if (contact.bodyA == belt_ || contact.bodyB == belt_) change.MoveSurface(contact, belt_, velocity_);
    }

private:
    BodyId belt_;
    Vector3 velocity_;
};

// A slope of 0.6 rad holds what has a friction of 0.75 > tan 0.6 = 0.684, so a belt at rest does, too. One that moves
// up at v carries up at v, once the box has it: it gains a = g (0.75 cos 0.6 - sin 0.6) = 0.53 m/s2, and so is 1 m/s
// after 1.88 s. From 1 s to 4 s it moves 3 m less what it lacks then, v2 / (2 a) in all and a t2 / 2 of it in the first
// second: (1 - a)2 / (2 a).
TEST(OnTheGround, ABeltOnASlopeHoldsAndCarries) {
    const double slope = 0.6, friction = 0.75, gain = kGravity * (friction * std::cos(slope) - std::sin(slope)),
                 carried = 3 - (1 - gain) * (1 - gain) / (2 * gain);
    const Vector3 up(static_cast<float>(std::cos(slope)), static_cast<float>(std::sin(slope)), 0),
        normal(-up.y(), up.x(), 0);
    for (const float speed : {0.0f, 1.0f}) {
        TestWorld world;
        const Quaternion tilt = RotationAbout({0, 0, 1}, slope);
        const Material material{.friction = static_cast<float>(friction)};
        const BodyId ramp = world.Add({.shape = BoxOf(20, 0.5f, 2),
                                       .motion = MotionType::Static,
                                       .rotation = tilt,
                                       .material = material}),
                     box = world.Add({.shape = BoxOf(0.4f, 0.2f, 0.4f),
                                      .position = (normal * 0.7f - up * 5.0f).cast<double>(),
                                      .rotation = tilt,
                                      .material = material});
        const Belt belt(ramp, up * speed);
        world.System().SetContactListener(&belt);
        const auto along = [&] { return world.PositionOf(box).dot(up.cast<double>()); };
        world.Steps(60);
        const double before = along();
        world.Steps(180);
        // Gravity is applied in steps, which a speed's gain of 0.53 / 60 shows: 3 mm a second.
        EXPECT_NEAR(along() - before, speed > 0 ? carried : 0, speed > 0 ? 0.02 : 0.001) << speed;
        world.System().SetContactListener(nullptr);
    }
}

// It stops after v2 / (2 mu g) = 3.19 m, without a turn, since friction acts on each point as the weight upon it, whose
// moment about the vertical is zero: within what four points in steps leave of it.
TEST(OnTheGround, ASlidingBoxGoesStraight) {
    const double friction = 0.4, speed = 5;
    for (int i = 0; i < 8; ++i) {
        TestWorld world;
        const Material material{.friction = static_cast<float>(friction)};
        world.AddFloor(material);
        const Quaternion yaw = RotationAbout({0, 1, 0}, 0.39 * i);
        const BodyId box = world.Add({.shape = BoxOf(0.5f, 0.3f, 0.25f),
                                      .position = {0, 0.3, 0},
                                      .rotation = yaw,
                                      .linearVelocity = {static_cast<float>(speed), 0, 0},
                                      .material = material});
        world.Run(2);
        const Pose pose = world.Bodies().GetPose(box);
        const Quaternion turn = pose.rotation * yaw.Conjugate();
        EXPECT_GT(std::fabs(turn.w), std::cos(0.5 * 0.02)) << "yaw " << i;
        EXPECT_NEAR(pose.position.z(), 0, 0.03) << "yaw " << i;
        EXPECT_NEAR(pose.position.x() / (speed * speed / (2 * friction * kGravity)), 1, 0.02) << "yaw " << i;
    }
}

// Twelve directions are one: what they differ by is rounding, and the start of contact points along the axes.
TEST(OnTheGround, AnEccentricBallRollsAlikeInAllDirections) {
    double least = 1e9, most = 0;
    for (int i = 0; i < 12; ++i) {
        TestWorld world;
        world.AddFloor({.friction = 1});
        const double a = i * kPi / 6, c = std::cos(a), s = std::sin(a);
        const ShapePtr ball =
            OffsetCenterOfMass(SphereOf(0.5f), {static_cast<float>(0.2 * c), 0, static_cast<float>(0.2 * s)}).Value();
        const BodyId body = world.Add({.shape = ball, .position = {0, 0.5, 0}, .material = {.friction = 1}});
        world.Steps(138);
        const Position at = world.PositionOf(body);
        least = std::min(least, at.x() * c + at.z() * s);
        most = std::max(most, at.x() * c + at.z() * s);
        EXPECT_NEAR(at.z() * c - at.x() * s, 0, 0.01) << "direction " << i;
    }
    EXPECT_LT(most - least, 0.02);
}

// About an edge that friction holds: a'' = g d / (I / m) sin a, with the half diagonal d and I / m = 8/3 h2. The time
// is integrated in small steps. Within 4 % and a step: a fraction of the cube's corner sinks into contacts that are
// soft.
TEST(OnTheGround, ACubeFallsOverAboutItsEdge) {
    const double half = 0.5, diagonal = half * std::sqrt(2.0), start = 3 * kDegree, end = kPi / 4 - 0.02;
    double time = 0;
    for (double a = start, speed = 0; a < end; time += 1e-5) {
        speed += kGravity * diagonal / (8 / 3.0 * half * half) * std::sin(a) * 1e-5;
        a += speed * 1e-5;
    }
    const Vector3 corners[] = {{-50, 0, -50}, {50, 0, -50}, {50, 0, 50}, {-50, 0, 50}};
    const uint32_t indices[] = {0, 2, 1, 0, 3, 2};
    const ShapePtr grounds[] = {BoxOf(50, 1, 50),
                                TriangleMesh::Create({.vertices = corners, .indices = indices}).Value()};
    for (const ShapePtr& ground : grounds) {
        TestWorld world;
        const Material rough{.friction = 5};
        world.Add({.shape = ground,
                   .motion = MotionType::Static,
                   .position = {0, ground == grounds[0] ? -1.0 : 0.0, 0},
                   .material = rough});
        const BodyId cube = world.Add({.shape = CubeOf(0.5f),
                                       .position = {diagonal * std::sin(start), diagonal * std::cos(start), 7},
                                       .rotation = RotationAbout({0, 0, 1}, kPi / 4 - start),
                                       .material = rough});
        const auto isDown = [&] {
            return Rotate(world.Bodies().GetPose(cube).rotation, Vector3(0, 1, 0)).y() > std::cos(0.02);
        };
        int step = 0;
        while (step < 240 && !isDown()) {
            world.Step();
            ++step;
        }
        EXPECT_GT(step * kStep, 0.96 * time) << ShapeTypeName(ground->Type());
        EXPECT_LT(step * kStep, 1.04 * time + kStep) << ShapeTypeName(ground->Type());
    }
}

// A kinematic platform that goes A (1 - cos w t) to and fro, or up and down: the box stays on it where A w2 is below
// mu g = 4.9 m/s2, and below g.
TEST(OnTheGround, ABoxStaysOnAShuttleAndALift) {
    for (const bool isLift : {false, true}) {
        TestWorld world;
        const BodyId platform = world.Add({.shape = BoxOf(2, 0.2f, 2), .motion = MotionType::Kinematic}),
                     box = world.Add({.shape = CubeOf(0.4f), .position = {0, 0.6, 0}});
        world.Steps(30);
        double gap = 0, slip = 0;
        for (int step = 1; step < 400; ++step) {
            const double way = (isLift ? 2 : 1) * (1 - std::cos(2 * kStep * step));
            const Position to = isLift ? Position(0, way, 0) : Position(way, 0, 0);
            ASSERT_TRUE(world.Bodies().MoveKinematic(platform, to, {}, static_cast<float>(kStep)));
            world.Step();
            const Position off = world.PositionOf(box) - world.PositionOf(platform);
            gap = std::max(gap, std::fabs(off.y() - 0.6));
            slip = std::max(slip, std::hypot(off.x(), off.z()));
        }
        // Soft contacts give way by some millimeters under 1.8 g.
        EXPECT_LT(gap, 0.006) << isLift;
        EXPECT_LT(slip, 0.02) << isLift;
    }
}

}  // namespace
}  // namespace fulcrum::testing
