// GJK through support functions: what it finds proves itself. The points it names lie in the cores, so that no distance
// is smaller than what the axis separates them by, and none larger than what lies between the points.
#include "NarrowPhaseTesting.h"

#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>

#include <gtest/gtest.h>

namespace fulcrum::testing {
namespace {

std::vector<NamedShape> Shapes() {
    return {{"sphere", MakeSphere(0.5f)},
            {"box", MakeBox(Vector3(0.5f, 0.4f, 0.7f))},
            {"capsule", MakeCapsule(0.5f, 0.25f)},
            {"hull", MakeRoundHull(32, 0.6f)},
            {"plank", MakeBox(Vector3(5, 0.05f, 0.5f), 0.02f)},
            {"ellipsoid", MakeEllipsoid(Vector3(0.3f, 0.6f, 0.9f))},
            {"disc", MakeEllipsoid(Vector3(0.5f, 0.01f, 0.5f))},
            {"cylinder", Cylinder::Create(0.5f, 0.3f).Value()},
            {"cone", Cylinder::CreateCone(0.5f, 0.3f, 0.02f).Value()},
            {"drop", TaperedCapsule::Create(0.5f, 0.1f, 0.4f).Value()},
            {"triangle", Triangle::Create(Vector3(0, 0, 0), Vector3(1, 0, 0.2f), Vector3(0.3f, 0.5f, 0)).Value()}};
}

double CoreSeparation(const ConvexShape& a, const ConvexShape& b, const RelativePose& pose, const Vector3& axis) {
    return SeparationAlong(a, b, pose, axis) + double{a.ConvexRadius()} + double{b.ConvexRadius()};
}

TEST(ConvexGjk, ItsAxisSeparatesAsFarAsItsPointsAreApart) {
    RandomPoses random(31);
    int apart = 0, overlapping = 0;
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            double worst = 0;
            for (int i = 0; i < 1000; ++i) {
                RelativePose pose{Vector3::Zero(), random.Rotation()};
                const Vector3 direction = random.Direction();
                const float reach = static_cast<float>(-CoreSeparation(*a.shape, *b.shape, pose, direction));
                pose.position = direction * (reach + random.Between(-0.2f, 0.3f));
                const SupportPair pair(*a.shape, *b.shape, pose);
                const ConvexGjkResult result = ConvexGjk(pair, random.Direction(), 1000);
                ASSERT_NE(result.status, ConvexGjkResult::Status::BeyondReach);
                if (result.status == ConvexGjkResult::Status::Overlapping) {
                    ++overlapping;
                    continue;
                }
                ++apart;
                EXPECT_NEAR(Length(result.axis), 1, 1e-6);
                const double along = CoreSeparation(*a.shape, *b.shape, pose, result.axis);
                const double between = double{Length(Vector3(result.onB - result.onA))};
                worst = std::max(worst, between - along);
                // The points belong to the cores: no direction has them outside.
                for (int k = 0; k < 10; ++k) {
                    const Vector3 n = random.Direction();
                    EXPECT_LE(Dot(n, result.onA), Dot(n, a.shape->SupportCore(n)) + 1e-5f);
                    const Vector3 inB = pose.InverseTransform(result.onB);
                    EXPECT_LE(Dot(n, inB), Dot(n, b.shape->SupportCore(n)) + 1e-5f);
                }
            }
            // Coordinates of up to 5 m in float have errors of 3e-7 m each; a few of them add up. The descent stops
            // where a step gains less than that, and a curved core's next step could gain as much again a few times.
            EXPECT_LE(worst, 1e-5) << a.name << " " << b.name;
        }
    }
    EXPECT_GT(apart, 10000);
    EXPECT_GT(overlapping, 1000);
}

TEST(ConvexGjk, DistinguishesOverlapFromDistance) {
    RandomPoses random(7);
    const ConvexPtr a = MakeEllipsoid(Vector3(0.3f, 0.6f, 0.9f)), b = MakeSphere(1);
    for (int i = 0; i < 2000; ++i) {
        // A sphere's core is a point: inside the ellipsoid or not in closed form.
        const Vector3 unit = random.Direction();
        const float scale = random.Between(0, 2);
        if (std::abs(scale - 1) < 1e-4f) continue;
        const RelativePose pose{Vector3(unit.cwiseProduct(Vector3(0.3f, 0.6f, 0.9f)) * scale), random.Rotation()};
        const ConvexGjkResult result = ConvexGjk(SupportPair(*a, *b, pose), random.Direction(), 1000);
        EXPECT_EQ(result.status == ConvexGjkResult::Status::Overlapping, scale < 1) << i << " " << scale;
    }
}

TEST(ConvexGjk, EndsEarlyBeyondTheReach) {
    const ConvexPtr a = MakeSphere(0.5f), b = MakeBox(Vector3(1, 1, 1));
    const RelativePose pose{Vector3(0, 5, 0), {}};
    const ConvexGjkResult result = ConvexGjk(SupportPair(*a, *b, pose), Vector3(0, 1, 0), 1);
    EXPECT_EQ(result.status, ConvexGjkResult::Status::BeyondReach);
    EXPECT_EQ(result.separation, 4);
    EXPECT_EQ(result.axis, Vector3(0, 1, 0));
}

}  // namespace
}  // namespace fulcrum::testing
