// Scene files: what is written reads the same and steps to the same bits, and what is wrong is named by its path.
#include <Fulcrum/Assets/Json/Base64.h>
#include <Fulcrum/Assets/Json/Schema.h>
#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Samples/Runner/FileScene.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace fulcrum::testing {
namespace {

TEST(Base64, IsThatOfTheStandardBothWays) {
    // The test vectors of RFC 4648, section 10.
    const std::pair<std::string, std::string> pairs[] = {
        {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}, {"\xff\xfe\xfd", "//79"}};
    for (const auto& [bytes, text] : pairs) {
        EXPECT_EQ(ToBase64(bytes), text);
        const auto read = FromBase64(text);
        ASSERT_TRUE(read) << text;
        EXPECT_EQ(std::string(read->begin(), read->end()), bytes);
    }
    for (const char* wrong : {"Z", "Zg=", "Zg", "Zh==", "Z===", "Zm9v=", "Zm 8", "Zm9-"})
        EXPECT_FALSE(FromBase64(wrong)) << wrong;
}

std::string HashAfter(const SceneDescription& description, int steps) {
    auto system = PhysicsSystem::Create(description.settings).Value();
    const Result<SceneIds> ids = AddScene(*system, description);
    if (!ids) return ids.GetError().message;
    for (int i = 0; i < steps; ++i) EXPECT_TRUE(system->Update(description.dt));
    return std::to_string(system->HashState());
}

// Every shape, every joint, settings that are not the defaults.
SceneDescription Everything() {
    SceneDescription scene;
    scene.description = "one of \"everything\"";
    scene.steps = 77;
    scene.dt = 1.0 / 120;
    scene.settings.gravity = Vector3(0.1f, -9.7f, 1e-7f);
    scene.settings.solver = {.substeps = 7, .positionCorrection = PositionCorrection::Baumgarte};
    scene.settings.accuracy.jointError = 0.001f;
    scene.settings.layerCollides[3] = ~8u;
    std::vector<Vector3> points, vertices;
    RandomPoses random(9);
    for (int i = 0; i < 30; ++i) points.push_back(random.Direction() * random.Between(0.3f, 0.5f));
    for (int i = 0; i < 4; ++i) vertices.push_back(Vector3(i & 1 ? 9.0f : -9.0f, -3, i & 2 ? 9.0f : -9.0f));
    const uint32_t indices[] = {0, 2, 1, 1, 2, 3};
    std::vector<float> heights;
    for (int i = 0; i < 25; ++i) heights.push_back(random.Between(-0.2f, 0.2f));
    const ShapePtr shapes[] = {
        SphereOf(0.3f),
        BoxOf(0.1f, 0.2f, 0.3f),
        CapsuleOf(0.3f, 0.1f),
        TaperedCapsule::Create(0.3f, 0.1f, 0.2f).Value(),
        Cylinder::Create(0.3f, 0.2f).Value(),
        Cylinder::CreateCone(0.3f, 0.2f).Value(),
        Cylinder::CreateTapered(0.3f, 0.2f, 0.1f, 0.02f).Value(),
        ConvexHull::Create(points).Value(),
        ConvexHull::Create(points, {.maxVertices = 12, .convexRadius = 0.03f}).Value(),
        CompoundOf({{.shape = CubeOf(0.2f), .position = {0.3f, 0, 0}, .rotation = random.Rotation()},
                    {.shape = ConvexHull::Create(points).Value(), .density = 3}}),
        MutableCompound::Create(std::vector<CompoundShape::ChildSettings>{{.shape = SphereOf(0.2f)}}).Value()};
    for (const ShapePtr& shape : shapes) {
        const Vector3 at = random.InBox(2), velocity = random.InBox(1), spin = random.InBox(2);
        scene.bodies.push_back(
            {"body " + std::to_string(scene.bodies.size()),
             {.shape = shape,
              .position = at.cast<double>() * 1.000000001,
              .rotation = random.Rotation(),
              .linearVelocity = velocity,
              .angularVelocity = spin,
              .density = random.Between(100, 2000),
              .material = {.friction = random.Between(0, 1), .restitutionRule = CombineRule::Average},
              .lockedAxes = scene.bodies.size() == 3 ? LockedAxes::Plane2D : LockedAxes::None,
              .category = 5,
              .mask = 0xFFFFFFFFFFFFFFFEull,
              .continuous = ContinuousCollision::LinearAndAngular,
              .userData = 0x8000000000000001ull}});
    }
    const ShapePtr grounds[] = {
        Plane::Create(Vector3(0, 1, 0), -4).Value(),
        TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value(),
        HeightField::Create({.sampleCountX = 5, .sampleCountZ = 5, .heights = heights, .origin = {-2, -2.5f, -2}})
            .Value()};
    for (const ShapePtr& ground : grounds)
        scene.bodies.push_back({{}, {.shape = ground, .motion = MotionType::Static}});
    scene.bodies.push_back({{}, {.shape = shapes[0], .position = {7, 0, 0}, .isSensor = true}});  // shares one

    const auto join = [&](auto settings, int a, int b) {
        settings.anchorA.point = scene.bodies[static_cast<size_t>(std::max(a, b))].settings.position;
        scene.joints.push_back({"joint " + std::to_string(scene.joints.size()), a, b, settings});
    };
    PulleyJointSettings pulley;
    pulley.fixedPointA = {0, 9, 0};
    pulley.fixedPointB = {1, 9, 0};
    PathJointSettings path;
    const Vector3 places[] = {{-1, 0, 0}, {0, 0.2f, 0}, {1, 0, 0.1f}}, up(0, 1, 0);
    path.path = Path::CatmullRom(places, std::span(&up, 1), false).Value();
    HingeJointSettings hinge;
    hinge.angle.limited = true;
    hinge.angle.limits = {.min = -0.3f, .max = 0.7f};
    WheelJointSettings wheel;
    wheel.anchorA.normal.reset();  // where the default has one
    join(PointJointSettings{}, 0, 1);
    join(FixedJointSettings{}, 1, 2);
    join(DistanceJointSettings{}, 2, 3);
    join(hinge, SceneJoint::kWorld, 4);
    join(SliderJointSettings{}, 4, 5);
    join(ConeJointSettings{}, 5, 6);
    join(SwingTwistJointSettings{}, 6, 7);
    join(SixDofJointSettings{}, 7, 8);
    join(GearJointSettings{}, 0, 8);
    join(RackAndPinionJointSettings{}, 1, 8);
    join(pulley, 2, 8);
    join(path, SceneJoint::kWorld, 9);
    join(wheel, 9, 10);
    return scene;
}

TEST(SceneFile, OfEverythingIsTheSameSceneBitByBit) {
    const SceneDescription scene = Everything();
    const Result<std::string> text = SceneToJson(scene);
    ASSERT_TRUE(text) << text.GetError().message;
    const Result<SceneDescription> read = SceneFromJson(text.Value());
    ASSERT_TRUE(read) << read.GetError().message;
    EXPECT_EQ(read.Value().description, scene.description);
    EXPECT_EQ(read.Value().steps, scene.steps);
    EXPECT_EQ(read.Value().dt, scene.dt);
    EXPECT_EQ(read.Value().settings.layerCollides, scene.settings.layerCollides);
    ASSERT_EQ(read.Value().bodies.size(), scene.bodies.size());
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodySettings &a = scene.bodies[i].settings, &b = read.Value().bodies[i].settings;
        EXPECT_EQ(SaveShape(*a.shape).Value(), SaveShape(*b.shape).Value()) << i;
        EXPECT_EQ(a.position, b.position) << i;
        EXPECT_EQ(a.mask, b.mask) << i;
        EXPECT_EQ(a.userData, b.userData) << i;
    }
    EXPECT_EQ(read.Value().bodies[0].settings.shape, read.Value().bodies.back().settings.shape) << "one shape, shared";
    EXPECT_EQ(HashAfter(read.Value(), 30), HashAfter(scene, 30));
    EXPECT_EQ(SceneToJson(read.Value()).Value(), text.Value());
}

TEST(SceneFile, OfScenesStepsAsTheScenesDo) {
    for (const char* name : {"pyramid", "hull_pile", "friction_ramp", "path", "springs", "ragdolls", "gears"}) {
        const Scene& scene = *FindScene(name);
        const auto original = SceneWorld::Create(scene).Value();
        const Result<ExportedScene> exported = ExportScene(scene, {});
        ASSERT_TRUE(exported) << name << ": " << exported.GetError().message;
        const Result<SceneDescription> read = SceneFromJson(SceneToJson(exported.Value().description).Value());
        ASSERT_TRUE(read) << name << ": " << read.GetError().message;
        const Scene ofFile = SceneOf(name, read.Value());
        SceneInput input;
        input.description = &read.Value();
        const auto again = SceneWorld::Create(ofFile, input).Value();
        for (int i = 0; i < 20; ++i) {
            ASSERT_TRUE(original->Step(1.0 / 60));
            ASSERT_TRUE(again->Step(1.0 / 60));
        }
        EXPECT_EQ(original->System().HashState(), again->System().HashState()) << name;
    }
}

TEST(SceneFile, IsJsonOrCborByItsName) {
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "scene_file_test";
    std::filesystem::create_directories(folder);
    const SceneDescription scene = Everything();
    for (const char* name : {"scene.json", "scene.cbor"}) {
        ASSERT_TRUE(WriteScene(folder / name, scene));
        const Result<SceneDescription> read = ReadScene(folder / name);
        ASSERT_TRUE(read) << read.GetError().message;
        EXPECT_EQ(HashAfter(read.Value(), 5), HashAfter(scene, 5)) << name;
    }
    EXPECT_LT(std::filesystem::file_size(folder / "scene.cbor"), std::filesystem::file_size(folder / "scene.json"));
    // Cut anywhere, it is refused.
    std::ifstream whole(folder / "scene.cbor", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
    for (size_t size = 0; size < bytes.size(); size += 97) {
        std::ofstream(folder / "cut.cbor", std::ios::binary) << bytes.substr(0, size);
        EXPECT_FALSE(ReadScene(folder / "cut.cbor")) << size;
    }
    EXPECT_NE(ReadScene(folder / "none.json").GetError().message.find("none.json"), std::string::npos);
    std::filesystem::remove_all(folder);
}

TEST(SceneFile, ErrorsNameThePath) {
    const std::pair<const char*, const char*> wrong[] = {
        {R"({)", "line 1"},
        {R"([])", "must be an object"},
        {R"({"fulcrumScene": 1, "dt": 1e2222222})", "1e2222222"},  // beyond a double
        {R"({})", "fulcrumScene: 0"},
        {R"({"fulcrumScene": 2})", "fulcrumScene: 2"},
        {R"({"fulcrumScene": 1, "stepz": 3})", "stepz: an unknown name"},
        {R"({"fulcrumScene": 1, "steps": 0})", "steps: it must be 1 or more"},
        {R"({"fulcrumScene": 1, "dt": "fast"})", "dt: of type string"},
        {R"({"fulcrumScene": 1, "settings": {"solver": {"substeps": 2.5}}})",
         "settings.solver.substeps: of type number"},
        {R"({"fulcrumScene": 1, "bodies": {}})", "bodies: it must be an array"},
        {R"({"fulcrumScene": 1, "bodies": [3]})", "bodies[0]: it must be an object"},
        {R"({"fulcrumScene": 1, "bodies": [{}]})", "bodies[0].shape: it is missing"},
        {R"({"fulcrumScene": 1, "bodies": [{"shape": "crate"}]})", "bodies[0].shape: no shape has the name \"crate\""},
        {R"({"fulcrumScene": 1, "bodies": [{"shape": {"kind": "Ball"}}]})", "bodies[0].shape.kind: \"Ball\""},
        {R"({"fulcrumScene": 1, "bodies": [{"shape": {"kind": "Sphere", "radius": -1}}]})", "bodies[0].shape: "},
        {R"({"fulcrumScene": 1, "bodies": [{"shape": {"kind": "Baked", "base64": "AAAA"}}]})", "bodies[0].shape: "},
        {R"({"fulcrumScene": 1, "shapes": {"a": {"kind": "MeshFile", "file": "no.obj"}}})", "shapes.a: "},
        {R"({"fulcrumScene": 1, "bodies": [{"name": "world", "shape": {"kind": "Empty"}}]})", "bodies[0].name"},
        {R"({"fulcrumScene": 1, "joints": [{"kind": "Point", "bodyA": "x", "bodyB": "world"}]})",
         "joints[0].bodyA: no body"},
        {R"({"fulcrumScene": 1, "joints": [{"kind": "Point", "bodyA": 0, "bodyB": "world"}]})",
         "joints[0].bodyA: there are 0"},
        {R"({"fulcrumScene": 1, "joints": [{"kind": "Rope", "bodyA": "world", "bodyB": "world"}]})",
         "joints[0].kind: \"Rope\""},
        {R"({"fulcrumScene": 1, "joints": [{"bodyA": "world", "bodyB": "world"}]})", "joints[0]: kind is missing"},
        {R"({"fulcrumScene": 1, "joints": [{"kind": "Path", "bodyA": "world", "bodyB": "world", "path": {"points": []}}]})",
         "path has 0 points; it needs 2"},
        {R"({"fulcrumScene": 1, "settings": {"gravity": [0, "down", 0]}})", "must be a number, or infinity in quotes"},
        {R"({"fulcrumScene": 1, "ragdolls": [{"file": "no.json"}]})", "no.json"}};
    for (const auto& [text, message] : wrong) {
        const Result<SceneDescription> read = SceneFromJson(text);
        ASSERT_FALSE(read) << text;
        EXPECT_NE(read.GetError().message.find(message), std::string::npos) << text << "\n" << read.GetError().message;
    }
}

// What earlier versions had and this one does not need is read past, with a note.
TEST(SceneFile, SettingsOfEarlierVersionsAreNoted) {
    const Result<SceneDescription> read =
        SceneFromJson(R"({"fulcrumScene": 1, "settings": {"jointFrequency": 30, "jointDampingRatio": 2,
                          "accuracy": {"penetration": 0.01, "drift": 0.1, "mostSubsteps": 64, "largeIslands": true}}})");
    ASSERT_TRUE(read) << read.GetError().message;
    ASSERT_EQ(read.Value().notes.size(), 5u);
    EXPECT_EQ(read.Value().settings.accuracy.penetration, 0.01f);
    EXPECT_NE(std::find(read.Value().notes.begin(), read.Value().notes.end(),
                        "settings.jointFrequency has no effect: locks of joints are hard"),
              read.Value().notes.end());
    EXPECT_FALSE(SceneFromJson(R"({"fulcrumScene": 1, "jointFrequency": 30})"));
}

// Readers call themselves for each level.
TEST(SceneFile, NestedTooDeepIsRefused) {
    std::string shape = R"({"kind": "Sphere", "radius": 1})";
    for (int level = 0; level < 20; ++level) shape = R"({"kind": "Compound", "children": [{"shape": )" + shape + "}]}";
    EXPECT_TRUE(SceneFromJson(R"({"fulcrumScene": 1, "bodies": [{"shape": )" + shape + "}]}"));
    std::string before, after;
    for (int level = 0; level < 100'000; ++level) {
        before += R"({"kind": "Compound", "children": [{"shape": )";
        after += "}]}";
    }
    const Result<SceneDescription> deep =
        SceneFromJson(R"({"fulcrumScene": 1, "bodies": [{"shape": )" + before + "3" + after + "}]}");
    ASSERT_FALSE(deep);
    EXPECT_NE(deep.GetError().message.find("nested"), std::string::npos) << deep.GetError().message;
    const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "deep_scene_test.cbor";
    // An array of one element each, maps of one, arrays without end; strings of which the pieces are strings; tags.
    const std::pair<char, const char*> heads[] = {{'\x81', "nested"},  {'\xA1', "nested"},  {'\x9F', "nested"},
                                                  {'\x5F', "unknown"}, {'\x7F', "unknown"}, {'\xC0', "tags"}};
    for (const auto& [head, message] : heads) {
        std::ofstream(file, std::ios::binary) << std::string(1'000'000, head);
        const Result<SceneDescription> binary = ReadScene(file);
        ASSERT_FALSE(binary);
        EXPECT_NE(binary.GetError().message.find(message), std::string::npos) << binary.GetError().message;
    }
    std::filesystem::remove(file);
}

// What is no UTF-8 cannot stand in JSON.
TEST(SceneFile, ANameOfAnyBytesIsWritten) {
    SceneDescription scene = Everything();
    scene.bodies[0].name = "a\xff";
    const Result<std::string> text = SceneToJson(scene);
    ASSERT_TRUE(text);
    const Result<SceneDescription> read = SceneFromJson(text.Value());
    ASSERT_TRUE(read) << read.GetError().message;
    EXPECT_EQ(read.Value().bodies[0].name, "a\xEF\xBF\xBD");
}

TEST(SceneFile, ThatCannotBeAddedLeavesNothing) {
    SceneDescription scene = Everything();
    HingeJointSettings broken;
    broken.angle.friction = -1;
    scene.joints.push_back({{}, 0, 1, broken});
    TestWorld world;
    world.AddFloor();
    const Result<SceneIds> ids = AddScene(world.System(), scene);
    ASSERT_FALSE(ids);
    EXPECT_NE(ids.GetError().message.find("joints[13]: "), std::string::npos) << ids.GetError().message;
    size_t bodies = 0, joints = 0;
    world.System().VisitBodies([&](BodyId) { ++bodies; });
    world.System().Joints().Visit([&](JointId) { ++joints; });
    EXPECT_EQ(bodies, 1u);
    EXPECT_EQ(joints, 0u);
}

// The chest of 1 m, whose lid turns about its upper edge at z = -0.5 by a quarter, onto its top.
TEST(SceneFile, TheExampleOfTheDocumentFallsShut) {
    std::ifstream file(FULCRUM_SOURCE_DIR "/Docs/SceneFiles.md");
    const std::string page((std::istreambuf_iterator<char>(file)), {});
    const size_t begin = page.find("```json\n") + 8;
    const Result<SceneDescription> scene = SceneFromJson(page.substr(begin, page.find("```", begin) - begin));
    ASSERT_TRUE(scene) << scene.GetError().message;
    const auto system = PhysicsSystem::Create(scene.Value().settings).Value();
    const Result<SceneIds> ids = AddScene(*system, scene.Value());
    ASSERT_TRUE(ids) << ids.GetError().message;
    for (int i = 0; i < scene.Value().steps; ++i) ASSERT_TRUE(system->Update(scene.Value().dt));
    const Position lid = system->Bodies().GetPose(ids.Value().bodies[2]).position;
    EXPECT_NEAR(lid.y(), 1.05, 0.01);
    EXPECT_NEAR(lid.z(), 0, 0.01);
}

// With FULCRUM_WRITE_SCHEMA=1 it writes the file anew.
TEST(SceneFile, TheSchemaIsThatOfTheFields) {
    constexpr const char* kFile = FULCRUM_SOURCE_DIR "/Assets/scene.schema.json";
    if (std::getenv("FULCRUM_WRITE_SCHEMA")) std::ofstream(kFile) << SceneSchema();
    std::ifstream file(kFile);
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_EQ(text.str(), SceneSchema()) << "Assets/scene.schema.json is not what the fields say";
}

}  // namespace
}  // namespace fulcrum::testing
