// Documents that ask for more than is read, or are no documents at all, are errors that say so; so are scenes that no
// document has. None throws, none takes long.
#include <Fulcrum/Assets/Json/JsonLimits.h>
#include <Fulcrum/Assets/RagdollJson.h>
#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/UnitTests/Support/FolderTest.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace fulcrum::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class SceneLimits : public FolderTest {
protected:
    fs::path Write(const char* name, const std::string& bytes) const {
        EXPECT_TRUE(WriteWholeFile(folder_ / name, {bytes}));
        return folder_ / name;
    }
};

template <class T>
void ExpectError(const Result<T>& result, const std::string& part) {
    ASSERT_FALSE(result) << part;
    EXPECT_NE(result.GetError().message.find(part), std::string::npos) << result.GetError().message;
}

Result<SceneDescription> SceneOf(const std::string& rest) {
    return SceneFromJson(R"({"fulcrumScene": 1, )" + rest + "}");
}

// Each shape is a compound of ten of the one before: 3 KB of text for ten millions of spheres.
std::string TenByTen(int levels) {
    std::string shapes = R"("shapes": {"s0": {"kind": "Sphere", "radius": 1})";
    for (int level = 1; level <= levels; ++level) {
        shapes += R"(, "s)" + std::to_string(level) + R"(": {"kind": "Compound", "children": [)";
        for (int i = 0; i < 10; ++i)
            shapes += (i > 0 ? ", " : "") + (R"({"shape": "s)" + std::to_string(level - 1) + R"("})");
        shapes += "]}";
    }
    return shapes + "}";
}

TEST_F(SceneLimits, ShapesTenByTenAreCounted) {
    EXPECT_TRUE(SceneOf(TenByTen(4)));
    ExpectError(SceneOf(TenByTen(7)), "shapes.s6: it has more than the 1048576 children of compounds that are read");
    // And bodies of a large one: 10 + 100 + 1000 + 10000 are the shapes', 104 times 10000 those of bodies.
    std::string bodies = R"(, "bodies": [{"shape": "s4"})";
    for (int i = 1; i < 104; ++i) bodies += R"(, {"shape": "s4"})";
    ExpectError(SceneOf(TenByTen(4) + bodies + "]"), "bodies[103].shape: it has more than the 1048576 children");
}

TEST_F(SceneLimits, CborThatClaimsMoreThanThereIsIsRefused) {
    // An array, and a map, of 2^64 - 1 elements; one of 2^60; a string of as many bytes; and within a scene.
    const std::string ones(8, '\xFF');
    const std::string many[] = {"\x9B" + ones,
                                "\xBB" + ones,
                                "\x7B" + ones,
                                "\x5B" + ones,
                                std::string("\x9B\x10\0\0\0\0\0\0\0", 9),
                                "\xA1\x61"
                                "a\x9B" +
                                    ones};
    for (const std::string& bytes : many) {
        EXPECT_FALSE(SceneFromCbor(bytes));
        EXPECT_FALSE(ReadScene(Write("scene.cbor", bytes)));
    }
}

TEST_F(SceneLimits, ValuesAndNamesAreCounted) {
    const auto list = [](int values) { return "[0" + std::string(static_cast<size_t>(values - 2), ',') + "]"; };
    const auto binary = [](int values) { return "\x9F" + std::string(static_cast<size_t>(values - 1), '\0') + "\xFF"; };
    const DocumentLimits thousand{.values = 1000};
    EXPECT_FALSE(CheckLimitsOfJson(list(1001), thousand));  // of which the first is not counted
    EXPECT_TRUE(CheckLimitsOfJson(list(1003), thousand));
    EXPECT_FALSE(CheckLimitsOfCbor(binary(1000), thousand));
    EXPECT_TRUE(CheckLimitsOfCbor(binary(1001), thousand));
    // n names of an object are compared n (n - 1) / 2 times: 4950 for a hundred.
    const DocumentLimits hundred{.comparisons = 4950};
    const auto names = [](int count) {
        std::string text = "{";
        for (int i = 0; i < count; ++i) text += "\"\":0,";
        return text + "}";
    };
    EXPECT_FALSE(CheckLimitsOfJson(names(100), hundred));
    EXPECT_TRUE(CheckLimitsOfJson(names(101), hundred));
    EXPECT_FALSE(CheckLimitsOfCbor("\xBF" + std::string(2 * 100, '\0') + "\xFF", hundred));
    EXPECT_TRUE(CheckLimitsOfCbor("\xBF" + std::string(2 * 101, '\0') + "\xFF", hundred));
    // Those of one object are not compared with another's: 110 times ten names take 45 each.
    std::string objects = "[";
    for (int i = 0; i < 110; ++i) objects += names(10) + ",";
    EXPECT_FALSE(CheckLimitsOfJson(objects, hundred));
    EXPECT_TRUE(CheckLimitsOfJson(objects + names(2), hundred));
}

TEST_F(SceneLimits, NamedFilesAreCountedAndMustBeFiles) {
    const std::string path = R"("ragdolls": [{"file": ")";
    for (const std::string& file : {std::string("/dev/zero"), folder_.string(), (folder_ / "none").string()})
        ExpectError(SceneOf(path + file + "\"}]"), "ragdolls[0]: " + file + ": it cannot be ");
    for (const char* kind : {"MeshFile", "HullFile"})
        for (const std::string& file : {std::string("/dev/zero"), folder_.string()})
            EXPECT_FALSE(
                SceneOf(R"("shapes": {"a": {"kind": ")" + std::string(kind) + R"(", "file": ")" + file + "\"}}"));
    for (const std::string& file : {std::string("/dev/zero"), folder_.string(), (folder_ / "none").string()}) {
        ExpectError(ReadScene(file), file);
        ExpectError(ReadRagdoll(file), file);
    }
    // A file of nothing, named again and again.
    const std::string large = Write("large.obj", "").string();
    fs::resize_file(large, kMostNamedBytes + 1);
    ExpectError(SceneOf(R"("shapes": {"a": {"kind": "MeshFile", "file": ")" + large + "\"}}"),
                "shapes.a: it has more than the 1073741824 bytes of files");
}

TEST_F(SceneLimits, AFiniteNumberDoesNotBecomeInfinite) {
    const char* const kBody = R"("bodies": [{"shape": {"kind": "Empty"}, "penetrationTarget": )";
    EXPECT_TRUE(SceneOf(std::string(kBody) + "3.4e38}]"));
    EXPECT_TRUE(SceneOf(std::string(kBody) + "\"infinity\"}]"));
    ExpectError(SceneOf(std::string(kBody) + "1e39}]"), "bodies[0].penetrationTarget");
    ExpectError(SceneOf(std::string(kBody) + "-1e300}]"), "bodies[0].penetrationTarget");
}

// A document that a program made may be nested without end.
TEST_F(SceneLimits, ShapesWithinShapesAreCounted) {
    Json shape = {{"kind", "Sphere"}, {"radius", 1}};
    for (int level = 0; level < 10'000; ++level) {
        Json outer = {{"kind", "Compound"}, {"children", Json::array({Json::object()})}};
        outer["children"][0]["shape"] = std::move(shape);
        shape = std::move(outer);
    }
    ExpectError(RagdollFromJson({{"parts", Json::array({{{"name", "a"}, {"body", {{"shape", std::move(shape)}}}}})}}),
                "nested too deep");
}

SceneDescription SmallScene() {
    SceneDescription scene;
    scene.bodies.push_back({"a", {.shape = SphereOf(1)}});
    scene.bodies.push_back({"b", {.shape = SphereOf(1)}});
    scene.joints.push_back({{}, 0, 1, HingeJointSettings{}});
    return scene;
}

RagdollSettings OneBall() {
    RagdollSettings ragdoll;
    ragdoll.parts.emplace_back();
    ragdoll.parts[0].name = "ball";
    ragdoll.parts[0].body.shape = SphereOf(1);
    return ragdoll;
}

TEST_F(SceneLimits, WhatNoDocumentHasIsNotWritten) {
    const float none = std::nanf("");
    const auto with = [](auto change) {
        SceneDescription scene = SmallScene();
        change(scene);
        return SceneToJson(scene);
    };
    EXPECT_TRUE(with([](SceneDescription&) {}));
    ExpectError(with([](auto& s) { s.bodies[1].settings.motion = MotionType(200); }), "bodies[1]: motion is 200");
    ExpectError(with([](auto& s) { s.bodies[1].settings.material.frictionRule = CombineRule(5); }),
                "bodies[1]: material.frictionRule is 5");
    ExpectError(with([](auto& s) { s.settings.narrowPhase = NarrowPhaseMethod(99); }), "settings: narrowPhase is 99");
    ExpectError(with([](auto& s) { s.settings.solver.positionCorrection = PositionCorrection(9); }),
                "settings: solver.positionCorrection is 9");
    ExpectError(with([&](auto& s) { s.bodies[0].settings.density = none; }), "bodies[0]: density is not a number");
    ExpectError(with([&](auto& s) { s.bodies[0].settings.position.y() = none; }), "bodies[0]: position is not");
    ExpectError(with([](auto& s) {
                    HingeJointSettings hinge;
                    hinge.angle.motor.mode = MotorMode(77);
                    s.joints[0].settings = hinge;
                }),
                "joints[0]: angle.motor.mode is 77");
    ExpectError(with([](auto& s) {
                    PathJointSettings path;
                    path.path = nullptr;
                    s.joints[0].settings = path;
                }),
                "joints[0]: path is null");
    ExpectError(with([](auto& s) { s.joints[0].bodyB = 2; }), "joints[0]: there is no body of that number");
    ExpectError(with([](auto& s) { s.bodies[1].name = "a"; }), "bodies[1].name");
    ExpectError(with([](auto& s) { s.bodies[1].name = "world"; }), "bodies[1].name");
    ExpectError(with([](auto& s) { s.steps = 0; }), "steps");
    ExpectError(with([](auto& s) { s.dt = 0; }), "dt");
    ExpectError(with([](auto& s) {
                    SceneRagdoll ragdoll{"r", {}, {}, MotionType(9)};
                    ragdoll.settings = OneBall();
                    s.ragdolls.push_back(ragdoll);
                }),
                "ragdolls[0]: motion is 9");
}

TEST_F(SceneLimits, AFileThatCannotBeWrittenRemains) {
    for (const char* name : {"scene.json", "scene.cbor"}) {
        const fs::path file = folder_ / name;
        ASSERT_TRUE(WriteScene(file, SmallScene()));
        const std::string before = ReadWholeFile(file).Value();
        SceneDescription broken = SmallScene();
        broken.bodies[0].settings.density = std::nanf("");
        EXPECT_FALSE(WriteScene(file, broken));
        EXPECT_EQ(ReadWholeFile(file).Value(), before);
        EXPECT_FALSE(WriteScene(folder_ / "no" / name, SmallScene()));
        EXPECT_FALSE(WriteScene(folder_, SmallScene()));
    }
    EXPECT_FALSE(WriteScene("/dev/full", SmallScene()));
    EXPECT_FALSE(WriteRagdoll("/dev/full", OneBall()));
    EXPECT_FALSE(WriteRagdoll(folder_.string(), OneBall()));
}

}  // namespace
}  // namespace fulcrum::testing
