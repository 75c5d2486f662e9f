#include "ViewerFallingStack.h"

#include <Fulcrum/Samples/Viewer/GlbWriter.h>
#include <Fulcrum/Samples/Viewer/ShapeMesh.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <fstream>
#include <numbers>
#include <sstream>

namespace fulcrum {
namespace {

// By the divergence theorem; also wrong if a triangle is turned inside out.
double VolumeOf(const ShapeMesh& mesh) {
    double volume = 0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vector3 &a = mesh.positions[mesh.indices[i]], &b = mesh.positions[mesh.indices[i + 1]],
                      &c = mesh.positions[mesh.indices[i + 2]];
        volume += Dot<float>(a, Cross<float>(b, c)) / 6;
        const Vector3 outwards = Cross<float>(b - a, c - a);
        EXPECT_GT(outwards.norm(), 0);
        EXPECT_GT(Dot<float>(outwards, mesh.normals[mesh.indices[i]]), 0);
    }
    for (const Vector3& normal : mesh.normals) EXPECT_NEAR(Length(normal), 1, 1e-6);
    return volume;
}

TEST(ViewerShapeMesh, EnclosesTheVolumeOfTheShape) {
    const FallingStack stack(1);
    const Recording& recording = stack.Get();
    const double pi = std::numbers::pi;
    EXPECT_NEAR(VolumeOf(MeshOfShape(recording, 1)), 8, 1e-5);
    // An inscribed polyhedron of 24 sides and steps of 15 degrees misses (15 degrees)^2 / 6 or 1.1 % around and 1.7 %
    // along.
    const double ball = 4.0 / 3 * pi * 1.2 * 1.2 * 1.2, capsule = 4.0 / 3 * pi * 0.343 + 2.4 * pi * 0.49;
    EXPECT_NEAR(VolumeOf(MeshOfShape(recording, 2)), ball, 0.03 * ball);
    EXPECT_NEAR(VolumeOf(MeshOfShape(recording, 3)), capsule, 0.03 * capsule);
    // A cube of side 4 without its corners, a sixth of it each.
    EXPECT_NEAR(VolumeOf(MeshOfShape(recording, 4)), 64.0 / 3, 1e-4);
    EXPECT_NEAR(VolumeOf(MeshOfShape(recording, 5)), ball + capsule, 0.03 * (ball + capsule));
}

nlohmann::json WrittenText(const Recording& recording, const std::string& name) {
    const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / name;
    const Status status = WriteGlb(recording, path);
    EXPECT_TRUE(status) << (status ? "" : status.GetError().message);
    std::ifstream file(path, std::ios::binary);
    std::stringstream content;
    content << file.rdbuf();
    const std::string bytes = content.str();
    std::filesystem::remove(path);
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    uint32_t total = 0, length = 0;
    std::memcpy(&total, bytes.data() + 8, 4);
    std::memcpy(&length, bytes.data() + 12, 4);
    EXPECT_EQ(total, bytes.size());
    EXPECT_EQ(length % 4, 0u);
    return nlohmann::json::parse(bytes.substr(20, length));
}

TEST(ViewerGlb, AnimatesWhatMovesAndNothingElse) {
    FallingStack stack(3);
    stack.AddFrames(120, 1.0 / 60);
    const nlohmann::json json = WrittenText(stack.Get(), "fulcrum-animated.glb");
    EXPECT_EQ(json["nodes"].size(), stack.Get().bodies.size());
    // Layer 0 of the pyramid never moves; layers 1 and 2 (4 cubes and 1) only fall; the four flyers move and turn.
    EXPECT_EQ(json["animations"][0]["channels"].size(), 4u + 1 + 2 * 4);
}

TEST(ViewerGlb, RestTakesTwoKeysHoweverLong) {
    FallingStack stack(1);
    Recording recording = stack.Get();
    RecordedState state;
    state.body = 1;
    for (int frame = 0; frame < 500; ++frame) {
        state.position.x() = frame < 250 ? 0.0f : 0.1f * static_cast<float>(frame - 250);
        AppendFrame(recording, frame, std::array{state}, {});
    }
    const nlohmann::json json = WrittenText(recording, "fulcrum-rest.glb");
    const nlohmann::json& sampler = json["animations"][0]["samplers"][0];
    // Start, end of the rest, end of the straight motion.
    EXPECT_EQ(json["accessors"][sampler["output"].get<size_t>()]["count"], 3);
    EXPECT_EQ(json["accessors"][sampler["input"].get<size_t>()]["max"][0], 499);
}

// A ball that comes in frame 1, is another one from frame 2 on and goes in frame 3: two nodes, each with a size while
// it is there.
TEST(ViewerGlb, WhatIsNotThereHasNoSize) {
    Recording recording;
    recording.shapes.resize(2);
    recording.shapes[0].radius = 1;
    recording.shapes[1].radius = 2;
    AppendFrame(recording, 0, {}, {});
    recording.bodies.emplace_back().isSensor = true;
    AppendFrame(recording, 1, {}, {});
    AppendFrame(recording, 2, {}, {}, {}, {}, std::array{RecordedShapeChange{0, 1}});
    RecordedState gone;
    gone.isThere = false;
    AppendFrame(recording, 3, std::array{gone}, {});
    const nlohmann::json json = WrittenText(recording, "fulcrum-presence.glb");
    ASSERT_EQ(json["nodes"].size(), 2u);
    EXPECT_NE(json["nodes"][0]["mesh"], json["nodes"][1]["mesh"]);
    const nlohmann::json& animation = json["animations"][0];
    ASSERT_EQ(animation["channels"].size(), 2u);
    for (size_t node = 0; node < 2; ++node) {
        EXPECT_EQ(animation["channels"][node]["target"]["path"], "scale");
        EXPECT_EQ(animation["samplers"][node]["interpolation"], "STEP");
        const nlohmann::json& times = json["accessors"][animation["samplers"][node]["input"].get<size_t>()];
        EXPECT_EQ(times["count"], 3);
        EXPECT_EQ(times["max"][0], 2.0 + static_cast<double>(node));
    }
    EXPECT_EQ(json["materials"].back()["alphaMode"], "BLEND");
}

TEST(ViewerGlb, NothingMovesIsNoAnimation) {
    FallingStack stack(1);
    stack.AddFrames(1, 1);
    EXPECT_FALSE(WrittenText(stack.Get(), "fulcrum-still.glb").contains("animations"));
}

TEST(ViewerGlb, NoBodiesIsAnError) {
    EXPECT_FALSE(WriteGlb(Recording(), std::filesystem::path(::testing::TempDir()) / "fulcrum-none.glb"));
}

}  // namespace
}  // namespace fulcrum
