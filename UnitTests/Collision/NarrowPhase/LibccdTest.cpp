// NarrowPhaseMethod::Libccd against the engine's own functions: depths and normals of all pairs of shapes, what libccd
// alone gets wrong, half spaces, queries; and what it allocates.
#include "NarrowPhaseTesting.h"

#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>
#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/CoreCast.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace fulcrum::testing {
namespace {

const std::vector<NamedShape>& Shapes() {
    static const std::vector<NamedShape> shapes = {
        {"ball", MakeSphere(0.5f)},
        {"pebble", MakeSphere(0.01f)},
        {"box", MakeBox(Vector3(0.5f, 0.4f, 0.7f))},
        {"rounded box", MakeBox(Vector3(0.5f, 0.4f, 0.7f), 0.1f)},
        {"floor", MakeBox(Vector3(50, 1, 50))},
        {"stick", MakeBox(Vector3(0.02f, 1, 0.02f))},
        {"plate", MakeBox(Vector3(0.5f, 0.01f, 0.5f))},
        {"capsule", MakeCapsule(0.5f, 0.25f)},
        {"needle", MakeCapsule(1, 0.01f)},
        {"hull", MakeRoundHull(32, 0.6f)},
        {"prism", MakePrism(6, 0.4f, 0.6f)},
        {"triangle",
         Triangle::Create(Vector3(-0.6f, 0, -0.5f), Vector3(0.7f, 0.1f, -0.4f), Vector3(0, 0, 0.8f)).Value()},
        {"field", Triangle::Create(Vector3(-60, 0, -50), Vector3(70, 0, -40), Vector3(0, 0, 80)).Value()},
        {"drop", TaperedCapsule::Create(0.5f, 0.2f, 0.4f).Value()},
        {"cylinder", Cylinder::Create(0.5f, 0.4f).Value()},
        {"puck", Cylinder::Create(0.2f, 0.6f, 0.05f).Value()},
        {"cone", Cylinder::CreateCone(0.5f, 0.4f).Value()},
        {"ellipsoid", MakeEllipsoid(Vector3(0.3f, 0.5f, 0.7f))}};
    return shapes;
}

// Of the smaller one, m.
double SizeOf(const ConvexShape& a, const ConvexShape& b) {
    return std::min(double{a.OuterRadius()}, double{b.OuterRadius()});
}

// From a little apart to concentric, along an axis that both shapes have a feature on, or anywhere.
RelativePose RandomPose(const ConvexShape& a, const ConvexShape& b, int i, RandomPoses& random) {
    RelativePose pose;
    pose.rotation = i % 3 == 0 ? random.QuarterTurns() : random.Rotation();
    Vector3 direction = random.Direction();
    if (i % 4 == 0) {
        direction = Vector3::Zero();
        direction[i / 4 % 3] = i % 8 == 0 ? 1.0f : -1.0f;
    }
    const double touching = -SeparationAlong(a, b, {Vector3::Zero(), pose.rotation}, direction);
    const double size = SizeOf(a, b);
    const double depths[] = {-0.05, -0.005, 1e-6, 1e-3, 0.02, 0.2, 1, 1e3};
    const double depth = depths[i % 8] * size * double{random.Between(0.2f, 1)};
    pose.position = direction * static_cast<float>(std::max(0.0, touching - depth));
    return pose;
}

TEST(Libccd, FindsTheDepthThatTheOwnFunctionsFind) {
    int found = 0, failures = 0, given = 0;
    double worst = 0;  // parts of what is allowed
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            RandomPoses random(3);
            for (int i = 0; i < Cases(400); ++i) {
                const RelativePose pose = RandomPose(*a.shape, *b.shape, i, random);
                CollideSettings settings;
                settings.speculativeDistance = 0.02f;
                const Manifold own = CollideCold(a.shape, b.shape, pose, settings);
                settings.method = NarrowPhaseMethod::Libccd;
                PairCache cache;
                Manifold manifold;
                CollideCounters counters;
                Collide(*a.shape, *b.shape, pose, settings, cache, manifold, counters);
                failures += static_cast<int>(counters.epaFailures);
                given += static_cast<int>(counters.centerLineFallbacks);
                // A face is preferred to an axis that is this much better.
                const double preference = 0.02 * double{settings.speculativeDistance};
                const auto separation = [&](const Manifold& m) {
                    return m.pointCount > 0 ? SeparationAlong(*a.shape, *b.shape, pose, m.normal)
                                            : double{settings.speculativeDistance};
                };
                const double expected = separation(own), is = separation(manifold);
                if (own.pointCount > 0 || manifold.pointCount > 0) ++found;
                const double tolerance = std::max(0.01 * std::abs(expected), 5e-5 * SizeOf(*a.shape, *b.shape)) +
                                         preference + 1e-6 * double{Length(pose.position)};
                worst = std::max(worst, std::abs(is - expected) / tolerance);
                ASSERT_NEAR(is, expected, tolerance) << a.name << " " << b.name << " " << i;
                if (manifold.pointCount == 0) continue;
                ASSERT_NEAR(Length(manifold.normal), 1, 1e-5);
                // Thin shapes have points ahead of those that touch, which may be deeper.
                if (a.shape->InnerRadius() + b.shape->InnerRadius() <= 10 * settings.speculativeDistance) continue;
                ASSERT_NEAR(DeepestSeparation(manifold), is, 2 * preference + 1e-5) << a.name << " " << b.name << i;
            }
        }
    }
    std::printf(
        "  %d contacts, off by at most %.2g of the tolerance; EPA contradicted itself in %d, MPR failed in %d\n", found,
        worst, failures, given);
    EXPECT_GT(found, Cases(45000));
    EXPECT_LT(failures, found / 100);
}

// A box that touches a large floor: libccd's EPA ends at the floor's other side.
TEST(Libccd, ABoxThatTouchesAFloorIsNotPushedThroughIt) {
    RandomPoses random(7);
    const ConvexPtr box = MakeBox(Vector3::Ones()), floor = MakeBox(Vector3(50, 1, 50));
    int otherSide = 0;
    for (int i = 0; i < Cases(20000); ++i) {
        const Vector3 turn = random.InCube() * (i % 3 == 0 ? 0.0f : i % 3 == 1 ? 1e-3f : 1e-5f);
        RelativePose pose{random.InCube() * 48.0f, Normalized(Quaternion{turn.x(), turn.y(), turn.z(), 1})};
        pose.position.y() = 2 + random.Between(-1e-4f, 1e-4f);
        const bool swap = i % 2 == 1;
        const ConvexPtr &a = swap ? box : floor, &b = swap ? floor : box;
        if (swap) pose = Inverse(pose);
        const float own = DeepestSeparation(CollideCold(a, b, pose));
        EXPECT_NEAR(DeepestSeparation(CollideCold(a, b, pose, {.method = NarrowPhaseMethod::Libccd})), own, 1e-5f) << i;
        const LibccdResult raw = LibccdPenetration(*a, *b, pose, 0, LibccdAlgorithm::Epa);
        otherSide += raw.status == LibccdResult::Status::Found && raw.separation < -1;
    }
    EXPECT_GT(otherSide, 0);  // else there is nothing left to guard against
}

// A body in a wall of 100 m: libccd's EPA ends with a normal along which they overlap by tens of meters, and MPR's
// depth is not the least.
TEST(Libccd, ABodyInALargeWallIsPushedOutStraight) {
    RandomPoses random(7);
    const ConvexPtr wall = MakeBox(Vector3(0.2f, 50, 50));
    const ConvexPtr bodies[] = {MakeSphere(0.5f), MakeBox(Vector3(0.25f, 0.5f, 0.5f)),
                                MakeBox(Vector3(0.5f, 0.125f, 0.125f))};
    int nonsense = 0;
    for (int i = 0; i < Cases(30000); ++i) {
        const ConvexPtr& body = bodies[i % 3];
        const float margin = i % 2 == 0 ? 0.06f : 0.27f;
        RelativePose pose{random.InCube() * 45.0f, random.Rotation()};
        pose.position.x() =
            static_cast<float>(-SeparationAlong(*wall, *body, {Vector3::Zero(), pose.rotation}, Vector3(1, 0, 0))) +
            random.Between(-0.3f, 0.9f * margin);
        const CollideSettings own{.speculativeDistance = margin},
            settings{.speculativeDistance = margin, .method = NarrowPhaseMethod::Libccd};
        const Manifold manifold = CollideCold(wall, body, pose, settings);
        ASSERT_GT(manifold.pointCount, 0) << i;
        EXPECT_GT(manifold.normal.x(), 0.9999f) << i;
        EXPECT_NEAR(DeepestSeparation(manifold), DeepestSeparation(CollideCold(wall, body, pose, own)), 1e-5f) << i;
        const LibccdResult raw = LibccdPenetration(*wall, *body, pose, double{margin}, LibccdAlgorithm::Epa);
        nonsense += raw.status == LibccdResult::Status::Found && raw.normal.x() < 0.9;
    }
    if (!kIsSanitized) {
        EXPECT_GT(nonsense, 0);
    }
}

TEST(Libccd, ServesHalfSpaces) {
    RandomPoses random(9);
    int touching = 0;
    for (const NamedShape& s : Shapes()) {
        for (int i = 0; i < Cases(300); ++i) {
            const Vector3 normal = random.Direction();
            const auto plane = Plane::Create(normal, random.Between(-1, 1)).Value();
            RelativePose pose{Vector3::Zero(), random.Rotation()};  // of the plane in the shape
            const Vector3 up = Rotate(pose.rotation, plane->Normal());
            const float reach = Length(s.shape->Support(Vector3(-up))),
                        lowest = -Dot(up, s.shape->Support(Vector3(-up)));
            const float height = lowest + random.Between(-0.5f, 0.05f) * std::min(reach, 1.0f);
            pose.position = up * (-height - plane->Offset());
            Manifold own, manifold;
            PairCache cache;
            CollideCounters counters;
            const CollideSettings settings;
            Collide(*s.shape, *plane, pose, settings, cache, own, counters);
            Collide(*s.shape, *plane, pose, {.method = NarrowPhaseMethod::Libccd}, cache, manifold, counters);
            EXPECT_EQ(counters.centerLineFallbacks, 0u);
            if (own.pointCount == 0 || manifold.pointCount == 0) {
                const float least = std::min(DeepestSeparation(own), DeepestSeparation(manifold));
                EXPECT_GT(least, 0.99f * settings.speculativeDistance) << s.name << " " << i;
                continue;
            }
            ++touching;
            EXPECT_NEAR(Dot(own.normal, manifold.normal), 1, 3e-6) << s.name << " " << i;
            EXPECT_NEAR(DeepestSeparation(own), DeepestSeparation(manifold),
                        1e-3f * std::min(1.0f, s.shape->OuterRadius()) + 1e-6f * s.shape->OuterRadius())
                << s.name << " " << i;
        }
    }
    EXPECT_GT(touching, Cases(3000));
}

TEST(Libccd, MeasuresAsTheOwnFunctionsDo) {
    RandomPoses random(11);
    int apart = 0, overlapping = 0;
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            for (int i = 0; i < Cases(60); ++i) {
                RelativePose pose = RandomPose(*a.shape, *b.shape, i, random);
                if (i % 2 == 0) {
                    const Vector3 direction = random.Direction();
                    pose.position += direction * random.Between(0, 3);
                }
                const float reach = i % 3 == 0 ? 1.0f : std::numeric_limits<float>::infinity();
                const ConvexSeparation own = MeasureConvex(*a.shape, *b.shape, pose, reach),
                                       is = MeasureConvex(*a.shape, *b.shape, pose, reach, NarrowPhaseMethod::Libccd);
                const double size = SizeOf(*a.shape, *b.shape);
                const double rounding = 2e-6 * double{a.shape->OuterRadius() + b.shape->OuterRadius()};
                if (own.isBeyond || is.isBeyond) {
                    EXPECT_TRUE((own.isBeyond || own.separation > 0.999f) && (is.isBeyond || is.separation > 0.999f))
                        << a.name << " " << b.name << " " << i;
                    continue;
                }
                const double tolerance = own.separation > 0 ? rounding : std::max(-0.02 * own.separation, 1e-4 * size);
                // Deep in a round shape the own axis is the best of some eighty, see Queries.md.
                const bool round = !HasPolyhedralCore(a.shape->Type()) || !HasPolyhedralCore(b.shape->Type()) ||
                                   a.shape->ConvexRadius() > 0 || b.shape->ConvexRadius() > 0;
                ASSERT_GE(is.separation, own.separation - tolerance - rounding) << a.name << " " << b.name << i;
                if (own.separation > 0 || !round) {
                    ASSERT_LE(is.separation, own.separation + tolerance + rounding) << a.name << " " << b.name << i;
                }
                ASSERT_NEAR(Dot(is.normal, Vector3(is.onB - is.onA)), is.separation, 2 * rounding + 1e-6);
                (own.separation > 0 ? apart : overlapping)++;
                if (std::abs(own.separation) > 2 * rounding) {
                    EXPECT_EQ(OverlapConvex(*a.shape, *b.shape, pose, NarrowPhaseMethod::Libccd), own.separation < 0)
                        << a.name << " " << b.name << " " << i;
                }
            }
        }
    }
    constexpr int kLeast = kIsSanitized ? 100 : 4000;  // fewer poses a pair are mostly apart
    EXPECT_GT(apart, kLeast);
    EXPECT_GT(overlapping, kLeast);
}

TEST(Libccd, CastsHitWhereTheOwnCastsHit) {
    RandomPoses random(13);
    int hits = 0, early = 0;
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            for (int i = 0; i < Cases(20); ++i) {
                CoreMotion motion;
                const Vector3 direction = random.Direction();
                const float size = a.shape->OuterRadius() + b.shape->OuterRadius();
                motion.position = (direction * (1.2f * size)).cast<double>();
                motion.rotation = random.Rotation();
                motion.displacement = (random.InCube() * 0.3f - direction) * (2 * size);
                if (i % 2 == 1) {
                    const Vector3 axis = random.Direction();
                    motion.turn = axis * random.Between(0.1f, 3);
                }
                const CoreCastLimits limits{1, i % 4 == 0 ? 0.05f : 0.0f, 1e-4f * size};
                const CoreCastResult own = CastCore(*a.shape, *b.shape, motion, limits);
                const CoreCastResult is = CastCore(*a.shape, *b.shape, motion, limits, NarrowPhaseMethod::Libccd);
                if (own.status == CoreCastResult::Status::Early || is.status == CoreCastResult::Status::Early) {
                    ++early;
                    continue;
                }
                // Those that only graze may be a hit for one, by the tolerance.
                const auto gapAt = [&](double fraction) {
                    return MeasureConvex(*a.shape, *b.shape, motion.At(fraction).bInA,
                                         std::numeric_limits<float>::infinity())
                               .separation -
                           limits.separation;
                };
                const float slack = 2.5f * limits.tolerance + 1e-5f * size;
                if (own.IsHit() != is.IsHit()) {
                    EXPECT_LT(gapAt(own.IsHit() ? own.fraction : is.fraction), slack) << a.name << b.name << i;
                    continue;
                }
                if (own.status == CoreCastResult::Status::AtStart || is.status == CoreCastResult::Status::AtStart) {
                    EXPECT_LT(gapAt(0), slack) << a.name << " " << b.name << " " << i;
                    continue;
                }
                if (!own.IsHit()) continue;
                ++hits;
                EXPECT_LT(std::abs(gapAt(is.fraction)), slack) << a.name << " " << b.name << " " << i;
                // Neither misses what the other hits: until then nothing touches.
                const double first = std::min(own.fraction, is.fraction);
                EXPECT_GT(gapAt(0.99 * first), -slack);
                EXPECT_NEAR(Length(is.normal), 1, 1e-5);
                // Of the whole shapes both surfaces pass the point, along the normal.
                const SupportPair pair(*a.shape, *b.shape, motion.At(is.fraction).bInA);
                EXPECT_GT(pair.SeparationAlong(is.normal) - pair.RadiusSum() - limits.separation, -slack)
                    << a.name << " " << b.name << " " << i;
            }
        }
    }
    EXPECT_GT(hits, Cases(2000));
    EXPECT_LT(early, hits / 50 + 1);
}

// GJK allocates nothing; EPA one block for each vertex, edge and facet of its polytope.
TEST(Libccd, AllocatesWherePolytopesGrow) {
    if (!kCountsMalloc) GTEST_SKIP() << "malloc is not counted in this build";
    const CollideSettings settings{.method = NarrowPhaseMethod::Libccd};
    const auto count = [&](const ConvexPtr& a, const ConvexPtr& b, const Vector3& position) {
        const uint64_t before = MallocCount();
        CollideCold(a, b, {position, RotationAbout(Vector3(0.6f, 0.8f, 0), 0.3)}, settings);
        return MallocCount() - before;
    };
    const ConvexPtr box = MakeBox(Vector3::Constant(0.5f)), hull = MakeRoundHull(32, 0.6f),
                    egg = MakeEllipsoid(Vector3(0.3f, 0.5f, 0.7f));
    EXPECT_EQ(count(box, box, Vector3(3, 0, 0)), 0u);
    EXPECT_EQ(count(box, box, Vector3(1.25f, 0.1f, 0.1f)), 0u);  // apart
    const uint64_t boxes = count(box, box, Vector3(1, 0.1f, 0.1f)), hulls = count(hull, hull, Vector3(1, 0.1f, 0.1f)),
                   eggs = count(egg, egg, Vector3(0.5f, 0.1f, 0.1f));
    std::printf("  overlapping boxes: %d blocks, hulls of 32 points: %d, ellipsoids: %d\n", static_cast<int>(boxes),
                static_cast<int>(hulls), static_cast<int>(eggs));
    EXPECT_GT(boxes, 0u);
    EXPECT_LT(boxes, 300u);
    EXPECT_LT(hulls, 1000u);
    EXPECT_LT(eggs, 3000u);
    // The default never asks it.
    const uint64_t before = MallocCount();
    CollideCold(hull, egg, {Vector3(0.5f, 0, 0), Quaternion{}});
    EXPECT_EQ(MallocCount() - before, 0u);
}

std::string ReadSource(const std::string& path) {
    std::ifstream file(std::string(FULCRUM_SOURCE_DIR "/Collision/NarrowPhase/") + path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// A function that no entry of the table names would never be called.
TEST(PairTable, NamesEveryPairFunction) {
    const std::string header = ReadSource("PairFunctions.h"), table = ReadSource("PairTable.cpp");
    const std::regex declaration("void (Collide[A-Za-z]+)\\(const PairQuery&");
    int count = 0;
    for (std::sregex_iterator it(header.begin(), header.end(), declaration), end; it != end; ++it, ++count) {
        const std::string name = (*it)[1];
        const std::string entry = name == "CollideLibccd" ? "\\? " + name + " :" : "<" + name + ">";
        EXPECT_TRUE(std::regex_search(table, std::regex(entry))) << name << " is in no entry of PairTable.cpp";
    }
    EXPECT_GE(count, 8);
}

}  // namespace
}  // namespace fulcrum::testing
