// Stabilization: the rules for masses and inertias of a ragdoll, and their effect.
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Physics/Ragdoll/Stabilize.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

// A chain of cubes below each other, of these masses, joined by ball joints.
RagdollSettings Chain(std::initializer_list<float> masses) {
    RagdollSettings settings;
    for (float mass : masses) {
        const auto index = static_cast<int>(settings.parts.size());
        PointJointSettings joint;
        joint.anchorA.point = Position(0, 0.25 - 0.5 * index, 0);
        settings.parts.push_back(
            {.name = std::to_string(index),
             .parent = index - 1,
             .body = {.shape = CubeOf(0.1f), .position = Position(0, -0.5 * index, 0), .mass = mass},
             .joint = joint});
    }
    return settings;
}

double TotalMass(const RagdollSettings& settings) {
    double sum = 0;
    for (const RagdollPart& part : settings.parts) sum += MassOf(part.body);
    return sum;
}

TEST(StabilizeMasses, KeepsWhatObeysTheRule) {
    RagdollSettings settings = Chain({10, 10, 5, 1});
    ASSERT_TRUE(StabilizeMasses(settings));
    const float masses[] = {10, 10, 5, 1};
    for (size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(settings.parts[i].body.mass, masses[i]);
}

TEST(StabilizeMasses, ClampsFromTheRootAndKeepsTheWhole) {
    // 100 becomes 10, then 2 is a fifth of it; 200 becomes 2. All times 310 / 24.
    RagdollSettings settings = Chain({10, 100, 0.1f, 200});
    ASSERT_TRUE(StabilizeMasses(settings, {.smallest = 0.2f, .largest = 1.0f}));
    const double factor = 310.1 / 24;
    const double masses[] = {10, 10, 2, 2};
    for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(settings.parts[i].body.mass, masses[i] * factor, 1e-4 * factor);
    EXPECT_NEAR(TotalMass(settings), 310.1, 1e-3);
}

TEST(StabilizeMasses, ScalesInertiasAlong) {
    RagdollSettings settings = Chain({10, 100});
    settings.parts[1].body.inertia = Vector3(1, 2, 3);
    ASSERT_TRUE(StabilizeMasses(settings));
    EXPECT_FLOAT_EQ(settings.parts[1].body.mass, 55);
    EXPECT_LT((settings.parts[1].body.inertia - Vector3(0.55f, 1.1f, 1.65f)).norm(),
              1e-6f * settings.parts[1].body.inertia.norm());
    // The shape's own: m (2 h)^2 / 6 of a cube.
    EXPECT_NEAR(InertiaOf(settings.parts[0].body).x(), 55 * 0.04 / 6, 1e-6);
}

TEST(StabilizeMasses, LeavesPartsBelowAFixedOneAlone) {
    RagdollSettings settings = Chain({1, 100, 200});
    settings.parts[0].body.motion = MotionType::Static;
    ASSERT_TRUE(StabilizeMasses(settings));
    EXPECT_FLOAT_EQ(settings.parts[0].body.mass, 1);
    EXPECT_FLOAT_EQ(settings.parts[1].body.mass, 150);
    EXPECT_FLOAT_EQ(settings.parts[2].body.mass, 150);
}

TEST(StabilizeInertia, RaisesMomentsToTheRuleAndNoFurther) {
    RagdollSettings settings = Chain({10, 10, 10});
    settings.parts[0].body.inertia = Vector3(1, 9, 9.5f);
    settings.parts[1].body.inertia = Vector3(0.3f, 0.2f, 0.4f);
    settings.parts[2].body.inertia = Vector3(0.5f, 6, 6);
    ASSERT_TRUE(StabilizeInertia(settings, {.principalRatio = 3, .childRatio = 2}));
    EXPECT_LT((settings.parts[2].body.inertia - Vector3(2, 6, 6)).norm(),
              1e-5f * settings.parts[2].body.inertia.norm());  // 6 / 3
    EXPECT_LT((settings.parts[1].body.inertia - Vector3(3, 3, 3)).norm(),
              1e-5f * settings.parts[1].body.inertia.norm());  // 6 / 2 of its child
    EXPECT_LT((settings.parts[0].body.inertia - Vector3(9.5f / 3, 9, 9.5f)).norm(),
              1e-5f * settings.parts[0].body.inertia.norm());  // its own spread; the child asks for 1.5
    for (const RagdollPart& part : settings.parts) EXPECT_EQ(part.body.mass, 10);
}

TEST(StabilizeInertia, HoldsForTheHumanoid) {
    RagdollSettings settings = Humanoid();
    const InertiaRule rule;
    ASSERT_TRUE(StabilizeInertia(settings, rule));
    for (const RagdollPart& part : settings.parts) {
        const Vector3 inertia = InertiaOf(part.body);
        EXPECT_LE(inertia.maxCoeff(), rule.principalRatio * inertia.minCoeff() * 1.0001f) << part.name;
        if (part.parent < 0) continue;
        const Vector3 ofParent = InertiaOf(settings.parts[static_cast<size_t>(part.parent)].body);
        EXPECT_LE(inertia.maxCoeff(), rule.childRatio * ofParent.minCoeff() * 1.0001f) << part.name;
    }
    // Obeyed already: nothing more to do.
    RagdollSettings again = settings;
    ASSERT_TRUE(StabilizeInertia(again, rule));
    for (size_t i = 0; i < again.parts.size(); ++i)
        EXPECT_LE((again.parts[i].body.inertia - settings.parts[i].body.inertia).norm(),
                  1e-6f * again.parts[i].body.inertia.norm());
}

TEST(Stabilize, ErrorsNameTheFieldAndChangeNothing) {
    RagdollSettings settings = Chain({10, 100});
    const auto expect = [&](const Status& status, ErrorCode code, const char* start) {
        ASSERT_FALSE(status);
        EXPECT_EQ(status.GetError().code, code);
        EXPECT_TRUE(status.GetError().message.starts_with(start)) << status.GetError().message;
        EXPECT_EQ(settings.parts[1].body.mass, 100);
        EXPECT_TRUE(settings.parts[1].body.inertia.isZero(0));
    };
    expect(StabilizeMasses(settings, {.smallest = 0, .largest = 1}), ErrorCode::NonPositive, "smallest");
    expect(StabilizeMasses(settings, {.smallest = 2, .largest = 1}), ErrorCode::OutOfRange, "smallest");
    expect(StabilizeInertia(settings, {.principalRatio = 0.5f, .childRatio = 1}), ErrorCode::OutOfRange,
           "principalRatio");
    expect(StabilizeInertia(settings, {.principalRatio = 2, .childRatio = -1}), ErrorCode::NonPositive, "childRatio");
    settings.parts[0].name.clear();
    expect(StabilizeMasses(settings), ErrorCode::Degenerate, "parts[0].name");
    expect(StabilizeInertia(settings), ErrorCode::Degenerate, "parts[0].name");
}

// A heavy end on light links, hung up and let go sideways: the gap of the joints where they are solved by iteration
// alone.
double GapOf(const RagdollSettings& settings) {
    SystemSettings system;
    system.exactJointLoad = std::numeric_limits<float>::infinity();
    TestWorld world(system);
    const Result<Ragdoll> ragdoll =
        Ragdoll::Create(world.System(), settings, {Position::Zero(), RotationAbout(Vector3(0, 0, 1), 90 * kDegree)});
    EXPECT_TRUE(ragdoll) << ragdoll.GetError().message;
    double largest = 0;
    for (int step = 0; step < 240; ++step) {
        world.Step();
        for (size_t i = 1; i < settings.parts.size(); ++i)
            largest = std::max<double>(largest, world.System().Joints().GetError(ragdoll.Value().Joints()[i]).distance);
    }
    return largest;
}

TEST(Stabilize, HoldsAHeavyEndOnLightLinks) {
    RagdollSettings settings = Chain({1, 1, 1, 1, 1, 200});
    settings.parts[0].body.motion = MotionType::Static;
    const double before = GapOf(settings);
    ASSERT_TRUE(StabilizeMasses(settings));
    ASSERT_TRUE(StabilizeInertia(settings));
    const double after = GapOf(settings);
    EXPECT_LT(after, 0.25 * before);
}

}  // namespace
}  // namespace fulcrum::testing
