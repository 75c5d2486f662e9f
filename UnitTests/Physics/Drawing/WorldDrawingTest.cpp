// Triangles of shapes and the drawing of a world.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Physics/Drawing/ShapeTriangles.h>
#include <Fulcrum/Physics/Drawing/WorldDrawing.h>
#include <Fulcrum/Samples/Embedding/ObjDrawing.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <map>
#include <set>
#include <string>

namespace fulcrum::testing {
namespace {

struct Surface {
    double volume = 0;  // by the divergence theorem: positive where triangles face outwards
    Position moment = Position::Zero();
    int triangles = 0;
    bool isInside = true;  // of the bounds
};

Surface SurfaceOf(const Shape& shape, int detail = 5) {
    Surface surface;
    const Vector3 slack = Vector3::Constant(1e-4f * shape.OuterRadius());
    VisitTriangles(
        shape,
        [&](const DrawnTriangle& triangle) {
            const Position a = triangle.corners[0].cast<double>(), b = triangle.corners[1].cast<double>(),
                           c = triangle.corners[2].cast<double>();
            const double volume = Dot<double>(a, Cross<double>(b, c)) / 6;
            surface.volume += volume;
            surface.moment += (a + b + c) * (volume / 4);
            ++surface.triangles;
            for (const Vector3& corner : triangle.corners) {
                const Vector3 local = corner - shape.Mass().centerOfMass;
                surface.isInside &= Vector3(shape.LocalBounds().lower - slack).isAtMost(local) &&
                                    local.isAtMost(Vector3(shape.LocalBounds().upper + slack));
            }
        },
        detail);
    return surface;
}

// They enclose the volume of the shape, about its center of mass.
TEST(ShapeTriangles, EncloseTheVolumeOfTheirShape) {
    const std::map<std::string, ShapePtr> shapes = {
        {"sphere", SphereOf(0.7f)},
        {"box", BoxOf(1, 2, 3)},
        {"capsule", CapsuleOf(1, 0.5f)},
        {"tapered capsule", TaperedCapsule::Create(1, 0.3f, 0.8f).Value()},
        {"cylinder", Cylinder::Create(1, 0.5f).Value()},
        {"cone", Cylinder::CreateCone(1, 0.5f).Value()},
        {"hull", HullOf({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}, {6, 1, 1}})},
        {"compound", CompoundOf({{.shape = CubeOf(0.3f)}, {.shape = SphereOf(0.3f), .position = {2, 0.4f, 0}}})},
    };
    for (const auto& [name, shape] : shapes) {
        const Surface surface = SurfaceOf(*shape);
        EXPECT_NEAR(surface.volume / double{shape->Mass().volume}, 1, 0.01) << name;
        const Position center = surface.moment / surface.volume;
        EXPECT_LT((center - shape->Mass().centerOfMass.cast<double>()).norm(), 0.01 * double{shape->OuterRadius()})
            << name;
        EXPECT_TRUE(surface.isInside) << name;
    }
    EXPECT_EQ(SurfaceOf(*shapes.at("box")).triangles, 12);
    // Its mass is that of the sharp box. Steiner's formula: the core, its faces, edges and corners, moved out by r.
    const double a = 0.7, c = 1.7, r = 0.3;
    EXPECT_NEAR(SurfaceOf(*Box::Create(Vector3(1, 1, 2), 0.3f).Value()).volume,
                8 * a * a * c + r * 8 * (a * a + 2 * a * c) + kPi * r * r * 2 * (2 * a + c) + 4 * kPi / 3 * r * r * r,
                0.15);
    EXPECT_NEAR(SurfaceOf(*shapes.at("hull")).volume / double{shapes.at("hull")->Mass().volume}, 1, 1e-5);
    // Finer ones are closer.
    double last = 0;
    for (const int detail : {1, 2, 3, 4}) {
        const double volume = SurfaceOf(*shapes.at("sphere"), detail).volume;
        EXPECT_GT(volume, last);
        last = volume;
    }
    EXPECT_NEAR(last / (4.0 / 3 * kPi * 0.343), 1, 0.01);
}

TEST(ShapeTriangles, OfSurfacesArePlanesAndNothing) {
    const Vector3 vertices[] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0.5f, 1}};
    const uint32_t indices[] = {0, 2, 1, 1, 2, 3};
    EXPECT_EQ(SurfaceOf(*TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value()).triangles, 2);
    const std::vector<float> heights(12, 0.5f);
    const ShapePtr field = HeightField::Create({.sampleCountX = 4, .sampleCountZ = 3, .heights = heights}).Value();
    EXPECT_EQ(SurfaceOf(*field).triangles, 12);
    Bounds all;
    VisitTriangles(*field, [&](const DrawnTriangle& triangle) {
        for (const Vector3& corner : triangle.corners) all.Include(corner);
    });
    EXPECT_EQ(all.lower, Vector3(0, 0.5f, 0));
    EXPECT_EQ(all.upper, Vector3(3, 0.5f, 2));
    int count = 0;
    VisitTriangles(
        *Plane::Create(Vector3(0, 0, 2), 3).Value(),
        [&](const DrawnTriangle& triangle) {
            ++count;
            for (const Vector3& corner : triangle.corners) EXPECT_FLOAT_EQ(corner.z(), 3);
            const Vector3* c = triangle.corners;
            EXPECT_NEAR(Cross<float>(Vector3(c[1] - c[0]), Vector3(c[2] - c[0])).z(), 400, 0.01f);  // to the front
        },
        3, 10);
    EXPECT_EQ(count, 2);
}

struct CountingTarget : DrawingTarget {
    std::map<DrawingColor, int> lines, triangles;
    std::vector<std::string> texts;
    std::vector<Position> corners;
    void Line(const Position&, const Position&, DrawingColor color) override { ++lines[color]; }
    void Triangle(const Position& a, const Position& b, const Position& c, DrawingColor color) override {
        ++triangles[color];
        corners.insert(corners.end(), {a, b, c});
    }
    void Text(const Position&, std::string_view text, DrawingColor) override { texts.emplace_back(text); }
};

TEST(WorldDrawing, ShowsBodiesWhereTheyAreByTheirState) {
    TestWorld world;
    world.AddFloor();
    const BodyId box =
        world.Add({.shape = HullOf({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}}), .position = {1e6, 3, 0}});
    world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Kinematic, .position = {9, 5, 0}});
    world.Add({.shape = CubeOf(0.5f), .position = {20, 0.5, 0}, .startAsleep = true});
    world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static, .position = {-9, 5, 0}, .isSensor = true});
    CountingTarget target;
    Draw(world.System(), target);
    const DrawingColors colors;
    EXPECT_EQ(target.triangles[colors.fixed], 12);
    EXPECT_EQ(target.triangles[colors.kinematic], 12);
    EXPECT_EQ(target.triangles[colors.asleep], 12);
    EXPECT_EQ(target.triangles[colors.sensor], 12);
    EXPECT_EQ(target.triangles[colors.awake], 4);
    EXPECT_TRUE(target.lines.empty());
    // Only one of them, where it is, although it is far away.
    CountingTarget one;
    const auto accepts = [&](BodyId id) { return id == box; };
    const FunctionRef<bool(BodyId)> filter = accepts;
    Draw(world.System(), one, {.bounds = true, .centers = true, .names = true, .accepts = &filter});
    EXPECT_EQ(one.corners.size(), 12u);
    const BodyBounds bounds = world.Bodies().GetBounds(box);
    for (const Position& corner : one.corners) {
        EXPECT_TRUE(Position(bounds.lower - Position::Constant(1e-5)).isAtMost(corner));
        EXPECT_TRUE(corner.isAtMost(Position(bounds.upper + Position::Constant(1e-5))));
    }
    EXPECT_EQ(one.lines[colors.bounds], 12);
    EXPECT_EQ(one.texts, std::vector<std::string>{std::to_string(box.index)});
}

TEST(WorldDrawing, ShowsContactsVelocitiesAndJoints) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}}),
                 ball = world.Add({.shape = SphereOf(0.3f), .position = {5, 3, 0}});
    HingeJointSettings hinge;
    hinge.bodyA = kWorldBody;
    hinge.bodyB = ball;
    hinge.anchorA.point = {4, 3, 0};
    ASSERT_TRUE(world.System().Joints().Create(hinge));
    world.Steps(10);
    CountingTarget target;
    Draw(world.System(), target,
         {.triangles = false, .wireframe = true, .velocities = true, .contacts = true, .names = true});
    const DrawingColors colors;
    EXPECT_TRUE(target.triangles.empty());
    EXPECT_EQ(target.lines[colors.contact], 4 + 1);  // and the joint's gap
    EXPECT_GE(target.lines[colors.velocity], 1);
    EXPECT_GE(target.lines[colors.joint], 6 + 1);
    EXPECT_NE(std::find(target.texts.begin(), target.texts.end(), "hinge"), target.texts.end());
    EXPECT_TRUE(world.Bodies().Exists(box));
}

TEST(WorldDrawing, WritesAnObjFile) {
    TestWorld world;
    world.Add({.shape = CubeOf(0.5f), .position = {1, 2, 3}});
    samples::ObjDrawing drawing;
    Draw(world.System(), drawing, {.bounds = true, .names = true});
    std::ostringstream out;
    drawing.Write(out);
    std::istringstream in(out.str());
    std::map<std::string, int> kinds;
    int vertices = 0;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        ++kinds[kind];
        vertices += kind == "v";
        for (int index; (kind == "f" || kind == "l") && words >> index;) {
            EXPECT_GE(index, 1);
            EXPECT_LE(index, 12 * 3 + 12 * 2);
        }
    }
    EXPECT_EQ(kinds["f"], 12);
    EXPECT_EQ(kinds["l"], 12);
    EXPECT_EQ(kinds["#"], 1);
    EXPECT_EQ(vertices, 12 * 3 + 12 * 2);
}

}  // namespace
}  // namespace fulcrum::testing
