#include "ViewerFallingStack.h"

#include <Fulcrum/Assets/Json/Base64.h>
#include <Fulcrum/Samples/Viewer/HtmlWriter.h>
#include <Fulcrum/Samples/Viewer/PageData.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

namespace fulcrum {
namespace {

// The format of PageData.h once more, as short as can be.
class Reader {
public:
    explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}
    uint64_t Unsigned() {
        uint64_t value = 0;
        for (int shift = 0;; shift += 7) {
            const uint8_t byte = static_cast<uint8_t>(bytes_.at(at_++));
            value |= static_cast<uint64_t>(byte & 127) << shift;
            if (byte < 128) return value;
        }
    }
    int64_t Signed() {
        const uint64_t value = Unsigned();
        return static_cast<int64_t>(value >> 1) ^ -static_cast<int64_t>(value & 1);
    }
    bool IsAtEnd() const { return at_ == bytes_.size(); }

private:
    std::string bytes_;
    size_t at_ = 0;
};

struct Decoded {
    double positionStep = 0;
    std::vector<Reader> columns;
};

// The header's numbers are found by their names: a JSON parser is not what is tested here.
Decoded Split(const std::string& bytes) {
    size_t length = 0;
    for (size_t i = 0; i < 4; ++i) length |= static_cast<size_t>(static_cast<uint8_t>(bytes[i])) << (8 * i);
    const std::string header = bytes.substr(4, length);
    Decoded decoded;
    decoded.positionStep = std::stod(header.substr(header.find("\"positionStep\":") + 15));
    std::istringstream sizes(header.substr(header.find("\"columns\":[") + 11));
    size_t at = 4 + length, size = 0;
    char comma = 0;
    while (sizes >> size) {
        decoded.columns.emplace_back(bytes.substr(at, size));
        at += size;
        sizes >> comma;
    }
    EXPECT_EQ(at, bytes.size());
    return decoded;
}

struct Tracked {
    std::array<int64_t, 3> position = {}, moved = {}, velocity = {};
    std::array<int64_t, 4> rotation = {};
    int64_t island = -1;
    long frame = -2;
    bool awake = true;
};

TEST(ViewerPageData, ComesBackWithinItsSteps) {
    FallingStack stack(5);
    const double dt = 1.0 / 60;
    stack.AddFrames(240, dt);
    Decoded decoded = Split(EncodePageData(stack.Get()));
    ASSERT_EQ(decoded.columns.size(), 11u);
    Reader &states = decoded.columns[0], &positions = decoded.columns[1], &rotations = decoded.columns[2],
           &velocities = decoded.columns[3], &islands = decoded.columns[4];
    std::map<size_t, Tracked> bodies;
    for (long frame = 0; frame < 240; ++frame) {
        size_t body = 0;
        for (uint64_t left = states.Unsigned(); left > 0; --left, ++body) {
            body += states.Unsigned();
            Tracked& tracked = bodies[body];
            const uint64_t flags = states.Unsigned();
            tracked.awake = flags & 1;
            if (flags & 2) tracked.island += islands.Signed();
            for (size_t k = 0; k < 3; ++k) {
                const int64_t change = positions.Signed() + (tracked.frame + 1 == frame ? tracked.moved[k] : 0);
                tracked.position[k] += change;
                tracked.moved[k] = tracked.frame == -2 ? 0 : change;
                tracked.velocity[k] += velocities.Signed();
            }
            for (int64_t& part : tracked.rotation) part += rotations.Signed();
            tracked.frame = frame;
        }
        ASSERT_EQ(bodies.size(), stack.Get().bodies.size());
        for (const auto& [id, tracked] : bodies) {
            const RecordedState expected = stack.StateAt(static_cast<uint32_t>(id), static_cast<double>(frame) * dt);
            // Rounding to the nearest step is off by half a step at most; a rotation may have the other sign.
            double dot = 0;
            const Quaternion& q = expected.rotation;
            const std::array<float, 4> parts = {q.x, q.y, q.z, q.w};
            for (size_t k = 0; k < 4; ++k) dot += parts[k] * static_cast<double>(tracked.rotation[k]);
            for (size_t k = 0; k < 4; ++k)
                ASSERT_NEAR(std::copysign(1.0, dot) * static_cast<double>(tracked.rotation[k]) / kRotationSteps,
                            parts[k], 0.51 / kRotationSteps);
            for (int k = 0; k < 3; ++k) {
                ASSERT_NEAR(static_cast<double>(tracked.position[k]) * decoded.positionStep, expected.position[k],
                            0.51 * decoded.positionStep);
                ASSERT_NEAR(static_cast<double>(tracked.velocity[k]) * kVelocityStep, expected.velocity[k],
                            0.51 * kVelocityStep);
            }
            ASSERT_EQ(tracked.island, expected.island);
            ASSERT_EQ(tracked.awake, expected.awake);
        }
    }
    for (const Reader* column : {&states, &positions, &rotations, &velocities, &islands})
        EXPECT_TRUE(column->IsAtEnd());
}

TEST(ViewerPageData, SaysWhatIsASensorWhatIsGoneAndWhatHasAnotherShape) {
    Recording recording;
    recording.shapes.resize(2);
    recording.bodies.resize(2);
    recording.bodies[1].isSensor = true;
    AppendFrame(recording, 0, {}, {});
    RecordedState gone;
    gone.awake = gone.isThere = false;
    AppendFrame(recording, 1, std::array{gone}, {}, {}, {}, std::array{RecordedShapeChange{1, 1}});
    const std::string bytes = EncodePageData(recording);
    EXPECT_NE(bytes.find("\"sensors\":[1]"), std::string::npos);
    EXPECT_NE(bytes.find("\"shapeChanges\":[[1,1,1]]"), std::string::npos);
    Decoded decoded = Split(bytes);
    std::vector<uint64_t> flags;
    for (int frame = 0; frame < 2; ++frame)
        for (uint64_t left = decoded.columns[0].Unsigned(); left > 0; --left) {
            EXPECT_EQ(decoded.columns[0].Unsigned(), 0u);  // no body is left out
            flags.push_back(decoded.columns[0].Unsigned());
        }
    EXPECT_EQ(flags, (std::vector<uint64_t>{1, 1, 4}));
    EXPECT_TRUE(decoded.columns[0].IsAtEnd());
}

TEST(ViewerPageData, RestingBodiesCostNoBytesAFrame) {
    FallingStack stack(8);
    Recording recording = stack.Get();
    AppendFrame(recording, 0, {}, {});
    const size_t before = EncodePageData(recording).size();
    for (int frame = 1; frame <= 1000; ++frame) AppendFrame(recording, frame, recording.latest, {});
    // A frame takes its time and its number in the list of frames with contacts (up to 7 and 5 letters), and two counts
    // of 0.
    EXPECT_LE(EncodePageData(recording).size() - before, 1000u * (7 + 5 + 2));
}

class ViewerHtml : public ::testing::Test {
protected:
    ViewerHtml() { std::filesystem::remove_all(folder_); }
    ~ViewerHtml() override { std::filesystem::remove_all(folder_); }
    const std::filesystem::path folder_ =
        std::filesystem::path(::testing::TempDir()) /
        (std::string("fulcrum-html-") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ViewerHtml, WritesOnePageAndNothingElse) {
    FallingStack stack(3);
    stack.AddFrames(10, 1.0 / 60);
    const Status status = WriteHtml(stack.Get(), folder_ / "deep" / "page.html");
    ASSERT_TRUE(status) << status.GetError().message;
    std::ifstream file(folder_ / "deep" / "page.html");
    std::stringstream page;
    page << file.rdbuf();
    EXPECT_EQ(page.str().rfind("<!doctype html>", 0), 0u);
    EXPECT_NE(page.str().find(ToBase64(Deflated(EncodePageData(stack.Get())))), std::string::npos);
    EXPECT_EQ(page.str().find("@@FULCRUM"), std::string::npos);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "deep"), {}), 1);
}

TEST_F(ViewerHtml, PlaceThatCannotBeWrittenIsNamed) {
    FallingStack stack(1);
    stack.AddFrames(1, 1);
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "file") << "in the way";
    const Status status = WriteHtml(stack.Get(), folder_ / "file" / "page.html");
    ASSERT_FALSE(status);
    EXPECT_NE(status.GetError().message.find("page.html: "), std::string::npos) << status.GetError().message;
}

TEST_F(ViewerHtml, PyramidOfFiveSecondsStaysSmall) {
    FallingStack stack(15);
    stack.AddFrames(300, 1.0 / 60);
    ASSERT_TRUE(WriteHtml(stack.Get(), folder_ / "page.html"));
    EXPECT_LT(std::filesystem::file_size(folder_ / "page.html"), 15u << 20);
}

}  // namespace
}  // namespace fulcrum
