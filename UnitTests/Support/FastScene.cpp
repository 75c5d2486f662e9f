#include <Fulcrum/UnitTests/Support/FastScene.h>

#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

namespace fulcrum::testing {

namespace {

constexpr int kSteps = 90;
constexpr float kRoom = 10;  // m, half

void AddRoom(TestWorld& world) {
    const Material wall{.friction = 0.3f, .restitution = 0.8f};
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            Vector3 half = Vector3::Constant(kRoom);
            half[axis] = 0.05f;
            Position at = Position::Zero();
            at[axis] = double{side * kRoom};
            world.Add({.shape = BoxOf(half.x(), half.y(), half.z()),
                       .motion = MotionType::Static,
                       .position = at,
                       .material = wall});
        }
    // A roof of two sheets, two-sided.
    const Vector3 corners[] = {{-6, 0, -6}, {6, 0, -6}, {-6, 2, 0}, {6, 2, 0}, {-6, 0, 6}, {6, 0, 6}};
    const uint32_t indices[] = {0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5};
    const ShapePtr roof = TriangleMesh::Create({.vertices = corners, .indices = indices, .isTwoSided = true}).Value();
    world.Add({.shape = roof, .motion = MotionType::Static, .position = {0, -5, 0}, .material = wall});
    world.Add({.shape = BoxOf(4, 0.5f, 0.1f),
               .motion = MotionType::Kinematic,
               .position = {0, 4, 0},
               .angularVelocity = {0, 30, 0},
               .material = wall,
               .continuous = ContinuousCollision::LinearAndAngular});
}

}  // namespace

std::vector<BodyId> BuildFastScene(TestWorld& world) {
    AddRoom(world);
    const ShapePtr shapes[] = {
        SphereOf(0.2f),
        BoxOf(0.3f, 0.1f, 0.2f),
        CapsuleOf(0.3f, 0.1f),
        HullOf({{0.4f, -0.2f, 0}, {-0.3f, -0.2f, 0.3f}, {-0.3f, -0.2f, -0.3f}, {0, 0.4f, 0}}),
        Cylinder::Create(0.1f, 0.25f).Value(),
        CompoundOf({{.shape = BoxOf(0.4f, 0.05f, 0.05f)}, {.shape = SphereOf(0.15f), .position = {0.4f, 0, 0}}}),
    };
    uint32_t random = 815;
    const auto number = [&] {
        return static_cast<float>((random = random * 1664525u + 1013904223u) >> 8) / 8388608.0f - 1;
    };
    std::vector<BodyId> bodies;
    for (int i = 0; i < 180; ++i) {
        const float x = number(), y = number(), z = number(), w = number();
        const float vx = number(), vy = number(), vz = number();
        const ContinuousCollision continuous = i % 5 == 4   ? ContinuousCollision::Off
                                               : i % 2 == 0 ? ContinuousCollision::Linear
                                                            : ContinuousCollision::LinearAndAngular;
        const float speed = continuous == ContinuousCollision::Off ? 3.0f : 200.0f;
        bodies.push_back(world.Add({.shape = shapes[i % 6],
                                    .position = Vector3(9 * x, 6.5f + 2.5f * y, 9 * z).cast<double>(),
                                    .rotation = Normalized(Quaternion{x, y, z, w + 1.1f}),
                                    .linearVelocity = Vector3(vx, vy, vz) * speed,
                                    .angularVelocity = Vector3(z, x, y) * 60.0f,
                                    .material = {.restitution = 0.5f},
                                    .continuous = continuous}));
    }
    return bodies;
}

uint64_t HashOfFastScene(uint32_t threads) {
    TestWorld world({}, threads);
    const std::vector<BodyId> bodies = BuildFastScene(world);
    world.Steps(kSteps);
    for (const BodyId body : bodies) {
        if (world.Bodies().GetContinuous(body) == ContinuousCollision::Off) continue;
        const Position p = world.PositionOf(body);
        EXPECT_LE(p.cwiseAbs().maxCoeff(), double{kRoom}) << body.index;
    }
    return world.System().HashPoses();
}

}  // namespace fulcrum::testing
