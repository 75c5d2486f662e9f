// An edit of a height field under HoldForChanges keeps the steps and queries of other threads out.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>

#include <thread>

namespace fulcrum::testing {
namespace {

using FieldPtr = std::shared_ptr<HeightField>;
constexpr uint32_t kSide = 41;  // samples, 1 m apart, about the origin

FieldPtr FlatField() {
    const std::vector<float> heights(kSide * kSide, 0);
    return HeightField::Create(
               {.sampleCountX = kSide, .sampleCountZ = kSide, .heights = heights, .origin = {-20, 0, -20}})
        .Value();
}

// The samples within 2 m of (x, 0), a square.
void Level(HeightField& field, int x, float height) {
    const std::vector<float> heights(25, height);
    EXPECT_TRUE(field.SetHeights(static_cast<uint32_t>(x + 18), 18, 5, 5, heights));
}

TEST(ShapeEdits, UnderAHoldAreSafeBesideStepsAndQueries) {
    TestWorld world({}, 2), neighbor;
    const FieldPtr field = FlatField(), elsewhere = FlatField();
    world.Add({.shape = field, .motion = MotionType::Static});
    neighbor.Add({.shape = elsewhere, .motion = MotionType::Static});
    for (int i = 0; i < 8; ++i) world.Add({.shape = CubeOf(0.5f), .position = {2.0 * i - 8, 1, 0}});
    std::thread queries([&] {
        WorldRayHit hit;
        for (int i = 0; i < 200; ++i)
            EXPECT_TRUE(world.System().Queries().CastRay({{0.1 * i - 10, 50, 3}, {0, -100, 0}}, hit));
    });
    std::thread edits([&] {
        for (int i = 0; i < 50; ++i) {
            {
                const auto alone = world.System().HoldForChanges();
                Level(*field, i % 11 - 5, 0.01f * static_cast<float>(i + 1));
            }
            Level(*elsewhere, i % 11 - 5, 0.01f * static_cast<float>(i + 1));  // of another world, at any time
            neighbor.Step();
        }
    });
    for (int i = 0; i < 50; ++i) world.Step();
    queries.join();
    edits.join();
    EXPECT_TRUE(world.AllFinite());
}

}  // namespace
}  // namespace fulcrum::testing
