#include "ViewerFallingStack.h"

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum {
namespace {

Recording OneBody() {
    Recording recording;
    recording.shapes.emplace_back().radius = 1;
    recording.bodies.emplace_back();
    return recording;
}

RecordedState StateAt(float x) {
    RecordedState state;
    state.position.x() = x;
    return state;
}

TEST(ViewerRecording, KeepsOnlyStatesThatChanged) {
    Recording recording = OneBody();
    for (float x : {1.0f, 1.0f, 2.0f, 2.0f}) AppendFrame(recording, 0, std::array{StateAt(x)}, {});
    EXPECT_EQ(recording.frames[0].states.size(), 1u);
    EXPECT_EQ(recording.frames[1].states.size(), 0u);
    EXPECT_EQ(recording.frames[2].states.size(), 1u);
    EXPECT_EQ(recording.frames[3].states.size(), 0u);
}

TEST(ViewerRecording, FallingAsleepIsAChange) {
    Recording recording = OneBody();
    RecordedState state = StateAt(1);
    AppendFrame(recording, 0, std::array{state}, {});
    state.awake = false;
    AppendFrame(recording, 1, std::array{state}, {});
    EXPECT_EQ(recording.frames[1].states.size(), 1u);
}

TEST(ViewerRecording, FirstFrameHasEveryBodyNamedOrNot) {
    Recording recording = OneBody();
    AppendFrame(recording, 0, {}, {});
    ASSERT_EQ(recording.frames[0].states.size(), 1u);
    EXPECT_EQ(recording.frames[0].states[0].position, Vector3(0, 0, 0));
}

TEST(ViewerRecording, BodyAddedLaterComesWithItsFirstFrame) {
    Recording recording = OneBody();
    AppendFrame(recording, 0, std::array{StateAt(1)}, {});
    recording.bodies.emplace_back();
    RecordedState second = StateAt(5);
    second.body = 1;
    AppendFrame(recording, 1, std::array{StateAt(1), second}, {});
    ASSERT_EQ(recording.frames[1].states.size(), 1u);
    EXPECT_EQ(recording.frames[1].states[0].body, 1u);
    EXPECT_EQ(recording.frames[1].states[0].position.x(), 5);
}

TEST(ViewerRecording, ABodyIsThereFromItsFirstFrameUntilItsLastWithTheShapesItIsGiven) {
    Recording recording = OneBody();
    recording.shapes.emplace_back().radius = 2;
    AppendFrame(recording, 0, {}, {});
    recording.bodies.emplace_back();
    AppendFrame(recording, 1, {}, {});
    AppendFrame(recording, 2, {}, {}, {}, {}, std::array{RecordedShapeChange{1, 1}});
    RecordedState gone;
    gone.isThere = false;
    AppendFrame(recording, 3, std::array{gone}, {});
    AppendFrame(recording, 4, {}, {});
    const std::vector<RecordedPresence> all = PresencesOf(recording);
    ASSERT_EQ(all.size(), 3u);
    const auto expect = [&](size_t i, uint32_t body, uint32_t shape, size_t from, size_t until) {
        EXPECT_EQ(all[i].body, body) << i;
        EXPECT_EQ(all[i].shape, shape) << i;
        EXPECT_EQ(all[i].from, from) << i;
        EXPECT_EQ(all[i].until, until) << i;
    };
    expect(0, 0, 0, 0, 3);
    expect(1, 1, 0, 1, 2);
    expect(2, 1, 1, 2, 5);
}

TEST(ViewerRecording, StateThatIsNotFiniteLeavesTheLastOne) {
    Recording recording = OneBody();
    AppendFrame(recording, 0, std::array{StateAt(3)}, {});
    AppendFrame(recording, 1, std::array{StateAt(std::numeric_limits<float>::quiet_NaN())}, {});
    EXPECT_TRUE(recording.frames[1].states.empty());
    EXPECT_EQ(recording.latest[0].position.x(), 3);
}

TEST(ViewerRecording, ThinsContactsEvenlyRatherThanOutgrowMemory) {
    Recording recording = OneBody();
    const std::vector<RecordedContact> contacts(kMostContactsPerFrame / 2);
    for (int frame = 0; frame < 100; ++frame)
        AppendFrame(recording, frame, {}, WantsContacts(recording) ? contacts : std::vector<RecordedContact>());
    // 16 frames' contacts fit: of 100 frames every 8th is the densest even choice of a power of two, with 13 of them.
    EXPECT_EQ(recording.contactInterval, 8u);
    EXPECT_LE(recording.contactCount, kMostContacts);
    for (size_t frame = 0; frame < recording.frames.size(); ++frame) {
        EXPECT_EQ(recording.frames[frame].hasContacts, frame % 8 == 0);
        EXPECT_EQ(recording.frames[frame].contacts.size(), frame % 8 == 0 ? contacts.size() : 0);
    }
}

TEST(ViewerRecording, SaysHowManyContactsAFrameLost) {
    Recording recording = OneBody();
    AppendFrame(recording, 0, {}, std::vector<RecordedContact>(kMostContactsPerFrame + 100));
    EXPECT_EQ(recording.frames[0].contacts.size(), kMostContactsPerFrame);
    EXPECT_EQ(recording.largestContactCut, 100u);
}

TEST(ViewerRecording, CheckNamesWhatIsMissing) {
    Recording recording = OneBody();
    EXPECT_TRUE(CheckRecording(recording));
    recording.bodies[0].shape = 7;
    const Status status = CheckRecording(recording);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.GetError().code, ErrorCode::UnknownId);
    EXPECT_NE(status.GetError().message.find("body 0 names the shape 7"), std::string::npos)
        << status.GetError().message;
}

TEST(ViewerRecording, CheckNamesAShapeThatABodyIsGivenLater) {
    Recording recording = OneBody();
    AppendFrame(recording, 0, {}, {}, {}, {}, std::array{RecordedShapeChange{0, 3}});
    const Status status = CheckRecording(recording);
    ASSERT_FALSE(status);
    EXPECT_NE(status.GetError().message.find("frame 0 names the shape 3"), std::string::npos)
        << status.GetError().message;
}

TEST(ViewerRecording, CheckRefusesACompoundInsideItself) {
    Recording recording = OneBody();
    RecordedShape& compound = recording.shapes.emplace_back();
    compound.kind = RecordedShapeKind::Compound;
    compound.children.push_back({1, {}});
    EXPECT_FALSE(CheckRecording(recording));
}

}  // namespace
}  // namespace fulcrum
