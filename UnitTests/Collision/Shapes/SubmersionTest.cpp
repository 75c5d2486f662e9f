// Volumes below planes, against closed forms and against each other.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Submersion.h>

#include <cmath>
#include <random>

namespace fulcrum::testing {
namespace {

const ConvexShape& AsConvex(const ShapePtr& shape) { return static_cast<const ConvexShape&>(*shape); }

Vector3 DirectionOf(std::mt19937& random) {
    std::normal_distribution<float> normal;
    const float x = normal(random), y = normal(random), z = normal(random);
    return Normalized(Vector3(x, y, z));
}

TEST(Submerged, OfABallIsACap) {
    const ShapePtr ball = SphereOf(2);
    for (const double level : {-1.9, -1.0, 0.0, 0.7, 1.9}) {
        const double h = level + 2;
        const SubmergedPart part = Submerged(AsConvex(ball), {0, 1, 0}, level);
        EXPECT_NEAR(part.volume, kPi * h * h * (6 - h) / 3, 1e-12);
        EXPECT_NEAR(part.center.y(), -3 * (4 - h) * (4 - h) / (4 * (6 - h)), 1e-12);
    }
    EXPECT_EQ(Submerged(AsConvex(ball), {0, 1, 0}, -2).volume, 0);
    EXPECT_NEAR(Submerged(AsConvex(ball), {0, 1, 0}, 3).volume, 32 * kPi / 3, 1e-12);
}

// Below a plane through the middle of a box that leans by `angle` there is half of it, a trapezoid whose middle follows
// from its two parts.
TEST(Submerged, OfALeaningBoxIsATrapezoid) {
    const ShapePtr box = BoxOf(1, 2, 3);
    EXPECT_NEAR(Submerged(AsConvex(box), {0, 1, 0}, 0.5).volume, 2 * 2.5 * 6, 1e-6);
    const double angle = 0.4, slope = std::tan(angle);
    const SubmergedPart part = Submerged(
        AsConvex(box), Vector3(static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0), 0);
    EXPECT_NEAR(part.volume, 24, 1e-5);
    // Column heights h(x) = 2 - x slope over x in -1 .. 1: the middle is at sum(x h) / sum(h), sum(h (h / 2 - 2)) /
    // sum(h).
    EXPECT_NEAR(part.center.x(), -slope / 6, 1e-6);
    EXPECT_NEAR(part.center.y(), (2 + slope * slope / 6) / 2 - 2, 1e-6);
    EXPECT_NEAR(part.center.z(), 0, 1e-6);
}

TEST(Submerged, OfALyingCylinderIsASegmentTimesItsLength) {
    const ShapePtr cylinder = Cylinder::Create(1.5f, 0.5f).Value();
    for (const double level : {-0.4, -0.1, 0.0, 0.3, 0.45}) {
        const double r = 0.5, root = std::sqrt(r * r - level * level);
        const double area = r * r * std::acos(-level / r) + level * root;
        const SubmergedPart part = Submerged(AsConvex(cylinder), {0, 0, 1}, level);
        EXPECT_NEAR(part.volume, 3 * area, 1e-9);
        EXPECT_NEAR(part.center.z(), -2.0 / 3 * root * root * root / area, 1e-9);
        // Standing it is a disc times the depth.
        const SubmergedPart standing = Submerged(AsConvex(cylinder), {0, 1, 0}, level);
        EXPECT_NEAR(standing.volume, kPi * r * r * (level + 1.5), 1e-6);
        EXPECT_NEAR(standing.center.y(), (level - 1.5) / 2, 1e-6);
    }
    // Leaning by 45 degrees, the plane through its middle halves it.
    const float half = std::sqrt(0.5f);
    EXPECT_NEAR(Submerged(AsConvex(cylinder), {half, half, 0}, 0).volume, kPi * 0.25 * 1.5, 1e-6);
}

// A cone upside down, to the depth d below its rim: similar to the whole.
TEST(Submerged, OfAConeOnItsTipIsASmallerCone) {
    const ShapePtr cone = Cylinder::CreateCone(1, 1).Value();  // the tip 1.5 above the center of mass
    const double depth = 0.8;
    const SubmergedPart part = Submerged(AsConvex(cone), {0, -1, 0}, -1.5 + depth);
    const double radius = depth / 2;
    EXPECT_NEAR(part.volume, kPi * radius * radius * depth / 3, 1e-6);
    EXPECT_NEAR(part.center.y(), 1.5 - 0.75 * depth, 1e-6);
}

// An ellipsoid, of which the ball's cap is an affine image: the fallback of custom shapes is exact for it.
class Ellipsoid final : public CustomConvex {
public:
    Vector3 FarthestPoint(const Vector3& d) const override {
        const Vector3 half(1, 2, 0.5f);
        const Vector3 scaled = d.cwiseProduct(half);
        return scaled.cwiseProduct(half) * (1 / std::sqrt(LengthSquared(scaled)));
    }
};

TEST(Submerged, OfAnEllipsoidIsThatOfTheBallThatItIsMadeFrom) {
    const ShapePtr ellipsoid = CreateCustom<Ellipsoid>().Value();
    const SubmergedPart part = Submerged(AsConvex(ellipsoid), {0, 1, 0}, -1);  // a quarter of its height
    const double ball = kPi * 0.25 * (3 - 0.5) / 3;
    EXPECT_NEAR(part.volume, ball * 1 * 2 * 0.5, 1e-4);
    EXPECT_NEAR(part.center.y(), -2 * 3 * 2.25 / (4 * 2.5), 1e-4);
}

// Whatever the shape and the plane: what is below and what is above make the whole, and their middles its center.
TEST(Submerged, BothSidesMakeTheWhole) {
    const std::vector<ShapePtr> shapes = {
        SphereOf(0.7f),
        BoxOf(0.3f, 1, 2),
        HullOf({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {1, 1, 1}, {-1, 0.5f, 0}}),
        CapsuleOf(1, 0.4f),
        Cylinder::Create(0.8f, 0.3f).Value(),
        Cylinder::CreateTapered(0.8f, 0.3f, 0.9f).Value(),
        Cylinder::CreateCone(1, 0.5f).Value(),
        TaperedCapsule::Create(1, 0.3f, 0.8f).Value()};
    std::mt19937 random(7);
    for (size_t k = 0; k < shapes.size(); ++k) {
        const ConvexShape& shape = AsConvex(shapes[k]);
        for (int i = 0; i < 200; ++i) {
            const Vector3 up = DirectionOf(random);
            const double level = std::uniform_real_distribution<double>(-1, 1)(random) * double{shape.OuterRadius()};
            const SubmergedPart below = Submerged(shape, up, level), above = Submerged(shape, Vector3(-up), -level);
            const double whole = shape.Mass().volume;
            EXPECT_NEAR(below.volume + above.volume, whole, 2e-5 * whole) << k << ", " << i;
            const Position moment = below.center * below.volume + above.center * above.volume;
            EXPECT_LT(moment.norm(), 2e-5 * whole * double{shape.OuterRadius()}) << k << ", " << i;
            const double height = Dot<double>(below.center, up.cast<double>());
            EXPECT_TRUE(below.volume == 0 || height <= level + 1e-6) << k << ", " << i;
        }
    }
}

TEST(ShadowArea, OfBallsBoxesCapsulesAndCylinders) {
    const Vector3 across(1, 0, 0), along(0, 1, 0), slanted = Normalized(Vector3(1, 1, 0));
    EXPECT_NEAR(ShadowArea(AsConvex(SphereOf(2)), slanted), 4 * kPi, 1e-5);
    EXPECT_NEAR(ShadowArea(AsConvex(BoxOf(1, 2, 3)), across), 24, 1e-4);
    EXPECT_NEAR(ShadowArea(AsConvex(BoxOf(1, 2, 3)), slanted), (24 + 12) * std::sqrt(0.5), 1e-4);
    EXPECT_NEAR(ShadowArea(AsConvex(CapsuleOf(1, 0.5f)), along), kPi * 0.25, 1e-5);
    EXPECT_NEAR(ShadowArea(AsConvex(CapsuleOf(1, 0.5f)), across), kPi * 0.25 + 2, 1e-5);
    const ShapePtr cylinder = Cylinder::Create(1, 0.5f).Value();
    EXPECT_NEAR(ShadowArea(AsConvex(cylinder), along), kPi * 0.25, 1e-5);
    EXPECT_NEAR(ShadowArea(AsConvex(cylinder), across), 2, 1e-5);
}

}  // namespace
}  // namespace fulcrum::testing
