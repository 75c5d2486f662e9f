// A moving shape that hits several bodies at the same fraction hits the lowest of them, in whichever order the trees
// find them. The fraction is rounded to float: where it was rounded down, the search for the others ended just before
// them, and a restored world, whose trees are built anew, answered with another body.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

// Bodies at the same pose, among others.
constexpr uint32_t kOthers = 20, kSame = 20;

void AddBodies(TestWorld& world, const ShapePtr& shape, RandomPoses& random) {
    for (uint32_t i = 0; i < kOthers; ++i)
        world.Add({.shape = SphereOf(0.1f),
                   .motion = MotionType::Static,
                   .position = (random.InBox(3) + Vector3(0, 10, 0)).cast<double>()});
    const Quaternion rotation = random.Rotation();
    for (uint32_t i = 0; i < kSame; ++i)
        world.Add({.shape = shape, .motion = MotionType::Static, .rotation = rotation});
}

TEST(EqualHits, OfAMovingShapeAreThoseOfTheLowestBody) {
    const ShapePtr plane = Plane::Create(Vector3(0, 1, 0), 0).Value();
    const ShapePtr shapes[] = {
        CubeOf(0.5f), SphereOf(0.5f), CapsuleOf(0.4f, 0.3f), plane,
        CompoundOf({{.shape = CubeOf(0.3f)}, {.shape = CubeOf(0.3f), .position = {0.5f, 0, 0}}})};
    const ShapePtr moving[] = {CubeOf(0.2f), SphereOf(0.2f), CapsuleOf(0.3f, 0.1f)};
    int hits = 0;
    for (uint32_t seed = 0; seed < static_cast<uint32_t>(Cases(200)); ++seed) {
        RandomPoses random(seed);
        TestWorld world, restored;
        AddBodies(world, shapes[seed % 5], random);
        const Assets assets(world.System());
        ASSERT_TRUE(restored.System().RestoreSnapshot(SnapshotOf(world.System()), assets.All()));
        for (int i = 0; i < 20; ++i) {
            const ShapePtr& shape = moving[i % 3];
            const Vector3 from = random.InBox(3), to = random.InBox(0.5f);
            MovingShape cast{static_cast<const ConvexShape*>(shape.get()),
                             {from.cast<double>(), random.Rotation()},
                             Vector3(to - from) * random.Between(1, 3)};
            if (i % 2) cast.turn = random.InBox(2);
            for (TestWorld* each : {&world, &restored}) {
                WorldShapeHit hit;
                if (!each->System().Queries().CastShape(cast, hit)) continue;
                EXPECT_EQ(hit.body.index, kOthers) << "seed " << seed << " cast " << i;
                ++hits;
            }
        }
    }
    EXPECT_GT(hits, Cases(200) * 20);
}

}  // namespace
}  // namespace fulcrum::testing
