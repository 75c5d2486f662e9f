// Lines and points of a recording: from the scene to the bytes of a page.
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Samples/Runner/Recorder.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Viewer/PageData.h>
#include <Fulcrum/Samples/Viewer/PageDrawings.h>

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum {
namespace {

void Append(Recording& recording, std::vector<RecordedLine> lines, std::vector<RecordedPoint> points) {
    AppendFrame(recording, static_cast<double>(recording.frames.size()), {}, {}, {}, {lines, points});
}

std::string Bytes(std::initializer_list<int> values) {
    std::string text;
    for (int value : values) text.push_back(static_cast<char>(value));
    return text;
}

TEST(Drawing, KeepsNothingUntilItIsTurnedOn) {
    Drawing drawing;
    drawing.Line({0, 0, 0}, {1, 0, 0}, Ink::Path);
    drawing.Normal({0, 0, 0}, Vector3(0, 1, 0));
    drawing.Box({0, 0, 0}, {1, 1, 1}, Ink::Shape);
    EXPECT_TRUE(drawing.Lines().empty());
    EXPECT_TRUE(drawing.Points().empty());
    drawing.TurnOn();
    drawing.Normal({0, 0, 0}, Vector3(0, 1, 0), 2);
    ASSERT_EQ(drawing.Lines().size(), 1u);
    EXPECT_EQ(drawing.Lines()[0].to, Position(0, 2, 0));
    EXPECT_EQ(drawing.Points().size(), 1u);
    drawing.Clear();
    EXPECT_TRUE(drawing.Lines().empty());
    EXPECT_TRUE(drawing.IsOn());
}

TEST(Drawing, OutlinesABoxByItsTwelveEdges) {
    Drawing drawing;
    drawing.TurnOn();
    drawing.Outline(*Box::Create(Vector3(1, 2, 3)).Value(), {{10, 0, 0}, {}}, Ink::Shape);
    ASSERT_EQ(drawing.Lines().size(), 12u);
    double length = 0;
    for (const DrawnLine& line : drawing.Lines()) length += (line.to - line.from).norm();
    EXPECT_NEAR(length, 4 * (2 + 4 + 6), 1e-5);
    Drawing corners;
    corners.TurnOn();
    corners.Box({9, -2, -3}, {11, 2, 3}, Ink::Shape);
    ASSERT_EQ(corners.Lines().size(), 12u);
    for (size_t i = 0; i < 12; ++i) {
        EXPECT_LT((corners.Lines()[i].from - drawing.Lines()[i].from).norm(), 1e-6);
        EXPECT_LT((corners.Lines()[i].to - drawing.Lines()[i].to).norm(), 1e-6);
    }
}

TEST(Drawing, OutlinesWhatIsRoundOnItsSurface) {
    Drawing drawing;
    drawing.TurnOn();
    drawing.Outline(*Sphere::Create(2).Value(), {{0, 5, 0}, {}}, Ink::Shape);
    EXPECT_EQ(drawing.Lines().size(), 96u);
    for (const DrawnLine& line : drawing.Lines()) EXPECT_NEAR((line.from - Position(0, 5, 0)).norm(), 2, 1e-5);
}

TEST(ViewerDrawings, ColumnIsEmptyWhereNothingIsDrawn) {
    Recording recording;
    for (int frame = 0; frame < 5; ++frame) Append(recording, {}, {});
    EXPECT_EQ(DrawingColumn(recording, 0.001), "");
    EXPECT_EQ(DrawingHeader(recording, 0.001)["mostLines"], 0);
}

TEST(ViewerDrawings, ColumnIsAsTheHeaderDescribesIt) {
    Recording recording;
    Append(recording, {{{1, 0, 0}, {1, 2, 0}, 3}, {{1, 0, -1}, {0, 0, 0}, 3}}, {{{0, 5, 0}, 1}});
    Append(recording, {{{1, 0, 0}, {1, 3, 0}, 2}}, {});
    // In steps of 1 m, zigzag. Frame 0: two lines. The first is expected at the origin with the color 0: color 3, from
    // (1, 0, 0), to (1, 2, 0). The second with the color of the first and both ends where that begins: color 0, from
    // (0, 0, -1), to (-1, 0, 0). One point. Frame 1: one line, by the first of frame 0: color -1, to (0, 1, 0).
    EXPECT_EQ(DrawingColumn(recording, 1),
              Bytes({2, 6, 2, 0, 0, 2, 4, 0, 0, 0, 0, 1, 1, 0, 0, 1, 2, 0, 10, 0, 1, 1, 0, 0, 0, 0, 2, 0, 0}));
    const auto header = DrawingHeader(recording, 1);
    EXPECT_EQ(header["mostLines"], 2);
    EXPECT_EQ(header["mostPoints"], 1);
}

TEST(ViewerDrawings, WhatIsNotFiniteIsDropped) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
    Recording recording;
    Append(recording, {{{kNan, 0, 0}, {0, 0, 0}, 1}, {{0, 0, 0}, {0, kInfinity, 0}, 1}, {{0, 0, 0}, {1e30f, 0, 0}, 1}},
           {{{0, 0, kNan}, 1}});
    EXPECT_EQ(recording.frames[0].lines.size(), 1u);
    EXPECT_TRUE(recording.frames[0].points.empty());
    EXPECT_FALSE(EncodePageData(recording).empty());  // 1e30 m count as 1e9 m
}

TEST(ViewerDrawings, WhatStandsStillCostsNextToNothing) {
    const auto sizeOf = [](int frames) {
        Recording recording;
        std::vector<RecordedLine> lines;
        for (int i = 0; i < 1000; ++i)
            lines.push_back({{0.37f * static_cast<float>(i), 1, 2}, {3, 0.11f * static_cast<float>(i), 1}, 0xFF0000});
        for (int frame = 0; frame < frames; ++frame) Append(recording, lines, {});
        return Deflated(DrawingColumn(recording, 0.001)).size();
    };
    // 7000 zeros a frame deflate by about a thousand.
    EXPECT_LT(sizeOf(101) - sizeOf(1), 100u * 20);
}

TEST(Recorder, TakesWhatTheSceneDrewInEachFrame) {
    auto world = SceneWorld::Create(*FindScene("query_bounds"));
    ASSERT_TRUE(world) << world.GetError().message;
    EXPECT_FALSE(world.Value()->Draw().IsOn());
    Recorder recorder(*world.Value(), 2, 1.0 / 60);
    for (int step = 0; step < 2; ++step) {
        ASSERT_TRUE(world.Value()->Step(1.0 / 60));
        recorder.AfterStep();
    }
    const std::vector<RecordedFrame>& frames = recorder.recording.frames;
    ASSERT_EQ(frames.size(), 3u);
    EXPECT_TRUE(frames[0].lines.empty());
    // Two boxes, a ray, two boxes and a line of the sweep.
    EXPECT_EQ(frames[1].lines.size(), 2 * 12 + 1 + 2 * 12 + 1u);
    EXPECT_EQ(frames[2].lines.size(), frames[1].lines.size());
    EXPECT_EQ(frames[1].lines[24].color, static_cast<uint32_t>(Ink::Path));
    EXPECT_LT(Length(frames[1].lines[24].from - Vector3(-7, 1.2f, frames[1].lines[24].to.z())), 1e-5f);
}

}  // namespace
}  // namespace fulcrum
