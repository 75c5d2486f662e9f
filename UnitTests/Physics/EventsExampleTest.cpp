// The example of Docs/Events.md compiles, and does what it says.
#include <Fulcrum/UnitTests/Support/ContactEvents.h>

#include <fstream>
#include <sstream>
#include <string>

namespace fulcrum::testing {
namespace {

struct Game {
    BodyId pane;
    int knocks = 0, shattered = 0, pictures = 0;

    void PlayKnock(const Position&, float) { ++knocks; }
    bool IsPane(BodyId id) const { return id == pane; }
    void Shatter(BodyId) { ++shattered; }
    void SetPicture(BodyId, const Pose&) { ++pictures; }
    void PlayCrack(JointId, float) {}
};

// Breaks panes that are hit by more than 6 N s, plays sounds, and updates the picture.
void AfterStep(PhysicsSystem& system, Game& game) {
    const StepEvents& events = system.Events();
    for (const ContactEvent& event : events.contacts) {
        const bool isImpact = event.kind == ContactEvent::Kind::Begin || event.kind == ContactEvent::Kind::Hit;
        if (isImpact && event.approachSpeed > 0.5f)
            game.PlayKnock(event.manifolds[0].Points()[0].position, event.NormalImpulse());
        if (game.IsPane(event.bodyB) && event.NormalImpulse() > 6) game.Shatter(event.bodyB);
    }
    for (const BodyId body : events.moved) game.SetPicture(body, system.Bodies().GetPose(body));
    for (const BrokenJoint& joint : events.brokenJoints) game.PlayCrack(joint.id, Length(joint.force));
}

std::string TextOf(const std::string& file) {
    std::ifstream in(std::string(FULCRUM_SOURCE_DIR) + "/" + file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

TEST(EventsExample, IsThatOfTheDocs) {
    const std::string page = TextOf("Docs/Events.md"), fence = "```cpp\n";
    const size_t begin = page.find(fence) + fence.size();
    const std::string example = page.substr(begin, page.find("```", begin) - begin);
    ASSERT_GT(example.size(), 200u);
    EXPECT_NE(TextOf("UnitTests/Physics/EventsExampleTest.cpp").find(example), std::string::npos);
}

// 1 kg at 5 m/s against a pane without restitution: 5 N s; at 7 m/s it breaks.
TEST(EventsExample, ShattersWhatIsHitHard) {
    for (const float speed : {5.0f, 7.0f}) {
        TestWorld world(WithAllEvents(NoGravity()));
        Game game;
        game.pane = world.Add({.shape = BoxOf(1, 1, 0.05f), .motion = MotionType::Static});
        world.Add({.shape = SphereOf(0.1f), .position = {0, 0, -1}, .linearVelocity = {0, 0, speed}, .mass = 1});
        for (int step = 0; step < 20; ++step) {
            world.Step();
            AfterStep(world.System(), game);
        }
        EXPECT_EQ(game.knocks, 1);
        EXPECT_EQ(game.shattered, speed > 6 ? 1 : 0);
        EXPECT_GT(game.pictures, 5);
    }
}

}  // namespace
}  // namespace fulcrum::testing
