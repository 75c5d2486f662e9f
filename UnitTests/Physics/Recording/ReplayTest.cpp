// A program that was recorded is played again with the same bits, whatever it called; where it differs, the step and
// the body are named.
#include <Fulcrum/Math/Hash.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/UnitTests/Physics/Recording/RecordedProgram.h>
#include <Fulcrum/UnitTests/Random/Program.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/JointScene.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/SurfaceScene.h>

#include <algorithm>
#include <cstring>

namespace fulcrum::testing {
namespace {

template <class Scene>
void ExpectSceneReplays(const SystemSettings& settings, int steps, const ReplaySources& sources = {}) {
    TestWorld world(settings);
    const Bytes bytes = RecordingOf(world.System(), [&] {
        Scene scene(world);
        for (int step = 0; step < steps; ++step) {
            scene.BeforeStep(step);
            world.Step();
        }
    });
    ExpectSameReplays(bytes, world.System().HashState(), sources);
}

TEST(Replay, OfOneOfEverythingHasTheSameBits) { ExpectSceneReplays<MixedScene>({}, 120); }

TEST(Replay, OfJointsOfEveryKindHasTheSameBits) {
    ExpectSceneReplays<JointScene>(JointScene::Settings(), 60, {.makeJoint = [](JointId) { return MakeScrew(); }});
}

// Notes what a recording does not contain: listeners, in the order in which they are set, and custom shapes.
class OwnObjects final : public CallObserver {
public:
    void BeginCall(const void* function, std::span<const void* const> arguments) override {
        if (function == &kCallTag<&PhysicsSystem::SetContactListener>) {
            const auto* const listener = *static_cast<const ContactListener* const*>(arguments[0]);
            if (listener && std::ranges::find(listeners, listener) == listeners.end()) listeners.push_back(listener);
        }
        using Child = CompoundShape::ChildSettings;
        if (function == &kCallTag<&BodyInterface::Create>)
            shapes.push_back(static_cast<const BodySettings*>(arguments[0])->shape);
        if (function == &kCallTag<&BodyInterface::SetShape>)
            shapes.push_back(*static_cast<const ShapePtr*>(arguments[1]));
        if (function == &kCallTag<&BodyInterface::AddChild>)
            shapes.push_back(static_cast<const Child*>(arguments[1])->shape);
        if (function == &kCallTag<&BodyInterface::SetChild>)
            shapes.push_back(static_cast<const Child*>(arguments[2])->shape);
    }
    void NoteCreated(const void*) override {}
    void EndStep(uint64_t) override {}
    std::vector<const ContactListener*> listeners;
    std::vector<ShapePtr> shapes;
};

// Calls of every kind, refused ones among them, on all kinds of shapes.
TEST(Replay, OfRandomProgramsHasTheSameBits) {
    SetMisuseHandler([](const Error&) {});
    const auto play = [](const RandomProgram& program, Twin& twin) {
        for (const RandomCall& call : program.calls) {
            Outcome outcome;
            Values values(call.seed, program.style);
            call.kind->play(twin, values, call.targets, outcome);
        }
    };
    uint64_t calls = 0;
    for (uint32_t seed = 1; seed <= Cases(60); ++seed) {
        SCOPED_TRACE("program " + std::to_string(seed));
        const RandomProgram program = MakeProgram(seed);
        OwnObjects own;
        Twin first({}, nullptr), second({}, nullptr);
        first.system->SetCallObserver(&own);
        play(program, first);
        const Bytes bytes = RecordingOf(*second.system, [&] { play(program, second); });
        ExpectSameReplays(bytes, second.system->HashState(), {.shapes = own.shapes, .contactListeners = own.listeners});
        if (HasFailure()) break;
        calls += Parsed(bytes).Calls();
    }
    SetMisuseHandler(nullptr);
    EXPECT_GT(calls, 1000u / (kIsSanitized ? 10 : 1));
}

TEST(Replay, BeginsInTheMiddleOfAGame) {
    TestWorld world;
    MixedScene scene(world);
    for (int step = 0; step < 50; ++step) {
        scene.BeforeStep(step);
        world.Step();
    }
    const Bytes bytes = RecordingOf(world.System(), [&] {
        for (int step = 50; step < 100; ++step) {
            scene.BeforeStep(step);
            world.Step();
        }
    });
    ExpectSameReplays(bytes, world.System().HashState());
}

TEST(Replay, OfAGameThatGoesBackHasTheSameBits) {
    TestWorld world;
    const Bytes bytes = RecordingOf(world.System(), [&] {
        world.AddFloor();
        std::vector<BodyId> boxes;
        for (int i = 0; i < 10; ++i)
            boxes.push_back(world.Add({.shape = CubeOf(0.3f), .position = {0.1 * i, 1.0 + i, 0}}));
        Bytes frame, some;
        ASSERT_TRUE(world.System().SaveSnapshot(frame));
        ASSERT_TRUE(world.System().SaveBodies(boxes, some));
        world.Steps(30);
        ASSERT_TRUE(world.System().RestoreSnapshot(frame));
        ASSERT_TRUE(world.Bodies().Remove(boxes[3]));
        world.Steps(20);
        ASSERT_FALSE(world.System().RestoreBodies(some));
        ASSERT_TRUE(world.System().SaveBodies({boxes.data(), 3}, some));
        world.Steps(20);
        ASSERT_TRUE(world.System().RestoreBodies(some));
        world.Steps(20);
    });
    ExpectSameReplays(bytes, world.System().HashState());
}

// ---- Divergence

constexpr int kBoxes = 20;
constexpr double kSecondImpulse = 7.25;

// Boxes apart from each other on a floor; two of them are pushed before step 31. `spoil` may do more before it.
Bytes PushedBoxes(const std::function<void(TestWorld&, std::span<const BodyId>)>& spoil = {},
                  bool pushesByForce = false) {
    TestWorld world;
    return RecordingOf(world.System(), [&] {
        world.AddFloor();
        std::vector<BodyId> boxes;
        for (int i = 0; i < kBoxes; ++i)
            boxes.push_back(world.Add({.shape = CubeOf(0.3f), .position = {3.0 * i, 0.3, 0}}));
        world.Steps(30);
        if (spoil) spoil(world, boxes);
        const Vector3 push(0, 0, static_cast<float>(kSecondImpulse));
        if (pushesByForce) EXPECT_TRUE(world.Bodies().AddForce(boxes[7], push * 60.0f));
        else EXPECT_TRUE(world.Bodies().AddImpulse(boxes[7], push));
        world.Steps(30);
    });
}

// The recording with the argument 7.25, which is there once, by another number: as after an error in memory, but valid.
Bytes Tampered(Bytes bytes, float from, float to) {
    constexpr size_t kHead = 12, kPiece = 24;
    size_t places = 0;
    for (size_t at = kHead; at < bytes.size();) {
        uint64_t size = 0;
        std::memcpy(&size, bytes.data() + at, sizeof size);
        for (size_t i = at + kPiece; i + sizeof from <= at + kPiece + size; ++i) {
            if (std::memcmp(bytes.data() + i, &from, sizeof from) != 0) continue;
            ++places;
            std::memcpy(bytes.data() + i, &to, sizeof to);
        }
        const uint64_t hash = HashBytes(bytes.data() + at + kPiece, size);
        std::memcpy(bytes.data() + at + 16, &hash, sizeof hash);
        at += kPiece + size;
    }
    EXPECT_EQ(places, 1u);
    return bytes;
}

void ExpectDivergence(const Bytes& bytes, uint64_t step, bool isInStep, uint32_t body) {
    const Result<ReplayReport> report = Replay(Parsed(bytes));
    ASSERT_TRUE(report) << report.GetError().message;
    ASSERT_TRUE(report.Value().divergence);
    const Divergence& divergence = *report.Value().divergence;
    EXPECT_EQ(divergence.step, step) << divergence.what;
    EXPECT_EQ(divergence.isInStep, isInStep) << divergence.what;
    EXPECT_EQ(divergence.bodiesStep, step) << divergence.what;
    ASSERT_EQ(divergence.bodies.size(), 1u) << divergence.what;
    EXPECT_EQ(divergence.bodies[0].index, body);
    EXPECT_NE(divergence.what.find("body " + std::to_string(body)), std::string::npos) << divergence.what;
    EXPECT_NE(divergence.what.find("step " + std::to_string(step)), std::string::npos) << divergence.what;
    EXPECT_LE(report.Value().steps, step);  // it has stopped
}

// The boxes follow the floor: body 8 is box 7.
TEST(Replay, NamesTheStepAndTheBodyOfACallThatDiffers) {
    const float impulse = static_cast<float>(kSecondImpulse);
    ExpectDivergence(Tampered(PushedBoxes(), impulse, impulse * 1.0000002f), 31, false, 8);
    // A force has no effect before the step.
    const float force = impulse * 60;
    ExpectDivergence(Tampered(PushedBoxes({}, true), force, force + 1), 31, true, 8);
}

// A listener that is another one than it was: the step makes the difference.
TEST(Replay, NamesTheBodyThatAStepMovesElsewhere) {
    class Slippery final : public ContactListener {
    public:
        explicit Slippery(float friction) : friction_(friction) {}
        void ModifyContact(const ContactView& contact, ContactChange& change) const override {
            if (contact.bodyA.index == 8 || contact.bodyB.index == 8) change.friction = friction_;
        }

    private:
        float friction_;
    };
    const Slippery as(0.5f), other(0.1f);
    const Bytes bytes =
        PushedBoxes([&](TestWorld& world, std::span<const BodyId>) { world.System().SetContactListener(&as); });
    const ContactListener* const same[] = {&as};
    const ContactListener* const another[] = {&other};
    const Result<ReplayReport> good = Replay(Parsed(bytes), {.sources = {.contactListeners = same}});
    ASSERT_TRUE(good);
    EXPECT_FALSE(good.Value().divergence);
    const Result<ReplayReport> bad = Replay(Parsed(bytes), {.sources = {.contactListeners = another}});
    ASSERT_TRUE(bad);
    ASSERT_TRUE(bad.Value().divergence);
    EXPECT_EQ(bad.Value().divergence->step, 31u) << bad.Value().divergence->what;
    EXPECT_TRUE(bad.Value().divergence->isInStep);
    ASSERT_EQ(bad.Value().divergence->bodies.size(), 1u) << bad.Value().divergence->what;
    EXPECT_EQ(bad.Value().divergence->bodies[0].index, 8u);
    const Result<ReplayReport> none = Replay(Parsed(bytes));
    ASSERT_FALSE(none);
    EXPECT_EQ(none.GetError().code, ErrorCode::Unsupported);
    EXPECT_NE(none.GetError().message.find("contactListeners"), std::string::npos) << none.GetError().message;
}

TEST(Replay, StopsWhenItIsTold) {
    uint64_t asked = 0;
    const Result<ReplayReport> report =
        Replay(Parsed(PushedBoxes()), {.afterStep = [&](PhysicsSystem&) { return ++asked < 12; }});
    ASSERT_TRUE(report);
    EXPECT_EQ(report.Value().steps, 12u);
    EXPECT_FALSE(report.Value().divergence);
}

// ---- Damage

TEST(CallRecording, IsRefusedIfDamaged) {
    const Bytes bytes = PushedBoxes();
    ASSERT_TRUE(CallRecording::Read(bytes));
    EXPECT_FALSE(CallRecording::Read({}));
    for (size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / Cases(4000)) {
        Bytes damaged = bytes;
        damaged[i] ^= std::byte{1};
        const auto read = CallRecording::Read(damaged);
        ASSERT_FALSE(read) << "byte " << i;
        EXPECT_FALSE(read.GetError().message.empty());
    }
}

// Of a program that crashed: what there is can be played.
TEST(CallRecording, IsValidUpToAnEndThatIsMissing) {
    const Bytes bytes = PushedBoxes();
    const CallRecording whole = Parsed(bytes);
    uint64_t steps = 0;
    for (size_t size = 4000; size < bytes.size(); size += 97) {
        const auto read = CallRecording::Read(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
        if (!read) continue;  // before the world
        EXPECT_FALSE(read.Value().IsComplete());
        EXPECT_GE(read.Value().Steps(), steps);
        steps = read.Value().Steps();
        const Result<ReplayReport> report = Replay(read.Value());
        ASSERT_TRUE(report) << report.GetError().message;
        EXPECT_FALSE(report.Value().divergence);
        EXPECT_EQ(report.Value().steps, steps);
    }
    EXPECT_GE(steps + 1, whole.Steps());
    EXPECT_TRUE(whole.IsComplete());
}

}  // namespace
}  // namespace fulcrum::testing
