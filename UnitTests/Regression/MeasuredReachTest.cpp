// What is measured between two shapes does not depend on how far the search reaches: the closest body would depend on
// the order in which the trees find bodies, and a restored world, whose trees are built anew, would answer differently.
// With the method Libccd shapes are rounded, and the rounding followed the reach: depths differed in the last digit.
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace fulcrum::testing {
namespace {

void ExpectSame(const ClosestPoints& a, const ClosestPoints& b) {
    EXPECT_EQ(a.distance, b.distance);
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.onA, b.onA);
    EXPECT_EQ(a.onB, b.onB);
}

void ExpectSameWithAnyReach(NarrowPhaseMethod method) {
    const ShapePtr shapes[] = {
        Triangle::Create(Vector3(-0.6f, 0, -0.5f), Vector3(0.7f, 0.1f, -0.4f), Vector3(0, 0, 0.8f)).Value(),
        Triangle::Create(Vector3(-0.2f, 0.1f, 0), Vector3(0.2f, 0, 0.1f), Vector3(0, -0.1f, -0.1f)).Value(),
        BoxOf(0.5f, 0.3f, 0.4f), CapsuleOf(0.4f, 0.2f), SphereOf(0.3f)};
    RandomPoses random(1);
    int apart = 0, overlapping = 0;
    for (int i = 0; i < Cases(2000); ++i) {
        const Shape &a = *shapes[random.Below(5)], &b = *shapes[random.Below(5)];
        const Vector3 position = random.InBox(0.8f);
        const RelativePose pose{position, random.Rotation()};
        ClosestPoints first;
        ASSERT_TRUE(FindClosestPoints(a, b, pose, std::numeric_limits<float>::infinity(), first, method));
        (first.distance > 0 ? apart : overlapping)++;
        const float least = std::max(first.distance, 0.0f) + RoundingOfDistances(1);
        for (const float reach : {least, 1.1f * least, 1.5f, 4.0f}) {
            ClosestPoints again;
            ASSERT_TRUE(FindClosestPoints(a, b, pose, std::max(reach, least), again, method)) << i;
            ExpectSame(first, again);
        }
    }
    EXPECT_GT(std::min(apart, overlapping), Cases(2000) / 4);
}

TEST(MeasuredReach, DoesNotChangeDistances) { ExpectSameWithAnyReach(NarrowPhaseMethod::Automatic); }

TEST(MeasuredReach, DoesNotChangeDistancesByLibccd) {
    if (!HasLibccd()) GTEST_SKIP() << "built without libccd";
    ExpectSameWithAnyReach(NarrowPhaseMethod::Libccd);
}

}  // namespace
}  // namespace fulcrum::testing
