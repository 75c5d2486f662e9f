// Bodies that fall on one end or corner and come over: the others strike within the next steps, and are not let through
// the ground. On planes and meshes the four points of a contact were others than those that come down next: rods sank
// in by their whole inner radius, plates and cones by half of it and more.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr int kCells = 40;
constexpr float kCell = 0.5f;  // m

ShapePtr FlatMesh() {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (int i = 0; i <= kCells; ++i)
        for (int j = 0; j <= kCells; ++j)
            vertices.push_back({kCell * static_cast<float>(i - kCells / 2) + 0.1f, 0,
                                kCell * static_cast<float>(j - kCells / 2) + 0.13f});
    for (uint32_t i = 0; i < kCells; ++i)
        for (uint32_t j = 0; j < kCells; ++j) {
            const uint32_t a = i * (kCells + 1) + j, b = a + 1, c = a + kCells + 1, d = c + 1;
            indices.insert(indices.end(), {a, b, d, a, d, c});
        }
    return TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
}

ShapePtr FlatField() {
    const std::vector<float> heights((kCells + 1) * (kCells + 1), 0.0f);
    return HeightField::Create({.sampleCountX = kCells + 1,
                                .sampleCountZ = kCells + 1,
                                .heights = heights,
                                .cellSizeX = kCell,
                                .cellSizeZ = kCell,
                                .origin = Vector3(-10.1f, 0, -10.13f)})
        .Value();
}

// Of the drops the deepest below the ground, over the inner radius: on average, and at most.
struct Depths {
    double mean = 0, most = 0;
};
Depths DropOnto(const ShapePtr& ground, const ShapePtr& shape) {
    constexpr int kDrops = 40;
    RandomPoses random(7);
    Depths depths;
    for (int i = 0; i < kDrops; ++i) {
        TestWorld world;
        const double top = ground->Type() == ShapeType::Box ? 1 : 0;
        world.Add({.shape = ground, .motion = MotionType::Static, .position = {0, -top, 0}});
        const Quaternion rotation = random.Rotation();
        const Vector3 axis = i % 2 == 0 ? Rotate(rotation, Vector3(0, 1, 0)) : random.Direction();
        const BodyId id = world.Add({.shape = shape,
                                     .position = {0, 0.6, 0},
                                     .rotation = rotation,
                                     .angularVelocity = axis * random.Between(0, 20)});
        double deepest = 0;
        for (int step = 0; step < 120; ++step) {
            world.Step();
            const Quaternion now = world.Bodies().GetPose(id).rotation;
            const Vector3 down = InverseRotate(now, Vector3(0, -1, 0));
            const float below = Rotate(now, static_cast<const ConvexShape&>(*shape).Support(down)).y();
            deepest = std::max(deepest, -(world.Bodies().GetCenterOfMass(id).y() + double{below}));
        }
        const double relative = deepest / double{shape->InnerRadius()};
        depths.mean += relative / kDrops;
        depths.most = std::max(depths.most, relative);
    }
    return depths;
}

TEST(FallingOver, NoEndSinksIntoTheGround) {
    const ShapePtr rod = HullOf({{-0.05f, -0.3f, -0.05f},
                                 {-0.05f, -0.3f, 0.05f},
                                 {-0.05f, 0.3f, -0.05f},
                                 {-0.05f, 0.3f, 0.05f},
                                 {0.05f, -0.3f, -0.05f},
                                 {0.05f, -0.3f, 0.05f},
                                 {0.05f, 0.3f, -0.05f},
                                 {0.05f, 0.3f, 0.05f}});
    const struct {
        const char* what;
        ShapePtr shape;
    } fallers[] = {{"box", BoxOf(0.05f, 0.3f, 0.05f)},
                   {"hull", rod},
                   {"plate", BoxOf(0.4f, 0.03f, 0.25f)},
                   {"capsule", CapsuleOf(0.2f, 0.1f)},
                   {"cylinder", Cylinder::Create(0.1f, 0.1f).Value()},
                   {"cone", Cylinder::CreateCone(0.2f, 0.15f).Value()}};
    const struct {
        const char* what;
        ShapePtr shape;
    } grounds[] = {{"plane", Plane::Create().Value()},
                   {"box", BoxOf(20, 1, 20)},
                   {"mesh", FlatMesh()},
                   {"height field", FlatField()}};
    for (const auto& ground : grounds)
        for (const auto& faller : fallers) {
            const Depths depths = DropOnto(ground.shape, faller.shape);
            EXPECT_LT(depths.mean, 0.05) << faller.what << " on " << ground.what;
            EXPECT_LT(depths.most, 0.35) << faller.what << " on " << ground.what;
        }
}

}  // namespace
}  // namespace fulcrum::testing
