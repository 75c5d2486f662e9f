#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <iterator>

namespace fulcrum::BreakingGlassScene {
namespace {

// `watched` has the panes, then a ball for each.
constexpr float kSpeeds[] = {2, 3, 4, 5.5f, 6.5f, 8, 60, 200};  // m/s
constexpr size_t kPanes = std::size(kSpeeds);
constexpr float kBallMass = 1;             // kg
constexpr float kStrength = 6;             // N s: a pane breaks if the impulse of a contact in a step is larger
constexpr double kMetersPerImpulse = 0.1;  // length of drawn lines per N s
constexpr float kLeastDrawn = 1;           // N s: more than what lies on the floor

void Adjust(SystemSettings& settings) { settings.events.contacts = true; }

void Build(SceneWorld& world) {
    world.AddFloor(20, 20);
    const ShapePtr pane = world.BoxOf(0.6f, 0.6f, 0.03f), ball = world.SphereOf(0.12f);
    const auto xOf = [](size_t i) { return 1.6 * static_cast<double>(i) - 5.6; };
    for (size_t i = 0; i < kPanes; ++i) {
        world.watched.push_back(world.Add({.shape = pane, .motion = MotionType::Static, .position = {xOf(i), 1.6, 0}}));
        world.Show(world.watched.back(), {.look = Look::Glass});
    }
    for (size_t i = 0; i < kPanes; ++i)
        world.watched.push_back(world.Add({.shape = ball,
                                           .position = {xOf(i), 1.6, -1 - 0.5 * double{kSpeeds[i]}},
                                           .linearVelocity = {0, 0, kSpeeds[i]},
                                           .mass = kBallMass,
                                           .gravityFactor = 0,
                                           .continuous = ContinuousCollision::Linear}));
}

void Break(SceneWorld& world, BodyId pane) {
    const Position at = world.Bodies().GetPose(pane).position;
    if (!world.Bodies().Remove(pane)) return;
    const ShapePtr shard = world.BoxOf(0.19f, 0.19f, 0.03f);
    for (int i = 0; i < 9; ++i)
        world.Show(world.Add({.shape = shard, .position = at + Position(0.4 * (i % 3 - 1), 0.4 * (i / 3 - 1), 0)}),
                   {.look = Look::Glass});
}

// Makes balls fall that hit something, and breaks panes that were hit hard.
void React(SceneWorld& world, double) {
    const auto isPane = [&](BodyId id) {
        const auto end = world.watched.begin() + kPanes;
        return std::find(world.watched.begin(), end, id) != end;
    };
    for (const ContactEvent& event : world.System().Events().contacts) {
        if (event.kind == ContactEvent::Kind::Begin || event.kind == ContactEvent::Kind::Hit)
            (void)world.Bodies().SetGravityFactor(event.bodyA, 1);
        if (isPane(event.bodyB) && event.NormalImpulse() > kStrength) Break(world, event.bodyB);
    }
}

void DrawImpulses(SceneWorld& world) {
    if (!world.Draw().IsOn()) return;
    for (const ContactEvent& event : world.System().Events().contacts)
        for (const ContactEvent::Manifold& manifold : event.manifolds)
            for (const ContactEvent::Point& point : manifold.Points())
                if (point.impulse > kLeastDrawn)
                    world.Draw().Normal(point.position, -manifold.normal,
                                        kMetersPerImpulse * double{std::min(point.impulse, 20.0f)});
}

double Accuracy(const SceneWorld& world) {
    int wrong = 0;
    for (size_t i = 0; i < kPanes; ++i) {
        const bool breaks = kBallMass * kSpeeds[i] > kStrength;
        wrong += world.Bodies().Exists(world.watched[i]) == breaks;
    }
    return wrong;
}

}  // namespace

extern const Scene kScene{
    .name = "breaking_glass",
    .description = "balls of 2 to 200 m/s hit panes, which break where the impulse is more than they stand",
    .view = {.color = ColorMode::Plain,
             .from = {0.75f, 0.25f, 0.8f},
             .lower = {-6.3, 0, -1},
             .upper = {6.3, 2.3, 1.5},
             .picture = 0.15},
    .adjust = Adjust,
    .build = Build,
    .beforeStep = React,
    .afterStep = DrawImpulses,
    .accuracy = Accuracy,
    .accuracyMeaning = "panes that broke too early, or not at all",
    .accuracyUnit = "panes",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::BreakingGlassScene
