// Every call that changes the world is recorded, and recording changes nothing.
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Physics/Recording/PublicCalls.h>
#include <Fulcrum/UnitTests/Physics/Recording/RecordedProgram.h>
#include <Fulcrum/UnitTests/Support/FailingMemory.h>
#include <Fulcrum/UnitTests/Support/FullDisk.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/PublicHeaders.h>

#include <filesystem>
#include <set>

namespace fulcrum::testing {
namespace {

std::set<std::string> RecordedCalls() {
    std::set<std::string> names;
    std::apply(
        [&](const auto&... call) {
            for (std::string name : {call.name...}) names.insert(name.substr(0, name.find(' ')));
        },
        kPublicCalls);
    return names;
}

// From the headers: a function that is not const changes the world. It is in the table, or made of calls that are.
TEST(CallRecorder, KnowsEveryCallThatChangesTheWorld) {
    const std::set<std::string> madeOfOthers = {
        "BodyInterface::SetPose",           // SetPoses
        "BodyInterface::AddRadialImpulse",  // AddImpulseAt
        "JointInterface::CreateTarget",     // Create
    };
    const std::set<std::string> notOfTheWorld = {
        "PhysicsSystem::SetStepObserver", "PhysicsSystem::SetCallObserver",                           // who looks on
        "PhysicsSystem::Bodies",          "PhysicsSystem::LockingBodies",   "PhysicsSystem::Joints",  // the interfaces
        "PhysicsSystem::HoldForChanges",
    };
    std::set<std::string> recorded = RecordedCalls();
    int functions = 0;
    for (const char* type : {"PhysicsSystem", "BodyInterface", "JointInterface"}) {
        for (const PublicFunction& function : PublicFunctionsOf("Physics/" + std::string(type) + ".h", type)) {
            if (function.isConst || function.isStatic) continue;
            ++functions;
            const std::string name = std::string(type) + "::" + function.name;
            const bool isKnown = recorded.contains(name);
            EXPECT_EQ(isKnown + madeOfOthers.contains(name) + notOfTheWorld.contains(name), 1)
                << name << ": a line in Physics/Recording/PublicCalls.h, and a WorldChange in its first line";
        }
    }
    EXPECT_GE(functions, 60);
}

class CountedCalls final : public CallObserver {
public:
    void BeginCall(const void* function, std::span<const void* const>) override { calls.push_back(function); }
    void NoteCreated(const void*) override { ++created; }
    void EndStep(uint64_t hash) override { hashes.push_back(hash); }
    std::vector<const void*> calls;
    int created = 0;
    std::vector<uint64_t> hashes;
};

TEST(CallObserver, SeesEachCallOnceAndCallsMadeOfOthersAsThose) {
    TestWorld world;
    CountedCalls seen;
    world.System().SetCallObserver(&seen);
    const auto expect = [&](std::initializer_list<const void*> calls) {
        EXPECT_TRUE(std::ranges::equal(seen.calls, calls)) << seen.calls.size();
        seen.calls.clear();
    };
    BodyInterface& bodies = world.Bodies();
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {0, 2, 0}});
    const BodyId bar = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Kinematic, .position = {5, 0, 0}});
    expect({&kCallTag<&BodyInterface::Create>, &kCallTag<&BodyInterface::Create>});
    EXPECT_EQ(seen.created, 2);
    ASSERT_TRUE(bodies.MoveKinematic(bar, {6, 0, 0}, {}, 1));
    ASSERT_TRUE(bodies.AddForceAt(ball, {1, 0, 0}, {0, 3, 0}));
    ASSERT_TRUE(bodies.AddImpulseAt(ball, {1, 0, 0}, {0, 3, 0}));
    expect({&kCallTag<&BodyInterface::MoveKinematic>, &kCallTag<&BodyInterface::AddForceAt>,
            &kCallTag<&BodyInterface::AddImpulseAt>});
    ASSERT_TRUE(bodies.SetPose(ball, {0, 1, 0}, {}));
    ASSERT_EQ(bodies.AddRadialImpulse({.center = {1, 1, 0}, .radius = 2, .impulse = 1}).Value(), 1u);
    ASSERT_TRUE(world.System().Joints().CreateTarget({.body = ball, .anchor = {0, 1, 0}, .target = {0, 2, 0}}));
    expect({&kCallTag<&BodyInterface::SetPoses>, &kCallTag<&BodyInterface::AddImpulseAt>,
            &kCallTag<&JointInterface::Create<SixDofJointSettings>>});
    std::vector<std::byte> some;
    ASSERT_TRUE(world.System().SaveBodies({&ball, 1}, some));
    ASSERT_TRUE(world.System().RestoreBodies(some));
    expect({&kCallTag<&PhysicsSystem::RestoreBodies>});
    world.Step();
    expect({&kCallTag<&PhysicsSystem::Update>});
    ASSERT_EQ(seen.hashes.size(), 1u);
    EXPECT_EQ(seen.hashes[0], world.System().HashState());
    world.System().SetCallObserver(nullptr);
    world.Step();
    expect({});
}

// Calls from callbacks of a step are refused, by any thread: they are not seen either.
TEST(CallObserver, DoesNotSeeCallsFromCallbacks) {
    class Meddler final : public ContactListener {
    public:
        explicit Meddler(PhysicsSystem& system) : system_(system) {}
        void ModifyContact(const ContactView& contact, ContactChange&) const override {
            EXPECT_FALSE(system_.Bodies().Wake(contact.bodyA));
        }

    private:
        PhysicsSystem& system_;
    };
    TestWorld world({}, 4);
    world.AddFloor();
    for (int i = 0; i < 20; ++i) world.Add({.shape = SphereOf(0.5f), .position = {2.0 * i, 0.5, 0}});
    const Meddler meddler(world.System());
    world.System().SetContactListener(&meddler);
    CountedCalls seen;
    world.System().SetCallObserver(&seen);
    world.Steps(3);
    EXPECT_EQ(seen.calls.size(), 3u);
    world.System().SetContactListener(nullptr);
}

TEST(CallRecorder, ChangesNothing) {
    const auto hashOf = [](bool records) {
        TestWorld world;
        Bytes bytes;
        std::unique_ptr<CallRecorder> recorder;
        if (records) recorder = CallRecorder::Create(world.System(), SinkInto(bytes)).Value();
        MixedScene scene(world);
        for (int step = 0; step < 60; ++step) {
            scene.BeforeStep(step);
            world.Step();
        }
        return world.System().HashState();
    };
    EXPECT_EQ(hashOf(true), hashOf(false));
}

TEST(CallRecorder, StoresShapesOnce) {
    TestWorld world;
    std::vector<Vector3> points;
    for (int i = 0; i < 60; ++i)
        points.push_back(Rotate(RotationAbout({0, 1, 0}, i * 0.7), Vector3(1, 0.5f * static_cast<float>(i % 3), 0)));
    const ShapePtr hull = ConvexHull::Create(points).Value();
    const Bytes one = RecordingOf(world.System(), [&] { world.Add({.shape = hull}); });
    const Bytes two = RecordingOf(world.System(), [&] {
        world.Add({.shape = hull, .position = {5, 0, 0}});
        world.Add({.shape = hull, .position = {9, 0, 0}});
    });
    const size_t shape = SaveShape(*hull).Value().size();
    EXPECT_GT(one.size(), shape);
    EXPECT_LT(two.size(), 2 * shape + one.size());
}

TEST(CallRecorder, SaysWhenItCannotWrite) {
    TestWorld world;
    size_t written = 0;
    const auto recorder = CallRecorder::Create(world.System(), [&](std::span<const std::byte> bytes) {
        written += bytes.size();
        return written < 40000;
    });
    ASSERT_TRUE(recorder);
    world.AddFloor();
    for (int i = 0; i < 50; ++i) world.Add({.shape = SphereOf(0.5f), .position = {2.0 * i, 5, 0}});
    world.Steps(200);
    const Status status = recorder.Value()->GetStatus();
    ASSERT_FALSE(status);
    EXPECT_NE(status.GetError().message.find("could not be written"), std::string::npos);
    EXPECT_FALSE(CallRecorder::ToFile(world.System(), "/no/such/folder/file.calls"));
}

TEST(CallRecorder, WritesAFile) {
    const std::string file = (std::filesystem::temp_directory_path() / "fulcrum-recorder-test.calls").string();
    TestWorld world;
    {
        const auto recorder = CallRecorder::ToFile(world.System(), file);
        ASSERT_TRUE(recorder) << recorder.GetError().message;
        world.AddFloor();
        world.Add({.shape = SphereOf(0.5f), .position = {0, 2, 0}});
        world.Steps(30);
    }
    const auto recording = CallRecording::ReadFile(file);
    ASSERT_TRUE(recording) << recording.GetError().message;
    const Result<ReplayReport> report = Replay(recording.Value());
    ASSERT_TRUE(report);
    EXPECT_EQ(report.Value().stateHash, world.System().HashState());
    EXPECT_EQ(report.Value().calls, 32u);
    std::filesystem::remove(file);
    EXPECT_FALSE(CallRecording::ReadFile(file));
}

// A custom shape is given by the program, or by its format.
class Lens final : public CustomConvex {
public:
    explicit Lens(float radius) : CustomConvex(0), radius_(radius) {}
    Vector3 FarthestPoint(const Vector3& direction) const override {
        const float length = Length(direction);
        return length > 0 ? Vector3(direction * (radius_ / length)) : Vector3(radius_, 0, 0);
    }

private:
    float radius_;
};

// Of a disk that is full from the beginning, and of one that is full later.
TEST(CallRecorder, LeavesAnOlderFileWhereItCannotWriteItsBeginning) {
    const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "full_disk_test.calls";
    ASSERT_TRUE(WriteWholeFile(file, {"older"}));
    {
        TestWorld world;
        const FullDisk disk(100);
        EXPECT_FALSE(CallRecorder::ToFile(world.System(), file.string()));
    }
    EXPECT_EQ(ReadWholeFile(file).Value(), "older");
    EXPECT_FALSE(CallRecording::ReadFile(file.string()));
    {
        TestWorld world;
        const FullDisk disk(10'000);
        const auto recorder = CallRecorder::ToFile(world.System(), file.string());
        ASSERT_TRUE(recorder) << recorder.GetError().message;
        for (int i = 0; i < 500 && recorder.Value()->GetStatus(); ++i) world.Step();
        EXPECT_FALSE(recorder.Value()->GetStatus());
    }
    const auto recording = CallRecording::ReadFile(file.string());
    ASSERT_TRUE(recording) << recording.GetError().message;
    EXPECT_FALSE(recording.Value().IsComplete());
    EXPECT_GT(recording.Value().Steps(), 10u);
    std::filesystem::remove(file);
}

TEST(CallRecording, OfWhatIsNoFileIsAnError) {
    TestWorld world;
    for (const std::string& file : {::testing::TempDir(), std::string("/dev/zero"), std::string("/nowhere/a.calls")}) {
        const auto recording = CallRecording::ReadFile(file);
        ASSERT_FALSE(recording) << file;
        EXPECT_TRUE(recording.GetError().message.starts_with(file)) << recording.GetError().message;
    }
    for (const std::string& file : {::testing::TempDir(), std::string("/dev/full"), std::string("/nowhere/a.calls")})
        EXPECT_EQ(CallRecorder::ToFile(world.System(), file).GetError().code, ErrorCode::Unsupported) << file;
}

TEST(CallRecorder, NamesCustomShapesByTheirContent) {
    const ShapePtr lens = CreateCustom<Lens>(0.4f).Value(), other = CreateCustom<Lens>(0.5f).Value();
    TestWorld world;
    const Bytes bytes = RecordingOf(world.System(), [&] {
        world.AddFloor();
        world.Add({.shape = lens, .position = {0, 2, 0}});
        world.Steps(40);
    });
    const ShapePtr shapes[] = {other, lens};
    ExpectSameReplays(bytes, world.System().HashState(), {.shapes = shapes});
    const Result<ReplayReport> without = Replay(Parsed(bytes), {.sources = {.shapes = {shapes, 1}}});
    ASSERT_FALSE(without);
    EXPECT_NE(without.GetError().message.find("ReplaySources::shapes"), std::string::npos);
}

// A call that runs out of memory has had no effect, and is not in the recording: the replay would make it.
TEST(CallRecorder, DoesNotRecordWhatRanOutOfMemory) {
    FailingMemory memory;
    const auto system = PhysicsSystem::Create({}, nullptr, &memory).Value();
    const ShapePtr cube = CubeOf(0.5f);
    const Bytes bytes = RecordingOf(*system, [&] {
        const BodyId first = system->Bodies().Create({.shape = cube}).Value();
        ASSERT_TRUE(system->Update(kStep));
        memory.FailAt(1);
        EXPECT_THROW((void)bool(system->Bodies().SetPose(first, {0, 5, 0}, {})), std::bad_alloc);
        ASSERT_TRUE(system->Bodies().SetVelocity(first, {1, 0, 0}, {}));
        ASSERT_TRUE(system->Update(kStep));
    });
    ExpectSameReplays(bytes, system->HashState());
}

}  // namespace
}  // namespace fulcrum::testing
