// Every build must give the same mesh and the same query results, bit by bit.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <gtest/gtest.h>

#include <bit>

namespace fulcrum {
namespace {

class SplitMix {
public:
    float Between(float low, float high) {
        uint64_t z = state_ += 0x9E3779B97F4A7C15u;
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
        z = (z ^ z >> 27) * 0x94D049BB133111EBu;
        return low + (high - low) * static_cast<float>((z ^ z >> 31) >> 40) * 0x1p-24f;
    }
    Vector3 InBox(float half) {
        const float x = Between(-half, half), y = Between(-half, half), z = Between(-half, half);
        return Vector3(x, y, z);
    }

private:
    uint64_t state_ = 1;
};

struct Hash {
    uint64_t value = 0xCBF29CE484222325u;
    void Add(uint32_t x) { value = (value ^ x) * 0x100000001B3u; }
    void Add(float x) { Add(std::bit_cast<uint32_t>(x)); }
    void Add(const Vector3& v) {
        for (int i = 0; i < 3; ++i) Add(v[i]);
    }
};

uint64_t HashOf(const SurfaceShape& shape) {
    Hash hash;
    const std::vector<uint8_t> bytes = SaveShape(shape).Value();
    for (const uint8_t byte : bytes) hash.Add(uint32_t{byte});
    SplitMix random;
    for (int i = 0; i < 2000; ++i) {
        const SurfaceRay ray{random.InBox(15), random.InBox(30), i % 2 == 0};
        SurfaceHit hit;
        if (shape.CastRay(ray, hit)) {
            hash.Add(hit.fraction);
            hash.Add(hit.triangle);
            hash.Add(hit.normal);
        }
        Bounds box;
        box.Include(random.InBox(10));
        box.Include(random.InBox(10));
        shape.VisitTriangles(box, [&](uint32_t id) {
            hash.Add(id);
            hash.Add(uint32_t{shape.GetTriangle(id).activeEdges});
        });
    }
    return hash.value;
}

TEST(SurfaceParity, MeshesAndTheirQueriesHaveTheSameBits) {
    SplitMix random;
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < 400; ++i) vertices.push_back(random.InBox(10));
    for (uint32_t i = 0; i < 1500; ++i) indices.push_back(static_cast<uint32_t>(random.Between(0, 399.5f)));
    TriangleMeshSettings settings;
    settings.vertices = vertices;
    settings.indices = indices;
    const auto mesh = TriangleMesh::Create(settings).Value();
    EXPECT_EQ(HashOf(*mesh), 13954134653063959058u);
    EXPECT_EQ(HashOf(*TriangleMesh::Scaled(*mesh, Vector3(-1, 0.7f, 1.3f)).Value()), 9170053694867493967u);
}

TEST(SurfaceParity, HeightFieldsAndTheirQueriesHaveTheSameBits) {
    SplitMix random;
    std::vector<float> heights;
    for (int i = 0; i < 40 * 30; ++i) heights.push_back(random.Between(-2, 2));
    HeightFieldSettings settings;
    settings.sampleCountX = 40;
    settings.sampleCountZ = 30;
    settings.heights = heights;
    settings.cellSizeX = 0.5f;
    settings.cellSizeZ = 0.6f;
    settings.origin = Vector3(-10, 0, -9);
    EXPECT_EQ(HashOf(*HeightField::Create(settings).Value()), 5941120585074841068u);
    settings.precision = HeightPrecision::Steps16;
    EXPECT_EQ(HashOf(*HeightField::Create(settings).Value()), 4843523400264569436u);
}

}  // namespace
}  // namespace fulcrum
