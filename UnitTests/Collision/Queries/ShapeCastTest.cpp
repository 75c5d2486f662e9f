// Shape casts. Nothing overlaps before the time of the hit and the shapes touch at it, both checked by distances.
#include "QueryTesting.h"

#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/CoreCast.h>
#include <Fulcrum/Collision/Queries/CoreShapes.h>
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// Of the other shape, which is at the origin.
RelativePose OtherAt(const ShapeMotion& motion, double fraction) {
    return {Vector3::Zero(), RotationFromVector(Vector3(motion.turnOfOther * static_cast<float>(fraction)))};
}

// In the frame of the other.
RelativePose PoseAt(const ShapeMotion& motion, double fraction) {
    const Vector3 turn = motion.turn * static_cast<float>(fraction);
    const RelativePose pose{(motion.pose.position + motion.displacement.cast<double>() * fraction).cast<float>(),
                            Normalized(RotationFromVector(turn) * motion.pose.rotation)};
    return motion.turnOfOther.isZero(0) ? pose : Inverse(OtherAt(motion, fraction)) * pose;
}

enum class Turning { None, OfTheCast, OfBoth };

ShapeMotion MotionNear(RandomPoses& random, Turning turning) {
    const Vector3 target = random.InCube(), direction = random.Direction();
    const Vector3 from = direction * random.Between(1.0f, 4);
    ShapeMotion motion;
    motion.pose = {from.cast<double>(), random.Rotation()};
    motion.displacement = (target - from) * random.Between(0.5f, 2);
    if (turning != Turning::None) motion.turn = random.InCube() * 4;
    if (turning == Turning::OfBoth) motion.turnOfOther = random.InCube() * 4;
    return motion;
}

void ExpectFirstTouch(const std::vector<NamedShape>& shapes, Turning turning, int casesPerPair, double touch) {
    RandomPoses random(turning == Turning::None ? 11 : 12);
    int hits = 0, early = 0, cases = 0;
    for (const NamedShape& a : shapes) {
        for (const NamedShape& b : shapes) {
            for (int i = 0; i < casesPerPair; ++i, ++cases) {
                const ShapeMotion motion = MotionNear(random, turning);
                const ShapeCaster caster(*b.shape, motion);
                ShapeHit hit;
                const bool found = caster.CastClosest(*a.shape, {}, {}, hit);
                const double end = found ? double{hit.fraction} : 1;
                const auto separation = [&](double fraction) {
                    return double{MeasureConvex(*a.shape, *b.shape, PoseAt(motion, fraction), 1e6f).separation};
                };
                // Missed or late: some time before it they would overlap.
                for (int k = 0; k < 12; ++k) {
                    const double s = separation(end * (k + 0.5) / 12);
                    if (!found || hit.fraction > 0) {
                        EXPECT_GT(s, -touch) << a.name << " " << b.name << " " << i << " " << k;
                    }
                }
                if (!found) continue;
                ++hits;
                if (hit.isEarly) {
                    ++early;
                    continue;
                }
                const double s = separation(end);
                if (hit.fraction == 0) {
                    EXPECT_NEAR(std::max(0.0, -s), double{hit.depth}, 1e-4);
                    continue;
                }
                // In some five of a million poses the distance itself is off by 2e-5, more than the point below.
                EXPECT_LT(s, touch + 2e-5) << a.name << " " << b.name << " " << i;
                EXPECT_NEAR(Length(hit.normal), 1, 1e-5f);
                // The normal is of a plane between the two; the point lies on both.
                const RelativePose other = OtherAt(motion, end);
                const Vector3 normal = InverseRotate(other.rotation, hit.normal);
                EXPECT_GT(SeparationAlong(*a.shape, *b.shape, PoseAt(motion, end), normal), -2 * touch)
                    << a.name << " " << b.name << " " << i;
                const Vector3 point = other.InverseTransform(hit.position.cast<float>());
                EXPECT_NEAR(MeasureConvex(*a.shape, PointCore(), {point, {}}, 1e6f).separation, 0, touch);
                EXPECT_NEAR(
                    MeasureConvex(*b.shape, PointCore(), {PoseAt(motion, end).InverseTransform(point), {}}, 1e6f)
                        .separation,
                    0, 2 * touch)
                    << a.name << " " << b.name << " " << i;
            }
        }
    }
    EXPECT_GT(hits, cases / 4);
    EXPECT_LE(early, cases / 1000 + 1);
    std::printf("  %d cases, %d hits, %d early\n", cases, hits, early);
}

// Poses and cores of 3 m in float: 3e-7 m a rounding, and the fraction's own of 6e-8 along up to 10 m. Of a million
// cases the point is off by 3.5e-6 at most.
TEST(ShapeCast, MovesUpToTheFirstTouch) { ExpectFirstTouch(QueryShapes(), Turning::None, Cases(2100), 5e-6); }

// The search ends within 2e-5 of the smaller and 4e-6 of the larger shape's size, 3 m here.
TEST(ShapeCast, TurnsUpToTheFirstTouch) { ExpectFirstTouch(QueryShapes(), Turning::OfTheCast, Cases(2100), 8e-5); }
TEST(ShapeCast, TurnsUpToTheFirstTouchOfWhatTurns) {
    ExpectFirstTouch(QueryShapes(), Turning::OfBoth, Cases(2100), 8e-5);
}

// Far ends that are fast and touch nothing must not use up the iterations.
TEST(ShapeCast, TurnsUpToTheFirstTouchOfShapesOfAnySizes) {
    int cases = 0, hits = 0, early = 0;
    for (uint32_t seed = 0; seed < static_cast<uint32_t>(Cases(4000)); ++seed) {
        RandomPoses random(seed);
        const float large = std::pow(10.0f, random.Between(0, 4)),
                    thin = large * std::pow(10.0f, random.Between(-3, 0));
        const float small = random.Between(0.1f, 2);
        const ConvexPtr pairs[3][2] = {
            {MakeBox(Vector3(large, thin, 0.7f * large)), MakeBox(Vector3(small, 0.3f, 0.1f))},
            {MakeBox(Vector3(thin, large, thin)), MakeBox(Vector3(small, 0.2f, 0.2f))},
            {MakeBox(Vector3(small, 0.1f, small)), MakeBox(Vector3(large, thin, 0.3f * large))}};
        const ConvexPtr &a = pairs[seed % 3][0], &b = pairs[seed % 3][1];
        const Vector3 at = random.InBox(1.5f * (seed % 5 == 0 ? large : thin) + 4);
        ShapeMotion motion{{at.cast<double>(), random.Rotation()}};
        motion.displacement = random.InBox(std::pow(10.0f, random.Between(-2, 2)));
        motion.turn = random.InBox(std::pow(10.0f, random.Between(-3, 1)));
        if (seed % 2 == 1) motion.turnOfOther = random.InBox(std::pow(10.0f, random.Between(-3, 1)));
        ShapeHit hit;
        const bool found = ShapeCaster(*b, motion).CastClosest(*a, {}, {.measureDepth = false}, hit);
        if (found && hit.fraction == 0) continue;
        ++cases;
        hits += found;
        early += found && hit.isEarly;
        // Between poses of 1e4 m in float distances are off by some 1e-3 m, but none was below 0.
        const double end = found ? double{hit.fraction} : 1, rounding = 1e-6 * double{large + small};
        for (int k = 0; k < 40; ++k) {
            const double fraction = end * (k < 20 ? k / 20.0 : 1 - std::pow(0.7, k - 19));
            EXPECT_GT(MeasureConvex(*a, *b, PoseAt(motion, fraction), 1e6f).separation, -rounding)
                << "seed " << seed << " at " << fraction << " of " << end;
        }
    }
    EXPECT_GT(hits, cases / 20);
    EXPECT_LE(early, cases / 200 + 1);
    std::printf("  %d cases, %d hits, %d early\n", cases, hits, early);
}

TEST(ShapeCast, CurvedShapesTouchToo) {
    const std::vector<NamedShape> shapes = {
        {"ellipsoid", std::make_shared<RoundedEllipsoid>(Vector3(0.3f, 0.6f, 0.9f))},
        {"disc", std::make_shared<RoundedEllipsoid>(Vector3(0.5f, 0.01f, 0.5f))},
        {"soft", std::make_shared<RoundedEllipsoid>(Vector3(0.2f, 0.3f, 0.1f), 0.2f)}};
    ExpectFirstTouch(shapes, Turning::None, 1000, 8e-5);
    ExpectFirstTouch(shapes, Turning::OfTheCast, 300, 8e-5);
    ExpectFirstTouch(shapes, Turning::OfBoth, 300, 8e-5);
}

TEST(ShapeCast, FastShapesDoNotPassThinWalls) {
    RandomPoses random(13);
    const ConvexPtr wall = MakeBox(Vector3(2, 2, 0.005f));
    const auto sheet = std::make_shared<TriangleList>(
        std::vector<std::array<Vector3, 3>>{{Vector3(-3, -3, 0), Vector3(3, -3, 0), Vector3(0, 5, 0)}});
    for (const NamedShape& b : QueryShapes()) {
        for (int i = 0; i < 1500; ++i) {
            ShapeMotion motion;
            const Vector3 through{random.Between(-1, 1), random.Between(-1, 1), 0};
            const Vector3 direction = Normalized(Vector3{random.Between(-1, 1), random.Between(-1, 1), -1.5f});
            // 1000 m/s for a 60th of a second.
            motion.displacement = direction * 16.7f;
            motion.pose = {(through - direction * random.Between(5, 12)).cast<double>(), random.Rotation()};
            if (i % 2 == 1) motion.turn = random.InCube() * 5;
            ShapeHit hit;
            EXPECT_TRUE(ShapeCaster(*b.shape, motion).CastClosest(*wall, {}, {}, hit)) << b.name << i;
            EXPECT_TRUE(ShapeCaster(*b.shape, motion).CastClosest(*sheet, {}, {}, hit)) << b.name << i;
            motion.pose.position.z() -= 30;
            EXPECT_FALSE(ShapeCaster(*b.shape, motion).CastClosest(*wall, {}, {}, hit)) << b.name << i;
        }
    }
}

TEST(ShapeCast, SpheresMeetWhenTheirCentersAreThatFarApart) {
    RandomPoses random(14);
    const ConvexPtr a = MakeSphere(0.7f), b = MakeSphere(0.3f);
    for (int i = 0; i < 20000; ++i) {
        const ShapeMotion motion = MotionNear(random, Turning::None);
        const Position p = motion.pose.position, d = motion.displacement.cast<double>();
        const double dd = d.squaredNorm(), pd = p.dot(d), c = p.squaredNorm() - 1, root = pd * pd - dd * c;
        const double expected = (-pd - std::sqrt(std::max(root, 0.0))) / dd;
        ShapeHit hit;
        const bool found = ShapeCaster(*b, motion).CastClosest(*a, {}, {}, hit);
        if (std::abs(root) < 1e-5 * dd || std::abs(c) < 1e-5 || std::abs(expected - 1) < 1e-5) continue;
        ASSERT_EQ(found, c < 0 || (root > 0 && expected > 0 && expected < 1)) << i;
        // The radii are floats: 0.7f + 0.3f is 1 to 3e-8; the tolerance in space is 1e-6, along the way larger by the
        // slope.
        if (found && c > 0) {
            EXPECT_NEAR(hit.fraction, expected, 2e-6 * dd / std::sqrt(root) / std::sqrt(dd) + 1e-6) << i;
        }
    }
}

TEST(ShapeCast, CompoundsAndSurfacesAreHitWhereTheirPartsAre) {
    RandomPoses random(15);
    const auto compound = MakeCompound(random, 25, 3);
    const auto terrain = MakeTerrain(10, 0.6f, [](float x, float z) { return 0.3f * std::sin(3 * x) + 0.2f * z; });
    int hits = 0;
    const std::vector<NamedShape> shapes = QueryShapes();
    for (int i = 0; i < 3000; ++i) {
        ShapeMotion motion = MotionNear(random, i % 3 == 0 ? Turning::OfTheCast : Turning::None);
        motion.pose.position *= 1.5;
        const ConvexShape& b = *shapes[static_cast<size_t>(i) % shapes.size()].shape;
        const ShapeCaster caster(b, motion);
        const Pose pose{Position(0.3, -0.2, 0.1), random.Rotation()};
        const auto best = [&](const Shape& shape, size_t pieces, const auto& pieceHit) {
            ShapeHit closest, hit;
            bool any = false;
            for (size_t k = 0; k < pieces; ++k) {
                ShapeHit here;
                if (pieceHit(k, here) && (!any || here.fraction < closest.fraction)) any = true, closest = here;
            }
            ASSERT_EQ(caster.CastClosest(shape, pose, {}, hit), any) << i;
            if (!any) return;
            ++hits;
            EXPECT_NEAR(hit.fraction, closest.fraction, 1e-5f) << i;
        };
        best(*compound, compound->Children().size(), [&](size_t k, ShapeHit& hit) {
            return caster.CastClosest(*compound->Children()[k].shape, pose * compound->Children()[k].pose, {}, hit);
        });
        int all = 0;
        uint32_t last = ~0u;
        bool isTwice = false;
        caster.CastAll(*terrain, pose, {}, [&](const ShapeHit& hit) {
            isTwice |= hit.subShape.triangle == last;
            last = hit.subShape.triangle;
            return ++all, true;
        });
        EXPECT_FALSE(isTwice);
        int expected = 0;
        best(*terrain, terrain->TriangleCount(), [&](size_t k, ShapeHit& hit) {
            const TriangleView view = terrain->GetTriangle(static_cast<uint32_t>(k));
            const TriangleList one({{view.vertices[0], view.vertices[1], view.vertices[2]}});
            const bool found = caster.CastClosest(one, pose, {}, hit);
            expected += found;
            return found;
        });
        EXPECT_EQ(all, expected) << i;
    }
    EXPECT_GT(hits, 1000);
}

TEST(ShapeCast, DegenerateMotions) {
    const ConvexPtr a = MakeBox(Vector3(1, 1, 1)), b = MakeSphere(0.5f);
    ShapeHit hit;
    ShapeMotion still;
    still.pose.position = Position(0, 1.25, 0);
    ASSERT_TRUE(ShapeCaster(*b, still).CastClosest(*a, {}, {}, hit));
    EXPECT_EQ(hit.fraction, 0);
    EXPECT_NEAR(hit.depth, 0.25f, 1e-5f);
    EXPECT_NEAR(hit.normal.y(), 1, 1e-5f);
    EXPECT_NEAR(hit.position.y(), 1, 1e-5f);
    still.pose.position = Position(0, 2, 0);
    EXPECT_FALSE(ShapeCaster(*b, still).CastClosest(*a, {}, {}, hit));
    still.displacement.x() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(ShapeCaster(*b, still).CastClosest(*a, {}, {}, hit));
}

// Against a box so large that its top is the plane, and by the lowest point at the time found.
TEST(ShapeCast, MeetsAPlaneAsItMeetsALargeBox) {
    RandomPoses random(16);
    const ConvexPtr ground = MakeBox(Vector3(50, 1, 50));
    for (const NamedShape& b : QueryShapes()) {
        for (int i = 0; i < 400; ++i) {
            ShapeMotion motion = MotionNear(random, i % 2 == 0 ? Turning::OfTheCast : Turning::None);
            motion.pose.position.y() = random.Between(1, 6);
            ShapeHit onBox;
            const bool found = ShapeCaster(*b.shape, motion).CastClosest(*ground, {}, {}, onBox);
            const CoreMotion core{motion.pose.position, motion.pose.rotation, motion.displacement, motion.turn};
            const CoreCastResult onPlane = CastToPlane(Vector3(0, 1, 0), 1, *b.shape, core, {});
            const auto height = [&](double fraction) {
                const RelativePose pose = PoseAt(motion, fraction);
                const Vector3 down = InverseRotate(pose.rotation, Vector3(0, -1, 0));
                return pose.Transform(b.shape->Support(down)).y() - 1;
            };
            if (!found || !onPlane.IsHit()) {
                EXPECT_EQ(found, onPlane.IsHit()) << b.name << i << " " << height(1);
                continue;
            }
            EXPECT_EQ(onPlane.status == CoreCastResult::Status::AtStart, height(0) <= 1e-5f) << b.name << i;
            // Of the box's 50 m, 1e-5 for those that turn, and early rather than late.
            if (onPlane.status == CoreCastResult::Status::Hit) {
                EXPECT_NEAR(height(onPlane.fraction), 0, 1e-5f) << b.name << i;
                EXPECT_GT(height(double{onBox.fraction}), -2e-5f) << b.name << i;
                EXPECT_LT(height(double{onBox.fraction}), 5e-4f) << b.name << i;
            }
        }
    }
}

TEST(ShapeCast, KeepsADistance) {
    const ConvexPtr a = MakeBox(Vector3(1, 1, 1)), b = MakeSphere(0.5f);
    ShapeMotion motion;
    motion.pose.position = Position(0, 4, 0);
    motion.displacement = Vector3(0, -4, 0);
    ShapeHit hit;
    ASSERT_TRUE(ShapeCaster(*b, motion).CastClosest(*a, {}, {.separation = 0.5f}, hit));
    EXPECT_NEAR(hit.fraction, 0.5f, 1e-6f);
}

}  // namespace
}  // namespace fulcrum::testing
