#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/UnitTests/Collision/Shapes/SurfaceChecks.h>

#include <cmath>
#include <limits>

namespace fulcrum {
namespace {

using FieldPtr = std::shared_ptr<HeightField>;

struct Samples {
    uint32_t countX, countZ;
    std::vector<float> heights;
    std::vector<uint8_t> cells;

    HeightFieldSettings Settings() const {
        HeightFieldSettings settings;
        settings.sampleCountX = countX;
        settings.sampleCountZ = countZ;
        settings.heights = heights;
        settings.cells = cells;
        settings.cellSizeX = 1.5f;
        settings.cellSizeZ = 0.7f;
        settings.origin = Vector3(-10, 3, 4);
        return settings;
    }
};

Samples Waves(uint32_t countX, uint32_t countZ, float height) {
    Samples samples{countX, countZ, {}, {}};
    for (uint32_t z = 0; z < countZ; ++z)
        for (uint32_t x = 0; x < countX; ++x)
            samples.heights.push_back(height * static_cast<float>(std::sin(0.7 * x) * std::cos(0.4 * z)));
    return samples;
}

Samples WithHoles(Samples samples, uint32_t every) {
    for (uint32_t i = 0; i < (samples.countX - 1) * (samples.countZ - 1); ++i)
        samples.cells.push_back(i % every == 0 ? kHoleCell : static_cast<uint8_t>(i % 5));
    return samples;
}

TEST(HeightField, SearchesAreExact) {
    const FieldPtr field = HeightField::Create(Waves(14, 21, 2).Settings()).Value();
    ExpectExactBoxes(*field, 50000, 4);
    ExpectExactRays(*field, 50000);
}

TEST(HeightField, SearchesAreExactWithHolesAndSteps) {
    const Samples samples = WithHoles(Waves(12, 19, 3), 3);
    HeightFieldSettings settings = samples.Settings();
    settings.precision = HeightPrecision::Steps16;
    settings.isTwoSided = true;
    const FieldPtr field = HeightField::Create(settings).Value();
    const uint32_t holes = 11 * 18 / 3;
    EXPECT_EQ(field->TriangleCount(), 2 * (11 * 18 - holes));
    ExpectExactBoxes(*field, 50000, 4);
    ExpectExactRays(*field, 50000);
}

TEST(HeightField, LargeAndThinOnesAreSearchedExactly) {
    ExpectExactRays(*HeightField::Create(Waves(2, 400, 1).Settings()).Value(), 2000);
    ExpectExactRays(*HeightField::Create(Waves(100, 100, 8).Settings()).Value(), 400);
    ExpectExactBoxes(*HeightField::Create(Waves(100, 100, 8).Settings()).Value(), 200, 40);
}

TEST(HeightField, FindsWhatIsNear) {
    ExpectNearTriangles(*HeightField::Create(Waves(14, 21, 2).Settings()).Value(), 3000, 4);
    const Samples samples = WithHoles(Waves(12, 19, 3), 3);
    ExpectNearTriangles(*HeightField::Create(samples.Settings()).Value(), 3000, 4);
    ExpectNearTriangles(*HeightField::Create(Waves(2, 400, 1).Settings()).Value(), 300, 40);
    ExpectNearTriangles(*HeightField::Create(Waves(100, 100, 8).Settings()).Value(), 100, 40);
}

TEST(HeightField, StepsAreWithinHalfAStepOfWhatWasSet) {
    const Samples samples = Waves(20, 20, 5);
    HeightFieldSettings settings = samples.Settings();
    settings.precision = HeightPrecision::Steps16;
    settings.lowestHeight = -8;
    settings.highestHeight = 8;
    const FieldPtr field = HeightField::Create(settings).Value();
    // Half a step, and the rounding of heights of up to 8 m: 2^-21 m each way.
    const double tolerance = 0.5 * 16 / 65535 + 0x1p-20;
    for (uint32_t z = 0; z < 20; ++z)
        for (uint32_t x = 0; x < 20; ++x)
            EXPECT_NEAR(double{field->Height(x, z)}, double{samples.heights[z * 20 + x]}, tolerance);
}

// 2 or 4 bytes a sample, a byte a cell where there are materials or holes, and at most 0.3 for the ranges of the
// blocks.
TEST(HeightField, TakesLittleMoreThanItsSamples) {
    const Samples plain = Waves(257, 257, 2), holes = WithHoles(Waves(257, 257, 2), 9);
    HeightFieldSettings settings = plain.Settings();
    const double samples = 257.0 * 257;
    EXPECT_LE(static_cast<double>(HeightField::Create(settings).Value()->MemoryUsed()) / samples, 4.3);
    settings.precision = HeightPrecision::Steps16;
    EXPECT_LE(static_cast<double>(HeightField::Create(settings).Value()->MemoryUsed()) / samples, 2.3);
    settings.cells = holes.cells;
    EXPECT_LE(static_cast<double>(HeightField::Create(settings).Value()->MemoryUsed()) / samples, 3.3);
}

// The heights before the last edits: 12 bytes a sample, however many edits there were, of all or of parts.
TEST(HeightField, KeepsFewOldHeights) {
    const Samples plain = Waves(257, 257, 2);
    const std::shared_ptr<HeightField> field = HeightField::Create(plain.Settings()).Value();
    const size_t before = field->MemoryUsed(), samples = size_t{257} * 257;
    for (int i = 1; i <= 20; ++i) {
        const std::vector<float> heights(samples, static_cast<float>(i));
        ASSERT_TRUE(field->SetHeights(0, 0, 257, 257, heights));
    }
    EXPECT_LE(field->MemoryUsed() - before, 12 * samples + 10000);
    for (uint32_t i = 0; i < 5000; ++i)
        ASSERT_TRUE(field->SetHeights(i % 250, i / 250, 3, 3, std::vector<float>(9, static_cast<float>(i))));
    EXPECT_LE(field->MemoryUsed() - before, 12 * samples + 300000);
}

TEST(HeightField, RaysFallThroughHolesAlone) {
    Samples samples = Waves(9, 9, 0);
    samples.cells.assign(64, 0);
    samples.cells[3 * 8 + 4] = kHoleCell;
    HeightFieldSettings settings = samples.Settings();
    settings.origin = Vector3::Zero();
    settings.cellSizeX = settings.cellSizeZ = 1;
    const FieldPtr field = HeightField::Create(settings).Value();
    EXPECT_TRUE(field->IsHole(4, 3));
    for (uint32_t z = 0; z < 8; ++z) {
        for (uint32_t x = 0; x < 8; ++x) {
            const SurfaceRay ray{Vector3(static_cast<float>(x) + 0.3f, 1, static_cast<float>(z) + 0.4f),
                                 Vector3(0, -2, 0)};
            EXPECT_EQ(field->IsHit(ray), x != 4 || z != 3) << x << ' ' << z;
        }
    }
    // Grid lines belong to the cells on both sides.
    EXPECT_TRUE(field->IsHit({Vector3(4, 1, 3.5f), Vector3(0, -2, 0)}));
    EXPECT_TRUE(field->IsHit({Vector3(5, 1, 4), Vector3(0, -2, 0)}));
    EXPECT_FALSE(field->IsHit({Vector3(4.5f, 1, 3.5f), Vector3(0, -2, 0)}));
}

// Against the triangle mesh of the same triangles: same corners, same active edges.
TEST(HeightField, HasTheActiveEdgesOfTheSameMesh) {
    const Samples samples = WithHoles(Waves(23, 17, 1.5f), 11);
    for (const bool isTwoSided : {false, true}) {
        HeightFieldSettings settings = samples.Settings();
        settings.isTwoSided = isTwoSided;
        const FieldPtr field = HeightField::Create(settings).Value();
        IndexedTriangles triangles;
        for (uint32_t z = 0; z < 17; ++z)
            for (uint32_t x = 0; x < 23; ++x) triangles.vertices.push_back(field->Vertex(x, z));
        std::vector<uint32_t> ids;
        for (const TriangleView& t : AllTriangles(*field)) {
            EXPECT_GT(t.normal.y(), 0);
            ids.push_back(t.id);
            triangles.indices.insert(triangles.indices.end(), {t.vertexIds[0], t.vertexIds[1], t.vertexIds[2]});
        }
        TriangleMeshSettings meshSettings = triangles.Settings();
        meshSettings.isTwoSided = isTwoSided;
        meshSettings.keepSourceTriangles = true;
        const auto mesh = TriangleMesh::Create(meshSettings).Value();
        ASSERT_EQ(mesh->TriangleCount(), field->TriangleCount());
        for (uint32_t id = 0; id < mesh->TriangleCount(); ++id) {
            const TriangleView t = mesh->GetTriangle(id), u = field->GetTriangle(ids[mesh->SourceTriangle(id)]);
            EXPECT_EQ(t.activeEdges, u.activeEdges) << u.id;
            EXPECT_EQ(t.normal, u.normal);
        }
    }
}

TEST(HeightField, EditsChangeWhatTheySay) {
    Samples samples = Waves(40, 33, 1);
    const FieldPtr field = HeightField::Create(samples.Settings()).Value();
    SurfaceRandom random(4);
    for (int round = 0; round < 40; ++round) {
        const uint32_t x0 = random.Below(40), z0 = random.Below(33);
        const uint32_t countX = 1 + random.Below(40 - x0), countZ = 1 + random.Below(33 - z0);
        std::vector<float> heights;
        for (uint32_t i = 0; i < countX * countZ; ++i) heights.push_back(random.Between(-3, 3));
        Bounds moved;
        const auto includeSamples = [&] {
            for (uint32_t z = z0; z < z0 + countZ; ++z)
                for (uint32_t x = x0; x < x0 + countX; ++x) moved.Include(field->Vertex(x, z));
        };
        includeSamples();
        const Result<Bounds> changed = field->SetHeights(x0, z0, countX, countZ, heights);
        ASSERT_TRUE(changed);
        includeSamples();
        EXPECT_TRUE(changed.Value().Contains(moved));
        for (uint32_t z = 0; z < countZ; ++z)
            for (uint32_t x = 0; x < countX; ++x) samples.heights[(z0 + z) * 40 + x0 + x] = heights[z * countX + x];
        // As if created again: earlier contents have no effect.
        const FieldPtr fresh = HeightField::Create(samples.Settings()).Value();
        EXPECT_EQ(field->LocalBounds().lower, fresh->LocalBounds().lower);
        EXPECT_EQ(field->LocalBounds().upper, fresh->LocalBounds().upper);
        for (int i = 0; i < 50; ++i) {
            const SurfaceRay ray{random.InBounds(field->LocalBounds()) + Vector3(0, 5, 0),
                                 Vector3(random.Between(-9, 9), -20, 1)};
            SurfaceHit a, b;
            ASSERT_EQ(field->CastRay(ray, a), fresh->CastRay(ray, b));
            ASSERT_EQ(a.fraction, b.fraction);
            ASSERT_EQ(a.triangle, b.triangle);
        }
    }
    ExpectExactBoxes(*field, 1000, 3);
    ExpectExactRays(*field, 1000);
}

TEST(HeightField, CellsCanBeCutAndFilled) {
    const FieldPtr field = HeightField::Create(Waves(20, 20, 1).Settings()).Value();
    const std::vector<uint8_t> holes(6, kHoleCell), ground(6, 2);
    const Result<Bounds> cut = field->SetCells(5, 7, 3, 2, holes);
    ASSERT_TRUE(cut);
    EXPECT_EQ(cut.Value().lower.x(), field->Vertex(5, 7).x());
    EXPECT_EQ(cut.Value().upper.z(), field->Vertex(5, 9).z());
    EXPECT_EQ(field->TriangleCount(), 2 * (19u * 19 - 6));
    ExpectExactBoxes(*field, 2000, 3);
    ASSERT_TRUE(field->SetCells(5, 7, 3, 2, ground));
    EXPECT_EQ(field->TriangleCount(), 2 * 19u * 19);
    EXPECT_EQ(field->GetTriangle(2 * (7 * 19 + 5)).material, 2);
}

TEST(HeightField, RefusesBadInputAndChangesNothing) {
    const auto codeOf = [](const HeightFieldSettings& settings) {
        const auto field = HeightField::Create(settings);
        EXPECT_FALSE(field);
        return field ? ErrorCode::UnknownId : field.GetError().code;
    };
    Samples samples = Waves(5, 5, 1);
    HeightFieldSettings s = samples.Settings();
    s.sampleCountX = 1;
    EXPECT_EQ(codeOf(s), ErrorCode::OutOfRange);
    s = samples.Settings();
    s.sampleCountX = s.sampleCountZ = 0xFFFFFFFF;
    EXPECT_EQ(codeOf(s), ErrorCode::OutOfRange);
    s = samples.Settings();
    s.sampleCountZ = 6;
    EXPECT_EQ(codeOf(s), ErrorCode::OutOfRange);
    s = samples.Settings();
    s.cellSizeX = 0;
    EXPECT_EQ(codeOf(s), ErrorCode::NonPositive);
    s.cellSizeX = NAN;
    EXPECT_EQ(codeOf(s), ErrorCode::NonFinite);
    s = samples.Settings();
    s.origin.x() = 1e9f;  // floats there are 64 m apart
    EXPECT_EQ(codeOf(s), ErrorCode::OutOfRange);
    s = samples.Settings();
    s.precision = HeightPrecision::Steps16;
    s.lowestHeight = 0;
    s.highestHeight = 0.5f;
    EXPECT_EQ(codeOf(s), ErrorCode::OutOfRange);
    s = samples.Settings();
    const std::vector<uint8_t> holes(16, kHoleCell), two(16, 2);
    s.cells = holes;
    EXPECT_EQ(codeOf(s), ErrorCode::Degenerate);
    s.cells = two;
    const std::vector<SurfaceMaterial> palette(2);
    s.materials = palette;
    EXPECT_EQ(codeOf(s), ErrorCode::OutOfRange);

    const FieldPtr field = HeightField::Create(samples.Settings()).Value();
    const std::vector<float> bad = {1, NAN}, good = {1, 2};
    EXPECT_EQ(field->SetHeights(0, 0, 2, 1, bad).GetError().code, ErrorCode::NonFinite);
    EXPECT_EQ(field->SetHeights(4, 0, 2, 1, good).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(field->SetHeights(0xFFFFFFFF, 0, 2, 1, good).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(field->SetHeights(0, 0, 1, 1, good).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(field->Height(0, 0), samples.heights[0]);
    samples.heights[7] = NAN;
    EXPECT_NE(HeightField::Create(samples.Settings()).GetError().message.find("height 7"), std::string::npos);
}

}  // namespace
}  // namespace fulcrum
