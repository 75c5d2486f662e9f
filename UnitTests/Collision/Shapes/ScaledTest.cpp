// Scaled, mirrored and moved shapes: their support functions are those of the images.
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum {
namespace {

class Bean final : public CustomConvex {
public:
    Vector3 FarthestPoint(const Vector3& d) const override {
        const Vector3 radii(0.3f, 0.5f, 0.8f), scaled = d.cwiseProduct(radii);
        return scaled.cwiseProduct(radii) * (1.0f / Length(scaled)) + Vector3(1, 0, 0);
    }
};

// Farthest along d in the user's frame, children included.
float Reach(const Shape& shape, const Vector3& d) {
    if (shape.IsConvex()) {
        const auto& convex = static_cast<const ConvexShape&>(shape);
        return Dot(d, Vector3(convex.Support(d) + shape.Mass().centerOfMass));
    }
    float most = -std::numeric_limits<float>::infinity();
    for (const Compound::Child& child : static_cast<const Compound&>(shape).Children()) {
        const Vector3 local = InverseRotate(child.pose.rotation, d);
        most = std::max(most,
                        Dot(d, Vector3(child.pose.Transform(child.shape->Support(local)) + shape.Mass().centerOfMass)));
    }
    return most;
}

void ExpectImage(const ShapePtr& shape, const Vector3& scale) {
    const Result<ShapePtr> scaled = Scaled(shape, scale);
    ASSERT_TRUE(scaled) << scaled.GetError().message;
    const float factor = std::fabs(scale.x() * scale.y() * scale.z());
    EXPECT_NEAR(scaled.Value()->Mass().volume, shape->Mass().volume * factor, 1e-4f * factor * shape->Mass().volume);
    EXPECT_LE(Length(Vector3(scaled.Value()->Mass().centerOfMass - shape->Mass().centerOfMass.cwiseProduct(scale))),
              1e-4f);
    for (int i = 0; i < 200; ++i) {
        const double y = 1 - (2 * i + 1.0) / 200, r = std::sqrt(1 - y * y), angle = i * 2.399963229728653;
        const Vector3 d = Position(r * std::cos(angle), y, r * std::sin(angle)).cast<float>();
        // The support value of the image along d is that of the shape along S d.
        EXPECT_NEAR(Reach(*scaled.Value(), d), Reach(*shape, d.cwiseProduct(scale)),
                    2e-5f * scale.cwiseAbs().maxCoeff());
    }
}

ShapePtr Hull() {
    const Vector3 points[] = {Vector3(0, 0, 0), Vector3(1, 0, 0.2f), Vector3(0, 1.3f, 0), Vector3(0.1f, 0, 0.7f),
                              Vector3(1, 1, 1)};
    return ConvexHull::Create(points).Value();
}

TEST(Scaled, MakesTheImageOfEveryShape) {
    const Vector3 uniform(2, 2, 2), mirrored(-1.5f, 1.5f, 1.5f), any(0.5f, -2, 3), round(2, -0.7f, -2);
    const ShapePtr sharp[] = {Box::Create(Vector3(1, 2, 3)).Value(), Hull(), CreateCustom<Bean>().Value()};
    const ShapePtr about[] = {Cylinder::Create(1, 0.5f).Value(), Cylinder::CreateCone(1, 0.5f).Value(),
                              Cylinder::CreateTapered(1, 1, 0.5f).Value()};
    const ShapePtr ball[] = {Sphere::Create(0.7f).Value(), Capsule::Create(0.5f, 0.2f).Value(),
                             TaperedCapsule::Create(0.5f, 0.2f, 0.4f).Value(),
                             Box::Create(Vector3(1, 2, 3), 0.1f).Value(), Cylinder::Create(1, 0.5f, 0.1f).Value()};
    for (const Vector3& scale : {uniform, mirrored, any, round})
        for (const ShapePtr& shape : sharp) ExpectImage(shape, scale);
    for (const Vector3& scale : {uniform, mirrored, round})
        for (const ShapePtr& shape : about) ExpectImage(shape, scale);
    for (const Vector3& scale : {uniform, mirrored, Vector3(-uniform)})
        for (const ShapePtr& shape : ball) ExpectImage(shape, scale);
    const Result<ShapePtr> triangle =
        Scaled(Triangle::Create(Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)).Value(), any);
    ASSERT_TRUE(triangle);
    EXPECT_NEAR(triangle.Value()->Mass().volume, 0.5 * 0.5 * 2 * 0.001, 1e-9);
}

TEST(Scaled, ScalesCompoundsAsTheirChildrenAreRotated) {
    const float half = std::sqrt(0.5f);
    const ShapePtr box = Box::Create(Vector3(1, 2, 3)).Value(), ball = Sphere::Create(0.5f).Value();
    const Compound::ChildSettings turned[] = {
        {.shape = box, .position = Vector3(1, 0, 0), .rotation = {0, 0, half, half}},
        {.shape = Hull(), .position = Vector3(0, 2, 0), .density = 3}};
    const Compound::ChildSettings tilted[] = {
        {.shape = box, .position = Vector3(1, 2, 3), .rotation = Normalized(Quaternion{0.1f, 0.2f, 0.3f, 0.9f})},
        {.shape = ball, .position = Vector3(0, -2, 1)}};
    const ShapePtr a = Compound::Create(turned).Value(), b = Compound::Create(tilted).Value();
    ExpectImage(a, Vector3(2, 3, 4));
    ExpectImage(a, Vector3(-2, 2, 2));
    ExpectImage(b, Vector3(2, 2, 2));
    ExpectImage(b, Vector3(-2, 2, 2));
    ExpectImage(b, Vector3(-2, -2, -2));
    const Result<ShapePtr> wrong = Scaled(b, Vector3(1, 2, 3));
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.GetError().code, ErrorCode::Unsupported);
}

TEST(Scaled, NamesTheNearestScaleThatIsValid) {
    const auto message = [](const ShapePtr& shape, const Vector3& scale) {
        const Result<ShapePtr> result = Scaled(shape, scale);
        return result ? std::string() : result.GetError().message;
    };
    EXPECT_NE(message(Sphere::Create(1).Value(), Vector3(1, 2, -3)).find("(2, 2, -2)"), std::string::npos);
    EXPECT_NE(message(Cylinder::Create(1, 1).Value(), Vector3(1, 5, 3)).find("(2, 5, 2)"), std::string::npos);
    EXPECT_NE(message(Box::Create(Vector3(1, 1, 1)).Value(), Vector3(1, 0, 3)).find("no factor may be 0"),
              std::string::npos);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(message(Box::Create(Vector3(1, 1, 1)).Value(), Vector3(1, nan, 3)).find("finite"), std::string::npos);
    EXPECT_FALSE(Scaled(nullptr, Vector3(1, 1, 1)));
}

TEST(RotatedTranslated, MovesTheShapeInItsUsersFrame) {
    const Quaternion q = Normalized(Quaternion{0.1f, 0.2f, 0.3f, 0.9f});
    const ShapePtr moved = RotatedTranslated(Hull(), Vector3(1, 2, 3), q).Value();
    const ShapePtr again = RotatedTranslated(moved, Vector3(0, 0, 1), Quaternion{}).Value();
    const Vector3 expected = Rotate(q, Hull()->Mass().centerOfMass) + Vector3(1, 2, 4);
    EXPECT_LE(Length(Vector3(again->Mass().centerOfMass - expected)), 1e-5f);
}

TEST(OffsetCenterOfMass, MovesTheCenterAndLeavesTheGeometry) {
    const ShapePtr box = Box::Create(Vector3(1, 1, 1)).Value();
    const ShapePtr low = OffsetCenterOfMass(box, Vector3(0, -0.5f, 0)).Value();
    EXPECT_EQ(low->Mass().centerOfMass, Vector3(0, -0.5f, 0));
    EXPECT_NEAR(Reach(*low, Vector3(0, 1, 0)), 1, 1e-6);
    EXPECT_NEAR(Reach(*low, Vector3(0, -1, 0)), 1, 1e-6);
    // 8 (1 + 1) / 3 about the old center, 8 / 4 more across.
    EXPECT_NEAR(low->Mass().principalInertia.x(), 16.0 / 3 + 2, 1e-5);
    EXPECT_NEAR(low->Mass().principalInertia.y(), 16.0 / 3, 1e-5);
    ExpectImage(low, Vector3(2, 2, 2));
}

TEST(EmptyShape, IsNotConvexAndHasAMass) {
    const auto empty = EmptyShape::Create();
    EXPECT_FALSE(empty->IsConvex());
    EXPECT_EQ(empty->Mass().volume, 1);
    EXPECT_EQ(empty->OuterRadius(), 0);
}

TEST(Scaled, APlaneMovesWithItsPoints) {
    const auto plane = Plane::Create(Vector3(1, 2, 2), 3);
    ASSERT_TRUE(plane);
    const Vector3 scale(2, -3, 0.5f);
    const Result<ShapePtr> scaled = Scaled(plane.Value(), scale);
    ASSERT_TRUE(scaled);
    const auto& result = static_cast<const Plane&>(*scaled.Value());
    // Points of the surface, one inside, one outside: the side that is solid goes with them.
    for (const Vector3& p : {Vector3(3, 3, 0), Vector3(9, 0, 0), Vector3(1, 1, 3)})
        EXPECT_NEAR(result.Distance(p.cwiseProduct(scale)), 0, 1e-5f);
    EXPECT_LT(result.Distance(Vector3(0, 0, 0).cwiseProduct(scale)), 0);
    EXPECT_GT(result.Distance(Vector3(5, 5, 5).cwiseProduct(scale)), 0);
}

}  // namespace
}  // namespace fulcrum
