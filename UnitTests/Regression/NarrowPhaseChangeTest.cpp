// The narrow-phase method may be changed between any two steps: caches of pairs are not shared between methods.
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

TEST(NarrowPhaseChange, LeavesRestingBodiesAtRest) {
    TestWorld world;
    world.AddFloor();
    const ShapePtr shapes[] = {SphereOf(0.5f), CubeOf(0.5f), CapsuleOf(0.5f, 0.5f),
                               HullOf({{-0.5f, -0.5f, -0.5f}, {0.5f, -0.5f, -0.5f}, {0, -0.5f, 0.5f}, {0, 0.5f, 0}}),
                               Cylinder::Create(0.5f, 0.5f).Value()};
    std::vector<BodyId> bodies;
    for (size_t i = 0; i < std::size(shapes); ++i)
        for (size_t k = 0; k < std::size(shapes); ++k) {
            const double x = 3.0 * static_cast<double>(i), z = 3.0 * static_cast<double>(k);
            const Quaternion lying =
                shapes[i]->Type() == ShapeType::Capsule ? RotationAbout(Vector3(0, 0, 1), kPi / 2) : Quaternion{};
            bodies.push_back(world.Add({.shape = shapes[i], .position = {x, 0.5, z}, .rotation = lying}));
            bodies.push_back(world.Add({.shape = shapes[k], .position = {x + 1.2, 1.2, z + 0.1}}));
        }
    SystemSettings settings = world.System().Settings();
    for (int i = 0; i < 120; ++i) {
        settings.narrowPhase = i / 3 % 2 == 0 ? NarrowPhaseMethod::Libccd : NarrowPhaseMethod::Automatic;
        ASSERT_TRUE(world.System().SetSettings(settings));
        world.Step();
        ASSERT_TRUE(world.AllFinite()) << i;
    }
    for (const BodyId id : bodies) {
        EXPECT_GT(world.PositionOf(id).y(), 0.1);
        EXPECT_LT(world.PositionOf(id).y(), 2);
        EXPECT_LT(Length(world.VelocityOf(id)), 10);
    }
}

}  // namespace
}  // namespace fulcrum::testing
