// Cylinders, cones, tapered capsules, triangles and custom shapes: mass against closed forms and numerical integration
// over the solid, sizes against the support function, errors by field.
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace fulcrum {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

struct Integral {
    double volume = 0, centerY = 0, across = 0, along = 0;  // about the center of mass
};

// A solid of revolution about y by 10^6 rings: the middles of 1000 x 1000 cells of height and radius.
Integral Revolve(double low, double high, double widest, const std::function<double(double)>& radiusAt) {
    constexpr int kCells = 1000;
    Integral sum;
    double second = 0;
    const double dy = (high - low) / kCells;
    for (int i = 0; i < kCells; ++i) {
        const double y = low + (i + 0.5) * dy, radius = std::min(widest, radiusAt(y));
        for (int k = 0; k < kCells; ++k) {
            const double r = (k + 0.5) / kCells * radius, volume = 2 * kPi * r * dy * radius / kCells;
            sum.volume += volume;
            sum.centerY += volume * y;
            second += volume * y * y;
            sum.along += volume * r * r;
        }
    }
    sum.centerY /= sum.volume;
    sum.across = sum.along / 2 + second - sum.volume * sum.centerY * sum.centerY;
    return sum;
}

// The cells' middles miss r^2 by 1 / 1000^2 of itself, the heights likewise; a ball's poles lose a little more.
void ExpectMass(const ConvexShape& shape, const Integral& expected, double relative = 2e-5) {
    const MassProperties& mass = shape.Mass();
    EXPECT_NEAR(mass.volume, expected.volume, relative * expected.volume);
    EXPECT_NEAR(mass.centerOfMass.y(), expected.centerY, relative * shape.OuterRadius());
    EXPECT_EQ(mass.centerOfMass.x(), 0);
    EXPECT_EQ(mass.centerOfMass.z(), 0);
    EXPECT_NEAR(mass.principalInertia.x(), expected.across, relative * expected.across);
    EXPECT_NEAR(mass.principalInertia.y(), expected.along, relative * expected.along);
    EXPECT_NEAR(mass.principalInertia.z(), expected.across, relative * expected.across);
}

std::vector<Vector3> Directions() {
    std::vector<Vector3> directions;
    for (int i = 0; i < 2000; ++i) {
        const double y = 1 - (2 * i + 1.0) / 2000, r = std::sqrt(1 - y * y), angle = i * 2.399963229728653;
        directions.push_back(Position(r * std::cos(angle), y, r * std::sin(angle)).cast<float>());
    }
    for (int i = 0; i < 3; ++i)
        for (const float sign : {1.0f, -1.0f}) directions.push_back(Vector3::Unit(i) * sign);
    return directions;
}

// Bounds and radii match the support function, and supporting faces lie in the core and face the direction.
void ExpectSizes(const ConvexShape& shape) {
    Bounds bounds;
    float outer = 0, inner = kInfinity;
    for (const Vector3& n : Directions()) {
        const Vector3 point = shape.Support(n);
        bounds.Include(point);
        outer = std::max(outer, Length(point));
        inner = std::min(inner, Dot(n, point));
        SupportingFace face;
        shape.FindSupportingFace(n, face);
        ASSERT_GE(face.count, 1);
        float most = -kInfinity;
        for (int i = 0; i < face.count; ++i) {
            most = std::max(most, Dot(n, face.vertices[i]));
            for (const Vector3& d : {n, Vector3(-n), Vector3(n.z(), n.x(), n.y())})
                EXPECT_LE(Dot(d, face.vertices[i]), Dot(d, shape.SupportCore(d)) + 1e-5f * shape.OuterRadius());
            for (int k = 0; k < i; ++k) EXPECT_NE(face.names[i], face.names[k]);
        }
        if (face.count <= 2) {
            EXPECT_NEAR(most, Dot(n, shape.SupportCore(n)), 2e-3f * shape.OuterRadius());
        }
        if (face.count > 2) {
            // Counter-clockwise: Newell's normal is the face's.
            Vector3 sum = Vector3::Zero();
            for (int i = 1; i + 1 < face.count; ++i)
                sum += Cross<float>(Vector3(face.vertices[i] - face.vertices[0]),
                                    Vector3(face.vertices[i + 1] - face.vertices[0]));
            EXPECT_GT(Dot(Normalized(sum), face.normal), 0.9999f);
        }
    }
    const float slack = 1e-5f * shape.OuterRadius();
    for (int i = 0; i < 3; ++i) {
        EXPECT_LE(shape.LocalBounds().lower[i], bounds.lower[i] + slack);
        EXPECT_NEAR(shape.LocalBounds().lower[i], bounds.lower[i], 0.01f * shape.OuterRadius());
        EXPECT_GE(shape.LocalBounds().upper[i], bounds.upper[i] - slack);
        EXPECT_NEAR(shape.LocalBounds().upper[i], bounds.upper[i], 0.01f * shape.OuterRadius());
    }
    EXPECT_GE(shape.OuterRadius(), outer - slack);
    EXPECT_LE(shape.OuterRadius(), outer * 1.01f);
    EXPECT_LE(shape.InnerRadius(), inner + slack);
    // 2000 directions are 0.03 rad apart: they miss a flat side by half that, times its breadth.
    EXPECT_GE(shape.InnerRadius(), inner - 0.015f * outer);
}

template <class T>
void ExpectError(const Result<T>& result, ErrorCode code, const char* names) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.GetError().code, code);
    EXPECT_NE(result.GetError().message.find(names), std::string::npos) << result.GetError().message;
}

TEST(Cylinder, HasTheMassOfTheClosedForm) {
    const auto cylinder = Cylinder::Create(0.7f, 0.3f).Value();
    const double h = 0.7f, r = 0.3f, volume = kPi * r * r * 2 * h;
    ExpectMass(*cylinder, {volume, 0, volume * (r * r / 4 + h * h / 3), volume * r * r / 2}, 1e-6);
    ExpectMass(*cylinder, Revolve(-h, h, 1, [&](double) { return r; }));
    ExpectSizes(*cylinder);
    ExpectSizes(*Cylinder::Create(0.7f, 0.3f, 0.05f).Value());
    EXPECT_EQ(Cylinder::Create(0.7f, 0.3f, 0.05f).Value()->LocalBounds().upper, Vector3(0.3f, 0.7f, 0.3f));
}

TEST(Cone, HasTheMassOfTheClosedForm) {
    const auto cone = Cylinder::CreateCone(0.6f, 0.4f).Value();
    // Center of mass at a quarter of the height; 3/10 m r^2 about the axis, 3/80 m (4 r^2 + H^2) across.
    const double height = 2 * double{0.6f}, r = 0.4f, volume = kPi * r * r * height / 3;
    ExpectMass(*cone, {volume, -height / 4, volume * 3 / 80 * (4 * r * r + height * height), volume * 0.3 * r * r},
               1e-6);
    ExpectMass(*cone, Revolve(-height / 2, height / 2, 1, [&](double y) { return r * (0.5 - y / height); }));
    ExpectSizes(*cone);
    ExpectSizes(*Cylinder::CreateTapered(0.6f, 0.4f, 0).Value());
}

TEST(TaperedCylinder, HasTheMassOfTheIntegral) {
    const auto cylinder = Cylinder::CreateTapered(0.5f, 0.2f, 0.6f).Value();
    ExpectMass(*cylinder, Revolve(-0.5, 0.5, 1, [](double y) { return 0.4 - 0.4 * y; }));
    ExpectSizes(*cylinder);
    ExpectSizes(*Cylinder::CreateTapered(0.5f, 0.6f, 0.2f, 0.1f).Value());
}

TEST(TaperedCapsule, HasTheMassOfTheIntegral) {
    const double h = 0.5, top = 0.2, bottom = 0.4;
    const auto capsule = TaperedCapsule::Create(0.5f, 0.2f, 0.4f).Value();
    // The union of the balls between the two ends: at the height y, the widest of them.
    const double sine = (bottom - top) / (2 * h), cosine = std::sqrt(1 - sine * sine);
    const auto radiusAt = [&](double y) {
        if (y < -h + bottom * sine) return std::sqrt(std::max(0.0, bottom * bottom - (y + h) * (y + h)));
        if (y > h + top * sine) return std::sqrt(std::max(0.0, top * top - (y - h) * (y - h)));
        const double from = -h + bottom * sine, to = h + top * sine;
        return cosine * (bottom + (top - bottom) * (y - from) / (to - from));
    };
    ExpectMass(*capsule, Revolve(-h - bottom, h + top, 1, radiusAt));
    ExpectSizes(*capsule);
    ExpectSizes(*TaperedCapsule::Create(0.5f, 0.4f, 0.1f).Value());
    // Two equal balls make a capsule.
    const double r = 0.3f, cylinder = 2 * kPi * r * r * double{0.7f}, ball = 4.0 / 3 * kPi * r * r * r;
    EXPECT_NEAR(TaperedCapsule::Create(0.7f, 0.3f, 0.3f).Value()->Mass().volume, cylinder + ball,
                1e-6 * (cylinder + ball));
}

TEST(RoundShapes, NameTheSizeThatIsWrong) {
    ExpectError(Cylinder::Create(0, 1), ErrorCode::NonPositive, "halfHeight");
    ExpectError(Cylinder::Create(1, -1), ErrorCode::NonPositive, "radius");
    ExpectError(Cylinder::Create(kNan, 1), ErrorCode::NonFinite, "halfHeight");
    ExpectError(Cylinder::Create(1, 0.5f, 0.6f), ErrorCode::OutOfRange, "convexRadius");
    ExpectError(Cylinder::Create(1, 0.5f, -0.1f), ErrorCode::OutOfRange, "convexRadius");
    ExpectError(Cylinder::Create(1, 0.5f, kNan), ErrorCode::NonFinite, "convexRadius");
    ExpectError(Cylinder::Create(1e17f, 1e17f), ErrorCode::OutOfRange, "volume");
    ExpectError(Cylinder::CreateTapered(1, -0.1f, 1), ErrorCode::Negative, "topRadius");
    ExpectError(Cylinder::CreateTapered(1, 1, kInfinity), ErrorCode::NonFinite, "bottomRadius");
    ExpectError(Cylinder::CreateTapered(1, 0, 0), ErrorCode::NonPositive, "bottomRadius");
    ExpectError(Cylinder::CreateCone(1, 0), ErrorCode::NonPositive, "radius");
    ExpectError(TaperedCapsule::Create(-1, 1, 1), ErrorCode::NonPositive, "halfHeight");
    ExpectError(TaperedCapsule::Create(1, 0, 1), ErrorCode::NonPositive, "topRadius");
    ExpectError(TaperedCapsule::Create(1, 1, kNan), ErrorCode::NonFinite, "bottomRadius");
    ExpectError(TaperedCapsule::Create(0.1f, 0.5f, 1), ErrorCode::Degenerate, "Sphere of radius 1 m");
}

TEST(Triangle, HasTheMassOfAThinPlate) {
    const Vector3 corners[3] = {Vector3(1, 2, 3), Vector3(2, 2.5f, 3), Vector3(1.2f, 2.1f, 4)};
    const auto triangle = Triangle::Create(corners[0], corners[1], corners[2], 0.05f).Value();
    // 1000 x 1000 cells of the parallelogram, folded onto the triangle, in ten layers of the thickness.
    const Position a = corners[0].cast<double>(), ab = corners[1].cast<double>() - a,
                   ac = corners[2].cast<double>() - a;
    const Position cross = Cross<double>(ab, ac), normal = cross * (1 / cross.norm()),
                   center = a + (ab + ac) * (1.0 / 3);
    const double volume = cross.norm() / 2 * double{0.05f} * 2;
    double second[3] = {0, 0, 0}, trace = 0;
    constexpr int kCells = 1000;
    for (int i = 0; i < kCells; ++i) {
        for (int k = 0; k < kCells; ++k) {
            double u = (i + 0.5) / kCells, v = (k + 0.5) / kCells;
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            const Position x = a + ab * u + ac * v - center;
            for (int axis = 0; axis < 3; ++axis) second[axis] += x[axis] * x[axis] / (kCells * kCells) * volume;
        }
    }
    const double layer = double{0.05f} * double{0.05f} / 3 * volume;  // t^2 / 12
    for (int axis = 0; axis < 3; ++axis) trace += second[axis] += layer * normal[axis] * normal[axis];
    EXPECT_NEAR(triangle->Mass().volume, volume, 1e-6 * volume);
    EXPECT_LE((triangle->Mass().centerOfMass - center.cast<float>()).norm(), 1e-6);
    const SolidMass solid = ToSolidMass(triangle->Mass());
    const double diagonal[3] = {solid.inertia.xx, solid.inertia.yy, solid.inertia.zz};
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(diagonal[axis], trace - second[axis], 1e-4 * trace);
    ExpectSizes(*triangle);
    EXPECT_EQ(Triangle::Create(corners[0], corners[1], corners[2]).Value()->InnerRadius(), 0);
}

TEST(Triangle, RefusesCornersOnALine) {
    const Vector3 a(0, 0, 0), b(1, 1, 1), c(2, 2, 2);
    ExpectError(Triangle::Create(a, b, c), ErrorCode::Degenerate, "line");
    ExpectError(Triangle::Create(a, a, a), ErrorCode::Degenerate, "line");
    ExpectError(Triangle::Create(a, b, Vector3(0, kNan, 0)), ErrorCode::NonFinite, "corner c");
    ExpectError(Triangle::Create(a, b, Vector3(0, 1, 0), -1), ErrorCode::Negative, "radius");
}

// Off its user's origin, to see the frames apart.
class Egg final : public CustomConvex {
public:
    explicit Egg(const Vector3& radii, float convexRadius = 0) : CustomConvex(convexRadius), radii_(radii) {}
    Vector3 FarthestPoint(const Vector3& d) const override {
        const Vector3 scaled = d.cwiseProduct(radii_);
        return scaled.cwiseProduct(radii_) * (1.0f / Length(scaled)) + Vector3(1, 2, 3);
    }

private:
    Vector3 radii_;
};

class Brick final : public CustomConvex {
public:
    Vector3 FarthestPoint(const Vector3& d) const override {
        return Vector3(d.x() < 0 ? -1.0f : 1.0f, d.y() < 0 ? -2.0f : 2.0f, d.z() < 0 ? -3.0f : 3.0f);
    }
};

class Wrong final : public CustomConvex {
public:
    Vector3 FarthestPoint(const Vector3& d) const override { return Normalized(d) * (d.x() < 0 ? -1.0f : 1.0f); }
};

class Flat final : public CustomConvex {
public:
    Vector3 FarthestPoint(const Vector3& d) const override {
        return Vector3(d.x() < 0 ? -1.0f : 1.0f, d.y() < 0 ? -1.0f : 1.0f, 0);
    }
};

TEST(CustomConvex, FindsItsMassFromTheSupportFunctionAlone) {
    const auto egg = CreateCustom<Egg>(Vector3(0.3f, 0.5f, 0.8f)).Value();
    const double x = 0.3f, y = 0.5f, z = 0.8f, volume = 4.0 / 3 * kPi * x * y * z;
    // What Richardson's extrapolation leaves of an inscribed mesh: the fourth power of a spacing of 1/64.
    EXPECT_NEAR(egg->Mass().volume, volume, 1e-5 * volume);
    EXPECT_LE((egg->Mass().centerOfMass - Vector3(1, 2, 3)).norm(), 1e-5f);
    EXPECT_NEAR(egg->Mass().principalInertia.x(), volume / 5 * (y * y + z * z), 2e-5 * volume);
    EXPECT_NEAR(egg->Mass().principalInertia.y(), volume / 5 * (x * x + z * z), 2e-5 * volume);
    EXPECT_NEAR(egg->Mass().principalInertia.z(), volume / 5 * (x * x + y * y), 2e-5 * volume);
    ExpectSizes(*egg);

    const auto brick = CreateCustom<Brick>().Value();
    EXPECT_NEAR(brick->Mass().volume, 48, 1e-4);
    EXPECT_NEAR(brick->Mass().principalInertia.x(), 48.0 / 12 * (16 + 36), 1e-3);
    ExpectSizes(*brick);
    // The default FindSupportingFace finds faces by the support function alone.
    SupportingFace face;
    brick->FindSupportingFace(Normalized(Vector3(0.005f, 1, 0.01f)), face);
    EXPECT_EQ(face.count, 4);
    EXPECT_GT(face.normal.y(), 0.9999f);

    const auto rounded = CreateCustom<Egg>(Vector3(0.3f, 0.3f, 0.3f), 0.2f).Value();
    EXPECT_NEAR(rounded->Mass().volume, 4.0 / 3 * kPi * 0.125, 1e-5);
}

TEST(CustomConvex, RefusesShapesThatAreNotConvexSolids) {
    ExpectError(CreateCustom<Wrong>(), ErrorCode::Degenerate, "FarthestPoint");
    ExpectError(CreateCustom<Flat>(), ErrorCode::Degenerate, "volume");
    ExpectError(CreateCustom<Egg>(Vector3(1, 1, kNan)), ErrorCode::NonFinite, "FarthestPoint");
    ExpectError(CreateCustom<Egg>(Vector3(1, 1, 1), -1.0f), ErrorCode::Negative, "convexRadius");
}

}  // namespace
}  // namespace fulcrum
