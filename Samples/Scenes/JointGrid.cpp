#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::JointGridScene {
namespace {

constexpr int kSide = 100;

void Build(SceneWorld& world) {
    const ShapePtr ball = world.SphereOf(0.4f);
    std::vector<BodyId> balls;
    const auto join = [&](BodyId a, BodyId b) {
        const Position middle = 0.5 * (world.Bodies().GetPose(a).position + world.Bodies().GetPose(b).position);
        world.Join(PointJointSettings{{.bodyA = a, .bodyB = b, .anchorA = {.point = middle}}});
    };
    for (int k = 0; k < kSide; ++k)
        for (int i = 0; i < kSide; ++i) {
            balls.push_back(world.Add({.shape = ball,
                                       .motion = i == 0 ? MotionType::Static : MotionType::Dynamic,
                                       .position = {1.0 * k, -1.0 * i, 0},
                                       .layer = 1}));
            const size_t last = balls.size() - 1;
            if (i > 0) join(balls[last - 1], balls[last]);
            if (k > 0 && i > 0) join(balls[last - kSide], balls[last]);
        }
}

void NoContacts(SystemSettings& settings) { settings.layerCollides[1] &= ~2u; }

}  // namespace

extern const Scene kScene{
    .name = "joint_grid",
    .description = "a curtain of 100 x 100 balls, held together by 19701 ball joints",
    .kind = SceneKind::Performance,
    .steps = 100,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Speed, .from = {0.3f, 0.1f, 1}, .picture = 1},
    .adjust = NoContacts,
    .build = Build,
    .accuracy = LargestJointGap,
    .accuracyMeaning = "largest distance between the two anchors of a joint",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.02}},
    .accuracyTolerance = 0.002,
};

}  // namespace fulcrum::JointGridScene
