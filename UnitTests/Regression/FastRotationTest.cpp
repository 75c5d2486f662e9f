// Bodies that rotate fast are not pressed into what they hit. With the contacts of the start of the step alone a rod of
// 1.2 m that hits the floor at 50 rad/s was 5.4 of its inner radii deep, a capsule 3.0, at any number of substeps.
#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <string>

namespace fulcrum::testing {
namespace {

struct Drops {
    double deepest = 0, mean = 0;  // largest depth of a drop, over the inner radius
    double energy = 0;             // the most at any time, over that at the start
};

// A floor of one box, or of two triangles.
ShapePtr FloorOf(bool isMesh) {
    if (!isMesh) return BoxOf(50, 1, 50);
    const Vector3 corners[] = {{-50, 1, -50}, {50, 1, -50}, {50, 1, 50}, {-50, 1, 50}};
    const uint32_t triangles[] = {0, 2, 1, 0, 3, 2};
    return TriangleMesh::Create({.vertices = corners, .indices = triangles}).Value();
}

Drops Drop(const ShapePtr& shape, bool ontoMesh, float spin, int substeps) {
    constexpr uint32_t kDrops = 40;
    const ShapePtr floor = FloorOf(ontoMesh), solid = BoxOf(50, 1, 50);
    Drops drops;
    for (uint32_t seed = 1; seed <= kDrops; ++seed) {
        RandomPoses random(seed);
        SystemSettings settings;
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        world.Add({.shape = floor, .motion = MotionType::Static, .position = {0, -1, 0}});
        const Quaternion rotation = random.Rotation();
        const Vector3 axis = random.Direction(), velocity = random.InBox(2);
        const BodyId id = world.Add({.shape = shape,
                                     .position = {0, 1, 0},
                                     .rotation = rotation,
                                     .linearVelocity = Vector3(velocity.x(), -2, velocity.z()),
                                     .angularVelocity = axis * spin});
        const double mass = double{world.Bodies().GetMass(id)};
        const auto energy = [&] {
            return world.Bodies().GetKineticEnergy(id) + mass * kGravity * world.PositionOf(id).y();
        };
        const double before = energy();
        double deepest = 0;
        for (int step = 0; step < 90; ++step) {
            world.Step();
            const ConvexSeparation apart =
                MeasureConvex(static_cast<const ConvexShape&>(*solid), static_cast<const ConvexShape&>(*shape),
                              Relative({Position(0, -1, 0), {}}, world.Bodies().GetPose(id)), 0);
            deepest = std::max(deepest, -double{apart.separation} / double{shape->InnerRadius()});
            drops.energy = std::max(drops.energy, energy() / before);
        }
        drops.deepest = std::max(drops.deepest, deepest);
        drops.mean += deepest / kDrops;
    }
    return drops;
}

TEST(FastRotation, PressesNothingIntoTheFloor) {
    const struct {
        const char* what;
        ShapePtr shape;
        double most, mean;  // of the inner radius
    } bodies[] = {{"capsule", CapsuleOf(0.5f, 0.1f), 0.5, 0.05},
                  {"rod", BoxOf(0.05f, 0.6f, 0.05f), 1.0, 0.15},
                  {"plate", BoxOf(0.5f, 0.05f, 0.5f), 0.8, 0.04},
                  {"cube", CubeOf(0.2f), 0.08, 0.01},
                  {"disc", Cylinder::Create(0.1f, 0.4f).Value(), 0.4, 0.12}};
    for (const auto& body : bodies)
        for (const bool ontoMesh : {false, true})
            for (const float spin : {5.0f, 20.0f, 50.0f})
                for (const int substeps : {4, 16}) {
                    const Drops drops = Drop(body.shape, ontoMesh, spin, substeps);
                    SCOPED_TRACE(std::string(body.what) + (ontoMesh ? " on a mesh, " : " on a box, ") +
                                 std::to_string(spin) + " rad/s, substeps: " + std::to_string(substeps));
                    EXPECT_LT(drops.deepest, body.most);
                    EXPECT_LT(drops.mean, body.mean);
                    EXPECT_LT(drops.energy, 1.001);
                }
}

}  // namespace
}  // namespace fulcrum::testing
