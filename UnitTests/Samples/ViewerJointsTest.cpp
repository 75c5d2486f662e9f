#include <Fulcrum/Samples/Viewer/PageData.h>
#include <Fulcrum/Samples/Viewer/PageJoints.h>

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum {
namespace {

// Two bodies and as many joints between them as are asked for.
Recording WithJoints(size_t count) {
    Recording recording;
    recording.shapes.emplace_back().radius = 1;
    recording.bodies.resize(2);
    for (size_t i = 0; i < count; ++i) recording.joints.push_back({.kind = "hinge", .bodyA = 0, .bodyB = 1});
    return recording;
}

RecordedJointState Limited(uint32_t joint, float min, float max) {
    RecordedJointState state{.joint = joint};
    state.limits[3] = {min, max};
    return state;
}

void Append(Recording& recording, std::vector<RecordedJointState> states) {
    AppendFrame(recording, static_cast<double>(recording.frames.size()), {}, {}, {states, {}});
}

TEST(ViewerJoints, KeepsOnlyStatesThatChanged) {
    Recording recording = WithJoints(2);
    Append(recording, {Limited(0, -1, 1), Limited(1, -1, 1)});
    Append(recording, {Limited(0, -1, 1), Limited(1, -1, 1)});
    Append(recording, {Limited(0, -1, 1), Limited(1, -1, 2)});
    EXPECT_EQ(recording.frames[0].joints.size(), 2u);
    EXPECT_EQ(recording.frames[1].joints.size(), 0u);
    ASSERT_EQ(recording.frames[2].joints.size(), 1u);
    EXPECT_EQ(recording.frames[2].joints[0].joint, 1u);
    EXPECT_EQ(recording.frames[2].joints[0].limits[3].max, 2);
}

TEST(ViewerJoints, JointThatBreaksIsAChange) {
    Recording recording = WithJoints(1);
    Append(recording, {{.joint = 0}});
    Append(recording, {{.joint = 0, .enabled = false}});
    ASSERT_EQ(recording.frames[1].joints.size(), 1u);
    EXPECT_FALSE(recording.frames[1].joints[0].enabled);
}

TEST(ViewerJoints, JointThatIsNotNamedIsOff) {
    Recording recording = WithJoints(1);
    Append(recording, {});
    EXPECT_FALSE(recording.latestJoints[0].enabled);
    EXPECT_TRUE(recording.frames[0].joints.empty());
}

TEST(ViewerJoints, StateOfAJointThatThereIsNotIsDropped) {
    Recording recording = WithJoints(1);
    Append(recording, {{.joint = 7}});
    EXPECT_TRUE(recording.frames[0].joints.empty());
}

TEST(ViewerJoints, CheckNamesTheBodyThatAJointLacks) {
    Recording recording = WithJoints(1);
    EXPECT_TRUE(CheckRecording(recording));
    recording.joints[0].bodyB = 2;
    const Status status = CheckRecording(recording);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.GetError().code, ErrorCode::UnknownId);
    EXPECT_NE(status.GetError().message.find("joint 0 names the body 2"), std::string::npos)
        << status.GetError().message;
}

TEST(ViewerJoints, ColumnsAreEmptyWithoutJoints) {
    Recording recording = WithJoints(0);
    for (int frame = 0; frame < 10; ++frame) Append(recording, {});
    for (const std::string& column : JointColumns(recording)) EXPECT_EQ(column, "");
}

TEST(ViewerJoints, ColumnsAreAsTheHeaderDescribesThem) {
    Recording recording = WithJoints(1);
    RecordedJoint& joint = recording.joints[0];
    joint.kind = "pulley";
    joint.isRope = true;
    joint.isHardLength = true;
    joint.ratio = 2;
    joint.frameA.position = {0.5f, 0, -0.25f};
    joint.frameB.rotation = {0, 0, -1, 0};
    joint.points = {{0, 1e-4f, 0}};
    RecordedJointState limited{.joint = 0};
    limited.limits[0].max = 1e-4f;
    const std::vector<RecordedJointState> states = {limited};
    AppendFrame(recording, 0, {}, {},
                {states, {.distance = 1e-5f, .angle = 2e-6f, .distanceJoint = 0, .angleJoint = 0}});
    Append(recording, {{.joint = 0, .enabled = false}});
    const auto bytes = [](std::initializer_list<int> values) {
        std::string text;
        for (int value : values) text.push_back(static_cast<char>(value));
        return text;
    };
    const auto [constants, changes, errors] = JointColumns(recording);
    // Flags: a rope and its hard length. Zigzag: body B is 1, so 2; the ratio is 200000 steps, so 400000 = 128, 181, 24
    // as a varint; 0.5 m are 50000 steps, so 100000 = 160, 141, 6; -0.25 m are -25000, so 49999 = 207, 134, 3; the
    // quaternions' 1 and -1 are 2^21 and 2^21 - 1.
    EXPECT_EQ(constants, bytes({0, 0, 0, 0, 0,   66,  0,   0, 0, 0, 0, 2, 128, 181, 24,  160, 141, 6, 0, 207, 134,
                                3, 0, 0, 0, 128, 128, 128, 1, 0, 0, 0, 0, 0,   255, 255, 127, 0,   1, 0, 20,  0}));
    // Frame 0: one state, of joint 0, enabled with other limits: the end 1 is at 10 steps. Frame 1: off, and the end is
    // gone.
    EXPECT_EQ(changes, bytes({1, 0, 3, 2, 20, 1, 0, 2, 0}));
    EXPECT_EQ(errors, bytes({10, 0, 2, 0, 0, 0, 0, 0}));
}

TEST(ViewerJoints, NumbersThatAreNotFiniteAreStoredAllTheSame) {
    Recording recording = WithJoints(1);
    recording.joints[0].frameA.position.x() = std::numeric_limits<float>::quiet_NaN();
    recording.joints[0].frameB.position.x() = std::numeric_limits<float>::infinity();
    Append(recording, {Limited(0, -1, 1)});
    EXPECT_FALSE(EncodePageData(recording).empty());
}

TEST(ViewerJoints, JointsOfOneKindCostFewBytes) {
    Recording few = WithJoints(100), many = WithJoints(10'100);
    for (Recording* recording : {&few, &many}) {
        std::vector<RecordedJointState> states;
        for (uint32_t i = 0; i < recording->joints.size(); ++i) states.push_back({.joint = i});
        for (int frame = 0; frame < 100; ++frame) Append(*recording, states);
    }
    // Its kind and locks, differences and a state are some 30 bytes, which deflate to a few, and nothing a frame.
    EXPECT_LT(Deflated(EncodePageData(many)).size() - Deflated(EncodePageData(few)).size(), 10'000u * 2);
}

}  // namespace
}  // namespace fulcrum
