#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/UnitTests/Collision/Shapes/SurfaceChecks.h>

#include <cmath>
#include <cstring>

namespace fulcrum {
namespace {

ShapePtr RandomHull(int points, float convexRadius, uint32_t seed) {
    SurfaceRandom random(seed);
    std::vector<Vector3> cloud;
    for (int i = 0; i < points; ++i) cloud.push_back(random.InBox(2) + Vector3(5, 0, 0));
    return ConvexHull::Create(cloud, {.convexRadius = convexRadius}).Value();
}

std::vector<Compound::ChildSettings> SomeChildren() {
    std::vector<Compound::ChildSettings> children(4);
    children[0].shape = Box::Create(Vector3(1, 2, 3), 0.1f).Value();
    children[1].shape = Sphere::Create(0.7f).Value();
    children[1].position = Vector3(3, 1, 0);
    children[1].density = 3;
    children[2].shape = RandomHull(20, 0, 3);
    children[2].rotation = Normalized(Quaternion{0.1f, 0.2f, 0.3f, 0.9f});
    children[3].shape = Capsule::Create(1, 0.25f).Value();
    children[3].rotation = Normalized(Quaternion{0.5f, 0.2f, -0.3f, 0.9f});
    return children;
}

ShapePtr SomeCompound() { return Compound::Create(SomeChildren()).Value(); }

// With free places, further ids and a mass that was kept.
std::shared_ptr<MutableCompound> SomeMutableCompound() {
    const std::vector<Compound::ChildSettings> children = SomeChildren();
    const auto compound = MutableCompound::Create(children).Value();
    for (int i = 0; i < 8; ++i) EXPECT_TRUE(compound->Add(children[static_cast<size_t>(i) % 4]));
    for (uint32_t i : {6u, 1u, 9u}) EXPECT_TRUE(compound->Remove({i, 0}));
    EXPECT_TRUE(compound->Add(children[0]));
    EXPECT_TRUE(compound->Remove({7, 0}, MassUpdate::Keep));
    return compound;
}

// A ball cut off at a height, with the radius and the height as all that it is.
class Dome final : public CustomConvex {
public:
    Dome(float r, float h) : CustomConvex(0.01f), radius(r), height(h) {}
    Vector3 FarthestPoint(const Vector3& direction) const override {
        const Vector3 onBall = direction * (radius / Length(direction));
        if (onBall.y() <= height) return onBall;
        const float across = std::sqrt(direction.x() * direction.x() + direction.z() * direction.z());
        const float rim = across > 0 ? std::sqrt(radius * radius - height * height) / across : 0.0f;
        return Vector3(direction.x() * rim, height, direction.z() * rim);
    }
    const float radius, height;
};

bool WriteDome(const CustomConvex& shape, std::vector<uint8_t>& bytes) {
    const auto* dome = dynamic_cast<const Dome*>(&shape);
    if (!dome) return false;
    bytes.resize(8);
    std::memcpy(bytes.data(), &dome->radius, 4);
    std::memcpy(bytes.data() + 4, &dome->height, 4);
    return true;
}

Result<ShapePtr> ReadDome(std::span<const uint8_t> bytes) {
    if (bytes.size() != 8) return Error{ErrorCode::Degenerate, "no dome"};
    float radius, height;
    std::memcpy(&radius, bytes.data(), 4);
    std::memcpy(&height, bytes.data() + 4, 4);
    if (!(radius > 0.01f && radius < 100 && std::fabs(height) < 0.9f * radius))
        return Error{ErrorCode::OutOfRange, "no dome"};
    const auto dome = CreateCustom<Dome>(radius, height);
    if (!dome) return dome.GetError();
    return ShapePtr(dome.Value());
}

const CustomShapeFormat kFormats[] = {
    {"nothing", [](const CustomConvex&, std::vector<uint8_t>& bytes) { return bytes.push_back(7), false; },
     [](std::span<const uint8_t>) { return Result<ShapePtr>(ShapePtr()); }},
    {"dome", WriteDome, ReadDome}};

ShapePtr SomeMesh(bool withMaterials, const Vector3& scale) {
    const IndexedTriangles terrain = WavyTerrain(12, 1, 1);
    const std::vector<uint8_t> materials(12 * 12 * 2, 1);
    const std::vector<SurfaceMaterial> palette(2, {.friction = 0.2f, .restitution = 0.5f});
    TriangleMeshSettings settings = terrain.Settings();
    if (withMaterials) {
        settings.triangleMaterials = materials;
        settings.materials = palette;
        settings.keepSourceTriangles = true;
        settings.isTwoSided = true;
    }
    const auto mesh = TriangleMesh::Create(settings).Value();
    if (scale == Vector3(Vector3::Ones())) return mesh;
    return TriangleMesh::Scaled(*mesh, scale).Value();
}

ShapePtr SomeField(HeightPrecision precision) {
    SurfaceRandom random(5);
    std::vector<float> heights;
    std::vector<uint8_t> cells;
    for (int i = 0; i < 21 * 14; ++i) heights.push_back(random.Between(1000, 1001));
    for (int i = 0; i < 20 * 13; ++i) cells.push_back(i % 6 == 0 ? kHoleCell : static_cast<uint8_t>(i % 3));
    HeightFieldSettings settings;
    settings.sampleCountX = 21;
    settings.sampleCountZ = 14;
    settings.heights = heights;
    settings.cells = cells;
    settings.precision = precision;
    settings.cellSizeX = 0.3f;
    settings.origin = Vector3(1, 2, 3);
    return HeightField::Create(settings).Value();
}

std::vector<ShapePtr> OneOfEach() {
    return {Sphere::Create(0.3f).Value(),
            Box::Create(Vector3(1, 2, 0.1f), 0.05f).Value(),
            Capsule::Create(1, 0.5f).Value(),
            Plane::Create(Vector3(1, 2, 3), -4).Value(),
            RandomHull(30, 0, 1),
            RandomHull(300, 0.05f, 2),
            SomeCompound(),
            SomeMesh(false, Vector3::Ones()),
            SomeMesh(true, Vector3(-2, 1, 0.5f)),
            SomeField(HeightPrecision::Float),
            SomeField(HeightPrecision::Steps16),
            TaperedCapsule::Create(0.5f, 0.2f, 0.4f).Value(),
            Cylinder::Create(0.5f, 0.3f, 0.02f).Value(),
            Cylinder::CreateTapered(0.7f, 0.1f, 0.4f).Value(),
            EmptyShape::Create(),
            Triangle::Create(Vector3(5, 1, 2), Vector3(6, 1.5f, 2), Vector3(5.5f, 3, 4)).Value(),
            Triangle::Create(Vector3(0, 0, 0), Vector3(-1, 0, 0.3f), Vector3(0, 1e-3f, 2), 0.05f).Value(),
            SomeMutableCompound()};
}

template <class T>
bool SameBits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

TEST(ShapeFile, EveryShapeComesBackWithTheSameBits) {
    for (const ShapePtr& shape : OneOfEach()) {
        const auto bytes = SaveShape(*shape);
        ASSERT_TRUE(bytes);
        const auto loaded = LoadShape(bytes.Value());
        ASSERT_TRUE(loaded) << ShapeTypeName(shape->Type()) << ": " << loaded.GetError().message;
        const Shape& back = *loaded.Value();
        EXPECT_EQ(back.Type(), shape->Type());
        EXPECT_TRUE(SameBits(back.LocalBounds(), shape->LocalBounds())) << ShapeTypeName(shape->Type());
        EXPECT_EQ(back.InnerRadius(), shape->InnerRadius());
        EXPECT_EQ(back.OuterRadius(), shape->OuterRadius());
        EXPECT_TRUE(SameBits(back.Mass(), shape->Mass())) << ShapeTypeName(shape->Type());
        // Saved again, the bytes are the same.
        EXPECT_EQ(SaveShape(back).Value(), bytes.Value()) << ShapeTypeName(shape->Type());
        if (shape->IsConvex()) {
            SurfaceRandom random(1);
            for (int i = 0; i < 100; ++i) {
                const Vector3 direction = random.InBox(1);
                EXPECT_EQ(static_cast<const ConvexShape&>(back).SupportCore(direction),
                          static_cast<const ConvexShape&>(*shape).SupportCore(direction));
            }
        }
    }
}

TEST(ShapeFile, SurfacesGiveTheSameQueryResults) {
    for (const ShapePtr& shape : OneOfEach()) {
        const auto* before = dynamic_cast<const SurfaceShape*>(shape.get());
        if (!before) continue;
        const ShapePtr loaded = LoadShape(SaveShape(*shape).Value()).Value();
        const auto& after = dynamic_cast<const SurfaceShape&>(*loaded);
        ASSERT_EQ(after.TriangleCount(), before->TriangleCount());
        EXPECT_EQ(after.Materials().size(), before->Materials().size());
        for (const TriangleView& t : AllTriangles(*before)) {
            const TriangleView u = after.GetTriangle(t.id);
            EXPECT_EQ(t.normal, u.normal);
            EXPECT_EQ(t.activeEdges, u.activeEdges);
            EXPECT_EQ(t.material, u.material);
        }
        ExpectExactRays(after, 500);
        ExpectExactBoxes(after, 500, 1);
    }
}

TEST(ShapeFile, HullsOfAllSizesComeBack) {
    for (uint32_t seed = 0; seed < 200; ++seed) {
        const ShapePtr hull = RandomHull(4 + static_cast<int>(seed), seed % 3 == 0 && seed > 20 ? 0.02f : 0.0f, seed);
        const auto bytes = SaveShape(*hull).Value();
        const auto loaded = LoadShape(bytes);
        ASSERT_TRUE(loaded) << seed << loaded.GetError().message;
        EXPECT_EQ(SaveShape(*loaded.Value()).Value(), bytes);
    }
    // The thinnest hulls that are accepted.
    std::vector<Vector3> plate;
    SurfaceRandom random(1);
    for (int i = 0; i < 40; ++i) plate.push_back(random.InBox(10).cwiseProduct(Vector3(1, 1e-4f, 1)));
    const auto thin = ConvexHull::Create(plate);
    ASSERT_TRUE(thin);
    EXPECT_TRUE(LoadShape(SaveShape(*thin.Value()).Value()));
}

TEST(ShapeFile, MutableCompoundsGoOnAsBefore) {
    const auto compound = SomeMutableCompound();
    const ShapePtr loaded = LoadShape(SaveShape(*compound).Value()).Value();
    const auto copy = static_cast<const MutableCompound&>(*loaded).Copy();
    EXPECT_EQ(copy->Count(), compound->Count());
    EXPECT_EQ(copy->RelativeMass(), compound->RelativeMass());
    const std::vector<Compound::ChildSettings> children = SomeChildren();
    for (int i = 0; i < 6; ++i) {
        const ChildId id = compound->Add(children[2]).Value();
        EXPECT_EQ(copy->Add(children[2]).Value(), id);
        EXPECT_EQ(SaveShape(*copy).Value(), SaveShape(*compound).Value());
    }
}

TEST(ShapeFile, CustomShapesNeedAFormat) {
    const ShapePtr dome = CreateCustom<Dome>(0.5f, 0.2f).Value();
    const Compound::ChildSettings children[] = {{.shape = dome}, {.shape = dome, .position = {1, 2, 3}}};
    for (const ShapePtr& shape :
         {dome, ShapePtr(Compound::Create(children).Value()), ShapePtr(MutableCompound::Create(children).Value())}) {
        const auto refused = SaveShape(*shape);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.GetError().code, ErrorCode::Unsupported);
        EXPECT_NE(refused.GetError().message.find("custom shape"), std::string::npos);
        const std::vector<uint8_t> bytes = SaveShape(*shape, kFormats).Value();
        const auto unknown = LoadShape(bytes);
        ASSERT_FALSE(unknown);
        EXPECT_EQ(unknown.GetError().code, ErrorCode::Unsupported);
        EXPECT_NE(unknown.GetError().message.find("\"dome\""), std::string::npos);
        const ShapePtr loaded = LoadShape(bytes, kFormats).Value();
        EXPECT_EQ(loaded->OuterRadius(), shape->OuterRadius());
        EXPECT_TRUE(SameBits(loaded->Mass(), shape->Mass()));
        EXPECT_EQ(SaveShape(*loaded, kFormats).Value(), bytes);
    }
    const CustomShapeFormat wrong[] = {{"", WriteDome, ReadDome}};
    EXPECT_EQ(SaveShape(*dome, wrong).GetError().code, ErrorCode::OutOfRange);
    const CustomShapeFormat liar[] = {
        {"dome", WriteDome, [](std::span<const uint8_t>) { return Result<ShapePtr>(ShapePtr()); }}};
    EXPECT_EQ(LoadShape(SaveShape(*dome, liar).Value(), liar).GetError().code, ErrorCode::Unsupported);
}

TEST(ShapeFile, RefusesWhatIsNoShapeFile) {
    const std::vector<uint8_t> bytes = SaveShape(*SomeCompound()).Value();
    EXPECT_EQ(LoadShape({}).GetError().code, ErrorCode::Unsupported);
    std::vector<uint8_t> other = bytes;
    other[0] ^= 1;
    EXPECT_EQ(LoadShape(other).GetError().code, ErrorCode::Unsupported);
    other = bytes;
    other[4] = kShapeFileVersion + 1;
    EXPECT_EQ(LoadShape(other).GetError().code, ErrorCode::Unsupported);
    other = bytes;
    other.push_back(0);
    EXPECT_EQ(LoadShape(other).GetError().code, ErrorCode::Degenerate);
}

TEST(ShapeFile, RefusesEveryDamagedBitAndLength) {
    for (const ShapePtr& shape : {OneOfEach()[2], SomeCompound(), ShapePtr(SomeMutableCompound()), OneOfEach()[15]}) {
        const std::vector<uint8_t> bytes = SaveShape(*shape).Value();
        for (size_t length = 0; length < bytes.size(); ++length)
            EXPECT_FALSE(LoadShape({bytes.data(), length})) << length;
        for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
            std::vector<uint8_t> damaged = bytes;
            damaged[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
            EXPECT_FALSE(LoadShape(damaged)) << bit;
        }
    }
}

// FNV-1a as in the format's description, so that damaged files have valid checksums.
void Seal(std::vector<uint8_t>& bytes) {
    if (bytes.size() < 24) return;
    uint64_t hash = 0xCBF29CE484222325u;
    for (size_t i = 24; i < bytes.size(); ++i) hash = (hash ^ bytes[i]) * 0x100000001B3u;
    const uint64_t length = bytes.size() - 24;
    for (size_t i = 0; i < 8; ++i) {
        bytes[8 + i] = static_cast<uint8_t>(length >> (8 * i));
        bytes[16 + i] = static_cast<uint8_t>(hash >> (8 * i));
    }
}

// Uses a loaded shape in every way that could read out of bounds.
void Exercise(const Shape& shape, SurfaceRandom& random) {
    if (const auto* surface = dynamic_cast<const SurfaceShape*>(&shape)) {
        Bounds box;
        box.lower = Vector3::Constant(-INFINITY);
        box.upper = Vector3::Constant(INFINITY);
        uint32_t count = 0;
        surface->VisitTriangles(box, [&](uint32_t id) {
            ++count;
            EXPECT_TRUE(IsFinite(surface->GetTriangle(id).normal));
        });
        EXPECT_EQ(count, surface->TriangleCount());
        for (int i = 0; i < 5; ++i) {
            SurfaceHit hit;
            const Vector3 origin = random.InBox(10);
            surface->CastRay({origin, random.InBox(30), true}, hit);
        }
    } else if (shape.IsConvex()) {
        EXPECT_TRUE(IsFinite(static_cast<const ConvexShape&>(shape).Support(Vector3(1, 2, 3))));
    } else if (shape.Type() == ShapeType::MutableCompound) {
        const auto compound = static_cast<const MutableCompound&>(shape).Copy();
        compound->Tree().Validate();
        const ShapePtr ball = Sphere::Create(1).Value();
        const auto id = compound->Add({.shape = ball});
        // The mass of what there was may be as large as a float.
        if (id) {
            EXPECT_TRUE(compound->Remove(id.Value(), MassUpdate::Keep));
        }
        const uint32_t count = static_cast<uint32_t>(compound->Children().size());
        for (uint32_t i = 0; i < count; ++i) {
            if (compound->Exists(compound->IdOf(i)) && compound->Count() > 1) {
                EXPECT_TRUE(compound->Remove(compound->IdOf(i), MassUpdate::Keep));
            }
        }
    }
    EXPECT_TRUE(SaveShape(shape));
}

// Bytes overwritten, cut, inserted, numbers replaced by extremes, with a checksum that fits: refused or usable, never a
// crash.
TEST(ShapeFile, SurvivesHostileFiles) {
    std::mt19937 engine(7);
    SurfaceRandom random(7);
    const std::vector<ShapePtr> shapes = OneOfEach();
    const uint32_t extremes[] = {0,          1,          0x7F800000, 0xFF800000, 0x7FC00000,
                                 0xFFFFFFFF, 0x80000000, 0x7F7FFFFF, 0x00000001, 255};
    int loadedCount = 0;
    for (int round = 0; round < 22000; ++round) {
        std::vector<uint8_t> bytes = SaveShape(*shapes[static_cast<size_t>(round) % shapes.size()]).Value();
        const uint32_t changes = 1 + random.Below(3);
        for (uint32_t i = 0; i < changes; ++i) {
            // Half of the changes hit the head of the content, where counts and settings are.
            const uint32_t size = static_cast<uint32_t>(bytes.size());
            const uint32_t at = 24 + random.Below(random.Below(2) == 0 ? std::min(120u, size - 24) : size - 24);
            switch (random.Below(5)) {
                case 0: bytes[at] = static_cast<uint8_t>(engine()); break;
                case 1: bytes[at] ^= static_cast<uint8_t>(1u << random.Below(8)); break;
                case 2: {
                    const uint32_t value = extremes[random.Below(10)];
                    for (uint32_t k = 0; k < 4 && at + k < size; ++k)
                        bytes[at + k] = static_cast<uint8_t>(value >> 8 * k);
                    break;
                }
                case 3:
                    bytes.erase(bytes.begin() + at, bytes.begin() + std::min(size, at + 1 + random.Below(8)));
                    break;
                default: bytes.insert(bytes.begin() + at, static_cast<uint8_t>(engine())); break;
            }
            if (bytes.size() < 30) break;
        }
        if (round % 10 != 0) Seal(bytes);
        const auto loaded = LoadShape(bytes);
        if (!loaded) {
            EXPECT_FALSE(loaded.GetError().message.empty());
            continue;
        }
        ++loadedCount;
        Exercise(*loaded.Value(), random);
    }
    EXPECT_GT(loadedCount, 500);  // changes that leave the file valid
}

}  // namespace
}  // namespace fulcrum
