// Invalid input is refused with an error and changes nothing. Solver settings do not matter here.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <limits>

namespace fulcrum::accuracy {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();

// Counts the cases with the expected result.
struct Cases {
    void Expect(bool holds) {
        ++tried;
        wrong += !holds;
    }
    void Report(LabRun& run) const {
        run.Error("wrong", static_cast<double>(wrong) / tried);
        run.Figure("cases", tried);
        run.Require(wrong == 0, "repaired or refused");
        run.Observe(static_cast<double>(wrong) / tried);
    }
    int tried = 0, wrong = 0;
};

bool MakesHull(const std::vector<Vector3>& points) { return bool(ConvexHull::Create(points)); }

// Hulls without volume and empty meshes are refused, duplicates and triangles without area are repaired.
void Degenerate(LabRun& run) {
    Cases cases;
    const std::vector<Vector3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (size_t count = 0; count <= 3; ++count)
        cases.Expect(!MakesHull({corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count)}));
    cases.Expect(!MakesHull({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}));              // collinear
    cases.Expect(!MakesHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}}));              // coplanar
    cases.Expect(!MakesHull({{0, 0, 0}, {1e-7f, 0, 0}, {0, 1e-7f, 0}, {0, 0, 1e-7f}, {1, 0, 0}}));  // nearly copies
    cases.Expect(!MakesHull({{0, 0, 0}, {1, 0, 0}, {0, kNotANumber, 0}, {0, 0, 1}}));
    std::vector<Vector3> copies;
    for (const Vector3& corner : corners)
        for (int i = 0; i < 3; ++i) copies.push_back(corner + Vector3(1e-7f * static_cast<float>(i), 0, 0));
    cases.Expect(MakesHull(copies));

    const auto mesh = [](const std::vector<Vector3>& vertices, const std::vector<uint32_t>& indices) {
        return TriangleMesh::Create({.vertices = vertices, .indices = indices});
    };
    cases.Expect(!mesh({{0, 0, 0}, {1, 0, 0}, {0, 0, kNotANumber}}, {0, 2, 1}));
    cases.Expect(!mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {0, 1, 2}));  // nothing is left
    cases.Expect(!mesh({}, {}));
    const auto repaired = mesh({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {2, 0, 0}}, {0, 2, 1, 0, 2, 1, 0, 1, 3});
    cases.Expect(repaired && repaired.Value()->TriangleCount() == 1);
    cases.Report(run);
}

// NaN, infinite, zero and negative numbers in every kind of setting: each gives an error, and a stack elsewhere is
// bit-identical to one in a world without these calls.
void BadInput(LabRun& run) {
    Cases cases;
    LabWorld world(run), untouched(run);
    PhysicsSystem& ours = world.Ours("refusals of input");
    Random random(1);
    for (LabWorld* each : {&world, &untouched}) {
        each->AddFloor();
        random = Random(1);
        AddStack(*each, 4, 1, 0.01, random);
    }
    const ShapePtr ball = SphereOf(0.5);
    const auto refusesBody = [&](auto change) {
        BodySettings body{.shape = ball, .position = {20, 5, 0}};
        change(body);
        cases.Expect(!ours.Bodies().Create(body));
    };
    const auto refusesWorld = [&](auto change) {
        SystemSettings settings;
        change(settings);
        cases.Expect(!PhysicsSystem::Create(settings));
    };
    for (const float bad : {kNotANumber, kInfinity, -kInfinity}) {
        refusesBody([&](BodySettings& body) { body.position.x() = double(bad); });
        refusesBody([&](BodySettings& body) { body.rotation.w = bad; });
        refusesBody([&](BodySettings& body) { body.linearVelocity.y() = bad; });
        refusesBody([&](BodySettings& body) { body.angularVelocity.z() = bad; });
        refusesBody([&](BodySettings& body) { body.density = bad; });
        refusesBody([&](BodySettings& body) { body.mass = bad; });
        refusesBody([&](BodySettings& body) { body.inertia = Vector3(1, bad, 1); });
        refusesBody([&](BodySettings& body) { body.material.friction = bad; });
        refusesBody([&](BodySettings& body) { body.material.restitution = bad; });
        refusesBody([&](BodySettings& body) { body.linearDamping = bad; });
        refusesBody([&](BodySettings& body) { body.angularDamping = bad; });
        refusesBody([&](BodySettings& body) { body.gravityFactor = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.gravity.y() = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.solver.baumgarte = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.speculativeDistance = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.contactPushSpeed = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.jointPushSpeed = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.restitutionSpeed = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.boundsMargin = bad; });
        cases.Expect(!Sphere::Create(bad));
        cases.Expect(!Box::Create({1, bad, 1}));
        cases.Expect(!Capsule::Create(bad, 1));
        cases.Expect(!ours.Update(double(bad)));
    }
    for (const float bad : {-1.0f, 0.0f}) {
        refusesBody([&](BodySettings& body) { body.density = bad; });
        refusesBody([&](BodySettings& body) { body.maxLinearSpeed = bad; });
        refusesBody([&](BodySettings& body) { body.maxAngularSpeed = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.solver.substeps = static_cast<int>(bad); });
        refusesWorld([&](SystemSettings& settings) { settings.solver.velocityIterations = static_cast<int>(bad); });
        refusesWorld([&](SystemSettings& settings) { settings.accuracy.penetration = bad; });
        refusesWorld([&](SystemSettings& settings) { settings.contactPushSpeed = bad; });
        cases.Expect(!Sphere::Create(bad));
        cases.Expect(!Box::Create({1, 1, bad}));
        cases.Expect(!Capsule::Create(1, bad));
    }
    refusesBody([&](BodySettings& body) { body.mass = -1; });
    refusesBody([&](BodySettings& body) { body.material.friction = -1; });
    refusesBody([&](BodySettings& body) { body.linearDamping = -1; });
    refusesBody([&](BodySettings& body) { body.shape = nullptr; });
    cases.Expect(!ours.Update(-1));
    cases.Expect(!ours.Joints().Create(PointJointSettings{}));
    for (LabWorld* each : {&world, &untouched}) each->Steps(1);
    cases.Expect(ours.HashPoses() == untouched.Ours("").HashPoses());
    cases.Report(run);
}

}  // namespace

std::vector<LabScene> InputScenes() {
    return {
        {.name = "degenerate",
         .what = "hulls and meshes without volume, of NaN, of copies",
         .error = "part that is neither repaired nor refused",
         .influences = {.timeStep = false},
         .isExtreme = true,
         .testBound = 1e-9,
         .run = Degenerate},
        {.name = "bad_input",
         .what = "NaN, infinite, zero, negative in the settings of bodies, shapes, joints and the system",
         .error = "part that is not refused, or changes others",
         .influences = {.timeStep = false},
         .isExtreme = true,
         .testBound = 1e-9,
         .run = BadInput},
    };
}

}  // namespace fulcrum::accuracy
