// Batches of rays are cast in packets of rays that lie close together: results must have the bits of single casts.
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace fulcrum::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

float Wave(float x, float z) { return 2 * static_cast<float>(std::sin(double{0.3f * x}) * std::cos(double{0.2f * z})); }

// Waves over a square of 60 m, 2048 triangles.
std::shared_ptr<const TriangleMesh> Hills() {
    constexpr uint32_t kSide = 33;
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        const float x = static_cast<float>(i % kSide) * 1.875f - 30, z = static_cast<float>(i / kSide) * 1.875f - 30;
        vertices.push_back(Vector3(x, Wave(x, z), z));
        if (i % kSide + 1 == kSide || i / kSide + 1 == kSide) continue;
        for (const uint32_t k : {i, i + kSide, i + 1, i + 1, i + kSide, i + kSide + 1}) indices.push_back(k);
    }
    TriangleMeshSettings settings;
    settings.vertices = vertices;
    settings.indices = indices;
    return TriangleMesh::Create(settings).Value();
}

ShapePtr Field() {
    std::vector<float> heights;
    for (int i = 0; i < 400; ++i) heights.push_back(Wave(static_cast<float>(i % 20), static_cast<float>(i / 20)));
    HeightFieldSettings settings;
    settings.sampleCountX = settings.sampleCountZ = 20;
    settings.heights = heights;
    return HeightField::Create(settings).Value();
}

// Hills, a smaller, mirrored and tilted copy of them, a height field, a half space below, tiles whose tops are level, a
// cloud of bodies of all kinds above, and two exactly alike in one place.
struct Landscape {
    TestWorld world;
    Position origin;
    std::vector<BodyId> ids;
    std::vector<ShapePtr> shapes{SphereOf(0.4f),
                                 BoxOf(0.5f, 0.3f, 0.7f),
                                 CapsuleOf(0.4f, 0.3f),
                                 Box::Create(Vector3(0.5f, 0.4f, 0.3f), 0.1f).Value(),
                                 HullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}),
                                 CompoundOf({{SphereOf(0.3f), Vector3(0.6f, 0, 0), {}, 1},
                                             {BoxOf(0.2f, 0.6f, 0.2f), Vector3(-0.3f, 0.2f, 0), {}, 1}})};

    explicit Landscape(uint32_t threads = 1, const Position& where = Position::Zero())
        : world(NoGravity(), threads), origin(where) {
        RandomPoses random(1);
        const std::shared_ptr<const TriangleMesh> hills = Hills();
        Add(hills, Vector3::Zero(), {}, MotionType::Static);
        Add(TriangleMesh::Scaled(*hills, Vector3(-0.2f, 0.3f, 0.15f)).Value(), Vector3(3, 8, 2), random.Rotation(),
            MotionType::Static);
        Add(Field(), Vector3(-25, 4, 5), random.Rotation(), MotionType::Static);
        Add(Plane::Create(Vector3(0, 1, 0), 0).Value(), Vector3(0, -6, 0), {}, MotionType::Static);
        for (int i = 0; i < 36; ++i)
            Add(BoxOf(1, 0.25f, 1), Vector3(static_cast<float>(i % 6) * 2 + 10, 5, static_cast<float>(i / 6) * 2 - 20),
                {}, MotionType::Static);
        for (int i = 0; i < 2; ++i) Add(BoxOf(2, 1, 2), Vector3(-20, 5, -20), {}, MotionType::Static);
        for (size_t i = 0; i < 300; ++i) {
            const Vector3 at = random.InCube().cwiseProduct(Vector3(28, 4, 28)) + Vector3(0, 5, 0);
            const Quaternion turn = random.Rotation();
            Add(shapes[i % shapes.size()], at, turn, i % 2 == 0 ? MotionType::Kinematic : MotionType::Dynamic,
                random.InCube() * 30);
        }
        world.Step();  // some have left their fat bounds
    }
    void Add(const ShapePtr& shape, const Vector3& at, const Quaternion& rotation, MotionType motion,
             const Vector3& velocity = Vector3::Zero()) {
        BodySettings settings;
        settings.shape = shape;
        settings.motion = motion;
        settings.position = origin + at.cast<double>();
        settings.rotation = rotation;
        settings.linearVelocity = velocity;
        settings.layer = static_cast<uint8_t>(ids.size() % 3);
        ids.push_back(world.Bodies().Create(settings).Value());
    }
    Ray At(const Vector3& from, const Vector3& along) const { return {origin + from.cast<double>(), along}; }
    const QueryInterface& Queries() { return world.System().Queries(); }
};

// Rays of every kind, `count` of each.
std::vector<std::vector<Ray>> AllRays(const Landscape& land, int count) {
    RandomPoses random(2);
    std::vector<std::vector<Ray>> kinds(8);
    const auto overGround = [&](float y) {
        return Vector3(random.InCube().cwiseProduct(Vector3(30, 0, 30)) + Vector3(0, y, 0));
    };
    for (int i = 0; i < count; ++i) {
        kinds[0].push_back(land.At(overGround(20), Vector3(0, -30, 0)));
        kinds[1].push_back(land.At(overGround(15), Vector3(20, -30, -8)));
        const float right = static_cast<float>(i % 60) * 0.8f - 24,
                    down = 25 * static_cast<float>(i / 60 * 60) / static_cast<float>(count);
        kinds[2].push_back(land.At(Vector3(1, 12, -35), Vector3(right, -down, 60)));
        const Vector3 above = overGround(random.Between(-8, 15));
        kinds[3].push_back(land.At(above, random.InCube() * 30));
        // Along axes, and on the planes where tiles, cells and boxes meet.
        Vector3 axis = Vector3::Zero();
        axis[i % 3] = i % 2 == 0 ? 40.0f : -40.0f;
        const Vector3 grid{std::floor(random.Between(-20, 20)), 5.25f, std::floor(random.Between(-20, 20))};
        kinds[4].push_back(land.At(grid - axis * 0.5f, axis));
        // Nearly the same ray; very long and very short ones; those that end where they hit.
        const Vector3 nearly(Vector3(0.1f, 9, 0.2f) + random.InCube() * 1e-4f);
        kinds[5].push_back(land.At(nearly, Vector3(0, -10, 0) + random.InCube() * 1e-4f));
        const Vector3 any = overGround(10);
        kinds[6].push_back(land.At(any, random.InCube() * (i % 2 == 0 ? 1e9f : 1e-3f)));
        const float bad[] = {kNan, kInfinity, -kInfinity, 0.0f, 1e30f, -1e-30f};
        Ray odd = land.At(overGround(20), Vector3(0, -30, 0));
        if (i % 3 == 0) odd.displacement[i % 2] = bad[i % 6];
        if (i % 5 == 0) odd.displacement.setZero();
        if (i % 7 == 0) odd.origin[i % 3] = double{bad[(i / 7) % 6]};
        kinds[7].push_back(odd);
    }
    std::vector<Ray> all;
    for (const std::vector<Ray>& kind : kinds) all.insert(all.end(), kind.begin(), kind.end());
    kinds.push_back(all);
    return kinds;
}

bool SameBits(const WorldRayHit& a, const WorldRayHit& b) {
    bool same = a.body == b.body && a.subShape == b.subShape && a.isBackFace == b.isBackFace &&
                std::bit_cast<uint32_t>(a.fraction) == std::bit_cast<uint32_t>(b.fraction);
    for (int k = 0; k < 3; ++k) {
        same &= std::bit_cast<uint32_t>(a.normal[k]) == std::bit_cast<uint32_t>(b.normal[k]);
        same &= std::bit_cast<uint64_t>(a.position[k]) == std::bit_cast<uint64_t>(b.position[k]);
    }
    return same;
}

// How many of them hit.
size_t ExpectSingleAnswers(const QueryInterface& queries, std::span<const Ray> rays,
                           const RayCastSettings& settings = {}, const QueryFilter& filter = {}) {
    WorldRayHit stale;
    stale.fraction = 7;
    std::vector<WorldRayHit> hits(rays.size(), stale);
    queries.CastRays(rays, hits, settings, filter);
    size_t count = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        WorldRayHit hit;
        count += queries.CastRay(rays[i], hit, settings, filter) ? 1 : 0;
        const bool same = SameBits(hits[i], hit);
        EXPECT_TRUE(same) << i << ": " << hits[i].fraction << " of body " << hits[i].body.index << ", alone "
                          << hit.fraction << " of " << hit.body.index;
        if (!same) break;
    }
    return count;
}

TEST(RayPackets, EachRayHasTheHitOfASingleCast) {
    for (const Position& where : {Position(0, 0, 0), Position(3e6, -1e6, 2e6)}) {
        Landscape land(1, where);
        const int count = Cases(3000);
        const std::vector<std::vector<Ray>> kinds = AllRays(land, count);
        for (size_t kind = 0; kind < kinds.size(); ++kind) {
            const size_t hits = ExpectSingleAnswers(land.Queries(), kinds[kind]);
            EXPECT_GT(hits, kinds[kind].size() / 5) << kind;
        }
    }
}

TEST(RayPackets, SettingsAndFiltersCountAsAlone) {
    Landscape land;
    const auto isWanted = [](BodyId id) { return id.index % 4 != 1; };
    const auto isFirst = [](BodyId, uint32_t child) { return child == 0; };
    const BodyId ignored[] = {land.ids[0]};
    for (const std::vector<Ray>& rays : AllRays(land, Cases(400))) {
        ExpectSingleAnswers(land.Queries(), rays, {.backFaces = true, .hollow = true});
        for (const float most : {0.0f, 0.3f, 1.5f, kInfinity})
            ExpectSingleAnswers(land.Queries(), rays, {.maxFraction = most});
        ExpectSingleAnswers(land.Queries(), rays, {}, {.layers = 0b101, .ignore = ignored, .sensors = true});
        ExpectSingleAnswers(land.Queries(), rays, {}, {.accepts = isWanted, .acceptsChild = isFirst});
    }
}

TEST(RayPackets, AnyNumberOfRaysAndThreads) {
    Landscape one(1), four(4);
    const std::vector<Ray> rays = AllRays(one, Cases(2000)).back();
    for (const size_t count : {size_t{0}, size_t{1}, size_t{7}, size_t{1000}, rays.size()}) {
        const std::span<const Ray> some = std::span(rays).first(std::min(count, rays.size()));
        std::vector<WorldRayHit> a(some.size()), b(some.size());
        one.Queries().CastRays(some, a);
        four.Queries().CastRays(some, b);
        for (size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(SameBits(a[i], b[i])) << i;
    }
    // Only what both have is done.
    std::vector<WorldRayHit> few(10);
    few[9].fraction = 7;
    one.Queries().CastRays(rays, std::span(few).first(9));
    EXPECT_EQ(few[9].fraction, 7);
}

TEST(RayPackets, BatchesInsideOfBatches) {
    Landscape land;
    const std::vector<Ray> rays = AllRays(land, 64)[0];
    std::vector<WorldRayHit> expected(rays.size()), inner(rays.size()), hits(rays.size());
    land.Queries().CastRays(rays, expected);
    const auto accepts = [&](BodyId) {
        land.Queries().CastRays(std::span(rays).first(40), inner);
        return true;
    };
    land.Queries().CastRays(rays, hits, {}, {.accepts = accepts});
    for (size_t i = 0; i < rays.size(); ++i) {
        EXPECT_TRUE(SameBits(hits[i], expected[i])) << i;
        if (i < 40) {
            EXPECT_TRUE(SameBits(inner[i], expected[i])) << i;
        }
    }
}

TEST(RayPackets, AllocateNothingTheSecondTime) {
    Landscape land;
    for (const std::vector<Ray>& rays : AllRays(land, 300)) {
        std::vector<WorldRayHit> hits(rays.size());
        land.Queries().CastRays(rays, hits);
        const uint64_t before = AllocationCount();
        land.Queries().CastRays(rays, hits);
        EXPECT_EQ(AllocationCount(), before);
    }
}

}  // namespace
}  // namespace fulcrum::testing
