// Queries and shapes with extreme numbers: minimal cases of failures that random programs have found.
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Random/QueryChecks.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/Deadline.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <ctime>

namespace fulcrum::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// One ray of a batch must not change the hits of the 31 others, whatever its numbers are.
TEST(QueriesAtExtremes, AnOddRayDoesNotSpoilItsBatch) {
    TestWorld world;
    world.AddFloor();
    world.Add({.shape = SphereOf(1), .motion = MotionType::Static, .position = Position(0, 2, 0)});
    const QueryInterface& queries = world.System().Queries();
    for (const float odd : {kInfinity, -kInfinity, kNaN, 3e38f, -3e38f, 1e30f, 1e19f, 0.0f}) {
        for (int axes = 1; axes < 8; ++axes) {
            std::vector<Ray> rays;
            for (int i = 0; i < 32; ++i) rays.push_back({Position(0.01 * i, 10, 0), Vector3(0.001f, -20, 0.002f)});
            for (int axis = 0; axis < 3; ++axis)
                if (axes >> axis & 1) rays[7].displacement[axis] = odd;
            std::vector<WorldRayHit> hits(rays.size());
            queries.CastRays(rays, hits);
            for (size_t i = 0; i < rays.size(); ++i) {
                WorldRayHit alone;
                const bool isHit = queries.CastRay(rays[i], alone);
                EXPECT_EQ(isHit, i != 7 || hits[7].body != BodyId{}) << odd << " in axes " << axes << ", ray " << i;
                EXPECT_TRUE(AreSame(alone, hits[i])) << odd << " in axes " << axes << ", ray " << i;
            }
        }
    }
}

// Bounds are measured from the first body. From 10^17 m away doubles told nothing near zero apart, and rays passed by
// what they hit.
TEST(QueriesAtExtremes, AFirstBodyFarAwayHidesNothing) {
    for (const double away : {100.0, 1e9, 1e12, 1e15, 7.885e17, -1e18}) {
        TestWorld world({}, 1);
        world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static, .position = {0.5, away, 1.3}});
        RandomPoses random(5);
        for (int i = 0; i < 50; ++i) {
            const Position center = random.InBox(20).cast<double>();
            const BodyId id = world.Add({.shape = SphereOf(0.3f), .motion = MotionType::Static, .position = center});
            const QueryInterface& queries = world.System().Queries();
            for (int axis = 0; axis < 3; ++axis) {
                const Vector3 along = Vector3::Unit(axis);
                WorldRayHit hit;
                ASSERT_TRUE(queries.CastRay({center - along.cast<double>(), along * 2}, hit)) << away;
                EXPECT_EQ(hit.body, id) << away;
                EXPECT_NEAR(hit.fraction, 0.35f, 1e-3f) << away;
            }
            std::vector<OverlapHit> inside;
            queries.FindBodiesAt(center, inside);
            EXPECT_TRUE(std::ranges::any_of(inside, [&](const OverlapHit& found) { return found.body == id; })) << away;
            ASSERT_TRUE(world.Bodies().Remove(id));
        }
    }
}

// A fraction may be larger than one: the list of all hits ended at one for meshes and height fields.
TEST(QueriesAtExtremes, AllHitsAreListedUpToTheFractionThatIsAskedFor) {
    const float heights[] = {0, 0, 0, 0};
    const Vector3 corners[] = {{-5, 0, -5}, {-5, 0, 5}, {5, 0, -5}};
    const uint32_t indices[] = {0, 1, 2};
    const ShapePtr shapes[] = {HeightField::Create({.sampleCountX = 2,
                                                    .sampleCountZ = 2,
                                                    .heights = heights,
                                                    .cellSizeX = 10,
                                                    .cellSizeZ = 10,
                                                    .origin = Vector3(-5, 0, -5)})
                                   .Value(),
                               TriangleMesh::Create({.vertices = corners, .indices = indices}).Value(),
                               BoxOf(5, 0.01f, 5), Plane::Create(Vector3(0, 1, 0), 0).Value()};
    for (const ShapePtr& shape : shapes) {
        TestWorld world;
        world.Add({.shape = shape, .motion = MotionType::Static});
        const Ray ray{Position(-0.5, 10, -0.7), Vector3(0, -4, 0)};
        for (const float maxFraction : {1.0f, 2.0f, 3.0f, 1e10f}) {
            WorldRayHit closest;
            std::vector<WorldRayHit> all;
            const RayCastSettings settings{.maxFraction = maxFraction};
            const bool isHit = world.System().Queries().CastRay(ray, closest, settings);
            world.System().Queries().CastRayAll(ray, all, settings);
            EXPECT_EQ(isHit, maxFraction > 2) << ShapeTypeName(shape->Type()) << " " << maxFraction;
            ASSERT_EQ(all.size(), isHit ? 1u : 0u) << ShapeTypeName(shape->Type()) << " " << maxFraction;
            EXPECT_TRUE(!isHit || AreSame(closest, all[0])) << ShapeTypeName(shape->Type()) << " " << maxFraction;
        }
    }
}

// The closest of a few bodies to a spike so long that its place is off by meters due to rounding: a matter of the
// numbers, not of the order in which the bodies were added, thus not of the tree's.
TEST(QueriesAtExtremes, TheClosestBodyDoesNotDependOnTheTree) {
    constexpr int kBodies = 12;
    for (const float size : {1.0f, 1e6f, 1e7f, 1e8f, 1e9f}) {
        for (uint32_t seed = 0; seed < 1000; ++seed) {
            RandomPoses random(seed);
            BodySettings bodies[kBodies];
            for (BodySettings& body : bodies) {
                const float radius = random.Between(0.1f, 0.5f);
                body.shape = random.Between(0, 1) < 0.5f ? BoxOf(radius, 0.5f * radius, radius) : SphereOf(radius);
                body.motion = MotionType::Static;
                body.position = random.InBox(2).cast<double>();
                body.rotation = random.Rotation();
            }
            const float heights[] = {0, random.Between(0, 1), random.Between(0, 1), size};
            const auto spiked = HeightField::Create({.sampleCountX = 2, .sampleCountZ = 2, .heights = heights}).Value();
            const PlacedShape query{spiked.get(), {random.InBox(1).cast<double>(), random.Rotation()}};
            int closest[2] = {-1, -1};
            float distances[2] = {};
            for (const bool backwards : {false, true}) {
                TestWorld world;
                for (int i = 0; i < kBodies; ++i) world.Add(bodies[backwards ? kBodies - 1 - i : i]);
                WorldClosest found;
                if (!world.System().Queries().FindClosest(query, 5, found)) continue;
                const int index = static_cast<int>(found.body.index);
                closest[backwards] = backwards ? kBodies - 1 - index : index;
                distances[backwards] = found.distance;
            }
            EXPECT_EQ(closest[0], closest[1]) << size << ", seed " << seed;
            EXPECT_EQ(distances[0], distances[1]) << size << ", seed " << seed;
        }
    }
}

// A negative tolerance shrank the box with which the tree was searched: which bodies were hit depended on the tree.
TEST(QueriesAtExtremes, CastsWithSettingsOutOfRangeHitNothing) {
    TestWorld world;
    world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static});
    const ShapePtr ball = SphereOf(0.2f);
    const QueryInterface& queries = world.System().Queries();
    const MovingShape moving{static_cast<const ConvexShape*>(ball.get()), {Position(0, 3, 0), {}}, Vector3(0, -4, 0)};
    WorldShapeHit hit;
    std::vector<WorldShapeHit> all;
    EXPECT_TRUE(queries.CastShape(moving, hit));
    for (const float odd : {-1e-6f, -0.1f, -3e4f, -kInfinity, kInfinity, kNaN}) {
        for (float ShapeCastSettings::*which : {&ShapeCastSettings::separation, &ShapeCastSettings::tolerance}) {
            ShapeCastSettings settings;
            settings.*which = odd;
            EXPECT_FALSE(queries.CastShape(moving, hit, settings)) << odd;
            EXPECT_FALSE(queries.IsHit(moving, settings)) << odd;
            queries.CastShapeAll(moving, all, settings);
            EXPECT_TRUE(all.empty()) << odd;
        }
    }
}

// If the rounding of coordinates exceeds the thickness of the shapes, libccd's MPR refined its portal forever: one pair
// of four here.
TEST(QueriesAtExtremes, ClosestPointsOfFieldsWithAnEndlessSpikeAreFound) {
    RandomPoses random(1);
    constexpr float kSpike = 3.3e12f;
    const auto fieldOf = [&](float corner) {
        const float heights[] = {random.Between(0, 0.1f), corner, random.Between(0, 0.1f), random.Between(0, 0.1f)};
        return HeightField::Create({.sampleCountX = 2, .sampleCountZ = 2, .heights = heights}).Value();
    };
    for (int i = 0; i < 60; ++i) {
        const auto flat = fieldOf(0.05f), spiked = fieldOf(kSpike);
        RelativePose pose;
        pose.rotation = random.Rotation();
        pose.position = Rotate<float>(pose.rotation, Vector3(0, -kSpike * random.Between(0, 1), 0));
        ClosestPoints closest;
        bool found = false;
        Within(60, [&] { found = FindClosestPoints(*flat, *spiked, pose, 1e30f, closest); });
        EXPECT_TRUE(!found || std::isfinite(closest.distance));
    }
}

// Whatever the length, where it meets a turned compound is a matter of its direction.
TEST(QueriesAtExtremes, ALongRayMeetsATurnedCompoundWhereAShortOneDoes) {
    const ShapePtr ball = SphereOf(1);
    const CompoundShape::ChildSettings children[] = {{ball, Vector3(0, 3, 0), {}, 1}, {ball, Vector3(0, -3, 0), {}, 1}};
    const auto compound = Compound::Create(children).Value();
    const Pose pose{Position(2, 1, 0), RotationFromVector(Vector3(0, 0, 0.7f))};
    const Position middle =
        Rotate<double>({pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w}, Position(0, 3, 0)) +
        pose.position;
    for (const float length : {10.0f, 1e3f, 1e10f, 1e19f, 1e20f, 1e30f, 3e38f}) {
        RayHit hit;
        ASSERT_TRUE(
            RayCaster({middle - Position(4, 0, 0), Vector3(length, 0, 0)}).CastClosest(*compound, pose, {}, hit))
            << length;
        EXPECT_NEAR(double{hit.fraction} * double{length}, 3, 1e-5) << length;
        EXPECT_FALSE(
            RayCaster({middle - Position(4, 2, 0), Vector3(length, 0, 0)}).CastClosest(*compound, pose, {}, hit))
            << length;
    }
}

TEST(QueriesAtExtremes, NothingTouchesTheEmptyShape) {
    const std::shared_ptr<const EmptyShape> empty = EmptyShape::Create();
    const RayCaster ray({Position(0, 1, 0), Vector3(0, -2, 0)});
    RayHit hit;
    EXPECT_FALSE(ray.CastClosest(*empty, {}, {}, hit));
    EXPECT_FALSE(ray.IsHit(*empty, {}, {}));
    int count = 0;
    EXPECT_TRUE(ray.CastAll(*empty, {}, {}, [&](const RayHit&) { return ++count > 0; }));
    const auto ball = Sphere::Create(1).Value();
    const ShapeCaster caster(*ball, {{Position(0, 1, 0), {}}, Vector3(0, -2, 0)});
    ShapeHit shapeHit;
    EXPECT_FALSE(caster.CastClosest(*empty, {}, {}, shapeHit));
    ClosestPoints closest;
    EXPECT_FALSE(FindClosestPoints(*empty, *ball, {}, 10, closest));
    EXPECT_FALSE(Overlap(*ball, *empty, {}));
    EXPECT_FALSE(Contains(*empty, Vector3::Zero()));
    EXPECT_EQ(count, 0);
}

TEST(QueriesAtExtremes, FilesLoadEveryCompoundThatCreateMakes) {
    const ShapePtr ball = SphereOf(0.5f);
    const float places[] = {0, 1e-30f, 1, 1e6f, 1e11f, 1e15f, 9e17f, 1e18f, 1e20f, 1e30f, FLT_MAX};
    const float densities[] = {1e-45f, 1e-40f, FLT_MIN, 1e-20f, 1, 1e20f, FLT_MAX};
    int made = 0;
    for (const float place : places) {
        for (const float density : densities) {
            const CompoundShape::ChildSettings children[] = {{ball, Vector3(place, 0, 0), {}, density},
                                                             {ball, Vector3(0, place, 1), {}, 1}};
            const Result<std::shared_ptr<const Compound>> fixed = Compound::Create(children);
            const Result<std::shared_ptr<MutableCompound>> edited = MutableCompound::Create(children);
            std::vector<ShapePtr> shapes;
            if (fixed) shapes.push_back(fixed.Value());
            if (edited) shapes.push_back(edited.Value());
            for (const ShapePtr& shape : shapes) {
                ++made;
                const Result<std::vector<uint8_t>> saved = SaveShape(*shape);
                ASSERT_TRUE(saved);
                const Result<ShapePtr> loaded = LoadShape(saved.Value());
                EXPECT_TRUE(loaded) << "children " << place << " m apart, density " << density << ": "
                                    << loaded.GetError().message;
            }
        }
    }
    EXPECT_GT(made, 20);
}

// A turn of so many radians that its square is no float: the fraction of a hit is one all the same.
TEST(QueriesAtExtremes, TheTimeOfAHitIsFinite) {
    const auto capsule = Capsule::Create(0.5f, 0.2f).Value();
    const ShapePtr box = BoxOf(1, 1, 1);
    int hits = 0;
    RandomPoses random(3);
    for (const float turn : {1e3f, 1e10f, 1e17f, 1e19f, 1e25f, 1e30f, 3e38f}) {
        for (int i = 0; i < 200; ++i) {
            Vector3 turns = random.InBox(2), way = random.InBox(4);
            turns[static_cast<int>(random.Below(3))] = turn;
            if (random.Chance(0.3f)) way[static_cast<int>(random.Below(3))] = std::min(turn, 1e17f);
            const ShapeCaster caster(*capsule, {{random.InBox(4).cast<double>(), random.Rotation()}, way, turns});
            ShapeHit hit;
            const std::shared_ptr<const Plane> plane = Plane::Create().Value();
            const Shape& target = random.Chance(0.5f) ? *box : static_cast<const Shape&>(*plane);
            if (!caster.CastClosest(target, {Position::Zero(), random.Rotation()}, {}, hit)) continue;
            ++hits;
            EXPECT_GE(hit.fraction, 0) << turn;
            EXPECT_LE(hit.fraction, 1) << turn;
            EXPECT_TRUE(IsFinite(hit.normal) && IsFinite(hit.position)) << turn;
        }
    }
    EXPECT_GT(hits, 0);
}

ShapePtr Waves() {
    std::vector<float> heights;
    for (int i = 0; i < 81; ++i) heights.push_back(0.1f * static_cast<float>(i % 7));
    return HeightField::Create({.sampleCountX = 9, .sampleCountZ = 9, .heights = heights, .origin = Vector3(-4, 0, -4)})
        .Value();
}

// Children so far apart that the box around them holds no digits of the field: found by where they are, in bounded
// time.
TEST(QueriesAtExtremes, ACompoundOfFarChildrenMeetsAHeightFieldInBoundedTime) {
    const ShapePtr ball = SphereOf(0.5f), field = Waves();
    const double begin = static_cast<double>(std::clock());
    for (const float apart : {1e3f, 1e6f, 1e9f, 1e11f, 1e15f, 1e17f}) {
        for (const bool isBalanced : {true, false}) {
            const float other = isBalanced ? -apart : 0;
            const CompoundShape::ChildSettings children[] = {{ball, Vector3(apart, 0, 0)},
                                                             {ball, Vector3(other, 0, 0)}};
            const Result<std::shared_ptr<const Compound>> compound = Compound::Create(children);
            ASSERT_TRUE(compound) << apart;
            for (const Vector3& at : {Vector3(0, 1, 0), Vector3(-apart, 1, 0), Vector3(0.3f * apart, 2, 5)}) {
                ClosestPoints closest;
                EXPECT_TRUE(FindClosestPoints(*compound.Value(), *field, {at, {}}, kInfinity, closest)) << apart;
                EXPECT_TRUE(FindClosestPoints(*field, *compound.Value(), {at, {}}, kInfinity, closest)) << apart;
                EXPECT_TRUE(std::isfinite(closest.distance)) << apart;
                (void)Overlap(*compound.Value(), *field, {at, {}});
                TestWorld world;
                world.Add({.shape = compound.Value(), .motion = MotionType::Static});
                world.Add({.shape = field, .motion = MotionType::Static, .position = at.cast<double>()});
                std::vector<OverlapHit> hits;
                const PlacedShape placed{compound.Value().get(), {at.cast<double>(), {}}};
                world.System().Queries().FindOverlaps(placed, hits);
                WorldClosest nearest;
                EXPECT_TRUE(world.System().Queries().FindClosest(placed, kInfinity, nearest));
            }
        }
    }
    EXPECT_LT((static_cast<double>(std::clock()) - begin) / CLOCKS_PER_SEC, kIsSanitized ? 60 : 3);
}

TEST(QueriesAtExtremes, ClosestPointsAgreeWithTheSupportsAtEverySize) {
    for (const float scale : {1e-5f, 1e-3f, 1.0f, 1e3f, 1e5f, 1e6f}) {
        RandomPoses random(7);
        for (int i = 0; i < Cases(3000); ++i) {
            const auto size = [&] {
                if (random.Chance(0.2f)) return std::pow(10.0f, random.Between(-6, 6));
                const float part = random.Between(0.1f, 1);
                return part * (random.Chance(0.3f) ? 1.0f : scale);
            };
            const float halfHeight = size(), radius = size();
            const auto capsule = Capsule::Create(halfHeight, radius);
            const float x = size(), y = size(), z = size();
            const auto box = Box::Create(Vector3(x, y, z));
            if (!capsule || !box) continue;
            const float reach = capsule.Value()->OuterRadius() + box.Value()->OuterRadius();
            const RelativePose pose{random.InBox(reach * (random.Chance(0.5f) ? 1.0f : 0.1f)),
                                    random.Chance(0.5f) ? random.Rotation() : random.QuarterTurns()};
            ClosestPoints closest;
            ASSERT_TRUE(FindClosestPoints(*capsule.Value(), *box.Value(), pose, FLT_MAX, closest));
            EXPECT_EQ(CheckClosest(*capsule.Value(), *box.Value(), pose, closest), "")
                << "size " << scale << ", case " << i;
        }
    }
}

TEST(QueriesAtExtremes, ATriangleThatIsCastTouchesWhatItHits) {
    RandomPoses random(11);
    int hits = 0;
    for (int i = 0; i < Cases(20000); ++i) {
        const float size = random.Chance(0.5f) ? 1.0f : std::pow(10.0f, random.Between(-5, 5));
        const Vector3 a = random.InBox(size), b = random.InBox(size), c = random.InBox(size);
        const auto triangle = Triangle::Create(a, b, c, random.Chance(0.7f) ? 0 : 0.05f * size);
        if (!triangle) continue;
        const float other = random.Chance(0.5f) ? size : std::pow(10.0f, random.Between(-5, 5));
        Result<std::shared_ptr<const Cylinder>> cylinder = Cylinder::Create(other, other);
        const Result<std::shared_ptr<const Box>> box = Box::Create(Vector3(other, 0.5f * other, 2 * other));
        const Vector3 d = random.InBox(other), e = random.InBox(other), f = random.InBox(other);
        const Result<std::shared_ptr<const Triangle>> second = Triangle::Create(d, e, f);
        std::vector<ShapePtr> shapes;
        if (cylinder) shapes.push_back(cylinder.Value());
        if (box) shapes.push_back(box.Value());
        if (second) shapes.push_back(second.Value());
        for (const ShapePtr& rest : shapes) {
            const float reach = triangle.Value()->OuterRadius() + rest->OuterRadius();
            const BodyShape body{{0, 0}, rest, {Position::Zero(), random.Rotation()}};
            MovingShape moving{triangle.Value().get(),
                               {random.InBox(2 * reach).cast<double>(), random.Rotation()},
                               random.InBox(4 * reach)};
            if (random.Chance(0.3f)) moving.turn = random.InBox(2);
            ShapeHit hit;
            const Pose center{moving.pose.Transform(triangle.Value()->Mass().centerOfMass), moving.pose.rotation};
            const ShapeCaster caster(*triangle.Value(), {center, moving.displacement, moving.turn});
            if (!caster.CastClosest(*rest, body.pose, {}, hit)) continue;
            ++hits;
            EXPECT_EQ(
                CheckShapeHit({body}, moving,
                              {body.id, hit.subShape, hit.fraction, hit.normal, hit.position, hit.depth, hit.isEarly}),
                "")
                << "case " << i << " " << ShapeTypeName(rest->Type()) << " sizes " << size << " " << other
                << (moving.turn.isZero(0) ? " straight" : " turning");
        }
    }
    EXPECT_GT(hits, Cases(2000));
}

// A triangle of 400 km has a rounding of centimeters, within which shapes near it may count as overlapping. Whether
// they do must not follow from how far away shapes are looked for: of two bodies the closest was the one that was found
// first.
TEST(QueriesAtExtremes, TheClosestPointsDoNotDependOnTheReach) {
    RandomPoses random(3);
    const auto small =
        Triangle::Create(Vector3(0.5f, 0, 0), Vector3(0, 0.3f, 0.1f), Vector3(-0.4f, 0.1f, 0.4f)).Value();
    int compared = 0;
    for (int i = 0; i < Cases(4000); ++i) {
        Vector3 vertices[3];
        for (Vector3& vertex : vertices) vertex = random.InBox(4e5f);
        const uint32_t indices[] = {0, 1, 2};
        const auto made = TriangleMesh::Create({.vertices = vertices, .indices = indices, .isTwoSided = true});
        ASSERT_TRUE(made);
        // Near a point of it.
        const float a = random.Between(0, 1), b = random.Between(0, 1 - a);
        const Vector3 on = vertices[0] * a + vertices[1] * b + vertices[2] * (1 - a - b), off = random.InBox(1.5f);
        const RelativePose pose{Vector3(on + off - made.Value()->Mass().centerOfMass), random.Rotation()};
        ClosestPoints all;
        if (!FindClosestPoints(*made.Value(), *small, pose, 10, all)) continue;
        for (const float reach : {0.02f, 0.1f, 0.5f, 1.0f, 3.0f}) {
            if (std::fabs(all.distance - reach) < 0.1f) continue;  // rounding
            ClosestPoints found;
            const bool isFound = FindClosestPoints(*made.Value(), *small, pose, reach, found);
            ASSERT_EQ(isFound, all.distance < reach) << i << ": " << all.distance << " within " << reach;
            if (isFound) {
                ASSERT_EQ(found.distance, all.distance) << i << " within " << reach;
            }
            ++compared;
        }
    }
    EXPECT_GT(compared, Cases(4000));
}

}  // namespace
}  // namespace fulcrum::testing
