// Invalid input is refused by name and changes nothing; a failure in a step affects only the bodies concerned.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

struct BadBody {
    const char* field;
    ErrorCode code;
    std::function<void(BodySettings&)> spoil;
};

std::vector<BadBody> BadBodies() {
    using S = BodySettings;
    std::vector<BadBody> list{
        {"shape", ErrorCode::Unsupported, [](S& s) { s.shape = nullptr; }},
        {"rotation", ErrorCode::Unnormalized,
         [](S& s) {
             s.rotation = {0, 0, 0, 1.1f};
         }},
        {"rotation", ErrorCode::Unnormalized,
         [](S& s) {
             s.rotation = {0, 0, 0, 0};
         }},
        {"rotation", ErrorCode::NonFinite, [](S& s) { s.rotation.x = kNaN; }},
        {"density", ErrorCode::NonPositive, [](S& s) { s.density = 0; }},
        {"density", ErrorCode::NonPositive, [](S& s) { s.density = -1; }},
        {"mass", ErrorCode::Negative, [](S& s) { s.mass = -1; }},
        {"inertia", ErrorCode::NonPositive,
         [](S& s) {
             s.inertia = {1, 0, 1};
         }},
        {"inertia", ErrorCode::NonPositive,
         [](S& s) {
             s.inertia = {1, -1, 1};
         }},
        {"friction", ErrorCode::Negative, [](S& s) { s.material.friction = -0.1f; }},
        {"restitution", ErrorCode::OutOfRange, [](S& s) { s.material.restitution = 1.1f; }},
        {"restitution", ErrorCode::OutOfRange, [](S& s) { s.material.restitution = -0.1f; }},
        {"linearDamping", ErrorCode::Negative, [](S& s) { s.linearDamping = -1; }},
        {"angularDamping", ErrorCode::Negative, [](S& s) { s.angularDamping = -1; }},
        {"maxLinearSpeed", ErrorCode::NonPositive, [](S& s) { s.maxLinearSpeed = 0; }},
        {"maxAngularSpeed", ErrorCode::NonPositive, [](S& s) { s.maxAngularSpeed = -1; }},
        {"layer", ErrorCode::OutOfRange, [](S& s) { s.layer = 32; }},
        {"lockedAxes", ErrorCode::OutOfRange, [](S& s) { s.lockedAxes = static_cast<LockedAxes>(64); }},
        {"startAsleep", ErrorCode::Unsupported, [](S& s) { s.startAsleep = true, s.motion = MotionType::Static; }},
        {"velocity", ErrorCode::Unsupported,
         [](S& s) {
             s.motion = MotionType::Static, s.linearVelocity = {1, 0, 0};
         }},
        // Masses and moments of which no float holds the inverse.
        {"mass", ErrorCode::OutOfRange, [](S& s) { s.mass = 1e-40f; }},
        {"inertia", ErrorCode::OutOfRange,
         [](S& s) {
             s.inertia = {1e-40f, 1, 1};
         }},
        {"density", ErrorCode::OutOfRange, [](S& s) { s.density = 1e-44f; }},
        {"density", ErrorCode::OutOfRange, [](S& s) { s.density = 3e38f; }},
    };
    for (float bad : {kNaN, kInfinite, -kInfinite}) {
        const ErrorCode code = ErrorCode::NonFinite;
        list.push_back({"position", code, [=](S& s) { s.position.y() = double(bad); }});
        list.push_back({"linearVelocity", code, [=](S& s) { s.linearVelocity.x() = bad; }});
        list.push_back({"angularVelocity", code, [=](S& s) { s.angularVelocity.z() = bad; }});
        list.push_back({"density", code, [=](S& s) { s.density = bad; }});
        list.push_back({"mass", code, [=](S& s) { s.mass = bad; }});
        list.push_back({"inertia", code, [=](S& s) { s.inertia.y() = bad; }});
        list.push_back({"friction", code, [=](S& s) { s.material.friction = bad; }});
        list.push_back({"restitution", code, [=](S& s) { s.material.restitution = bad; }});
        list.push_back({"linearDamping", code, [=](S& s) { s.linearDamping = bad; }});
        list.push_back({"angularDamping", code, [=](S& s) { s.angularDamping = bad; }});
        list.push_back({"gravityFactor", code, [=](S& s) { s.gravityFactor = bad; }});
        list.push_back({"maxLinearSpeed", code, [=](S& s) { s.maxLinearSpeed = bad; }});
        list.push_back({"maxAngularSpeed", code, [=](S& s) { s.maxAngularSpeed = bad; }});
    }
    return list;
}

TEST(Errors, ABadBodyIsNotCreatedAndNamesItsField) {
    TestWorld world;
    world.AddFloor();
    const BodyId witness = world.Add({.shape = CubeOf(0.5f), .position = {0, 3, 0}});
    world.Steps(5);
    const BodyBits before = BitsOf(world, witness);
    for (const BadBody& bad : BadBodies()) {
        BodySettings settings{.shape = CubeOf(0.5f)};
        bad.spoil(settings);
        const Result<BodyId> result = world.Bodies().Create(settings);
        ASSERT_FALSE(result) << bad.field;
        EXPECT_EQ(result.GetError().code, bad.code) << result.GetError().message;
        EXPECT_NE(result.GetError().message.find(bad.field), std::string::npos) << result.GetError().message;
    }
    int bodies = 0;
    world.System().VisitBodies([&](BodyId) { ++bodies; });
    EXPECT_EQ(bodies, 2);
    EXPECT_EQ(BitsOf(world, witness), before);
}

TEST(Errors, RefusedCallsDoNotChangeTheFuture) {
    const auto run = [](bool spoil) {
        TestWorld world;
        const BodyId floor = world.AddFloor();
        const BodyId box =
            world.Add({.shape = CubeOf(0.5f), .position = {0, 1, 0}, .rotation = RotationAbout({1, 0, 0}, 0.2)});
        for (int i = 0; i < 100; ++i) {
            if (spoil) {
                BodyInterface& b = world.Bodies();
                const BodyId unknown{77, 0};
                EXPECT_FALSE(b.Create({}));
                EXPECT_FALSE(b.AddForce(box, {kNaN, 0, 0}));
                EXPECT_FALSE(b.AddForceAt(box, {1, 0, 0}, {double(kInfinite), 0, 0}));
                EXPECT_FALSE(b.AddTorque(box, {0, kInfinite, 0}));
                EXPECT_FALSE(b.AddImpulse(box, {0, 0, kNaN}));
                EXPECT_FALSE(b.AddImpulseAt(box, {0, 0, 1}, {0, double(kNaN), 0}));
                EXPECT_FALSE(b.AddAngularImpulse(box, {0, 0, kNaN}));
                EXPECT_FALSE(b.SetVelocity(box, {kNaN, 0, 0}, {0, 0, 0}));
                EXPECT_FALSE(b.SetVelocity(box, {0, 0, 0}, {0, kInfinite, 0}));
                EXPECT_FALSE(b.SetVelocity(floor, {1, 0, 0}, {0, 0, 0}));
                EXPECT_FALSE(b.SetPose(box, {double(kNaN), 0, 0}, {}));
                EXPECT_FALSE(b.SetPose(box, {0, 0, 0}, {0, 0, 0, 2}));
                EXPECT_FALSE(b.SetMaterial(box, {.friction = -1}));
                EXPECT_FALSE(b.SetGravityFactor(box, kNaN));
                EXPECT_FALSE(b.MoveKinematic(box, {0, 0, 0}, {}, 1));
                EXPECT_FALSE(b.AddForce(floor, {1, 0, 0}));
                EXPECT_FALSE(b.Sleep(floor));
                EXPECT_FALSE(b.Remove(unknown));
                EXPECT_FALSE(b.SetPose(unknown, {0, 0, 0}, {}));
                EXPECT_FALSE(b.Wake(unknown));
                EXPECT_FALSE(world.System().Update(-0.1));
                EXPECT_FALSE(world.System().Update(1.5));
                EXPECT_FALSE(world.System().Update(std::numeric_limits<double>::quiet_NaN()));
                SystemSettings settings;
                settings.solver.substeps = 0;
                EXPECT_FALSE(world.System().SetSettings(settings));
            }
            world.Step();
        }
        return BitsOf(world, box);
    };
    EXPECT_EQ(run(false), run(true));
}

TEST(Errors, ABadSystemIsNotCreated) {
    using S = SystemSettings;
    struct Bad {
        const char* field;
        ErrorCode code;
        std::function<void(S&)> spoil;
    };
    const std::vector<Bad> list{
        {"gravity", ErrorCode::NonFinite, [](S& s) { s.gravity.x() = kNaN; }},
        {"substeps", ErrorCode::OutOfRange, [](S& s) { s.solver.substeps = 0; }},
        {"substeps", ErrorCode::OutOfRange, [](S& s) { s.solver.substeps = 256; }},
        {"velocityIterations", ErrorCode::OutOfRange, [](S& s) { s.solver.velocityIterations = 0; }},
        {"velocityIterations", ErrorCode::OutOfRange, [](S& s) { s.solver.velocityIterations = 256; }},
        {"positionIterations", ErrorCode::OutOfRange, [](S& s) { s.solver.positionIterations = -1; }},
        {"positionIterations", ErrorCode::OutOfRange, [](S& s) { s.solver.positionIterations = 256; }},
        {"positionCorrection", ErrorCode::OutOfRange,
         [](S& s) { s.solver.positionCorrection = static_cast<PositionCorrection>(2); }},
        {"baumgarte", ErrorCode::NonPositive, [](S& s) { s.solver.baumgarte = 0; }},
        {"baumgarte", ErrorCode::OutOfRange, [](S& s) { s.solver.baumgarte = 1.5f; }},
        {"baumgarteSlop", ErrorCode::OutOfRange, [](S& s) { s.solver.baumgarteSlop = -1e-3f; }},
        {"baumgarte", ErrorCode::NonFinite, [](S& s) { s.solver.baumgarte = kNaN; }},
        {"accuracy.penetration", ErrorCode::NonPositive, [](S& s) { s.accuracy.penetration = 0; }},
        {"accuracy.penetration", ErrorCode::NonFinite, [](S& s) { s.accuracy.penetration = kNaN; }},
        {"sleep.seconds", ErrorCode::Negative, [](S& s) { s.sleep.seconds = -1; }},
        {"sleep.linearSpeed", ErrorCode::NonFinite, [](S& s) { s.sleep.linearSpeed = kInfinite; }},
        {"speculativeDistance", ErrorCode::NonPositive, [](S& s) { s.speculativeDistance = 0; }},
        {"penetrationSlop", ErrorCode::Negative, [](S& s) { s.penetrationSlop = -1; }},
        {"contactFrequency", ErrorCode::NonPositive, [](S& s) { s.contactFrequency = 0; }},
        {"contactFrequency", ErrorCode::NonFinite, [](S& s) { s.contactFrequency = kNaN; }},
        {"contactDampingRatio", ErrorCode::Negative, [](S& s) { s.contactDampingRatio = -1; }},
        {"contactPushSpeed", ErrorCode::NonPositive, [](S& s) { s.contactPushSpeed = 0; }},
        {"depenetrationSpeed", ErrorCode::NonPositive, [](S& s) { s.depenetrationSpeed = 0; }},
        {"jointPushSpeed", ErrorCode::NonPositive, [](S& s) { s.jointPushSpeed = -1; }},
        {"exactJointLoad", ErrorCode::NonPositive, [](S& s) { s.exactJointLoad = 0; }},
        {"exactJointLoad", ErrorCode::NonFinite,
         [](S& s) { s.exactJointLoad = std::numeric_limits<float>::quiet_NaN(); }},
        {"restitutionSpeed", ErrorCode::Negative, [](S& s) { s.restitutionSpeed = -1; }},
        {"boundsMargin", ErrorCode::NonPositive, [](S& s) { s.boundsMargin = 0; }},
        {"layerCollides", ErrorCode::Unsupported, [](S& s) { s.layerCollides[3] = 1; }},
    };
    for (const Bad& bad : list) {
        SystemSettings settings;
        bad.spoil(settings);
        const auto result = PhysicsSystem::Create(settings);
        ASSERT_FALSE(result) << bad.field;
        EXPECT_EQ(result.GetError().code, bad.code) << result.GetError().message;
        EXPECT_NE(result.GetError().message.find(bad.field), std::string::npos) << result.GetError().message;
    }
}

// Floats end at 3.4e38: two such forces make an infinite one.
void PushBeyondAllNumbers(TestWorld& world, BodyId id) {
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(world.Bodies().AddForce(id, {3e38f, 3e38f, 0}));
        ASSERT_TRUE(world.Bodies().AddTorque(id, {3e38f, 0, 3e38f}));
    }
}

TEST(Frozen, ABodyThatTurnsNonFiniteStopsAtItsLastGoodPose) {
    TestWorld world;
    const BodyId bad =
        world.Add({.shape = SphereOf(0.5f), .position = {1, 2, 3}, .maxLinearSpeed = 3e38f, .maxAngularSpeed = 3e38f});
    const BodyId good = world.Add({.shape = SphereOf(0.5f), .position = {10, 2, 3}});
    PushBeyondAllNumbers(world, bad);
    world.Step();
    EXPECT_EQ(world.Report().frozenBodies, 1u);
    EXPECT_EQ(world.Report().firstFrozen, bad);
    EXPECT_TRUE(world.Bodies().IsFrozen(bad));
    EXPECT_EQ(world.PositionOf(bad), Position(1, 2, 3));
    EXPECT_EQ(world.VelocityOf(bad), Vector3(0, 0, 0));
    world.Steps(10);
    EXPECT_EQ(world.PositionOf(bad), Position(1, 2, 3));
    EXPECT_LT(world.PositionOf(good).y(), 2);
    const Status status = world.Bodies().AddForce(bad, {1, 0, 0});
    ASSERT_FALSE(status);
    EXPECT_EQ(status.GetError().code, ErrorCode::Unsupported);

    ASSERT_TRUE(world.Bodies().SetPose(bad, {0, 5, 0}, {}));
    EXPECT_FALSE(world.Bodies().IsFrozen(bad));
    world.Run(0.5);
    EXPECT_FALSE(world.Bodies().IsFrozen(bad));
    EXPECT_NEAR(world.PositionOf(bad).y(), 5 - 0.5 * kGravity * 0.25, 1e-3);
}

TEST(Frozen, NeighborsInTouchGoOn) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId below = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const BodyId bad =
        world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}, .maxLinearSpeed = 3e38f, .maxAngularSpeed = 3e38f});
    const BodyId above = world.Add({.shape = CubeOf(0.5f), .position = {0, 2.5, 0}});
    const BodyId beside = world.Add({.shape = CubeOf(0.5f), .position = {1, 0.5, 0}});
    world.Run(1);
    PushBeyondAllNumbers(world, bad);
    world.Step();
    EXPECT_EQ(world.Report().frozenBodies, 1u);
    EXPECT_EQ(world.Report().firstFrozen, bad);
    world.Run(2);
    EXPECT_TRUE(world.Bodies().IsFrozen(bad));
    for (BodyId id : {below, above, beside}) {
        EXPECT_FALSE(world.Bodies().IsFrozen(id));
        EXPECT_TRUE(IsFinite(world.PositionOf(id)));
    }
    // Those above rest on the frozen one as on a static body.
    EXPECT_NEAR(world.PositionOf(below).y(), 0.5, 0.01);
    EXPECT_NEAR(world.PositionOf(above).y(), 2.5, 0.01);
    EXPECT_NEAR(world.PositionOf(beside).y(), 0.5, 0.01);
}

TEST(Frozen, HugeButFiniteForcesAreHeldBySpeedLimits) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const BodyId beside = world.Add({.shape = CubeOf(0.5f), .position = {3, 0.5, 0}});
    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(world.Bodies().AddForce(box, {1e30f, 1e30f, -1e30f}));
        ASSERT_TRUE(world.Bodies().AddTorque(box, {1e30f, 1e30f, -1e30f}));
        world.Step();
        EXPECT_EQ(world.Report().frozenBodies, 0u);
    }
    EXPECT_TRUE(world.AllFinite());
    EXPECT_NEAR(world.PositionOf(beside).y(), 0.5, 0.01);
}

}  // namespace
}  // namespace fulcrum::testing
