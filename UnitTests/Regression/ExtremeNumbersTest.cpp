// Sizes, masses, speeds and forces from one end of the floats to the other, mixed with ordinary ones, put NaN into
// normals and separations of contacts and made steps last for a minute. Random worlds of such numbers: whatever can be
// read is finite, no speed exceeds its limit, and the time of a step is bounded by what is in the world.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>
#include <string>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr double kSlowness = kIsSanitized ? 30 : 1;

class Extremes {
public:
    Extremes(uint32_t seed, bool hasJoints) : random_(seed), world_(SettingsOf()) {
        AddFloor();
        const int count = 5 + static_cast<int>(random_() % 20);
        for (int i = 0; i < count; ++i) AddBody();
        for (int i = 0; hasJoints && i < count / 3; ++i) AddJoint();
    }

    // Fails the test if a condition is violated.
    void Run(int steps) {
        for (int i = 0; i < steps; ++i) {
            if (i % 7 == 3) Meddle();
            const std::clock_t start = std::clock();
            world_.Step(random_() % 8 == 0 ? Pick({1e-9, 1e-4, 1.0}) : kStep);
            slowest = std::max(slowest, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
            Check(i);
            if (::testing::Test::HasFailure()) return;
        }
    }
    double slowest = 0;  // s, of the processor

private:
    double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    template <class T>
    T Pick(std::initializer_list<T> of) {
        return *(of.begin() + random_() % of.size());
    }
    // Mostly ordinary, sometimes anywhere between 10^-most and 10^most.
    float Magnitude(double ordinary, double most) {
        if (random_() % 3 != 0) return static_cast<float>(Uniform(0.2, 1) * ordinary);
        return static_cast<float>(std::pow(10.0, Uniform(-most, most)));
    }
    Vector3 Direction() {
        return Normalized(Vector3(static_cast<float>(Uniform(-1, 1)), static_cast<float>(Uniform(-1, 1)),
                                  static_cast<float>(Uniform(-1, 1))));
    }
    Vector3 Vector(double ordinary, double most) { return Direction() * Magnitude(ordinary, most); }
    Position Place() {
        const double reach = random_() % 6 == 0 ? std::pow(10.0, Uniform(-6, 20)) : 3;
        return Position(Uniform(-reach, reach), Uniform(0, reach), Uniform(-reach, reach));
    }
    Quaternion Rotation() { return RotationAbout(Direction(), Uniform(-kPi, kPi)); }

    SystemSettings SettingsOf() {
        SystemSettings settings;
        settings.solver.substeps = Pick({1, 4, 4, 4, 16});
        settings.sleep.enabled = random_() % 2;
        if (random_() % 8 == 0) settings.gravity = Vector(9.81, 5);
        if (random_() % 8 == 0) settings.speculativeDistance = Pick({1e-30f, 1e-4f, 1000.0f});
        if (random_() % 8 == 0) settings.boundsMargin = Pick({1e-30f, 1e30f});
        if (random_() % 8 == 0) settings.contactFrequency = Pick({1e-30f, 1e30f});
        if (random_() % 8 == 0) settings.contactDampingRatio = Pick({0.0f, 1e6f});
        if (random_() % 8 == 0) settings.contactPushSpeed = Pick({1e-30f, 1e6f});
        return settings;
    }

    template <class T>
    static ShapePtr OrNone(Result<T> made) {
        return made ? ShapePtr(made.Value()) : nullptr;
    }
    ShapePtr Convex() {
        switch (random_() % 7) {
            case 0: return OrNone(Sphere::Create(Magnitude(0.5, 6)));
            case 1: return OrNone(Box::Create(Vector3(Magnitude(0.5, 6), Magnitude(0.5, 6), Magnitude(0.5, 6))));
            case 2: return OrNone(Capsule::Create(Magnitude(0.5, 6), Magnitude(0.5, 6)));
            case 3: return OrNone(Cylinder::Create(Magnitude(0.5, 6), Magnitude(0.5, 6)));
            case 4: return OrNone(Cylinder::CreateCone(Magnitude(0.5, 6), Magnitude(0.5, 6)));
            case 5: {
                std::vector<Vector3> points;
                const float size = Magnitude(0.5, 6);
                for (int i = 0; i < 12; ++i) points.push_back(Direction() * size);
                return OrNone(ConvexHull::Create(points));
            }
            default: return OrNone(Box::Create(Vector3::Constant(Magnitude(0.5, 6))));
        }
    }
    ShapePtr Any() {
        if (random_() % 6 != 0) return Convex();
        std::vector<Compound::ChildSettings> children;
        for (int i = 0; i < 3; ++i)
            if (const ShapePtr child = Convex())
                children.push_back({.shape = child, .position = Vector(0.5, 6), .rotation = Rotation()});
        return OrNone(Compound::Create(children));
    }
    ShapePtr Ground() {
        constexpr uint32_t kSide = 17;
        const float cell = Magnitude(1, 3);
        std::vector<float> heights;
        for (uint32_t i = 0; i < kSide * kSide; ++i) heights.push_back(cell * static_cast<float>(Uniform(-0.3, 0)));
        const float corner = -0.5f * cell * (kSide - 1);
        switch (random_() % 4) {
            case 0:
                return OrNone(HeightField::Create({.sampleCountX = kSide,
                                                   .sampleCountZ = kSide,
                                                   .heights = heights,
                                                   .cellSizeX = cell,
                                                   .cellSizeZ = cell,
                                                   .origin = {corner, 0, corner}}));
            case 1: {
                std::vector<Vector3> points;
                std::vector<uint32_t> corners;
                for (uint32_t z = 0; z < kSide; ++z)
                    for (uint32_t x = 0; x < kSide; ++x) {
                        points.push_back({corner + cell * static_cast<float>(x), heights[z * kSide + x],
                                          corner + cell * static_cast<float>(z)});
                        if (x + 1 == kSide || z + 1 == kSide) continue;
                        const uint32_t at = z * kSide + x;
                        corners.insert(corners.end(), {at, at + kSide, at + 1, at + 1, at + kSide, at + kSide + 1});
                    }
                return OrNone(TriangleMesh::Create({.vertices = points, .indices = corners}));
            }
            case 2: return OrNone(Plane::Create({0, 1, 0}, 0));
            default: return BoxOf(100, 1, 100);
        }
    }

    void Add(const BodySettings& settings) {
        if (const Result<BodyId> id = world_.Bodies().Create(settings))
            bodies_.push_back({id.Value(), settings.maxLinearSpeed, settings.maxAngularSpeed});
    }
    void AddFloor() {
        const ShapePtr ground = Ground();
        ASSERT_TRUE(ground);
        Add({.shape = ground, .motion = MotionType::Static});
    }
    void AddBody() {
        BodySettings s;
        s.shape = Any();
        if (!s.shape) return;
        s.motion = random_() % 6 == 0 ? MotionType::Kinematic : MotionType::Dynamic;
        s.position = Place();
        s.rotation = Rotation();
        s.linearVelocity = Vector(3, 38);
        s.angularVelocity = Vector(3, 38);
        if (random_() % 2) s.mass = Magnitude(10, 30);
        s.material = {.friction = random_() % 5 == 0 ? Pick({0.0f, 1e30f, 3e38f}) : 0.5f,
                      .restitution = Pick({0.0f, 0.0f, 1.0f}),
                      .frictionRule = Pick({CombineRule::GeometricMean, CombineRule::Multiply, CombineRule::Maximum})};
        if (random_() % 8 == 0) s.linearDamping = Magnitude(1, 30);
        if (random_() % 8 == 0) s.angularDamping = Magnitude(1, 30);
        if (random_() % 8 == 0) s.gravityFactor = Pick({-1e6f, 0.0f, 1e6f});
        if (random_() % 4 == 0) s.maxLinearSpeed = Magnitude(10, 38);
        if (random_() % 4 == 0) s.maxAngularSpeed = Magnitude(10, 38);
        if (random_() % 6 == 0)
            s.continuous = Pick({ContinuousCollision::Linear, ContinuousCollision::LinearAndAngular});
        if (random_() % 8 == 0) s.lockedAxes = static_cast<LockedAxes>(random_() % 64);
        Add(s);
    }
    void AddJoint() {
        const JointSettings between = Between(AnyBody(), AnyBody(), Place(), Direction());
        switch (random_() % 4) {
            case 0: (void)JointsOf(world_).Create(Of<PointJointSettings>(between)); break;
            case 1: (void)JointsOf(world_).Create(Of<FixedJointSettings>(between)); break;
            case 2: (void)JointsOf(world_).Create(Of<HingeJointSettings>(between)); break;
            default: (void)JointsOf(world_).Create(Of<DistanceJointSettings>(between)); break;
        }
    }
    BodyId AnyBody() { return bodies_[random_() % bodies_.size()].id; }

    // Refused settings are not the subject of this test.
    void Meddle() {
        BodyInterface& bodies = world_.Bodies();
        for (int i = 0; i < 4; ++i) {
            const BodyId id = AnyBody();
            switch (random_() % 7) {
                case 0: (void)bodies.AddForce(id, Vector(1000, 30)); break;
                case 1: (void)bodies.AddTorque(id, Vector(1000, 30)); break;
                case 2: (void)bodies.AddImpulse(id, Vector(100, 30)); break;
                case 3: (void)bodies.AddAngularImpulse(id, Vector(100, 30)); break;
                case 4: (void)bodies.SetVelocity(id, Vector(10, 38), Vector(10, 38)); break;
                case 5: (void)bodies.AddForceAt(id, Vector(1000, 30), Place()); break;
                default: (void)bodies.SetPose(id, Place(), Rotation()); break;
            }
        }
    }

    void Check(int step) {
        for (const Limited& body : bodies_) {
            const Pose pose = world_.Bodies().GetPose(body.id);
            const Vector3 v = world_.Bodies().GetLinearVelocity(body.id),
                          w = world_.Bodies().GetAngularVelocity(body.id);
            ASSERT_TRUE(IsFinite(pose.position) && IsFinite(pose.rotation))
                << "step " << step << ", body " << body.id.index;
            ASSERT_NEAR(LengthSquared(pose.rotation), 1, 1e-4) << "step " << step << ", body " << body.id.index;
            ASSERT_LE(Length(v), body.linear * (1 + 1e-6f) + 1e-18f) << "step " << step << ", body " << body.id.index;
            ASSERT_LE(Length(w), body.angular * (1 + 1e-6f) + 1e-18f) << "step " << step << ", body " << body.id.index;
            ASSERT_FALSE(world_.Bodies().IsFrozen(body.id)) << "step " << step << ", body " << body.id.index;
        }
        world_.System().VisitContacts([&](const ContactView& contact) {
            EXPECT_NEAR(LengthSquared(contact.normal), 1, 1e-2) << "step " << step;
            for (const ContactView::Point& p : contact.points)
                EXPECT_TRUE(IsFinite(p.position) && std::isfinite(p.separation) && std::isfinite(p.impulse))
                    << "step " << step;
        });
        EXPECT_TRUE(std::isfinite(world_.Report().largestPenetration));
    }

    struct Limited {
        BodyId id;
        float linear, angular;
    };
    std::mt19937 random_;
    TestWorld world_;
    std::vector<Limited> bodies_;
};

void RunSeeds(uint32_t first, uint32_t last, bool hasJoints) {
    for (uint32_t seed = first; seed <= last; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Extremes world(seed, hasJoints);
        world.Run(60);
        // 25 bodies and some hundred triangles: a second where all is as bad as it can be, and the rest for slow
        // machines and builds.
        EXPECT_LT(world.slowest, 5.0 * kSlowness);
        if (::testing::Test::HasFailure()) return;
    }
}

TEST(ExtremeNumbers, OfBodiesStayFiniteAndInTime) { RunSeeds(1, kIsSanitized ? 1 : 6, false); }
TEST(ExtremeNumbers, OfBodiesWithJointsStayFiniteAndInTime) { RunSeeds(41, kIsSanitized ? 41 : 46, true); }

TEST(ExtremeNumbers, SettingsOfWhichNothingSensibleCanFollowAreRefused) {
    struct Bad {
        const char* field;
        void (*spoil)(SystemSettings&);
    };
    const Bad list[] = {
        {"gravity",
         [](SystemSettings& s) {
             s.gravity = {0, -2e6f, 0};
         }},
        {"speculativeDistance", [](SystemSettings& s) { s.speculativeDistance = 1001; }},
        {"contactDampingRatio", [](SystemSettings& s) { s.contactDampingRatio = 2e6f; }},
        {"contactPushSpeed", [](SystemSettings& s) { s.contactPushSpeed = 2e6f; }},
        {"depenetrationSpeed", [](SystemSettings& s) { s.depenetrationSpeed = 2e6f; }},
        {"jointPushSpeed", [](SystemSettings& s) { s.jointPushSpeed = 2e6f; }},
    };
    for (const Bad& bad : list) {
        SystemSettings settings;
        bad.spoil(settings);
        const auto result = PhysicsSystem::Create(settings);
        ASSERT_FALSE(result) << bad.field;
        EXPECT_EQ(result.GetError().code, ErrorCode::OutOfRange) << bad.field;
        EXPECT_NE(result.GetError().message.find(bad.field), std::string::npos) << result.GetError().message;
    }
}

// Their squares, and sums of their distances, would not be floats: closest points were at infinity, the length of a
// rope infinite.
TEST(ExtremeNumbers, SizesAndRatiosBeyondWhatFloatsCanSquareAreRefused) {
    const auto triangle = [](float radius) { return Triangle::Create({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, radius); };
    for (const auto& code :
         {triangle(3e38f).GetError().code, Sphere::Create(3e38f).GetError().code,
          Box::Create(Vector3(1, 3e38f, 1)).GetError().code, Capsule::Create(2e18f, 1).GetError().code})
        EXPECT_EQ(code, ErrorCode::OutOfRange);
    TestWorld world({}, 1);
    const BodyId bodies[] = {world.Add({.shape = CubeOf(0.5f), .position = {0, 10, 0}}),
                             world.Add({.shape = CubeOf(0.5f), .position = {5, 10, 0}})};
    const auto codeOf = [&](auto settings, float ratio) {
        settings.bodyA = bodies[0];
        settings.bodyB = bodies[1];
        settings.ratio = ratio;
        const Result<JointId> joint = world.System().Joints().Create(settings);
        return joint ? std::optional<ErrorCode>() : joint.GetError().code;
    };
    for (const float ratio : {3e38f, 1e-38f}) {
        EXPECT_EQ(codeOf(PulleyJointSettings{}, ratio), ErrorCode::OutOfRange) << ratio;
        EXPECT_EQ(codeOf(GearJointSettings{}, -ratio), ErrorCode::OutOfRange) << ratio;
        EXPECT_EQ(codeOf(RackAndPinionJointSettings{}, ratio), ErrorCode::OutOfRange) << ratio;
    }
    EXPECT_EQ(codeOf(PulleyJointSettings{}, 1e9f), std::nullopt);
}

// A ball as large as a rough mesh, thrown at it: each triangle that it touched asked for all the others, and each edge
// for all edges.
TEST(ExtremeNumbers, AHugeShapeInASurfaceTakesNoSquareOfItsTriangles) {
    constexpr uint32_t kSide = 121;
    std::mt19937 random(1);
    std::vector<Vector3> points;
    std::vector<uint32_t> corners;
    for (uint32_t z = 0; z < kSide; ++z)
        for (uint32_t x = 0; x < kSide; ++x) {
            points.push_back({static_cast<float>(x) - 60, std::uniform_real_distribution<float>(-1, 0)(random),
                              static_cast<float>(z) - 60});
            if (x + 1 == kSide || z + 1 == kSide) continue;
            const uint32_t at = z * kSide + x;
            corners.insert(corners.end(), {at, at + kSide, at + 1, at + 1, at + kSide, at + kSide + 1});
        }
    const auto mesh = TriangleMesh::Create({.vertices = points, .indices = corners});
    ASSERT_TRUE(mesh);
    for (const ContinuousCollision continuous : {ContinuousCollision::Off, ContinuousCollision::LinearAndAngular}) {
        TestWorld world(NoSleep());
        world.Add({.shape = mesh.Value(), .motion = MotionType::Static});
        world.Add({.shape = BoxOf(60, 0.5f, 60),
                   .position = {0, 0.4, 0},
                   .linearVelocity = {0, -60, 0},
                   .angularVelocity = {1, 2, 1},
                   .continuous = continuous});
        for (int i = 0; i < 3; ++i) {
            const std::clock_t start = std::clock();
            world.Step();
            // 28,800 triangles take some 30 ms; the square of their number took minutes.
            EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 10.0 * kSlowness) << "step " << i;
        }
        EXPECT_TRUE(world.AllFinite());
    }
}

}  // namespace
}  // namespace fulcrum::testing
