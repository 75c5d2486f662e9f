// Deltas of snapshots: they lead to the same bytes, and are as long as what changed.
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

namespace fulcrum::testing {
namespace {

Bytes DeltaOf(const Bytes& base, const Bytes& snapshot) {
    Bytes delta, again;
    const Status made = MakeSnapshotDelta(base, snapshot, delta);
    if (!made) ADD_FAILURE() << made.GetError().message;
    const Status applied = ApplySnapshotDelta(base, delta, again);
    if (!applied) ADD_FAILURE() << applied.GetError().message;
    EXPECT_TRUE(again == snapshot);
    return delta;
}

// Rows of boxes on a floor, of which most come to rest.
void AddBoxes(TestWorld& world, int count) {
    world.AddFloor();
    for (int i = 0; i < count; ++i)
        world.Add({.shape = CubeOf(0.4f), .position = {1.0 * (i % 40), 0.4 + 0.8 * (i / 800), 1.0 * (i / 40 % 20)}});
}

TEST(SnapshotDelta, LeadsToTheSameBytes) {
    TestWorld world;
    AddBoxes(world, 60);
    const Bytes start = SnapshotOf(world.System());
    Bytes last = start;
    for (int step = 0; step < 60; ++step) {
        if (step % 7 == 3) world.Add({.shape = SphereOf(0.3f), .position = {0.1 * step, 3, 0.3}});
        EXPECT_TRUE(step % 9 != 5 || world.Bodies().Remove({static_cast<uint32_t>(1 + step / 9), 0}));
        world.Step();
        const Bytes now = SnapshotOf(world.System());
        DeltaOf(last, now);
        DeltaOf(start, now);
        DeltaOf(now, start);
        DeltaOf(now, now);
        last = now;
    }
}

TEST(SnapshotDelta, IsAsLongAsWhatChanged) {
    TestWorld world;
    AddBoxes(world, 1600);
    world.Steps(120);
    EXPECT_EQ(world.Report().awakeBodies, 0u);
    const Bytes rest = SnapshotOf(world.System());
    world.Step();
    const Bytes stillAtRest = SnapshotOf(world.System());
    const size_t ofRest = DeltaOf(rest, stillAtRest).size();
    EXPECT_LT(ofRest, 400u);  // the number of the step, and headers
    EXPECT_GT(rest.size(), 500000u);

    // Ten times as many bodies that move change about ten times as much.
    size_t lengths[2] = {0, 0};
    for (int turn = 0; turn < 2; ++turn) {
        const int count = turn == 0 ? 10 : 100;
        EXPECT_TRUE(world.System().RestoreSnapshot(rest));
        for (int i = 0; i < count; ++i)
            EXPECT_TRUE(world.Bodies().AddImpulse({static_cast<uint32_t>(1600 - 4 * i), 0}, {0, 2000, 0}));
        world.Steps(20);
        const Bytes before = SnapshotOf(world.System());
        world.Step();
        lengths[turn] = DeltaOf(before, SnapshotOf(world.System())).size();
        EXPECT_EQ(world.Report().awakeBodies, 2 * static_cast<uint32_t>(count));  // with what they stood on
    }
    EXPECT_LT(lengths[0], 2 * 10 * 300u);
    EXPECT_GT(lengths[1], 4 * lengths[0]);
    EXPECT_LT(lengths[1], 12 * lengths[0]);
    RecordProperty("bytesAtRest", static_cast<int>(ofRest));
    RecordProperty("bytesOfTen", static_cast<int>(lengths[0]));
}

TEST(SnapshotDelta, WantsItsBaseAndAllItsBytes) {
    TestWorld world;
    AddBoxes(world, 20);
    const Bytes first = SnapshotOf(world.System());
    world.Step();
    const Bytes second = SnapshotOf(world.System());
    Bytes delta, out;
    ASSERT_TRUE(MakeSnapshotDelta(first, second, delta));
    out.resize(7);
    const Status wrongBase = ApplySnapshotDelta(second, delta, out);
    ASSERT_FALSE(wrongBase);
    EXPECT_EQ(wrongBase.GetError().code, ErrorCode::Degenerate);
    EXPECT_TRUE(out.empty());
    for (size_t at = 0; at < delta.size(); at += at < 300 ? 1 : Cases(10) == 10 ? 7 : 101) {
        Bytes bad = delta;
        bad[at] ^= static_cast<std::byte>(1u << at % 8);
        EXPECT_FALSE(ApplySnapshotDelta(first, bad, out)) << "byte " << at;
        EXPECT_FALSE(ApplySnapshotDelta(first, std::span(delta).first(at), out)) << "size " << at;
        EXPECT_TRUE(out.empty());
    }
    const Status none = ApplySnapshotDelta(first, second, out);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.GetError().code, ErrorCode::Unsupported);
    EXPECT_FALSE(MakeSnapshotDelta(first, delta, out));
    EXPECT_FALSE(MakeSnapshotDelta({}, second, out));
}

}  // namespace
}  // namespace fulcrum::testing
