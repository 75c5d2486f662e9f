// Inner edges of grounds that are made of pieces, and thin bodies on a mesh.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kContacts{.contacts = true};

double Flat(double, double) { return 0; }

// Cells of `cell` m about the origin, at the height that a function of x and z gives.
ShapePtr GridMesh(int cells, double cell, double (*height)(double, double)) {
    const double corner = -0.5 * cells * cell;
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (int z = 0; z <= cells; ++z)
        for (int x = 0; x <= cells; ++x) {
            const double px = corner + cell * x, pz = corner + cell * z;
            vertices.push_back(Position(px, height(px, pz), pz).cast<float>());
        }
    const auto at = [&](int x, int z) { return static_cast<uint32_t>(z * (cells + 1) + x); };
    for (int z = 0; z < cells; ++z)
        for (int x = 0; x < cells; ++x)
            for (const uint32_t index :
                 {at(x, z), at(x, z + 1), at(x + 1, z), at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)})
                indices.push_back(index);
    return TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
}

enum Grounds { kMesh = 0, kBoxes = 1, kFields = 2 };

void AddGround(LabWorld& world, Grounds ground) {
    const Material smooth{.friction = 0};
    const auto add = [&](const ShapePtr& shape, const Position& at) {
        world.Add({.shape = shape, .motion = MotionType::Static, .position = at, .material = smooth});
    };
    if (ground == kMesh) add(GridMesh(24, 1, Flat), {0, 0, 0});
    if (ground == kBoxes) {
        const ShapePtr box = BoxOf(0.5, 0.5, 0.5);
        for (int x = -12; x <= 12; ++x)
            for (int z = -6; z <= 6; ++z) add(box, {1.0 * x, -0.5, 1.0 * z});
    }
    if (ground == kFields) {
        const std::vector<float> heights(13 * 13, 0.0f);
        const ShapePtr field =
            HeightField::Create({.sampleCountX = 13, .sampleCountZ = 13, .heights = heights}).Value();
        add(field, {-12, 0, -6});
        add(field, {0, 0, -6});
    }
}

// A cube of 0.2 m that slides without friction at 3 m/s, askew: nothing may turn it aside, lift or brake it.
void InternalEdges(LabRun& run) {
    constexpr double kSpeed = 3, kHalf = 0.1, kHeading = 0.2;
    LabWorld world(run);
    AddGround(world, static_cast<Grounds>(static_cast<int>(run.parameter)));
    const Position along(std::cos(kHeading), 0, std::sin(kHeading)), aside(-std::sin(kHeading), 0, std::cos(kHeading));
    const BodyId cube = world.Add({.shape = BoxOf(kHalf, kHalf, kHalf),
                                   .position = Position(-4.5, kHalf, -1),
                                   .rotation = RotationAbout({0, 1, 0}, 0.1),
                                   .linearVelocity = (along * kSpeed).cast<float>(),
                                   .material = {.friction = 0}});
    double offSpeed = 0, offHeight = 0;
    for (int i = run.Steps(3); i > 0; --i) {
        world.Step();
        const Position speed = world.Speed(cube);
        offSpeed = std::max({offSpeed, std::abs(speed.dot(aside)), std::abs(speed.y())});
        offHeight = std::max(offHeight, std::abs(world.At(cube).y() - kHalf));
    }
    run.Error("sideways", offSpeed / kSpeed);
    run.Error("braked", std::abs(world.Speed(cube).dot(along) - kSpeed) / kSpeed);
    run.Error("height", offHeight / (2 * kHalf));
    run.Require(offSpeed < 0.01, "sideways and upwards below 1 cm/s");
    run.Require(offHeight < 0.001, "height to 1 mm");
    run.Observe(world.At(cube).x() / kSpeed);
}

double Waves(double x, double z) { return 2 * std::sin(0.21 * x) * std::cos(0.21 * z); }

// Rods of 8 m and plates of 4 cm thickness tossed on a wavy mesh: lost, or awake at the end. The parameter is the
// inertia ratio, 0: the shapes' own.
void Thin(LabRun& run) {
    LabWorld world(run, kDown, LabWorld::Sleeps);
    world.Add({.shape = GridMesh(60, 2, Waves), .motion = MotionType::Static});
    const ShapePtr rod = BoxOf(0.05, 4, 0.05), plate = BoxOf(0.02, 0.2, 0.04);
    std::vector<BodyId> bodies;
    const int rods = run.Count(40, 6), plates = run.Count(400, 40);
    for (int i = 0; i < rods + plates; ++i) {
        const bool isRod = i < rods;
        const double x = run.random.Between(-45, 45), z = run.random.Between(-45, 45);
        const double axisZ = run.random.Between(0.1, 1), axisY = run.random.Between(-1, 1);
        const Position axis(run.random.Between(-1, 1), axisY, axisZ);
        BodySettings body{.shape = isRod ? rod : plate,
                          .position = {x, Waves(x, z) + (isRod ? 8 : 2) + 0.02 * i, z},
                          .rotation = RotationAbout(axis.normalized().cast<float>(), run.random.Between(0, 2 * kPi))};
        if (run.parameter > 0) {
            const float inertia = isRod ? 100.0f : 0.05f;
            body.inertia = Vector3(inertia, inertia / static_cast<float>(run.parameter), inertia);
        }
        bodies.push_back(world.Add(body));
    }
    for (int i = run.Steps(run.Seconds(30, 10)); i > 0; --i) {
        world.Step();
        if (world.AwakeBodies() == 0) break;
    }
    double lost = 0, awake = 0;
    for (const BodyId id : bodies) {
        lost += !(world.At(id).y() > -2.5);  // below all hills
        awake += world.Bodies().IsAwake(id);
    }
    const double count = static_cast<double>(bodies.size());
    run.Error("lost_or_awake", (lost + awake) / count);
    run.Figure("lost", lost);
    run.Figure("awake", awake);
    run.Require(lost == 0, "all settle above the mesh");
    if (!run.isQuick) run.Require(awake == 0, "all sleep");
    run.Observe((lost + awake) / count);
}

LabScene Over(const char* variant, Grounds ground) {
    return {.name = "internal_edges",
            .variant = variant,
            .what = "a cube of 0.2 m sliding at 3 m/s without friction over such a ground, 3 s",
            .error = "largest speed sideways or upwards, over 3 m/s",
            .parameter = static_cast<double>(ground),
            .influences = kContacts,
            .isExtreme = true,
            .testBound = 0.0034,
            .run = InternalEdges};
}

LabScene OnWaves(const char* variant, double ratio) {
    return {.name = "thin",
            .variant = variant,
            .what = "40 rods of 8 m and 400 plates on a wavy mesh, 30 s",
            .error = "part that is lost or awake at the end",
            .parameter = ratio,
            .influences = kContacts,
            .isExtreme = true,
            .isSlow = true,
            .seeds = 32,
            .quickSeeds = 1,
            .testBound = 0.5,
            .run = Thin};
}

}  // namespace

std::vector<LabScene> SurfaceScenes() {
    return {
        Over("mesh", kMesh), Over("boxes", kBoxes), Over("fields", kFields), OnWaves("own", 0), OnWaves("inertia", 1e4),
    };
}

}  // namespace fulcrum::accuracy
