// A program may set another floating-point environment for its threads: flush subnormal numbers to zero, read them as
// zero, round otherwise, trap. The engine computes the same bits in all of them, raises no trap, and gives the
// program's environment back, flags included. On x86-64 and 64-bit ARM; other processors run the calls alone.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/SampledSurface.h>
#include <Fulcrum/Collision/Shapes/Submersion.h>
#include <Fulcrum/Fulcrum.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <array>
#include <bit>
#include <functional>
#include <string>

namespace fulcrum::testing {
namespace {

// The control register and, above it, the flags of exceptions that occurred.
struct Registers {
    uint64_t control = 0, flags = 0;
    bool operator==(const Registers&) const = default;
};

#if defined(__x86_64__)
Registers Read() {
    const uint32_t word = __builtin_ia32_stmxcsr();
    return {word & ~0x3Fu, word & 0x3Fu};
}
void Write(const Registers& registers) {
    __builtin_ia32_ldmxcsr(static_cast<uint32_t>(registers.control | registers.flags));
}
constexpr uint64_t kMasks = 0x1F80;
const std::vector<std::pair<std::string, Registers>> kEnvironments = {
    {"default", {kMasks, 0}},
    {"flush to zero", {kMasks | 0x8000, 0}},
    {"subnormals are zero", {kMasks | 0x0040, 0x20}},
    {"both", {kMasks | 0x8040, 0}},
    {"down", {kMasks | 0x2000, 0x01}},
    {"up", {kMasks | 0x4000, 0}},
    {"towards zero and flush", {kMasks | 0xE000, 0}},
    {"traps", {0, 0}},
};
#elif defined(__aarch64__)
Registers Read() {
    Registers now;
    asm volatile("mrs %0, fpcr" : "=r"(now.control));
    asm volatile("mrs %0, fpsr" : "=r"(now.flags));
    return now;
}
void Write(const Registers& registers) {
    asm volatile("msr fpcr, %0" : : "r"(registers.control) : "memory");
    asm volatile("msr fpsr, %0" : : "r"(registers.flags) : "memory");
}
// Few processors have traps: where they do not, the bits read as zero.
const std::vector<std::pair<std::string, Registers>> kEnvironments = {
    {"default", {0, 0}},   {"flush to zero", {1u << 24, 0}}, {"default NaN", {1u << 25, 0x10}},
    {"up", {1u << 22, 0}}, {"down", {2u << 22, 0x01}},       {"towards zero and flush", {3u << 22 | 1u << 24, 0}},
};
#else
Registers Read() { return {}; }
void Write(const Registers&) {}
const std::vector<std::pair<std::string, Registers>> kEnvironments = {{"default", {}}};
#endif

// What stands between here and End() runs in an environment, which must be there still. The test's own arithmetic, such
// as that of settings, stays outside.
class Environment {
public:
    explicit Environment(const Registers& registers) : before_(Read()) {
        Write(registers);
        set_ = Read();  // bits that the processor has not are zero
    }
    ~Environment() {
        const Registers now = Read();
        Write(before_);
        EXPECT_EQ(now.control, set_.control);
        EXPECT_EQ(now.flags, set_.flags);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

private:
    const Registers before_;
    Registers set_;
};

// FNV-1a of the bits of numbers.
class Bits {
public:
    template <class T>
    Bits& operator<<(const T& value) {
        if constexpr (std::is_same_v<T, Vector3> || std::is_same_v<T, Position>) {
            *this << value.x() << value.y() << value.z();
        } else if constexpr (std::is_same_v<T, Quaternion>) {
            *this << value.x << value.y << value.z << value.w;
        } else if constexpr (std::is_same_v<T, Pose>) {
            *this << value.position << value.rotation;
        } else {
            static_assert(std::is_arithmetic_v<T>);
            for (const auto byte : std::bit_cast<std::array<unsigned char, sizeof(T)>>(value))
                hash_ = (hash_ ^ byte) * 0x100000001B3ull;
        }
        return *this;
    }
    uint64_t Hash() const { return hash_; }

private:
    uint64_t hash_ = 0xCBF29CE484222325ull;
};

// ---- A world

// Settings of bodies of many shapes, above a floor that is half a mesh, half a height field. Some are so slow and so
// small that their numbers are subnormal.
std::vector<BodySettings> Bodies(const std::vector<ShapePtr>& shapes) {
    std::vector<BodySettings> bodies;
    for (int i = 0; i < 24; ++i) {
        const double x = i % 4 * 0.9 - 1.4, y = 0.7 + i / 4 * 0.8, z = i % 3 * 0.11;
        bodies.push_back({.shape = shapes[static_cast<size_t>(i) % shapes.size()],
                          .position = {x, y, z},
                          .rotation = RotationAbout({0, 0, 1}, 0.1f * static_cast<float>(i)),
                          .linearVelocity = {1e-39f * static_cast<float>(i), i % 5 == 0 ? -20.0f : 0, 0},
                          .angularVelocity = {0, 1e-40f, 0},
                          .continuous = i % 5 == 0 ? ContinuousCollision::Linear : ContinuousCollision::Off});
    }
    return bodies;
}

struct Ground {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    std::vector<float> heights;

    Ground() {
        for (int i = 0; i < 64; ++i) {
            vertices.emplace_back(static_cast<float>(i % 8) - 7.0f, 0.02f * static_cast<float>(i % 3),
                                  static_cast<float>(i / 8) - 3.5f);
            heights.push_back(0.03f * static_cast<float>(i % 4));
        }
        for (uint32_t z = 0; z < 7; ++z)
            for (uint32_t x = 0; x < 7; ++x) {
                const uint32_t a = 8 * z + x;
                indices.insert(indices.end(), {a, a + 8, a + 1, a + 1, a + 8, a + 9});
            }
    }
};

std::vector<ShapePtr> MakeShapes() {
    const ShapePtr box = Box::Create({0.3f, 0.2f, 0.25f}).Value(), ball = Sphere::Create(0.23f).Value();
    const Vector3 corners[] = {{0, 0.31f, 0}, {0.3f, -0.1f, 0}, {-0.2f, -0.1f, 0.3f}, {-0.1f, -0.1f, -0.33f}};
    const Compound::ChildSettings children[] = {{.shape = box}, {.shape = ball, .position = {0.3f, 0.1f, 0}}};
    return {box,
            ball,
            Capsule::Create(0.2f, 0.15f).Value(),
            Cylinder::Create(0.2f, 0.25f).Value(),
            Cylinder::CreateCone(0.3f, 0.25f).Value(),
            TaperedCapsule::Create(0.2f, 0.1f, 0.2f).Value(),
            ConvexHull::Create(corners).Value(),
            Compound::Create(children).Value(),
            Scaled(ConvexHull::Create(corners).Value(), {1.3f, 0.7f, 1.1f}).Value(),
            OffsetCenterOfMass(box, {0.05f, -0.03f, 0.01f}).Value()};
}

// The hash of a world after a second in which bodies fall, joints hold, rays are cast and forces act. early: the
// environment is set before shapes, threads and world are made; otherwise before the first step.
uint64_t HashOfWorld(const Registers& registers, bool early, uint32_t threads) {
    const Registers normal = Read();
    const Registers& first = early ? registers : normal;
    const Ground ground;
    std::vector<ShapePtr> shapes;
    ShapePtr mesh, field;
    std::unique_ptr<ThreadPool> pool;
    std::unique_ptr<PhysicsSystem> system;
    {
        const Environment environment(first);
        pool = std::make_unique<ThreadPool>(threads);
        system = PhysicsSystem::Create({}, pool.get()).Value();
        shapes = MakeShapes();
        mesh = TriangleMesh::Create({.vertices = ground.vertices, .indices = ground.indices}).Value();
        field = HeightField::Create(
                    {.sampleCountX = 8, .sampleCountZ = 8, .heights = ground.heights, .origin = {0, 0, -3.5f}})
                    .Value();
    }
    const std::vector<BodySettings> bodies = Bodies(shapes);
    std::vector<BodyId> ids;
    std::vector<HingeJointSettings> hinges(2);
    Fields fields{.waters = {{.level = 0.3, .density = 300}}, .winds = {{.velocity = {3, 0, 1}}}};
    {
        const Environment environment(first);
        (void)system->Bodies().Create({.shape = mesh, .motion = MotionType::Static}).Value();
        (void)system->Bodies().Create({.shape = field, .motion = MotionType::Static}).Value();
        for (const BodySettings& body : bodies) ids.push_back(system->Bodies().Create(body).Value());
    }
    for (size_t k = 0; k < 2; ++k) {
        hinges[k].bodyA = ids[k];
        hinges[k].bodyB = ids[k + 4];
        hinges[k].anchorA = {.point = bodies[k].position, .axis = {0, 0, 1}};
        hinges[k].angle.motor = {.mode = MotorMode::ToVelocity, .targetSpeed = 1, .minForce = -3, .maxForce = 3};
    }
    Bits bits;
    const Environment environment(registers);
    for (const HingeJointSettings& hinge : hinges) (void)system->Joints().Create(hinge).Value();
    for (int step = 0; step < 30; ++step) {
        if (step % 8 == 0) (void)fields.Apply(*system, kStep);
        if (!system->Update(kStep)) ADD_FAILURE();
        WorldRayHit hit;
        if (system->Queries().CastRay({{0.1, 4, 0.1}, {0, -5, 0.3f}}, hit)) bits << hit.fraction << hit.normal;
        WorldClosest closest;
        if (system->Queries().FindClosest(Position(0, 2, 0), 3, closest)) bits << closest.distance << closest.onBody;
    }
    return (bits << system->HashState() << system->HashPoses() << system->GetEnergy()).Hash();
}

TEST(FloatEnvironment, IsTheDefaultInEveryWorld) {
    const uint64_t expected = HashOfWorld(Read(), true, 1);
    for (const auto& [name, registers] : kEnvironments)
        for (const uint32_t threads : {1u, 4u})
            for (const bool early : {true, false})
                EXPECT_EQ(HashOfWorld(registers, early, threads), expected)
                    << name << (early ? ", early, " : ", late, ") << threads;
}

// Workers of a game's own threads have what the game set for them, job by job.
TEST(FloatEnvironment, IsTheDefaultInJobsOfThreadsOfTheGame) {
    class GameThreads final : public JobSystem {
    public:
        explicit GameThreads(const Registers& registers) : registers_(registers) {}
        uint32_t WorkerCount() const override { return pool_.WorkerCount(); }
        void ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) override {
            pool_.ParallelFor(count, minimumRange, [&](JobRange range) {
                const Environment environment(registers_);
                job(range);
            });
        }
        void RunOnWorkers(FunctionRef<void(uint32_t)> job) override {
            pool_.RunOnWorkers([&](uint32_t worker) {
                const Environment environment(registers_);
                job(worker);
            });
        }

    private:
        ThreadPool pool_{4};
        const Registers registers_;
    };
    const auto hashWith = [](JobSystem* jobs) {
        const auto system = PhysicsSystem::Create({}, jobs).Value();
        (void)system->Bodies().Create({.shape = Plane::Create().Value(), .motion = MotionType::Static}).Value();
        for (const BodySettings& body : Bodies(MakeShapes())) (void)system->Bodies().Create(body).Value();
        for (int step = 0; step < 20; ++step) EXPECT_TRUE(system->Update(kStep));
        return system->HashState();
    };
    const uint64_t expected = hashWith(nullptr);
    for (const auto& [name, registers] : kEnvironments) {
        GameThreads jobs(registers);
        EXPECT_EQ(hashWith(&jobs), expected) << name;
    }
}

TEST(FloatEnvironment, IsTheDefaultWhereMeshesAreBuiltByThreads) {
    // Enough triangles that the tree's build runs jobs.
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    constexpr uint32_t kSide = 160;
    for (uint32_t i = 0; i < kSide * kSide; ++i)
        vertices.emplace_back(static_cast<float>(i % kSide) * 0.37f, static_cast<float>(i * i % 17) * 0.1f,
                              static_cast<float>(i / kSide) * 0.41f);
    for (uint32_t z = 0; z + 1 < kSide; ++z)
        for (uint32_t x = 0; x + 1 < kSide; ++x)
            indices.insert(indices.end(), {kSide * z + x, kSide * (z + 1) + x, kSide * z + x + 1});
    const auto hashOf = [&](const ParallelLoop& parallel) {
        const auto mesh = TriangleMesh::Create({.vertices = vertices, .indices = indices}, nullptr, parallel).Value();
        Bits bits;
        for (uint32_t id = 0; id < mesh->TriangleIdEnd(); ++id) bits << mesh->GetTriangle(id).vertices[0];
        return bits.Hash();
    };
    ThreadPool pool(4);
    const uint64_t expected = hashOf({});
    for (const auto& [name, registers] : kEnvironments) {
        const ParallelLoop loop = [&pool, &wanted = registers](uint32_t count, const Function<void(uint32_t)>& job) {
            pool.ParallelFor(count, 1, [&](JobRange range) {
                const Environment environment(wanted);
                for (uint32_t i = range.begin; i < range.end; ++i) job(i);
            });
        };
        EXPECT_EQ(hashOf(loop), expected) << name;
    }
}

// ---- Calls

struct Call {
    const char* name;
    std::function<void(Bits&)> make;  // without arithmetic of its own
};

class Lines : public DrawingTarget {
public:
    explicit Lines(Bits& bits) : bits_(bits) {}
    void Line(const Position& from, const Position& to, DrawingColor) override { bits_ << from << to; }
    void Triangle(const Position& a, const Position& b, const Position& c, DrawingColor) override {
        bits_ << a << b << c;
    }

private:
    Bits& bits_;
};

void Add(Bits& bits, const SolidMass& mass) {
    bits << mass.volume << mass.center << mass.inertia.xx << mass.inertia.xy << mass.inertia.zz;
}

RagdollSettings TwoParts() {
    RagdollSettings ragdoll;
    ragdoll.parts.push_back({.name = "hip", .body = {.shape = BoxOf(0.2f, 0.1f, 0.1f)}, .joint = {}});
    SwingTwistJointSettings joint;
    joint.anchorA = {.point = {0, 0.3, 0}, .axis = {0, 1, 0}};
    joint.twist.motor = joint.swingY.motor = joint.swingZ.motor = {.mode = MotorMode::ToPosition};
    ragdoll.parts.push_back({.name = "chest",
                             .parent = 0,
                             .body = {.shape = BoxOf(0.15f, 0.2f, 0.1f), .position = {0, 0.51, 0}, .mass = 0.3f},
                             .joint = joint});
    return ragdoll;
}

std::vector<Call> CallsWithoutWorld() {
    const std::vector<ShapePtr> shapes = MakeShapes();
    const auto convex = [](const ShapePtr& shape) -> const ConvexShape& {
        return static_cast<const ConvexShape&>(*shape);
    };
    const ShapePtr box = shapes[0], hull = shapes[6], compound = shapes[7];
    const RelativePose near{{0.41f, 0.13f, 0.05f}, RotationAbout({0.6f, 0, 0.8f}, 0.7f)};
    const Pose pose{{0.41, 0.13, 0.05}, near.rotation};
    const ShapeMotion motion{.pose = {{3, 0.1, 0}, {}}, .displacement = {-4, 0.1f, 0}, .turn = {0, 0.3f, 0}};
    const Position corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const int faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    static const PolygonRange kPolygons[] = {{0, 3}, {3, 3}, {6, 3}, {9, 3}};
    const std::vector<Position> vertices(corners, corners + 4);
    const std::vector<int> indices(faces, faces + 12);
    const Vector3 way[] = {{0, 0, 0}, {1, 0.2f, 0}, {2, 0, 0.7f}, {3, -0.3f, 1}};
    const std::vector<Vector3> points(way, way + 4);
    const auto path = Path::CatmullRom(points, std::vector<Vector3>{{0, 1, 0}}, false).Value();
    const RagdollSettings ragdoll = TwoParts();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    return {
        {"shapes",
         [](Bits& bits) {
             for (const ShapePtr& shape : MakeShapes())
                 bits << shape->Mass().volume << shape->Mass().principalInertia << shape->Mass().principalAxes
                      << shape->LocalBounds().upper << ContentHash(*shape);
         }},
        {"refused settings",
         [=](Bits& bits) {
             bits << bool(Box::Create({nan, 1, 1})) << bool(Sphere::Create(nan)) << bool(Plane::Create({nan, 0, 0}));
         }},
        {"collide",
         [=](Bits& bits) {
             for (const ShapePtr& other : shapes) {
                 if (!other->IsConvex()) continue;
                 Manifold manifold;
                 PairCache cache;
                 CollideCounters counters;
                 Collide(convex(box), convex(other), near, {}, cache, manifold, counters);
                 bits << manifold.pointCount << manifold.normal << manifold.points[0].separation;
             }
         }},
        {"distances",
         [=](Bits& bits) {
             for (const ShapePtr& other : shapes) {
                 ClosestPoints found;
                 bits << FindClosestPoints(*hull, *other, near, 5, found) << found.distance << found.onA;
                 bits << FindClosestPoint(*other, {1, 0.3f, 0}, 5, found) << found.distance;
                 bits << Overlap(*hull, *other, near) << Contains(*other, {0.1f, 0, 0});
             }
         }},
        {"rays",
         [=](Bits& bits) {
             const RayCaster caster({{0.1, 3, 0.05}, {0.2f, -4, 0}});
             for (const ShapePtr& other : shapes) {
                 RayHit hit;
                 bits << caster.CastClosest(*other, pose, {}, hit) << hit.fraction << hit.normal
                      << caster.IsHit(*other, pose, {});
             }
         }},
        {"shape casts",
         [=](Bits& bits) {
             const ShapeCaster caster(convex(hull), motion);
             for (const ShapePtr& other : shapes) {
                 ShapeHit hit;
                 bits << caster.CastClosest(*other, pose, {}, hit) << hit.fraction << hit.normal << hit.position;
             }
         }},
        {"mass properties",
         [=](Bits& bits) {
             const SolidMass solid = PolyhedronMass(vertices, kPolygons, indices);
             Add(bits, solid);
             Add(bits, Transformed(solid, near.rotation, {1, 2, 3}));
             const SolidMass both[] = {solid, ToSolidMass(hull->Mass())};
             const double densities[] = {1, 3};
             const SolidMass sum = CombinedMass(both, densities);
             Add(bits, sum);
             bits << Diagonalized(sum.inertia).values << ToMassProperties(sum).Value().principalInertia;
         }},
        {"what is under water, and in the wind",
         [=](Bits& bits) {
             for (const ShapePtr& shape : shapes)
                 if (shape->IsConvex())
                     bits << Submerged(convex(shape), {0, 1, 0}, 0.03).volume << ShadowArea(convex(shape), {0, 0, 1});
         }},
        {"surfaces that are drawn",
         [=](Bits& bits) {
             for (const ShapePtr& shape : shapes)
                 VisitTriangles(
                     *shape, [&](const DrawnTriangle& triangle) { bits << triangle.corners[1]; }, 1);
             for (const Vector3& vertex : SampleSurface(convex(hull), 5).vertices) bits << vertex;
         }},
        {"paths",
         [=](Bits& bits) {
             bits << path->Length() << path->LengthAt(1.3) << path->Closest({1.2f, 1, 0.3f}) << path->Sample(2.2).turn;
             bits << Path::CatmullRom(points, std::vector<Vector3>{{0, 1, 0}}, true).Value()->Length();
         }},
        {"edits of compounds",
         [=](Bits& bits) {
             const MutableCompound::ChildSettings child{.shape = box};
             const auto edited = MutableCompound::Create({&child, 1}).Value();
             const auto id = edited->Add({.shape = hull, .position = {0.7f, 0.1f, 0}}).Value();
             bits << edited->Mass().principalInertia;
             EXPECT_TRUE(edited->Move(id, {0.3f, 0.7f, 0.1f}, near.rotation));
             bits << edited->Mass().principalInertia << edited->Mass().centerOfMass;
             bits << Scaled(compound, {2, 2, 2}).Value()->Mass().volume;
         }},
        {"files of shapes",
         [=](Bits& bits) {
             const std::vector<uint8_t> bytes = SaveShape(*compound).Value();
             bits << LoadShape(bytes).Value()->Mass().principalInertia;
         }},
        {"settings of ragdolls",
         [=](Bits& bits) {
             RagdollSettings settings = ragdoll;
             EXPECT_TRUE(StabilizeMasses(settings));
             EXPECT_TRUE(StabilizeInertia(settings));
             bits << settings.parts[1].body.mass << settings.parts[1].body.inertia
                  << JointFramesOf(settings, 1).inPart.position;
             Pose poses[2];
             ReferencePose(settings, pose, poses);
             bits << poses[1];
             const Quaternion rotations[] = {{}, near.rotation};
             PoseFromJoints(settings, pose, rotations, poses);
             bits << poses[1];
         }},
    };
}

std::vector<Call> CallsOfWorld(PhysicsSystem& system, std::span<const BodyId> ids) {
    BodyInterface& bodies = system.Bodies();
    const QueryInterface& queries = system.Queries();
    const BodyId body = ids[0];
    const ShapePtr ball = SphereOf(0.4f);
    const auto& convexBall = static_cast<const ConvexShape&>(*ball);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    return {
        {"getters",
         [&, body](Bits& bits) {
             bits << bodies.GetPose(body) << bodies.GetVelocityAt(body, {0, 1, 0}) << bodies.GetMass(body)
                  << bodies.GetAngularMomentum(body) << bodies.GetKineticEnergy(body) << bodies.GetBounds(body).upper
                  << bodies.GetInertia(body).xx << system.LockingBodies().GetPose(body) << system.GetEnergy();
             system.Joints().Visit([&](JointId id) {
                 bits << system.Joints().GetError(id).distance << system.Joints().GetFrameB(id)
                      << system.Joints().GetCoordinate(id, JointAxis::AngularX);
             });
         }},
        {"refused changes",
         [&, body, nan](Bits& bits) {
             bits << bool(bodies.SetVelocity(body, {nan, 0, 0}, {})) << bool(bodies.AddForce(body, {nan, 0, 0}))
                  << bool(system.Update(nan)) << bool(bodies.SetPenetrationTarget(body, nan));
             std::vector<OverlapHit> hits;
             queries.FindBodiesAt(Position::Constant(nan), hits);
             queries.FindInBox(Position::Constant(nan), Position::Constant(nan), hits);
         }},
        {"queries",
         [&, ball](Bits& bits) {
             std::vector<WorldRayHit> rays;
             queries.CastRayAll({{0.1, 6, 0.1}, {0, -7, 0.3f}}, rays);
             for (const WorldRayHit& hit : rays) bits << hit.fraction << hit.normal << hit.position;
             std::vector<WorldShapeHit> hits;
             queries.CastShapeAll({&convexBall, {{0.1, 6, 0.1}, {}}, {0, -7, 0.3f}}, hits);
             for (const WorldShapeHit& hit : hits) bits << hit.fraction << hit.normal << hit.position;
             std::vector<WorldContact> contacts;
             queries.CollideShape({ball.get(), {{0, 0.5, 0}, {}}}, 0.3f, contacts);
             for (const WorldContact& contact : contacts) bits << contact.normal << contact.points[0].onBody;
             WorldClosest closest;
             bits << queries.FindClosest({ball.get(), {{0, 6, 0}, {}}}, 9, closest) << closest.distance;
             std::vector<OverlapHit> found;
             queries.FindOnSweep({-1, 0, -1}, {1, 1, 1}, {0, 3, 0}, found);
             bits << found.size() << queries.IsOverlapping({ball.get(), {{0, 1, 0}, {}}});
         }},
        {"batches of queries",
         [&](Bits& bits) {
             std::vector<Ray> rays(300, Ray{{0.1, 6, 0.1}, {0, -7, 0.3f}});
             std::vector<WorldRayHit> hits(rays.size());
             queries.CastRays(rays, hits);
             for (const WorldRayHit& hit : hits) bits << hit.fraction << hit.normal;
         }},
        {"views and drawings",
         [&](Bits& bits) {
             system.VisitContacts([&](const ContactView& contact) { bits << contact.Center(); });
             Lines lines(bits);
             Draw(system, lines, {.bounds = true, .centers = true, .velocities = true, .contacts = true});
         }},
        {"snapshots",
         [&, ids](Bits& bits) {
             std::vector<std::byte> all, some;
             EXPECT_TRUE(system.SaveSnapshot(all));
             EXPECT_TRUE(system.SaveBodies(ids, some));
             EXPECT_TRUE(system.Update(kStep));
             bits << system.HashState();
             EXPECT_TRUE(system.RestoreBodies(some));
             EXPECT_TRUE(system.Update(kStep));
             bits << system.HashState();
             EXPECT_TRUE(system.RestoreSnapshot(all));
             bits << system.HashState();
         }},
        {"changes",
         [&, body, tilted = RotationAbout({0, 0, 1}, 0.3f)](Bits& bits) {
             EXPECT_TRUE(bodies.AddImpulseAt(body, {0.3f, 0.1f, 0}, {0.1, 1, 0}));
             EXPECT_TRUE(bodies.AddRadialImpulse({.center = {0, 1, 0}, .radius = 3, .impulse = 0.7f}));
             EXPECT_TRUE(bodies.SetPose(body, {0, 5, 0}, tilted));
             EXPECT_TRUE(system.Update(kStep));
             bits << system.HashState();
         }},
        {"ragdolls",
         [&, settings = TwoParts()](Bits& bits) {
             Ragdoll ragdoll = Ragdoll::Create(system, settings, {{5, 3, 0}, {}}).Value();
             Pose poses[2];
             EXPECT_TRUE(ragdoll.GetPose(poses));
             EXPECT_TRUE(ragdoll.DriveByMotors(poses));
             EXPECT_TRUE(ragdoll.DriveByVelocities(poses, 0.1f));
             EXPECT_TRUE(system.Update(kStep));
             bits << ragdoll.Origin() << system.HashState();
             ragdoll.Remove();
         }},
        {"recordings",
         [&](Bits& bits) {
             EXPECT_TRUE(system.Update(kStep));  // what was removed is gone
             std::vector<std::byte> bytes;
             {
                 const auto recorder = CallRecorder::Create(system, [&](std::span<const std::byte> more) {
                                           bytes.insert(bytes.end(), more.begin(), more.end());
                                           return true;
                                       }).Value();
                 EXPECT_TRUE(system.Update(kStep));
             }
             const auto replayed = Replay(CallRecording::Read(bytes).Value()).Value();
             EXPECT_FALSE(replayed.divergence);
             bits << replayed.stateHash;
         }},
    };
}

void ExpectTheSameInEveryEnvironment(const std::function<std::vector<Call>()>& make) {
    std::vector<uint64_t> expected;
    for (const auto& [name, registers] : kEnvironments) {
        const std::vector<Call> calls = make();
        for (size_t i = 0; i < calls.size(); ++i) {
            SCOPED_TRACE(name + ", " + calls[i].name);
            Bits bits;
            {
                const Environment environment(registers);
                calls[i].make(bits);
            }
            if (expected.size() == i) expected.push_back(bits.Hash());
            EXPECT_EQ(bits.Hash(), expected[i]);
        }
    }
}

TEST(FloatEnvironment, IsTheDefaultInEveryCallWithoutWorld) { ExpectTheSameInEveryEnvironment(CallsWithoutWorld); }

TEST(FloatEnvironment, IsTheDefaultInEveryCallOfAWorld) {
    std::unique_ptr<TestWorld> world;
    std::vector<BodyId> ids;
    ExpectTheSameInEveryEnvironment([&] {
        world = std::make_unique<TestWorld>(SystemSettings{}, 2);
        world->AddFloor();
        ids.clear();
        for (const BodySettings& body : Bodies(MakeShapes())) ids.push_back(world->Add(body));
        HingeJointSettings hinge;
        hinge.bodyA = ids[0];
        hinge.bodyB = ids[1];
        (void)world->System().Joints().Create(hinge).Value();
        world->Steps(20);
        return CallsOfWorld(world->System(), ids);
    });
}

// What the engine calls back computes as the engine does, whatever the program has set.
TEST(FloatEnvironment, IsTheDefaultInCallbacks) {
    TestWorld world;
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const Registers normal = Read();
    struct Listener : ContactListener {
        mutable Registers seen;
        void ModifyContact(const ContactView&, ContactChange&) const override { seen = Read(); }
    } listener;
    world.System().SetContactListener(&listener);
    for (const auto& [name, registers] : kEnvironments) {
        Registers inQuery;
        {
            const Environment environment(registers);
            EXPECT_TRUE(world.System().Update(kStep));
            const auto accepts = [&](BodyId) { return inQuery = Read(), true; };
            WorldRayHit hit;
            (void)world.System().Queries().CastRay({{0, 3, 0}, {0, -3, 0}}, hit, {}, {.accepts = accepts});
        }
        EXPECT_EQ(listener.seen.control, normal.control) << name;
        EXPECT_EQ(inQuery.control, normal.control) << name;
    }
}

// While a program holds a world, its own arithmetic between the calls is in its own environment.
TEST(FloatEnvironment, IsTheProgramsWhileItHoldsAWorld) {
    TestWorld world;
    for (const auto& [name, registers] : kEnvironments) {
        const Environment environment(registers);
        const auto held = world.System().Queries().Hold();
        EXPECT_EQ(Read().control, registers.control) << name;
    }
}

}  // namespace
}  // namespace fulcrum::testing
