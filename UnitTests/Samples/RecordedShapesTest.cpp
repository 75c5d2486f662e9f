// Shapes in recordings are those that the drawing interface draws: VisitTriangles.
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Physics/Drawing/ShapeTriangles.h>
#include <Fulcrum/Samples/Runner/RecordedShapes.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

// m3, by the divergence theorem: positive if the triangles face outwards.
double VolumeOf(const RecordedShape& shape) {
    double volume = 0;
    for (const auto& t : shape.triangles) {
        const Vector3 &a = shape.vertices[t[0]], &b = shape.vertices[t[1]], &c = shape.vertices[t[2]];
        volume += Dot<double>(a.cast<double>(), Cross<double>(b.cast<double>(), c.cast<double>())) / 6;
    }
    return volume;
}

TEST(RecordedShapes, HaveTheTrianglesOfTheDrawingInterface) {
    const ShapePtr shapes[] = {HullOf({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}}), Cylinder::Create(1, 0.5f).Value(),
                               TaperedCapsule::Create(1, 0.3f, 0.8f).Value()};
    for (const ShapePtr& shape : shapes) {
        const RecordedShape recorded = RecordedShapeOf(*shape);
        ASSERT_EQ(recorded.kind, RecordedShapeKind::Hull);
        size_t next = 0;
        VisitTriangles(
            *shape,
            [&](const DrawnTriangle& triangle) {
                ASSERT_LT(next, recorded.triangles.size());
                for (size_t i = 0; i < 3; ++i)
                    EXPECT_EQ(recorded.vertices[recorded.triangles[next][i]], triangle.corners[i]);
                ++next;
            },
            4);
        EXPECT_EQ(next, recorded.triangles.size());
        EXPECT_NEAR(VolumeOf(recorded) / double{shape->Mass().volume}, 1, 0.01);
        EXPECT_TRUE(recorded.looks.empty());
    }
    EXPECT_EQ(RecordedShapeOf(*shapes[0]).vertices.size(), 4u);
    const RecordedShape plane = RecordedShapeOf(*Plane::Create(Vector3(0, 1, 0), 2).Value());
    EXPECT_EQ(plane.vertices.size(), 4u);
    EXPECT_EQ(plane.triangles.size(), 2u);
}

TEST(RecordedShapes, OfSurfacesHaveTheirMaterialsAsLooks) {
    const Vector3 vertices[] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0.5f, 1}};
    const uint32_t indices[] = {0, 2, 1, 1, 2, 3};
    const uint8_t materials[] = {1, 0};
    const SurfaceMaterial palette[2] = {};
    const auto meshOf = [&](TriangleMeshSettings settings) {
        settings.vertices = vertices;
        settings.indices = indices;
        return TriangleMesh::Create(settings).Value();
    };
    EXPECT_TRUE(RecordedShapeOf(*meshOf({})).looks.empty());
    const RecordedShape recorded = RecordedShapeOf(*meshOf({.triangleMaterials = materials, .materials = palette}));
    ASSERT_EQ(recorded.triangles.size(), 2u);
    ASSERT_EQ(recorded.looks.size(), 2u);
    EXPECT_EQ(recorded.vertices.size(), 4u);
    for (size_t i = 0; i < 2; ++i) {
        bool isFirst = false;  // of the mesh
        for (const uint32_t corner : recorded.triangles[i]) isFirst |= recorded.vertices[corner] == vertices[0];
        EXPECT_EQ(recorded.looks[i], isFirst ? 1 : 0);
    }
}

}  // namespace
}  // namespace fulcrum::testing
