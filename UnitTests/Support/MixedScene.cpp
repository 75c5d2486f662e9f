#include <Fulcrum/UnitTests/Support/MixedScene.h>

namespace fulcrum::testing {

MixedScene::MixedScene(TestWorld& world) : world_(world) {
    world.AddFloor({.friction = 0.6f});
    world.Add({.shape = BoxOf(4, 0.5f, 4),
               .motion = MotionType::Static,
               .position = {6, 1, 0},
               .rotation = RotationAbout({0, 0, 1}, 0.4)});
    const ShapePtr shapes[] = {
        SphereOf(0.4f),
        BoxOf(0.4f, 0.3f, 0.5f),
        CapsuleOf(0.4f, 0.25f),
        HullOf({{0.5f, -0.3f, 0}, {-0.4f, -0.3f, 0.4f}, {-0.4f, -0.3f, -0.4f}, {0, 0.5f, 0}, {0.2f, 0.3f, 0.3f}}),
        CompoundOf({{.shape = BoxOf(0.5f, 0.1f, 0.1f)}, {.shape = SphereOf(0.2f), .position = {0.5f, 0, 0}}}),
    };
    uint32_t random = 12345;
    const auto number = [&] {
        return static_cast<float>((random = random * 1664525u + 1013904223u) >> 8) / 16777216.0f;
    };
    for (int i = 0; i < 150; ++i) {
        // In separate statements: the order of evaluation of arguments is unspecified.
        const float x = number(), y = number(), z = number(), w = number(), bounce = number();
        BodySettings settings;
        settings.shape = shapes[i % 5];
        settings.position = {i % 5 * 1.2 - 2.4 + 0.2 * double(x), 1.5 + i / 25 * 1.3,
                             i / 5 % 5 * 1.2 - 2.4 + 0.2 * double(z)};
        settings.rotation = Normalized(Quaternion{x, y, z, w + 0.1f});
        settings.angularVelocity = Vector3(x, y, z) * 4.0f;
        settings.material.restitution = i % 7 == 0 ? bounce : 0;
        settings.linearDamping = i % 11 == 0 ? 0.3f : 0;
        settings.gravityFactor = i % 13 == 0 ? 0.5f : 1.0f;
        settings.lockedAxes = i % 17 == 0 ? LockedAxes::Rotation : LockedAxes::None;
        const BodyId id = world.Add(settings);
        if (i == 20) pushed_ = id;
        if (i == 40) removed_ = id;
    }
    // Towers that fall asleep, so that sleeping is covered too.
    for (int i = 0; i < 12; ++i) world.Add({.shape = CubeOf(0.5f), .position = {-20.0 - 3 * (i / 3), 0.5 + i % 3, 0}});
    sweeper_ = world.Add({.shape = BoxOf(0.3f, 0.5f, 5), .motion = MotionType::Kinematic, .position = {-6, 0.6, 0}});
}

void MixedScene::BeforeStep(int step) {
    const double x = -6 + 0.03 * step;
    EXPECT_TRUE(world_.Bodies().MoveKinematic(sweeper_, {x, 0.6, 0}, RotationAbout({0, 1, 0}, 0.001 * step),
                                              static_cast<float>(kStep)));
    const Position corner = world_.PositionOf(pushed_) + Position(0.1, 0.1, 0);
    EXPECT_TRUE(step >= 60 || world_.Bodies().AddForceAt(pushed_, {300, 100, 50}, corner));
    EXPECT_TRUE(step != 100 || world_.Bodies().Remove(removed_));
}

uint64_t HashOfMixedScene(uint32_t threads) {
    TestWorld world({}, threads);
    MixedScene scene(world);
    for (int step = 0; step < kMixedSceneSteps; ++step) {
        scene.BeforeStep(step);
        world.Step();
    }
    EXPECT_TRUE(world.AllFinite());
    return world.System().HashPoses();
}

}  // namespace fulcrum::testing
