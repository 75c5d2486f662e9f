// Every function that creates a shape or a path, with one number at a time that is not a number, infinite, zero,
// negative or huge: it is refused with an error that says what is wrong, or the shape is sound: a world of it steps.
// The list is held to the headers.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Physics/BadInput/Room.h>

#include <cmath>
#include <set>

namespace fulcrum::testing {

template <class Archive>
void Describe(Archive& archive, ConvexHullSettings& settings) {
    archive.Field("maxVertices", settings.maxVertices);
    archive.Field("convexRadius", settings.convexRadius);
}
template <class Archive>
void Describe(Archive& archive, TriangleMeshSettings& settings) {
    archive.Field("activeEdgeCosine", settings.activeEdgeCosine);
    archive.Field("weldDistance", settings.weldDistance);
}
template <class Archive>
void Describe(Archive& archive, HeightFieldSettings& settings) {
    archive.Field("sampleCountX", settings.sampleCountX);
    archive.Field("sampleCountZ", settings.sampleCountZ);
    archive.Field("cellSizeX", settings.cellSizeX);
    archive.Field("cellSizeZ", settings.cellSizeZ);
    archive.Field("origin", settings.origin);
    archive.Choice("precision", settings.precision, std::array{"Float", "Steps16"});
    archive.Field("activeEdgeCosine", settings.activeEdgeCosine);
}
template <>
inline constexpr SettingsHeader kSettingsHeader<ConvexHullSettings>{"Collision/Shapes/ConvexHull.h",
                                                                    "ConvexHullSettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<TriangleMeshSettings>{"Collision/Shapes/TriangleMesh.h",
                                                                      "TriangleMeshSettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<HeightFieldSettings>{"Collision/Shapes/HeightField.h",
                                                                     "HeightFieldSettings"};

namespace {

using Points = std::vector<Vector3>;
using Children = std::vector<CompoundShape::ChildSettings>;

// What the functions are given; each uses some of it.
struct ShapeArguments {
    float radius = 0.3f, halfHeight = 0.4f, topRadius = 0.2f, bottomRadius = 0.3f, convexRadius = 0.05f, offset = 0.5f;
    Vector3 halfExtents{0.3f, 0.4f, 0.5f}, normal{0, 1, 0}, scale{2, 2, 2}, position{1, 0, 0};
    Quaternion rotation{};
    Points points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    ConvexHullSettings hull;
    TriangleMeshSettings mesh;
    HeightFieldSettings field{.sampleCountX = 3, .sampleCountZ = 3};
    std::vector<float> heights = std::vector<float>(9, 1.0f);
    std::vector<uint32_t> indices = {0, 1, 2, 2, 1, 3};
    Children children = {{.shape = SphereOf(0.3f)}, {.shape = CubeOf(0.2f), .position = {1, 0, 0}}};
    std::vector<PathPoint> path = {{{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {1, 0, 0}}, {{2, 0, 1}, {0, 0, 1}}};
};

struct Creator {
    const char* name;
    const char* uses;  // of the arguments
    Result<ShapePtr> (*create)(const ShapeArguments& a);
};

template <class T>
Result<ShapePtr> AsShape(const Result<T>& made) {
    if (!made) return made.GetError();
    if constexpr (std::is_convertible_v<T, ShapePtr>) return ShapePtr(made.Value());
    else return ShapePtr();  // a path
}

const Creator kCreators[] = {
    {"Sphere::Create", "radius", [](const ShapeArguments& a) { return AsShape(Sphere::Create(a.radius)); }},
    {"Box::Create", "halfExtents convexRadius",
     [](const ShapeArguments& a) { return AsShape(Box::Create(a.halfExtents, a.convexRadius)); }},
    {"Capsule::Create", "halfHeight radius",
     [](const ShapeArguments& a) { return AsShape(Capsule::Create(a.halfHeight, a.radius)); }},
    {"TaperedCapsule::Create", "halfHeight topRadius bottomRadius",
     [](const ShapeArguments& a) {
         return AsShape(TaperedCapsule::Create(a.halfHeight, a.topRadius, a.bottomRadius));
     }},
    {"Cylinder::Create", "halfHeight radius convexRadius",
     [](const ShapeArguments& a) { return AsShape(Cylinder::Create(a.halfHeight, a.radius, a.convexRadius)); }},
    {"Cylinder::CreateTapered", "halfHeight endRadii convexRadius",
     [](const ShapeArguments& a) {
         return AsShape(Cylinder::CreateTapered(a.halfHeight, a.topRadius, a.bottomRadius, a.convexRadius));
     }},
    {"Cylinder::CreateCone", "halfHeight radius convexRadius",
     [](const ShapeArguments& a) { return AsShape(Cylinder::CreateCone(a.halfHeight, a.radius, a.convexRadius)); }},
    {"Plane::Create", "normal offset",
     [](const ShapeArguments& a) { return AsShape(Plane::Create(a.normal, a.offset)); }},
    {"Triangle::Create", "points",
     [](const ShapeArguments& a) {
         return AsShape(Triangle::Create(a.points[0], a.points[1], a.points[a.points.size() - 1]));
     }},
    {"ConvexHull::Create", "points hull",
     [](const ShapeArguments& a) { return AsShape(ConvexHull::Create(a.points, a.hull)); }},
    {"TriangleMesh::Create", "points mesh indices",
     [](const ShapeArguments& a) {
         TriangleMeshSettings settings = a.mesh;
         settings.vertices = a.points;
         settings.indices = a.indices;
         return AsShape(TriangleMesh::Create(settings));
     }},
    {"TriangleMesh::Scaled", "scale",
     [](const ShapeArguments& a) {
         const auto mesh = TriangleMesh::Create({.vertices = a.points, .indices = a.indices}).Value();
         return AsShape(TriangleMesh::Scaled(*mesh, a.scale));
     }},
    {"HeightField::Create", "field heights",
     [](const ShapeArguments& a) {
         HeightFieldSettings settings = a.field;
         settings.heights = a.heights;
         return AsShape(HeightField::Create(settings));
     }},
    {"Compound::Create", "children", [](const ShapeArguments& a) { return AsShape(Compound::Create(a.children)); }},
    {"MutableCompound::Create", "children",
     [](const ShapeArguments& a) { return AsShape(MutableCompound::Create(a.children)); }},
    {"Scaled", "scale", [](const ShapeArguments& a) { return Scaled(CubeOf(1), a.scale); }},
    {"RotatedTranslated", "position rotation",
     [](const ShapeArguments& a) { return RotatedTranslated(CubeOf(1), a.position, a.rotation); }},
    {"OffsetCenterOfMass", "position",
     [](const ShapeArguments& a) { return OffsetCenterOfMass(CubeOf(1), a.position); }},
    {"Path::Hermite", "path", [](const ShapeArguments& a) { return AsShape(Path::Hermite(a.path, false)); }},
    {"Path::CatmullRom", "points",
     [](const ShapeArguments& a) {
         const Vector3 normal(0, 0.9f, 0.1f);
         return AsShape(Path::CatmullRom(a.points, {&normal, 1}, false));
     }},
};

TEST(BadShapes, HaveAllFunctionsInTheList) {
    std::set<std::string> listed, declared = {"Scaled", "RotatedTranslated", "OffsetCenterOfMass"};  // Scaled.h
    for (const Creator& creator : kCreators) listed.insert(creator.name);
    const std::pair<const char*, const char*> types[] = {
        {"Primitives", "Sphere"},          {"Primitives", "Box"},
        {"Primitives", "Capsule"},         {"RoundShapes", "Cylinder"},
        {"RoundShapes", "TaperedCapsule"}, {"Plane", "Plane"},
        {"Triangle", "Triangle"},          {"ConvexHull", "ConvexHull"},
        {"TriangleMesh", "TriangleMesh"},  {"HeightField", "HeightField"},
        {"Compound", "Compound"},          {"MutableCompound", "MutableCompound"}};
    for (const auto& [header, type] : types)
        for (const PublicFunction& function : PublicFunctionsOf(std::string("Collision/Shapes/") + header + ".h", type))
            if (function.isStatic && function.returns.find("Result<") != std::string::npos)
                declared.insert(std::string(type) + "::" + function.name);
    for (const PublicFunction& function : PublicFunctionsOf("Constraints/Joints/Path.h", "Path"))
        if (function.isStatic && function.returns.find("Result<") != std::string::npos)
            declared.insert("Path::" + function.name);
    EXPECT_EQ(listed, declared);
}

// Empty, or what is wrong with a shape: as a body in a world it must stay finite.
std::string WrongOf(const ShapePtr& shape) {
    if (!shape) return {};
    const MassProperties& mass = shape->Mass();
    if (!std::isfinite(mass.volume) || !IsFinite(mass.centerOfMass) || !IsFinite(mass.principalInertia))
        return "its mass is not finite";
    TestWorld world;
    world.AddFloor();
    for (const MotionType motion : {MotionType::Dynamic, MotionType::Static}) {
        const auto body = world.Bodies().Create({.shape = shape, .motion = motion, .position = {0, 1, 0}});
        if (!body) continue;  // no volume, or a mass of which no float has the inverse
        world.Steps(2);
        if (!world.AllFinite()) return "a world with it is not finite";
        EXPECT_TRUE(world.Bodies().Remove(body.Value()));
    }
    return {};
}

TEST(BadShapes, AreRefusedOrSound) {
    const BadIds none;
    int values = 0, refused = 0;
    for (const Creator& creator : kCreators) {
        SCOPED_TRACE(creator.name);
        const Result<ShapePtr> good = creator.create({});
        EXPECT_TRUE(good) << good.GetError().message;
        const std::string uses = std::string(" ") + creator.uses + " ";
        for (size_t which = 0;; ++which) {
            ShapeArguments bad;
            Spoiler spoiler(which, none);
            const auto spoil = [&](const char* name, auto& value, const char* comment = "") {
                if (uses.find(std::string(" ") + name + " ") != std::string::npos)
                    spoiler.Argument(name, value, comment);
            };
            spoil("radius", bad.radius, "m, > 0");
            spoil("halfHeight", bad.halfHeight, "m, > 0");
            spoil("topRadius", bad.topRadius, "m, > 0");
            spoil("bottomRadius", bad.bottomRadius, "m, > 0");
            spoil("endRadii", bad.topRadius, "m, >= 0");
            spoil("endRadii", bad.bottomRadius, "m, >= 0");
            spoil("convexRadius", bad.convexRadius, "m, >= 0");
            spoil("halfExtents", bad.halfExtents, "m, > 0");
            spoil("offset", bad.offset);
            spoil("normal", bad.normal);
            spoil("scale", bad.scale);
            spoil("position", bad.position);
            spoil("rotation", bad.rotation);
            spoil("points", bad.points);
            spoil("hull", bad.hull);
            spoil("mesh", bad.mesh);
            spoil("indices", bad.indices, "0..4");
            spoil("field", bad.field);
            spoil("heights", bad.heights);
            spoil("children", bad.children);
            spoil("path", bad.path);
            if (!spoiler.Done()) break;
            ++values;
            const std::string what = spoiler.Done()->path + " = " + spoiler.Done()->value;
            const Result<ShapePtr> made = creator.create(bad);
            if (!made) {
                ++refused;
                EXPECT_FALSE(made.GetError().message.empty()) << what;
                continue;
            }
            EXPECT_EQ(spoiler.Done()->verdict, Verdict::MayBeRefused) << what << " was not refused";
            const std::string wrong = WrongOf(made.Value());
            EXPECT_TRUE(wrong.empty()) << what << ": " << wrong;
        }
    }
    EXPECT_GT(values, 400);
    EXPECT_GT(refused, 250);
}

}  // namespace
}  // namespace fulcrum::testing
