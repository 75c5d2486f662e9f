// Recordings of calls: what can be read can be replayed, or is refused. The hashes of the pieces are repaired, so that
// what is behind them is reached: a recording may be forged, its calls are public ones.
#include <Fulcrum/Physics/Recording/RecordingFormat.h>
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>
#include <Fulcrum/UnitTests/Physics/Recording/RecordedProgram.h>

namespace fulcrum::testing {

namespace {

// In a short time: a recording with many or expensive steps is valid.
void Play(Bytes bytes) {
    const auto recording = CallRecording::Read(std::move(bytes));
    if (!recording) return;
    int steps = 0;
    static_cast<void>(Replay(recording.Value(), {.afterStep = [&](PhysicsSystem&) { return ++steps < 20; }}));
}

void RunRecording(std::span<const uint8_t> bytes) {
    const auto* begin = reinterpret_cast<const std::byte*>(bytes.data());
    Bytes file(begin, begin + bytes.size());
    Play(file);
    size_t at = kRecordingMagic.size() + sizeof kRecordingVersion;
    while (at + sizeof(RecordingPiece) <= file.size()) {
        RecordingPiece piece;
        std::memcpy(&piece, file.data() + at, sizeof piece);
        const size_t left = file.size() - at - sizeof piece;
        piece.size = std::min<uint64_t>(piece.size, left);
        piece.sizeHash = HashOfSize(piece.size);
        piece.dataHash = HashBytes(file.data() + at + sizeof piece, piece.size);
        std::memcpy(file.data() + at, &piece, sizeof piece);
        at += sizeof piece + piece.size;
    }
    Play(std::move(file));
}

std::vector<FuzzBytes> SeedsOfRecordings() {
    TestWorld world;
    const auto play = [&] {
        world.AddFloor();
        const BodyId a = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.6, 0}}),
                     b = world.Add({.shape = SphereOf(0.3f), .position = {0, 1.6, 0}, .layer = 2});
        HingeJointSettings hinge;
        hinge.bodyA = a;
        hinge.bodyB = b;
        EXPECT_TRUE(world.System().Joints().Create(hinge));
        SliderJointSettings slider;
        slider.bodyA = a;
        slider.bodyB = BodyBatch::Body(1);
        const BodySettings box{.shape = CubeOf(0.1f), .position = {0, 3, 0}};
        EXPECT_TRUE(world.Bodies().Commit(BodyBatch::Prepare({box, box}, {slider}).Value()));
        world.Steps(2);
        EXPECT_TRUE(world.Bodies().AddImpulse(a, Vector3(1, 2, 3)));
        EXPECT_TRUE(world.Bodies().SetMaterial(b, {.friction = 0.1f, .restitution = 0.5f}));
        world.Step();
        EXPECT_TRUE(world.Bodies().SetVelocity(b, Vector3(0, 1, 0), Vector3(1, 0, 0)));
        EXPECT_TRUE(world.Bodies().Remove(a));
        world.Steps(2);
    };
    const Bytes first = RecordingOf(world.System(), play), second = RecordingOf(world.System(), play);
    std::vector<FuzzBytes> seeds;
    for (const Bytes& bytes : {first, second}) {
        const auto* begin = reinterpret_cast<const uint8_t*>(bytes.data());
        seeds.emplace_back(begin, begin + bytes.size());
    }
    return seeds;
}

}  // namespace

const FuzzTarget kRecordingTarget{"recording", RunRecording, SeedsOfRecordings, 600};

}  // namespace fulcrum::testing
