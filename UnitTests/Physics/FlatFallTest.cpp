// What falls flat onto flat ground stays where it is: impacts of its corners, found one after the other, must not make
// it spin or slide.
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

enum class Ground { Plane, Box, Mesh };

void AddGround(TestWorld& world, Ground ground, const Material& material) {
    if (ground == Ground::Plane) {
        world.AddFloor(material);
        return;
    }
    ShapePtr shape = BoxOf(50, 1, 50);
    if (ground == Ground::Mesh)
        shape = TriangleMesh::Create({.vertices = {{-50, 1, -50}, {50, 1, -50}, {50, 1, 50}, {-50, 1, 50}},
                                      .indices = {0, 2, 1, 0, 3, 2}})
                    .Value();
    world.Add({.shape = shape, .motion = MotionType::Static, .position = {0, -1, 0}, .material = material});
}

struct FlatFallCase {
    int substeps;
    double dt;  // s
};

class FlatFall : public ::testing::TestWithParam<FlatFallCase> {};

TEST_P(FlatFall, LeavesNeitherSpinNorDrift) {
    constexpr int kFalls = kIsSanitized ? 2 : 8;
    for (const Ground ground : {Ground::Plane, Ground::Box, Ground::Mesh})
        for (const float restitution : {0.0f, 0.5f, 1.0f}) {
            RandomPoses random(11);
            for (int i = 0; i < kFalls; ++i) {
                SystemSettings settings = NoSleep();
                settings.solver.substeps = GetParam().substeps;
                TestWorld world(settings);
                const Material material{.friction = 0.5f, .restitution = restitution};
                AddGround(world, ground, material);
                const float half = std::pow(10.0f, random.Between(-1.0f, 0.5f));
                const Position start(double{random.Between(-20.0f, 20.0f)}, double{half + random.Between(1.0f, 6.0f)},
                                     double{random.Between(-20.0f, 20.0f)});
                const BodyId cube = world.Add({.shape = CubeOf(half),
                                               .position = start,
                                               .rotation = RotationAbout({0, 1, 0}, double{random.Between(0.0f, 6.0f)}),
                                               .material = material});
                double cornerSpeed = 0;  // m/s
                for (double t = 0; t < 3; t += GetParam().dt) {
                    world.Step(GetParam().dt);
                    cornerSpeed =
                        std::max(cornerSpeed, double{Length(world.Bodies().GetAngularVelocity(cube))} * double{half});
                }
                const Position way = world.PositionOf(cube) - start;
                EXPECT_LT(cornerSpeed, 0.3)
                    << int(ground) << ", restitution " << restitution << ", half extent " << half;
                EXPECT_LT(std::hypot(way.x(), way.z()), 0.01 * double{half})
                    << int(ground) << ", restitution " << restitution << ", half extent " << half;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Efforts, FlatFall,
                         ::testing::Values(FlatFallCase{1, 1.0 / 60}, FlatFallCase{2, 1.0 / 60},
                                           FlatFallCase{4, 1.0 / 60}, FlatFallCase{16, 1.0 / 60},
                                           FlatFallCase{4, 1.0 / 30}, FlatFallCase{4, 1.0 / 240},
                                           FlatFallCase{64, 1.0 / 60}));

}  // namespace
}  // namespace fulcrum::testing
