// Bodies are put to sleep in kinematic hills that move through them: in the next step one face has left the body, and
// another one wakes it. The contact with the first was solved on, as a wall that nobody sees, but not in a world that
// was restored from a snapshot. Found by random programs.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

namespace fulcrum::testing {
namespace {

ShapePtr RandomHills(RandomPoses& random) {
    constexpr uint32_t kSide = 6;
    std::vector<Vector3> corners;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        const float height = random.Between(-0.5f, 0.5f);
        corners.push_back(Vector3(float(i / kSide) - 2.5f, height, float(i % kSide) - 2.5f));
        if (i / kSide + 1 == kSide || i % kSide + 1 == kSide) continue;
        for (const uint32_t corner : {i, i + 1, i + kSide, i + kSide, i + 1, i + kSide + 1}) indices.push_back(corner);
    }
    return TriangleMesh::Create({.vertices = corners, .indices = indices}).Value();
}

TEST(EndedWhileAsleep, FacesThatLeaveASleepingBodyAreNotSolved) {
    int woken = 0;
    for (int seed = 1; seed <= Cases(2000); ++seed) {
        RandomPoses random(static_cast<uint32_t>(seed));
        TestWorld world(NoGravity());
        const ShapePtr hills = RandomHills(random);
        const Vector3 v = 8 * random.InCube(), w = 3 * random.InCube();
        world.Add({.shape = hills, .motion = MotionType::Kinematic, .linearVelocity = v, .angularVelocity = w});
        const Quaternion rotation = random.Rotation();
        const BodyId box = world.Add({.shape = BoxOf(0.8f, 0.3f, 0.6f),
                                      .position = {0, double{random.Between(0, 0.6f)}, 0},
                                      .rotation = rotation});
        world.Step();
        world.Step();
        ASSERT_TRUE(world.Bodies().Sleep(box));
        world.Step();
        woken += world.Bodies().IsAwake(box);
        std::vector<std::byte> bytes;
        ASSERT_TRUE(world.System().SaveSnapshot(bytes));
        TestWorld restored(NoGravity());
        const ShapePtr shapes[] = {hills, world.Bodies().GetShape(box)};
        ASSERT_TRUE(restored.System().RestoreSnapshot(bytes, {.shapes = shapes}));
        for (int step = 0; step < 10; ++step) {
            world.Step();
            restored.Step();
            ASSERT_EQ(world.System().HashPoses(), restored.System().HashPoses()) << "seed " << seed;
        }
    }
    EXPECT_GT(woken, 10);
}

}  // namespace
}  // namespace fulcrum::testing
