// Snapshots and deltas of them. What is damaged is refused, and the world is as it was; what is whole restores the
// state that it says.
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

namespace {

using Snapshot = std::vector<std::byte>;

// A small world, at rest in the middle of its motion, that each run finds as it was.
struct FuzzedWorld {
    TestWorld world;
    uint64_t hash = 0;
    Snapshot snapshot, later;

    FuzzedWorld() {
        world.AddFloor();
        const BodyId a = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.45, 0}, .userData = 5}),
                     b = world.Add({.shape = SphereOf(0.3f), .position = {0, 1.4, 0}});
        world.Add({.shape = CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.4f, 0, 0}}}),
                   .position = {2, 0.5, 0}});
        world.Add({.shape = CubeOf(1), .motion = MotionType::Static, .position = {2, 1, 0}, .isSensor = true});
        PointJointSettings joint;
        joint.bodyA = a;
        joint.bodyB = b;
        EXPECT_TRUE(world.System().Joints().Create(joint));
        world.Steps(5);
        EXPECT_TRUE(world.System().SaveSnapshot(later));
        world.Steps(5);
        EXPECT_TRUE(world.System().SaveSnapshot(snapshot));
        later.swap(snapshot);
        EXPECT_TRUE(world.System().RestoreSnapshot(snapshot));
        hash = world.System().HashState();
    }
    static FuzzedWorld& Instance() {
        static FuzzedWorld instance;
        return instance;
    }
};

FuzzBytes BytesOf(const Snapshot& snapshot) {
    const auto* begin = reinterpret_cast<const uint8_t*>(snapshot.data());
    return {begin, begin + snapshot.size()};
}
Snapshot SnapshotOf(std::span<const uint8_t> bytes) {
    const auto* begin = reinterpret_cast<const std::byte*>(bytes.data());
    return {begin, begin + bytes.size()};
}

void RunSnapshot(std::span<const uint8_t> bytes) {
    FuzzedWorld& fuzzed = FuzzedWorld::Instance();
    PhysicsSystem& system = fuzzed.world.System();
    const Snapshot snapshot = SnapshotOf(bytes);
    const Status whole = system.RestoreSnapshot(snapshot);
    if (!whole) {
        Promise(system.HashState() == fuzzed.hash, "a snapshot that is refused changes nothing");
    } else {
        Snapshot again;
        Promise(static_cast<bool>(system.SaveSnapshot(again)), "what was restored can be saved");
        Promise(again == snapshot, "what was restored is saved to the same bytes");
        fuzzed.world.Steps(2);
        Promise(static_cast<bool>(system.RestoreSnapshot(fuzzed.snapshot)), "the world goes back");
    }
    const uint64_t before = system.HashState();
    if (!system.RestoreBodies(snapshot))
        Promise(system.HashState() == before, "a snapshot of bodies that is refused changes nothing");
    else Promise(static_cast<bool>(system.RestoreSnapshot(fuzzed.snapshot)), "the world goes back");
}

std::vector<FuzzBytes> SeedsOfSnapshots() {
    FuzzedWorld& fuzzed = FuzzedWorld::Instance();
    std::vector<FuzzBytes> seeds = {BytesOf(fuzzed.snapshot), BytesOf(fuzzed.later)};
    std::vector<BodyId> ids;
    fuzzed.world.System().VisitBodies([&](BodyId id) { ids.push_back(id); });
    Snapshot some;
    EXPECT_TRUE(fuzzed.world.System().SaveBodies(std::span(ids).subspan(1, 2), some));
    seeds.push_back(BytesOf(some));
    return seeds;
}

// Two snapshots are always whole or refused: a delta between them, too.
void RunDelta(std::span<const uint8_t> bytes) {
    const FuzzedWorld& fuzzed = FuzzedWorld::Instance();
    Snapshot made, delta = SnapshotOf(bytes);
    if (ApplySnapshotDelta(fuzzed.snapshot, delta, made)) {
        Snapshot again;
        Promise(static_cast<bool>(MakeSnapshotDelta(fuzzed.snapshot, made, again)), "what a delta made is a snapshot");
    } else {
        Promise(made.empty(), "a delta that is refused makes nothing");
    }
    if (MakeSnapshotDelta(fuzzed.snapshot, SnapshotOf(bytes), delta)) {
        Promise(static_cast<bool>(ApplySnapshotDelta(fuzzed.snapshot, delta, made)), "a delta can be applied");
        Promise(made == SnapshotOf(bytes), "a delta makes what it was made of");
    }
}

std::vector<FuzzBytes> SeedsOfDeltas() {
    const FuzzedWorld& fuzzed = FuzzedWorld::Instance();
    Snapshot delta;
    EXPECT_TRUE(MakeSnapshotDelta(fuzzed.snapshot, fuzzed.later, delta));
    return {BytesOf(delta), BytesOf(fuzzed.later)};
}

}  // namespace

const FuzzTarget kSnapshotTarget{"snapshot", RunSnapshot, SeedsOfSnapshots, 1500};
const FuzzTarget kSnapshotDeltaTarget{"snapshot-delta", RunDelta, SeedsOfDeltas, 3000};

}  // namespace fulcrum::testing
