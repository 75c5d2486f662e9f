// Chunks of a level that come and go with the player: what stands on them stands, and nothing is left of those that
// went.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Samples/Embedding/Streaming.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <chrono>

namespace fulcrum::samples {
namespace {

using namespace fulcrum::testing;

constexpr double kSize = 16;  // m

// Flat ground at a height that its place gives, with four boxes on it, and a lamp that hangs above it.
ChunkContents ChunkAt(ChunkPlace place) {
    const float height = 0.25f * static_cast<float>((place.x & 3) + (place.z & 1));
    const std::vector<float> heights(17 * 17, height);
    const ShapePtr ground = HeightField::Create({.sampleCountX = 17, .sampleCountZ = 17, .heights = heights}).Value();
    const Position corner(kSize * place.x, 0, kSize * place.z);
    std::vector<BodySettings> bodies{{.shape = ground, .motion = MotionType::Static, .position = corner}};
    const ShapePtr box = CubeOf(0.5f);
    for (int i = 0; i < 4; ++i)
        bodies.push_back({.shape = box, .position = corner + Position(4 + 3.0 * i, double{height} + 0.5, 5)});
    bodies.push_back({.shape = SphereOf(0.2f), .position = corner + Position(8, 3, 8)});
    DistanceJointSettings rope;
    rope.bodyA = kWorldBody;
    rope.bodyB = BodyBatch::Body(static_cast<uint32_t>(bodies.size()) - 1);
    rope.anchorA.point = corner + Position(8, 4, 8);
    rope.anchorB = JointAnchor{.point = bodies.back().position};
    rope.maxDistance = 1;
    return {std::move(bodies), {rope}};
}

// Waits for the loader as long as it takes.
void AddAll(ChunkStreamer& streamer, const Position& player, size_t chunks) {
    const auto begin = std::chrono::steady_clock::now();
    while (streamer.Chunks().size() != chunks) {
        ASSERT_TRUE(streamer.Update(player, 100));
        ASSERT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
        std::this_thread::yield();
    }
}

TEST(Streaming, ChunksComeAndGoWithThePlayer) {
    TestWorld world;
    ChunkStreamer streamer(world.System(), kSize, 1, ChunkAt);
    AddAll(streamer, {8, 0, 8}, 9);
    for (int step = 0; step < 120; ++step) {
        ASSERT_TRUE(streamer.Update({8, 0, 8}));
        world.Step();
    }
    for (const auto& [place, ids] : streamer.Chunks()) {
        ASSERT_EQ(ids.bodies.size(), 6u);
        ASSERT_EQ(ids.joints.size(), 1u);
        for (size_t i = 1; i < ids.bodies.size(); ++i)
            EXPECT_NEAR(world.PositionOf(ids.bodies[i]).y(), ChunkAt(place).bodies[i].position.y(), 0.01);
    }
    const auto before = streamer.Chunks();
    // Three chunks on: three rows of new ones; those two places away stay, as far as they were there.
    AddAll(streamer, {8 + 3 * kSize, 0, 8}, 9 + 3);
    world.Step();
    size_t stayed = 0;
    for (const auto& [place, ids] : before) {
        const bool isThere = streamer.Chunks().contains(place);
        EXPECT_EQ(isThere, place.x == 1) << place.x << " " << place.z;
        for (const BodyId id : ids.bodies) EXPECT_EQ(world.Bodies().Exists(id), isThere);
        EXPECT_EQ(world.System().Joints().Exists(ids.joints[0]), isThere);
        stayed += isThere;
    }
    EXPECT_EQ(stayed, 3u);
    EXPECT_TRUE(world.AllFinite());
}

TEST(Streaming, TheWorldStepsWhileTheLoaderWorks) {
    TestWorld world;
    ChunkStreamer streamer(world.System(), kSize, 2, ChunkAt);
    double x = 8;
    size_t most = 0;
    for (int step = 0; step < 300; ++step, x += 0.5) {
        ASSERT_TRUE(streamer.Update({x, 0, 8}));
        world.Step();
        most = std::max(most, streamer.Chunks().size());
    }
    EXPECT_LE(most, 49u);  // 7 x 7: those one farther stay
    EXPECT_TRUE(world.AllFinite());
}

TEST(Streaming, AWrongChunkIsAnErrorThatNamesTheBody) {
    TestWorld world;
    ChunkStreamer streamer(world.System(), kSize, 0, [](ChunkPlace) {
        return ChunkContents{{{.shape = CubeOf(1)}, {.shape = CubeOf(1), .mass = -1}}, {}};
    });
    Status status = Done{};
    while (status && streamer.Chunks().empty()) status = streamer.Update({0, 0, 0});
    ASSERT_FALSE(status);
    EXPECT_NE(status.GetError().message.find("bodies[1]: "), std::string::npos) << status.GetError().message;
}

}  // namespace
}  // namespace fulcrum::samples
