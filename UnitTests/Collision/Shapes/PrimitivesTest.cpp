#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>

#include <Fulcrum/UnitTests/Collision/Shapes/PointSets.h>

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

template <class T>
ErrorCode CodeOf(const Result<T>& result) {
    EXPECT_FALSE(result);
    if (result) return ErrorCode::UnknownId;
    EXPECT_FALSE(result.GetError().message.empty());
    return result.GetError().code;
}

TEST(Shapes, HaveNames) {
    EXPECT_STREQ(ShapeTypeName(ShapeType::Sphere), "sphere");
    EXPECT_STREQ(ShapeTypeName(ShapeType::Compound), "compound");
}

TEST(Primitives, RefuseBadSizes) {
    EXPECT_EQ(CodeOf(Sphere::Create(0)), ErrorCode::NonPositive);
    EXPECT_EQ(CodeOf(Sphere::Create(-1)), ErrorCode::NonPositive);
    EXPECT_EQ(CodeOf(Sphere::Create(kNaN)), ErrorCode::NonFinite);
    EXPECT_EQ(CodeOf(Sphere::Create(kInfinity)), ErrorCode::NonFinite);
    EXPECT_EQ(CodeOf(Box::Create(Vector3(1, 0, 1))), ErrorCode::NonPositive);
    EXPECT_EQ(CodeOf(Box::Create(Vector3(1, 1, kNaN))), ErrorCode::NonFinite);
    EXPECT_EQ(CodeOf(Box::Create(Vector3(1, 1, 1), kNaN)), ErrorCode::NonFinite);
    EXPECT_EQ(CodeOf(Box::Create(Vector3(1, 1, 1), -0.1f)), ErrorCode::OutOfRange);
    EXPECT_EQ(CodeOf(Box::Create(Vector3(1, 0.5f, 1), 0.6f)), ErrorCode::OutOfRange);
    EXPECT_EQ(CodeOf(Capsule::Create(0, 1)), ErrorCode::NonPositive);
    EXPECT_EQ(CodeOf(Capsule::Create(1, kInfinity)), ErrorCode::NonFinite);
    EXPECT_NE(Box::Create(Vector3(1, -2, 1)).GetError().message.find("half extent y is -2"), std::string::npos);
}

TEST(Primitives, RefuseSizesWhoseInertiaIsNoNormalFloat) {
    EXPECT_EQ(CodeOf(Sphere::Create(1e-9f)), ErrorCode::OutOfRange);
    EXPECT_EQ(CodeOf(Sphere::Create(1e9f)), ErrorCode::OutOfRange);
    EXPECT_TRUE(Sphere::Create(1e-6f));
    EXPECT_TRUE(Box::Create(Vector3(1e6f, 1, 1e6f)));
}

TEST(Primitives, SupportsLieOnTheSurfaceFarthestAlong) {
    const auto sphere = Sphere::Create(2).Value();
    EXPECT_LT(Length(sphere->Support(Vector3(0, 3, 4)) - Vector3(0, 1.2f, 1.6f)), 1e-6f);
    const auto box = Box::Create(Vector3(1, 2, 3)).Value();
    EXPECT_EQ(box->Support(Vector3(1, -1, 5)), Vector3(1, -2, 3));
    const auto capsule = Capsule::Create(1, 0.5f).Value();
    EXPECT_EQ(capsule->Support(Vector3(0, -7, 0)), Vector3(0, -1.5f, 0));
    EXPECT_LT(Length(capsule->Support(Vector3(2, 0, 0)) - Vector3(0.5f, 1, 0)), 1e-6f);
}

TEST(Primitives, RoundedBoxStaysWithinItsExtents) {
    const auto box = Box::Create(Vector3(1, 2, 3), 0.25f).Value();
    EXPECT_EQ(box->ConvexRadius(), 0.25f);
    EXPECT_EQ(box->SupportCore(Vector3(1, 1, 1)), Vector3(0.75f, 1.75f, 2.75f));
    test::Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 direction = random.InBall().cast<float>(), p = box->Support(direction);
        EXPECT_TRUE((p.cwiseAbs() - box->HalfExtents()).maxCoeff() <= 1e-6f);
        EXPECT_LE(Length(p), box->OuterRadius() * (1 + 1e-6f));
    }
    EXPECT_EQ(box->InnerRadius(), 1);
    EXPECT_EQ(box->LocalBounds().upper, Vector3(1, 2, 3));
}

TEST(Compound, RefusesBadChildren) {
    const ShapePtr box = Box::Create(Vector3(1, 1, 1)).Value();
    using Children = std::vector<Compound::ChildSettings>;
    const auto create = [](const Children& children) { return CodeOf(Compound::Create(children)); };
    EXPECT_EQ(create({}), ErrorCode::Degenerate);
    EXPECT_EQ(create({{.shape = nullptr}}), ErrorCode::Unsupported);
    EXPECT_EQ(create({{.shape = box, .position = {kNaN, 0, 0}}}), ErrorCode::NonFinite);
    EXPECT_EQ(create({{.shape = box, .rotation = {0, 0, 0, 2}}}), ErrorCode::Unnormalized);
    EXPECT_EQ(create({{.shape = box, .rotation = {0, 0, 0, 0}}}), ErrorCode::Unnormalized);
    EXPECT_EQ(create({{.shape = box, .rotation = {0, 0, kInfinity, 0}}}), ErrorCode::NonFinite);
    EXPECT_EQ(create({{.shape = box, .density = 0}}), ErrorCode::NonPositive);
    EXPECT_EQ(create({{.shape = box, .density = kNaN}}), ErrorCode::NonFinite);
    const ShapePtr plane = Plane::Create().Value();
    EXPECT_EQ(create({{.shape = plane}}), ErrorCode::Unsupported);
    EXPECT_NE(
        Compound::Create(Children{{.shape = box}, {.shape = plane}}).GetError().message.find("child 1 is a plane"),
        std::string::npos);
}

TEST(Compound, BoundsAndRadiiHoldAllChildren) {
    const auto capsule = Capsule::Create(1, 0.25f).Value();
    const auto box = Box::Create(Vector3(0.5f, 0.5f, 0.5f)).Value();
    test::Random random(2);
    for (int i = 0; i < 50; ++i) {
        std::vector<Compound::ChildSettings> children;
        for (int c = 0; c < 3; ++c) {
            children.push_back({.shape = c == 1 ? ShapePtr(capsule) : ShapePtr(box),
                                .position = (random.InCube() * 3).cast<float>(),
                                .rotation = random.Rotation()});
        }
        const auto compound = Compound::Create(children).Value();
        EXPECT_EQ(compound->InnerRadius(), 0.25f);
        for (const Compound::Child& child : compound->Children()) {
            for (int k = 0; k < 100; ++k) {
                const Vector3 direction = random.InBall().cast<float>();
                const Vector3 p = child.pose.Transform(child.shape->Support(direction));
                for (int axis = 0; axis < 3; ++axis) {
                    EXPECT_GE(p[axis], compound->LocalBounds().lower[axis]);
                    EXPECT_LE(p[axis], compound->LocalBounds().upper[axis]);
                }
                EXPECT_LE(Length(p), compound->OuterRadius() * (1 + 1e-6f));
            }
        }
    }
}

}  // namespace
}  // namespace fulcrum
