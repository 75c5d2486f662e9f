// Light bodies between heavy ones and the ground. Of the approach of a heavy body an iteration stopped only a small
// part: light ones were pressed in by up to half of their inner radius, and what pushed them out again threw the heavy
// one back, at 17 m/s after an impact of 30 m/s without restitution.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace fulcrum::testing {
namespace {

// (substeps, mass of the heavy body over that of the light one, shape of the heavy one)
class HeavyOnLight : public ::testing::TestWithParam<std::tuple<int, float, int>> {
protected:
    int Substeps() const { return std::get<0>(GetParam()); }
    float Ratio() const { return std::get<1>(GetParam()); }
    static ShapePtr ShapeOf(int index, float radius) {
        if (index == 0) return SphereOf(radius);
        return index == 1 ? CubeOf(radius) : CapsuleOf(2 * radius, radius);
    }
    SystemSettings Settings() const {
        SystemSettings settings;
        settings.solver.substeps = Substeps();
        return settings;
    }
};

constexpr float kLight = 0.25f, kHeavy = 0.5f;  // m, inner radii
constexpr float kMass = 100;                    // kg, of a light body
const Quaternion kLying{std::numbers::sqrt2_v<float> / 2, 0, 0, std::numbers::sqrt2_v<float> / 2};

TEST_P(HeavyOnLight, IsStoppedWithoutReboundAndHardlyPenetrates) {
    const int shape = std::get<2>(GetParam());
    for (int light = 0; light < 3; ++light)
        for (const float speed : {2.0f, 13.0f, 30.0f}) {
            TestWorld world(Settings());
            world.AddFloor();
            world.Add({.shape = ShapeOf(light, kLight),
                       .position = {0, kLight, 0},
                       .rotation = light == 2 ? kLying : Quaternion{},
                       .mass = kMass});
            const BodyId heavy = world.Add({.shape = ShapeOf(shape, kHeavy),
                                            .position = {0.1, 2 * kLight + kHeavy + 0.3, 0.03},
                                            .rotation = shape == 2 ? kLying : Quaternion{},
                                            .linearVelocity = {0, -speed, 0},
                                            .mass = Ratio() * kMass});
            float deepest = 0, rebound = 0;
            for (int step = 0; step < 40; ++step) {
                world.Step();
                deepest = std::max(deepest, world.Report().largestPenetration);
                rebound = std::max(rebound, world.VelocityOf(heavy).y());
            }
            EXPECT_LT(deepest, 0.2f * kLight) << "light " << light << ", " << speed << " m/s";
            EXPECT_LT(rebound, 0.3f + 0.08f * speed) << "light " << light << ", " << speed << " m/s";
        }
}

// Through a column of light ones, too.
TEST_P(HeavyOnLight, OnAColumnIsNotThrownBack) {
    const int shape = std::get<2>(GetParam());
    TestWorld world(Settings());
    world.AddFloor();
    for (int i = 0; i < 3; ++i)
        world.Add({.shape = CubeOf(kLight), .position = {0, (2 * i + 1) * double{kLight}, 0}, .mass = kMass});
    const BodyId heavy = world.Add({.shape = ShapeOf(shape, kHeavy),
                                    .position = {0, 6 * kLight + kHeavy + 0.3, 0},
                                    .rotation = shape == 2 ? kLying : Quaternion{},
                                    .linearVelocity = {0, -13, 0},
                                    .mass = Ratio() * kMass});
    float rebound = 0;
    for (int step = 0; step < 40; ++step) {
        world.Step();
        rebound = std::max(rebound, world.VelocityOf(heavy).y());
    }
    EXPECT_LT(rebound, 1.0f);
}

INSTANTIATE_TEST_SUITE_P(Efforts, HeavyOnLight,
                         ::testing::Combine(::testing::Values(4, 16), ::testing::Values(4.0f, 16.0f),
                                            ::testing::Values(0, 1, 2)));

// A plastic impact in space: both go on with the velocity of their center of mass, at any ratio of their masses.
TEST(HeavyOnLight, InSpaceGoOnTogether) {
    for (const float ratio : {4.0f, 100.0f, 10000.0f}) {
        TestWorld world(NoGravity());
        const BodyId light = world.Add({.shape = SphereOf(kLight), .position = {1, 0, 0}, .mass = kMass});
        const BodyId heavy =
            world.Add({.shape = SphereOf(kHeavy), .linearVelocity = {10, 0, 0}, .mass = ratio * kMass});
        world.Steps(10);
        const float together = 10 * ratio / (ratio + 1);
        EXPECT_NEAR(world.VelocityOf(light).x(), together, 1e-2f);
        EXPECT_NEAR(world.VelocityOf(heavy).x(), together, 1e-2f);
    }
}

// 10^4 times the weight, dropped from a centimeter and more: it stays where it is. It walked by up to 40 mm, at steps
// of 1/30 s by 160 mm.
TEST(HeavyOnLight, DroppedFromLowHeightStaysInPlace) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240})
        for (const float ratio : {10.0f, 1000.0f, 10000.0f}) {
            TestWorld world(NoSleep());
            world.AddFloor();
            const BodyId light = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = kMass});
            const BodyId heavy = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.51, 0}, .mass = ratio * kMass});
            world.Run(10, dt);
            for (const BodyId id : {light, heavy}) {
                const Position at = world.PositionOf(id);
                EXPECT_LT(std::hypot(at.x(), at.z()), 0.01) << "ratio " << ratio << ", dt " << dt;
                EXPECT_LT(Length(world.VelocityOf(id)), 1e-3f) << "ratio " << ratio << ", dt " << dt;
            }
        }
}

}  // namespace
}  // namespace fulcrum::testing
