// What ./fulcrum replay and shrink do beside Physics/Recording: programs that crash are played in processes of their
// own.
#include <Fulcrum/Samples/Runner/ReplayCommands.h>
#include <Fulcrum/UnitTests/Physics/Recording/RecordedProgram.h>

#include <cstdlib>

namespace fulcrum::testing {
namespace {

TEST(RunInAProcess, SaysWhetherItDiedAndWhatItSent) {
    const auto send = [](const CallRecorder::Sink& sink, size_t size) {
        const Bytes bytes(size, std::byte{7});
        EXPECT_TRUE(sink(bytes));
    };
    const IsolatedRun good = RunInAProcess([&](const CallRecorder::Sink& sink) { send(sink, 200'000); });
    EXPECT_FALSE(good.hasDied);
    EXPECT_EQ(good.sent, Bytes(200'000, std::byte{7}));
    const IsolatedRun bad = RunInAProcess([&](const CallRecorder::Sink& sink) {
        send(sink, 5);
        std::abort();
    });
    EXPECT_TRUE(bad.hasDied);
    EXPECT_EQ(bad.sent, Bytes(5, std::byte{7}));
}

// A program's error: it dies at a contact of two bodies with this friction.
class Deadly final : public ContactListener {
public:
    void ModifyContact(const ContactView&, ContactChange& change) const override {
        if (change.friction == 0.125f) std::abort();
    }
};

TEST(Shrink, FindsTheBodiesWithWhichAProgramDies) {
    const Deadly deadly;
    // Recorded until it dies, in a process of its own.
    const IsolatedRun dead = RunInAProcess([&](const CallRecorder::Sink& sink) {
        const auto system = PhysicsSystem::Create().Value();
        const auto recorder = CallRecorder::Create(*system, sink).Value();
        system->SetContactListener(&deadly);
        (void)system->Bodies()
            .Create({.shape = BoxOf(50, 1, 50), .motion = MotionType::Static, .position = {0, -1, 0}})
            .Value();
        for (int i = 0; i < 60; ++i) {
            const float friction = i == 33 || i == 34 ? 0.125f : 0.5f;
            const Material material{.friction = friction, .frictionRule = CombineRule::Maximum};
            (void)system->Bodies()
                .Create({.shape = CubeOf(0.3f), .position = {0.55 * i, 0.3 + 0.1 * (i % 3), 0}, .material = material})
                .Value();
        }
        for (int step = 0; step < 60; ++step) (void)bool(system->Update(kStep));
    });
    ASSERT_TRUE(dead.hasDied);
    const CallRecording recording = Parsed(dead.sent);
    EXPECT_FALSE(recording.IsComplete());
    const ContactListener* const listeners[] = {&deadly};
    const Result<ShrinkReport> report =
        Shrink(recording, nullptr, {.sources = {.contactListeners = listeners}, .isolation = RunInAProcess});
    ASSERT_TRUE(report) << report.GetError().message;
    EXPECT_EQ(report.Value().before.bodies, 61u);
    EXPECT_EQ(report.Value().after.bodies, 2u);
    EXPECT_EQ(report.Value().after.steps, 1u);
    EXPECT_EQ(report.Value().after.calls, 4u);  // the listener, two bodies, a step
    EXPECT_EQ(Parsed(report.Value().recording).Calls(), 4u);
}

}  // namespace
}  // namespace fulcrum::testing
