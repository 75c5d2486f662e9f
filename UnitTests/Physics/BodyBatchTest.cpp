// Bodies and joints that are checked beforehand and created together.
#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/UnitTests/Physics/Recording/RecordedProgram.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/JointScene.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <future>

namespace fulcrum::testing {
namespace {

std::vector<BodySettings> ManyBodies() {
    std::vector<BodySettings> bodies;
    RandomPoses random(4);
    const ShapePtr shapes[] = {
        SphereOf(0.3f), CubeOf(0.3f), CapsuleOf(0.3f, 0.2f),
        CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.4f, 0, 0}}})};
    for (int i = 0; i < 200; ++i) {
        const Vector3 at = random.InBox(5);
        bodies.push_back({.shape = shapes[i % 4],
                          .motion = i % 7 == 0 ? MotionType::Static : MotionType::Dynamic,
                          .position = (at + Vector3(0, 6, 0)).cast<double>(),
                          .rotation = random.Rotation(),
                          .startAsleep = i % 7 != 0 && i % 11 == 0,
                          .isSensor = i % 13 == 0});
    }
    return bodies;
}

TEST(BodyBatch, AreTheSameBodiesAsOneByOne) {
    TestWorld together, alone;
    for (TestWorld* world : {&together, &alone}) world->AddFloor();
    const Result<BodyBatch> batch = BodyBatch::Prepare(ManyBodies());
    ASSERT_TRUE(batch);
    const Result<BatchIds> ids = together.Bodies().Commit(batch.Value());
    ASSERT_TRUE(ids);
    std::vector<BodyId> expected;
    for (const BodySettings& settings : ManyBodies()) expected.push_back(alone.Add(settings));
    EXPECT_EQ(ids.Value().bodies, expected);
    EXPECT_TRUE(ids.Value().joints.empty());
    for (int step = 0; step < 60; ++step) {
        ASSERT_EQ(together.System().HashState(), alone.System().HashState()) << step;
        together.Step();
        alone.Step();
    }
}

TEST(BodyBatch, IsRefusedAsAWholeAndNamesTheBody) {
    std::vector<BodySettings> bodies = ManyBodies();
    bodies[57].density = -1;
    const Result<BodyBatch> batch = BodyBatch::Prepare(bodies);
    ASSERT_FALSE(batch);
    EXPECT_NE(batch.GetError().message.find("bodies[57]: "), std::string::npos) << batch.GetError().message;
    bodies[3].shape = nullptr;
    EXPECT_NE(BodyBatch::Prepare(bodies).GetError().message.find("bodies[3]: "), std::string::npos);
    TestWorld world;
    EXPECT_TRUE(world.Bodies().Commit(BodyBatch::Prepare({}).Value()).Value().bodies.empty());
}

TEST(BodyBatch, IsPreparedWhileTheWorldSteps) {
    TestWorld world({}, 2);
    world.AddFloor();
    for (int round = 0; round < 5; ++round) {
        std::future<Result<BodyBatch>> next =
            std::async(std::launch::async, [] { return BodyBatch::Prepare(ManyBodies()); });
        for (int step = 0; step < 5; ++step) world.Step();
        const Result<BodyBatch> batch = next.get();
        ASSERT_TRUE(batch);
        const Result<BatchIds> ids = world.Bodies().Commit(batch.Value());
        ASSERT_TRUE(ids);
        world.Steps(3);
        for (const BodyId id : ids.Value().bodies) ASSERT_TRUE(world.Bodies().Remove(id));
    }
    EXPECT_TRUE(world.AllFinite());
}

// ---- Joints

// A joint of every kind, each to the body before and, in turn, to the world or a body that is there already.
std::vector<BodyBatch::Joint> JointsOfEveryKind(BodyId there) {
    std::vector<BodyBatch::Joint> joints;
    const auto add = [&](auto settings) {
        const auto index = static_cast<uint32_t>(joints.size());
        settings.bodyB = BodyBatch::Body(index + 1);
        settings.bodyA = index % 5 == 0 ? there : index % 5 == 1 ? kWorldBody : BodyBatch::Body(index);
        settings.anchorA.point = {0.6 * index, 5, 0};
        settings.userData = index;
        using Settings = decltype(settings);
        if constexpr (std::is_same_v<Settings, DistanceJointSettings>) settings.maxDistance = 2;
        if constexpr (std::is_same_v<Settings, HingeJointSettings>)
            settings.angle.motor = {.mode = MotorMode::ToVelocity, .targetSpeed = 1};
        if constexpr (std::is_same_v<Settings, PulleyJointSettings>)
            settings.fixedPointA = settings.fixedPointB = {0.6 * index, 9, 0};
        if constexpr (std::is_same_v<Settings, CustomJointSettings>) settings.make = MakeScrew;
        joints.emplace_back(settings);
    };
#define FULCRUM_ADD(kind) add(kind##JointSettings{});
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_ADD)
#undef FULCRUM_ADD
    return joints;
}

std::vector<BodySettings> BoxesInARow(size_t count) {
    std::vector<BodySettings> boxes;
    for (size_t i = 0; i < count; ++i)
        boxes.push_back({.shape = CubeOf(0.2f), .position = {0.6 * static_cast<double>(i), 5, 0}});
    return boxes;
}

TEST(BodyBatch, HasTheSameJointsAsOneByOne) {
    TestWorld together, alone;
    std::vector<BodyBatch::Joint> joints;
    std::vector<BodySettings> boxes;
    for (TestWorld* world : {&together, &alone}) {
        world->AddFloor();
        joints = JointsOfEveryKind(world->Add({.shape = SphereOf(0.3f), .position = {-1, 5, 0}}));
        boxes = BoxesInARow(joints.size() + 1);
    }
    const Result<BodyBatch> batch = BodyBatch::Prepare(boxes, joints);
    ASSERT_TRUE(batch) << batch.GetError().message;
    const Result<BatchIds> ids = together.Bodies().Commit(batch.Value());
    ASSERT_TRUE(ids) << ids.GetError().message;
    BatchIds expected;
    for (const BodySettings& settings : boxes) expected.bodies.push_back(alone.Add(settings));
    for (BodyBatch::Joint& joint : joints) {
        for (BodyId* const body : {&CommonOf(joint).bodyA, &CommonOf(joint).bodyB})
            if (BodyBatch::IsBody(*body)) *body = expected.bodies[BodyBatch::IndexOf(*body)];
        const auto create = [&](const auto& settings) { return alone.System().Joints().Create(settings).Value(); };
        expected.joints.push_back(std::visit(create, joint));
    }
    EXPECT_EQ(ids.Value(), expected);
    for (size_t i = 0; i < joints.size(); ++i) {
        EXPECT_EQ(together.System().Joints().GetUserData(ids.Value().joints[i]), i);
        EXPECT_EQ(together.System().Joints().GetBodyB(ids.Value().joints[i]), ids.Value().bodies[i + 1]);
    }
    for (int step = 0; step < 60; ++step) {
        ASSERT_EQ(together.System().HashState(), alone.System().HashState()) << step;
        together.Step();
        alone.Step();
    }
}

// The chain hangs still below its hook, whose joint carries the weight of all its links.
TEST(BodyBatch, AChainThatIsStreamedInHangs) {
    constexpr int kLinks = 8;
    constexpr float kLength = 0.5f, kMass = 2;
    TestWorld world({}, 2);
    auto load = std::async(std::launch::async, [&] {
        std::vector<BodySettings> links;
        std::vector<BodyBatch::Joint> joints;
        for (uint32_t i = 0; i < kLinks; ++i) {
            links.push_back({.shape = BoxOf(0.05f, kLength / 2, 0.05f),
                             .position = {0, 10 - kLength * (i + 0.5), 0},
                             .mass = kMass});
            PointJointSettings joint;
            joint.bodyA = i == 0 ? kWorldBody : BodyBatch::Body(i - 1);
            joint.bodyB = BodyBatch::Body(i);
            joint.anchorA.point = {0, 10 - double{kLength} * i, 0};
            joints.emplace_back(joint);
        }
        return BodyBatch::Prepare(std::move(links), std::move(joints));
    });
    world.Steps(5);
    const Result<BodyBatch> batch = load.get();
    ASSERT_TRUE(batch) << batch.GetError().message;
    const BatchIds ids = world.Bodies().Commit(batch.Value()).Value();
    world.Run(2);
    const JointInterface& joints = world.System().Joints();
    for (uint32_t i = 0; i < kLinks; ++i) {
        EXPECT_NEAR(world.PositionOf(ids.bodies[i]).y(), 10 - kLength * (i + 0.5), 0.01);  // of 4 m
        EXPECT_NEAR(Length(joints.GetForce(ids.joints[i])), (kLinks - static_cast<float>(i)) * kMass * kGravity, 0.5);
    }
    // To abort is to drop the batch; to remove the bodies is to remove their joints.
    for (const BodyId id : ids.bodies) ASSERT_TRUE(world.Bodies().Remove(id));
    for (const JointId id : ids.joints) EXPECT_FALSE(joints.Exists(id));
}

TEST(BodyBatch, NamesTheJointThatIsWrong) {
    std::vector<BodySettings> bodies = BoxesInARow(3);
    bodies[2].motion = MotionType::Static;
    const auto errorOf = [&](BodyId a, BodyId b, float breakForce = 1) {
        HingeJointSettings good, joint;
        good.bodyA = kWorldBody;
        good.bodyB = BodyBatch::Body(0);
        joint.bodyA = a;
        joint.bodyB = b;
        joint.breakForce = breakForce;
        const Result<BodyBatch> batch = BodyBatch::Prepare(bodies, {good, joint});
        if (batch) return Error{};
        EXPECT_EQ(batch.GetError().message.substr(0, 11), "joints[1]: ");
        return batch.GetError();
    };
    EXPECT_EQ(errorOf(BodyBatch::Body(0), BodyBatch::Body(3)).code, ErrorCode::UnknownId);
    EXPECT_EQ(errorOf(BodyBatch::Body(3), BodyBatch::Body(0)).code, ErrorCode::UnknownId);
    EXPECT_EQ(errorOf(BodyBatch::Body(1), BodyBatch::Body(1)).code, ErrorCode::Unsupported);
    EXPECT_EQ(errorOf(kWorldBody, BodyBatch::Body(2)).code, ErrorCode::Unsupported);
    EXPECT_EQ(errorOf(BodyBatch::Body(0), BodyBatch::Body(1), -1).code, ErrorCode::NonPositive);
    EXPECT_TRUE(errorOf(BodyBatch::Body(0), BodyBatch::Body(1)).message.empty());
    EXPECT_TRUE(errorOf({5, 7}, BodyBatch::Body(1)).message.empty());  // known when it is added
}

// What became wrong after it was prepared is refused as a whole, and no bit has changed.
TEST(BodyBatch, AJointThatIsRefusedLeavesTheWorldAsItWas) {
    TestWorld world;
    world.AddFloor();
    const BodyId hook = world.Add({.shape = SphereOf(0.1f), .position = {0, 6, 0}});
    world.Steps(3);
    std::vector<BodyBatch::Joint> joints = JointsOfEveryKind(hook);
    PointJointSettings last;
    last.bodyA = hook;
    last.bodyB = BodyBatch::Body(0);
    joints.emplace_back(last);
    const auto refusal = [&](const std::vector<BodySettings>& bodies) {
        const BodyBatch batch = BodyBatch::Prepare(bodies, joints).Value();
        const uint64_t before = world.System().HashState();
        const Result<BatchIds> ids = world.Bodies().Commit(batch);
        EXPECT_FALSE(ids);
        EXPECT_EQ(world.System().HashState(), before);
        return ids ? Error{} : ids.GetError();
    };
    std::vector<BodySettings> boxes = BoxesInARow(joints.size());
    boxes[0].motion = MotionType::Static;
    ASSERT_TRUE(world.Bodies().SetMotionType(hook, MotionType::Kinematic));
    const Error bothFixed = refusal(boxes);
    EXPECT_EQ(bothFixed.code, ErrorCode::Unsupported);
    EXPECT_EQ(bothFixed.message.substr(0, 12), "joints[14]: ");
    ASSERT_TRUE(world.Bodies().Remove(hook));
    const Error unknown = refusal(boxes);
    EXPECT_EQ(unknown.code, ErrorCode::UnknownId);
    EXPECT_EQ(unknown.message.substr(0, 18), "joints[0]: bodyA: ");
    CustomJointSettings custom;
    custom.bodyA = kWorldBody;
    custom.bodyB = BodyBatch::Body(1);
    custom.make = [] { return std::unique_ptr<JointType>(); };
    joints = {custom};
    EXPECT_NE(refusal(boxes).message.find("joints[0]: make"), std::string::npos);
    // A batch may be added again, as other bodies.
    custom.make = MakeScrew;
    const BodyBatch batch = BodyBatch::Prepare(boxes, {custom}).Value();
    const BatchIds first = world.Bodies().Commit(batch).Value(), second = world.Bodies().Commit(batch).Value();
    EXPECT_NE(first.bodies[0], second.bodies[0]);
    EXPECT_NE(first.joints[0], second.joints[0]);
    world.Steps(10);
    EXPECT_TRUE(world.AllFinite());
}

// Elsewhere the ids of a batch are those of no body.
TEST(BodyBatch, ItsIdsAreOfNoWorld) {
    TestWorld world;
    world.AddFloor();
    const uint64_t before = world.System().HashState();
    EXPECT_FALSE(world.Bodies().Exists(BodyBatch::Body(0)));
    EXPECT_FALSE(world.Bodies().Remove(BodyBatch::Body(0)));
    PointJointSettings joint;
    joint.bodyA = kWorldBody;
    joint.bodyB = BodyBatch::Body(0);
    EXPECT_FALSE(world.System().Joints().Create(joint));
    EXPECT_EQ(world.System().HashState(), before);
    EXPECT_FALSE(BodyBatch::IsBody(kWorldBody));
    EXPECT_FALSE(BodyBatch::IsBody(BodyId{}));
}

TEST(BodyBatch, IsRecordedAndReplayedWithItsJoints) {
    TestWorld world;
    const Bytes bytes = RecordingOf(world.System(), [&] {
        const BodyId there = world.Add({.shape = SphereOf(0.3f), .position = {-1, 5, 0}});
        const std::vector<BodyBatch::Joint> joints = JointsOfEveryKind(there);
        const BodyBatch batch = BodyBatch::Prepare(BoxesInARow(joints.size() + 1), joints).Value();
        ASSERT_TRUE(world.Bodies().Commit(batch));
        world.Steps(10);
        ASSERT_TRUE(world.Bodies().Remove(there));
        ASSERT_FALSE(world.Bodies().Commit(batch));  // refused in the replay, too
        world.Steps(10);
    });
    ExpectSameReplays(bytes, world.System().HashState(), {.makeJoint = [](JointId) { return MakeScrew(); }});
}

// Memory grows as vectors do, however many batches it takes.
TEST(BodyBatch, ManySmallOnesDoNotCopyEverythingEachTime) {
    TestWorld world;
    const BodyBatch batch = BodyBatch::Prepare({{.shape = CubeOf(0.1f), .motion = MotionType::Static}}).Value();
    const uint64_t before = AllocationCount();
    for (int i = 0; i < 4000; ++i) ASSERT_TRUE(world.Bodies().Commit(batch));
    // The ids of each and the list of what its bodies will own, and the growth of some twenty buffers.
    EXPECT_LT(AllocationCount() - before, 2 * 4000u + 800);
}

}  // namespace
}  // namespace fulcrum::testing
