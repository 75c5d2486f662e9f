// Import of mesh files as shapes: valid files, and files without usable meshes.
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Assets/Meshes/MeshImport.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>
#include <Fulcrum/UnitTests/Support/FolderTest.h>

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <sstream>

// assimp leaks a little memory for broken files; this names the leaks to suppress.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

namespace fulcrum {
namespace {

namespace fs = std::filesystem;

class MeshFiles : public testing::FolderTest {
protected:
    fs::path Write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }
    std::string Complaint(const fs::path& path) const {
        const auto shape = ImportShape(path, 1);
        if (!shape) return shape.GetError().message;
        ADD_FAILURE() << path << " was read";
        return {};
    }
};

// A box of an OBJ group; `first` is the number of vertices before it.
std::string ObjBox(const std::string& name, const Position& lowest, const Position& highest, int first) {
    std::ostringstream text;
    text << "o " << name << "\n";
    for (int i = 0; i < 8; ++i)
        text << "v " << (i & 1 ? highest : lowest).x() << " " << (i & 2 ? highest : lowest).y() << " "
             << (i & 4 ? highest : lowest).z() << "\n";
    const std::array<std::array<int, 4>, 6> faces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& face : faces) {
        text << "f";
        for (int corner : face) text << " " << first + corner + 1;
        text << "\n";
    }
    return text.str();
}

// The meshes that ./fulcrum drop can be tried with.
TEST(SampleMeshes, TheTeapotIsSeventeenConvexPartsAndTheFountainOneClosedSurface) {
    const fs::path folder = fs::path(FULCRUM_SOURCE_DIR) / "Samples" / "Meshes";
    const auto teapot = ImportShape(folder / "teapot.obj", 1);
    ASSERT_TRUE(teapot) << teapot.GetError().message;
    EXPECT_EQ(teapot.Value().hulls, 17u);
    EXPECT_TRUE(teapot.Value().warnings.empty()) << teapot.Value().warnings.front();
    const Bounds box = teapot.Value().shape->LocalBounds();
    EXPECT_NEAR(box.upper.x() - box.lower.x(), 1, 1e-3);
    const auto fountain = ImportMesh(folder / "fountain.obj");
    ASSERT_TRUE(fountain) << fountain.GetError().message;
    EXPECT_FALSE(fountain.Value().isTwoSided);
    EXPECT_EQ(fountain.Value().report.boundaryEdges, 0u);
    EXPECT_EQ(fountain.Value().report.irregularEdges, 0u);
}

TEST_F(MeshFiles, ACubeBecomesAHullOf8VerticesAnd1m) {
    const auto read = ImportShape(Write("cube.obj", ObjBox("cube", {10, 10, 10}, {14, 14, 14}, 0)), 1);
    ASSERT_TRUE(read) << read.GetError().message;
    const auto hull = std::dynamic_pointer_cast<const ConvexHull>(read.Value().shape);
    ASSERT_TRUE(hull);
    EXPECT_EQ(hull->Vertices().size(), 8u);
    EXPECT_NEAR(hull->Mass().volume, 1, 1e-5);
    EXPECT_LT(Length(hull->Mass().centerOfMass), 1e-5f);  // centered on its bounds
    EXPECT_DOUBLE_EQ(read.Value().fileSize, 4);
    EXPECT_TRUE(read.Value().warnings.empty());
}

TEST_F(MeshFiles, TwoMeshesBecomeACompoundOfTwoHulls) {
    const std::string text = ObjBox("left", {0, 0, 0}, {1, 1, 1}, 0) + ObjBox("right", {3, 0, 0}, {4, 1, 1}, 8);
    const auto read = ImportShape(Write("two.obj", text), 2);
    ASSERT_TRUE(read) << read.GetError().message;
    const auto compound = std::dynamic_pointer_cast<const Compound>(read.Value().shape);
    ASSERT_TRUE(compound);
    EXPECT_EQ(compound->Children().size(), 2u);
    EXPECT_NEAR(compound->LocalBounds().upper.x(), 1, 1e-5);  // 4 units are 2 m
    EXPECT_NEAR(compound->Mass().volume, 2 * 0.125, 1e-5);
}

TEST_F(MeshFiles, AFlatPartIsLeftOutWithAWarning) {
    const std::string text =
        ObjBox("cube", {0, 0, 0}, {1, 1, 1}, 0) + "o sheet\nv 0 0 9\nv 9 0 9\nv 0 9 9\nf 9 10 11\n";
    const auto read = ImportShape(Write("sheet.obj", text), 1);
    ASSERT_TRUE(read) << read.GetError().message;
    EXPECT_EQ(read.Value().hulls, 1u);
    ASSERT_EQ(read.Value().warnings.size(), 1u);
    EXPECT_NE(read.Value().warnings[0].find("sheet"), std::string::npos) << read.Value().warnings[0];
    // The sheet counts no more: the cube alone is 1 m.
    EXPECT_NEAR(read.Value().shape->LocalBounds().upper.x(), 0.5, 1e-5);
}

TEST_F(MeshFiles, NodesPlaceTheirMeshes) {
    // A triangle pyramid in glTF, drawn by two nodes, one moved by 3 and turned upside down.
    const std::string buffer =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAC"
        "AAEAAAABAAMAAAADAAIAAQACAAMA";
    const std::string text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
      "nodes":[{"mesh":0},{"mesh":0,"translation":[3,0,0],"rotation":[1,0,0,0]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
                   {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
      "buffers":[{"byteLength":72,"uri":")" +
                             buffer + R"("}]})";
    const auto read = ImportShape(Write("nodes.gltf", text), 4);
    ASSERT_TRUE(read) << read.GetError().message;
    EXPECT_EQ(read.Value().hulls, 2u);
    // From 0 to 4 in x; the second pyramid reaches as far below y = 0 as the first one above.
    EXPECT_NEAR(read.Value().shape->LocalBounds().upper.x() - read.Value().shape->LocalBounds().lower.x(), 4, 1e-4);
    EXPECT_NEAR(read.Value().shape->LocalBounds().upper.y() - read.Value().shape->LocalBounds().lower.y(), 2, 1e-4);
}

TEST_F(MeshFiles, InvalidMeshesAreErrorsWithAReason) {
    EXPECT_NE(Complaint(folder_ / "absent.obj").find("no file"), std::string::npos);
    EXPECT_NE(Complaint(folder_).find("not a file"), std::string::npos);
    EXPECT_NE(Complaint(Write("empty.obj", "")).find("empty.obj"), std::string::npos);
    EXPECT_NE(Complaint(Write("text.txt", "no mesh at all")).find("cannot be read"), std::string::npos);
    EXPECT_NE(Complaint(Write("broken.stl", "solid x\nfacet normal 0 0")).find("broken.stl"), std::string::npos);
    const std::string flat = Complaint(Write("quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"));
    EXPECT_NE(flat.find("no part with a volume"), std::string::npos) << flat;
    const std::string point = Complaint(Write("point.obj", "v 2 2 2\nv 2 2 2\nv 2 2 2\nf 1 2 3\n"));
    EXPECT_NE(point.find("extent"), std::string::npos) << point;
}

TEST_F(MeshFiles, AHeapOfOneLandsInItsTray) {
    const std::string text = ObjBox("left", {0, 0, 0}, {1, 1, 1}, 0) + ObjBox("right", {1, 0, 0}, {2, 3, 1}, 8);
    const auto read = ImportShape(Write("ell.obj", text), 1);
    ASSERT_TRUE(read) << read.GetError().message;
    SceneInput input;
    input.shape = read.Value().shape;
    input.count = 12;
    const auto world = SceneWorld::Create(DropScene::kScene, input);
    ASSERT_TRUE(world) << world.GetError().message;
    for (int step = 0; step < 240; ++step) ASSERT_TRUE(world.Value()->Step(1.0 / 60));
    EXPECT_EQ(world.Value()->watched.size(), 12u);
    EXPECT_EQ(world.Value()->NonFiniteBodies(), 0);
    EXPECT_EQ(DropScene::kScene.accuracy(*world.Value()), 0);
    for (BodyId id : world.Value()->watched) EXPECT_LT(world.Value()->Bodies().GetCenterOfMass(id).y(), 2.5);
}

// ---- Triangles to drop onto

class MeshGrounds : public MeshFiles {
protected:
    ImportedMesh Import(const fs::path& path, const MeshImportSettings& settings = {}) const {
        const auto mesh = ImportMesh(path, settings);
        if (mesh) return mesh.Value();
        ADD_FAILURE() << mesh.GetError().message;
        return {};
    }
    std::string Refusal(const fs::path& path, const MeshImportSettings& settings = {}) const {
        const auto mesh = ImportMesh(path, settings);
        if (!mesh) return mesh.GetError().message;
        ADD_FAILURE() << path << " was read";
        return {};
    }
};

// 2 x 2 squares over x and z, seen from above; one corner higher.
constexpr const char* kSheet =
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 0 1\nv 1 0.5 1\nv 2 0 1\nv 0 0 2\nv 1 0 2\nv 2 0 2\n"
    "f 1 4 5 2\nf 2 5 6 3\nf 4 7 8 5\nf 5 8 9 6\n";

TEST_F(MeshGrounds, AClosedBoxStandsOnTheFloorWithOneSide) {
    const ImportedMesh read = Import(Write("cube.obj", ObjBox("cube", {10, 10, 10}, {14, 12, 14}, 0)));
    ASSERT_TRUE(read.mesh);
    EXPECT_EQ(read.mesh->TriangleCount(), 12u);
    EXPECT_EQ(read.mesh->VertexCount(), 8u);
    EXPECT_FALSE(read.isTwoSided);
    EXPECT_DOUBLE_EQ(read.fileSize, 4);
    EXPECT_DOUBLE_EQ(read.scale, 5);  // 20 m
    const Bounds box = read.mesh->LocalBounds();
    EXPECT_LT(Length(box.lower - Vector3(-10, 0, -10)), 1e-4f);
    EXPECT_LT(Length(box.upper - Vector3(10, 10, 10)), 1e-4f);
}

TEST_F(MeshGrounds, AnOpenSheetHasTwoSides) {
    const ImportedMesh read = Import(Write("sheet.obj", kSheet), {.scale = 3});
    ASSERT_TRUE(read.mesh);
    EXPECT_TRUE(read.isTwoSided);
    EXPECT_EQ(read.report.boundaryEdges, 8u);
    EXPECT_EQ(read.mesh->TriangleCount(), 8u);
    EXPECT_NEAR(read.mesh->LocalBounds().upper.x(), 3, 1e-5);
    EXPECT_NEAR(read.mesh->LocalBounds().upper.y(), 1.5, 1e-5);
}

TEST_F(MeshGrounds, ABoxTurnedInsideOutHasTwoSides) {
    std::string text = ObjBox("cube", {0, 0, 0}, {1, 1, 1}, 0);
    // A mirrored vertex list turns every front inwards.
    for (size_t at = text.find("v "); at != std::string::npos; at = text.find("\nv ", at + 1))
        text.insert(text.find(' ', at) + 1, 1, '-');
    EXPECT_TRUE(Import(Write("inside.obj", text)).isTwoSided);
}

TEST_F(MeshGrounds, TheAxisThatIsUpBecomesY) {
    // A wedge whose ridge is up along z in the file, 1 high, 2 long and 3 wide.
    const fs::path file = Write("wedge.obj",
                                "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 1 1\nv 2 1 1\n"
                                "f 1 4 3 2\nf 1 2 6 5\nf 3 4 5 6\nf 1 5 4\nf 2 3 6\n");
    const ImportedMesh up = Import(file, {.scale = 1, .up = UpAxis::Z}),
                       down = Import(file, {.scale = 1, .up = UpAxis::MinusZ});
    ASSERT_TRUE(up.mesh && down.mesh);
    EXPECT_FALSE(up.isTwoSided);
    EXPECT_FALSE(down.isTwoSided);  // turned, not mirrored
    for (const ImportedMesh& read : {up, down}) EXPECT_NEAR(read.mesh->LocalBounds().upper.y(), 1, 1e-6);
    // A ray from above meets the ridge of the one, the base of the other.
    SurfaceHit hit;
    const auto heightAt = [&](const ImportedMesh& read, float wide) {
        // y of the file runs along x here, from its middle at 1.5.
        const bool isHit = read.mesh->CastRay({Vector3(wide, 5, 0.3f), Vector3(0, -10, 0)}, hit);
        return isHit ? 5 - 10 * hit.fraction : -1.0f;
    };
    EXPECT_NEAR(heightAt(up, -0.5f), 1, 1e-5);
    EXPECT_NEAR(heightAt(up, 1.4f), 0.05, 1e-5);
    EXPECT_NEAR(heightAt(down, 1.4f), 1, 1e-5);
}

TEST_F(MeshGrounds, NodesPlaceTheirTrianglesAndMirroredOnesKeepTheirFronts) {
    // The triangle pyramid of the hulls' test, and beside it its mirror image.
    const std::string buffer =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAC"
        "AAEAAAABAAMAAAADAAIAAQACAAMA";
    const std::string text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
      "nodes":[{"mesh":0},{"mesh":0,"translation":[3,0,0],"scale":[-1,1,1]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
                   {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
      "buffers":[{"byteLength":72,"uri":")" +
                             buffer + R"("}]})";
    const ImportedMesh read = Import(Write("nodes.gltf", text), {.scale = 1});
    ASSERT_TRUE(read.mesh);
    EXPECT_EQ(read.mesh->TriangleCount(), 8u);
    EXPECT_FALSE(read.isTwoSided);
    // Both pyramids are met from above, one sided as they are.
    SurfaceHit hit;
    for (float x : {-1.3f, 1.3f}) {
        EXPECT_TRUE(read.mesh->CastRay({Vector3(x, 5, -0.3f), Vector3(0, -10, 0)}, hit)) << x;
        EXPECT_GT(hit.normal.y(), 0);
    }
}

TEST_F(MeshGrounds, RepairsAreReported) {
    // The two squares of a step share no vertices, as in every STL; a face twice; one without area; a line.
    const ImportedMesh read =
        Import(Write("mended.obj",
                     "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 1 0 0\nv 2 0.5 0\nv 2 0.5 1\nv 1 0 1\n"
                     "f 1 4 3 2\nf 5 8 7 6\nf 1 4 3\nf 1 2 5\nl 1 2\n"));
    ASSERT_TRUE(read.mesh);
    EXPECT_EQ(read.mesh->TriangleCount(), 4u);
    EXPECT_EQ(read.mesh->VertexCount(), 6u);
    EXPECT_GT(read.report.weldedVertices.count, 0u);
    EXPECT_EQ(read.report.duplicateTriangles.count, 1u);
    EXPECT_EQ(read.report.degenerateTriangles.count, 1u);
    std::string all;
    for (const std::string& line : read.repairs) all += line + "\n";
    for (const char* part : {"welded", "duplicate", "without area", "points and lines"})
        EXPECT_NE(all.find(part), std::string::npos) << part << " is not in:\n" << all;
}

TEST_F(MeshGrounds, InvalidGroundsAreRefused) {
    EXPECT_NE(Refusal(folder_ / "absent.obj").find("no file"), std::string::npos);
    EXPECT_NE(Refusal(Write("text.txt", "no mesh at all")).find("cannot be read"), std::string::npos);
    const std::string line = Refusal(Write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nl 1 2 3\n"));
    EXPECT_NE(line.find("no triangles"), std::string::npos) << line;
    const std::string flat = Refusal(Write("needle.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"));
    EXPECT_NE(flat.find("needle.obj"), std::string::npos) << flat;
    const std::string point = Refusal(Write("point.obj", "v 2 2 2\nv 2 2 2\nv 2 2 2\nf 1 2 3\n"));
    EXPECT_NE(point.find("extent"), std::string::npos) << point;
    EXPECT_NE(Refusal(Write("sheet.obj", kSheet), {.scale = -1}).find("scale"), std::string::npos);
}

TEST_F(MeshGrounds, BodiesLandOnTheSheet) {
    const auto shape = ImportShape(Write("cube.obj", ObjBox("cube", {0, 0, 0}, {1, 1, 1}, 0)), 1);
    ASSERT_TRUE(shape);
    SceneInput input;
    input.shape = shape.Value().shape;
    input.ground = Import(Write("sheet.obj", kSheet), {.size = 10}).mesh;
    input.count = 9;
    const auto world = SceneWorld::Create(DropOntoScene::kScene, input);
    ASSERT_TRUE(world) << world.GetError().message;
    for (int step = 0; step < 180; ++step) ASSERT_TRUE(world.Value()->Step(1.0 / 60));
    EXPECT_EQ(world.Value()->watched.size(), 9u);
    EXPECT_EQ(DropOntoScene::kScene.accuracy(*world.Value()), 0);
    for (BodyId id : world.Value()->watched) {
        // Above the sheet at 10 x (1 - distance from its middle), or beside it on the floor; half a cube higher.
        EXPECT_GT(world.Value()->Bodies().GetCenterOfMass(id).y(), 0.4);
        EXPECT_LT(Length(world.Value()->Bodies().GetLinearVelocity(id)), 2);
    }
}

// assimp's reader of RAW files leaves nodes out, and crashed what followed them.
TEST_F(MeshFiles, WhoseNodesAreMissingHaveAllTheirMeshes) {
    const fs::path file = Write("two.raw", "a\n0 0 0 0 0 2 2 0 0\n\nb\n0 0 0 2 0 0 0 2 0\n");
    const auto mesh = ImportMesh(file, {.scale = 1});
    ASSERT_TRUE(mesh) << mesh.GetError().message;
    EXPECT_EQ(mesh.Value().mesh->TriangleCount(), 2u);
}

// They crash assimp 5.2: polygons and vertices that are announced and do not come.
TEST_F(MeshFiles, ThatCrashTheirReaderAreErrors) {
    const std::string head =
        "element vertex 400\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 200\nproperty list uchar int vertex_indices\nend_header\n";
    for (const fs::path& file : {Write("text.ply", "ply\nformat ascii 1.0\n" + head + "0 0 0\n1 0 0\n0 1 "),
                                 Write("binary.ply", "ply\nformat binary_little_endian 1.0\n" + head + "xxxxyyyyzzzz"),
                                 Write("cut.off", "OFF\n8 6 12\n0 0 0\n1 0 0\n")}) {
        EXPECT_NE(Complaint(file).find(file.string()), std::string::npos);
        EXPECT_FALSE(ImportMesh(file));
    }
}

}  // namespace
}  // namespace fulcrum
