// Contacts with triangles, culled by lanes and in closed forms, against GJK on each triangle by itself. The triangles
// share no corners, so that every edge counts and none is hidden by another's contact.
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>
#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleSide.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Collision/NarrowPhase/NarrowPhaseTesting.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

namespace fulcrum::testing {
namespace {

constexpr float kReach = 0.1f;
constexpr float kNone = std::numeric_limits<float>::infinity();

std::shared_ptr<const TriangleMesh> Loose(RandomPoses& random, int count, bool isTwoSided) {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (int i = 0; i < count; ++i) {
        const Vector3 middle = random.InCube() * 2.0f;
        for (int k = 0; k < 3; ++k) {
            vertices.push_back(middle + random.InCube());
            indices.push_back(static_cast<uint32_t>(indices.size()));
        }
    }
    return TriangleMesh::Create({.vertices = vertices, .indices = indices, .isTwoSided = isTwoSided}).Value();
}

struct Nearest {
    float separation = kNone;
    bool overlaps = false;  // a core: its depth is another matter
};

// By GJK, of the triangles that have the shape's center before them and the shape's nearest point, too.
Nearest NearestByGjk(const ConvexShape& shape, const TriangleMesh& mesh, const RelativePose& pose) {
    Nearest nearest;
    const Vector3 center = pose.InverseTransform(Vector3::Zero());
    for (uint32_t id = 0; id < mesh.TriangleCount(); ++id) {
        const TriangleView view = mesh.GetTriangle(id);
        Vector3 normal = view.normal;
        if (Dot(normal, Vector3(center - view.vertices[0])) < 0) {
            if (!mesh.IsTwoSided()) continue;
            normal = -normal;
        }
        const Vector3 middle = (view.vertices[0] + view.vertices[1] + view.vertices[2]) * (1.0f / 3.0f);
        const Vector3 corners[3] = {view.vertices[0] - middle, view.vertices[1] - middle, view.vertices[2] - middle};
        const Triangle triangle(corners, view.normal);
        const SupportPair pair(shape, triangle, {pose.Transform(middle), pose.rotation});
        const ConvexGjkResult gjk = ConvexGjk(pair, Normalized(pair.position), 1e3f);
        if (gjk.status == ConvexGjkResult::Status::Overlapping) {
            nearest.overlaps = true;
            continue;
        }
        if (Dot(InverseRotate(pose.rotation, gjk.axis), normal) > 0) continue;
        nearest.separation = std::min(nearest.separation, gjk.separation - pair.RadiusSum());
    }
    return nearest;
}

float Least(const SurfaceContacts& contacts) {
    float least = kNone;
    for (const SurfaceManifold& found : contacts.Manifolds())
        for (int i = 0; i < found.manifold.pointCount; ++i)
            least = std::min(least, found.manifold.points[i].separation);
    return least;
}

void FindsTheNearest(const ConvexShape& shape, const std::string& name,
                     NarrowPhaseMethod method = NarrowPhaseMethod::Automatic) {
    // A face is taken where it is this much nearer than what touches: ContactTolerances::prefer. And rounding.
    constexpr float kTolerance = 0.02f * kReach + 1e-5f;
    RandomPoses random(7);
    SurfaceContacts contacts;
    int touching = 0, apart = 0;
    for (int i = 0; i < 400; ++i) {
        const bool isTwoSided = i % 2 == 1;
        const auto mesh = Loose(random, 1 + i % 20, isTwoSided);
        const Vector3 position = random.InCube() * 2.0f;
        const RelativePose pose{position, random.Rotation()};
        const Nearest expected = NearestByGjk(shape, *mesh, pose);
        if (expected.overlaps) continue;
        CollideSettings settings;
        settings.speculativeDistance = kReach;
        settings.method = method;
        CollideSurface(shape, *mesh, pose, settings, {}, contacts);
        const float least = Least(contacts);
        if (expected.separation > kReach + kTolerance) {
            EXPECT_EQ(least, kNone) << name << " " << i;
            ++apart;
        } else if (expected.separation < kReach - kTolerance) {
            EXPECT_NEAR(least, expected.separation, kTolerance) << name << " " << i << (isTwoSided ? " two-sided" : "");
            ++touching;
        }
    }
    EXPECT_GT(touching, 10) << name;
    EXPECT_GT(apart, 10) << name;
}

TEST(SurfaceContact, ASphereFindsTheNearestTriangle) { FindsTheNearest(*MakeSphere(0.4f), "sphere"); }
TEST(SurfaceContact, ACapsuleFindsTheNearestTriangle) {
    FindsTheNearest(*MakeCapsule(0.3f, 0.3f), "capsule");
    FindsTheNearest(*MakeCapsule(1.5f, 0.05f), "rod");
}
TEST(SurfaceContact, ABoxFindsTheNearestTriangle) {
    FindsTheNearest(*MakeBox(Vector3(0.2f, 0.3f, 0.4f)), "box");
    FindsTheNearest(*MakeBox(Vector3(0.2f, 0.3f, 0.4f), 0.1f), "rounded box");
}
TEST(SurfaceContact, HullsFindTheNearestTriangle) {
    FindsTheNearest(*MakeHull({Vector3(0, 0.5f, 0), Vector3(0.5f, 0, 0), Vector3(-0.5f, 0, 0), Vector3(0, 0, 0.5f),
                               Vector3(0, 0, -0.5f)}),
                    "pyramid");
    FindsTheNearest(*MakeRoundHull(60, 0.4f), "round hull");  // more vertices than go one after the other
    FindsTheNearest(*MakePrism(20, 0.4f, 0.3f), "prism");     // more corners than the triangles' own clipping takes
}
TEST(SurfaceContact, LibccdFindsTheNearestTriangle) {
    const auto find = [](const ConvexPtr& shape, const char* name) {
        FindsTheNearest(*shape, name, NarrowPhaseMethod::Libccd);
    };
    find(MakeSphere(0.4f), "sphere");
    find(MakeCapsule(0.3f, 0.3f), "capsule");
    find(MakeCapsule(1.5f, 0.05f), "rod");
    find(MakeBox(Vector3(0.2f, 0.3f, 0.4f)), "box");
    find(MakeBox(Vector3(0.2f, 0.3f, 0.4f), 0.1f), "rounded box");
    find(MakeRoundHull(60, 0.4f), "round hull");
    find(MakePrism(20, 0.4f, 0.3f), "prism");
    find(MakeEllipsoid(Vector3(0.2f, 0.3f, 0.5f)), "ellipsoid");
}
TEST(SurfaceContact, ACurvedShapeFindsTheNearestTriangle) {
    FindsTheNearest(*MakeEllipsoid(Vector3(0.2f, 0.3f, 0.5f)), "ellipsoid");
}

// What a mesh of one large triangle says of a shape above it, in closed form.
class AboveATriangle : public ::testing::Test {
protected:
    AboveATriangle() {
        const std::vector<Vector3> vertices{Vector3(-5, 0, -5), Vector3(0, 0, 5), Vector3(5, 0, -5)};
        const std::vector<uint32_t> indices{0, 1, 2};
        mesh_ = TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
    }
    // The shape at `position`, turned by `rotation`.
    std::span<const SurfaceManifold> Collide(const ConvexShape& shape, const Vector3& position,
                                             const Quaternion& rotation = {}) {
        CollideSettings settings;
        settings.speculativeDistance = kReach;
        CollideSurface(shape, *mesh_, Inverse(RelativePose{position, rotation}), settings, {}, contacts_);
        return contacts_.Manifolds();
    }
    std::shared_ptr<const TriangleMesh> mesh_;
    SurfaceContacts contacts_;
};

TEST_F(AboveATriangle, ASphereTouchesBelowItsCenter) {
    const auto found = Collide(*MakeSphere(0.5f), Vector3(0.3f, 0.45f, -1));
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].manifold.pointCount, 1);
    EXPECT_NEAR(found[0].manifold.normal.y(), -1, 1e-6);
    EXPECT_NEAR(found[0].manifold.points[0].separation, -0.05, 1e-6);
    EXPECT_NEAR(Length(Vector3(found[0].manifold.points[0].positionOnA - Vector3(0, -0.5f, 0))), 0, 1e-6);
}

// Beyond the side at z = -5, by 0.3, and 0.4 above: half a meter from it, three fifths of the way sideways.
TEST_F(AboveATriangle, ASphereBesideItTouchesItsSide) {
    const auto found = Collide(*MakeSphere(0.55f), Vector3(1, 0.4f, -5.3f));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].manifold.normal.y(), -0.8, 1e-6);
    EXPECT_NEAR(found[0].manifold.normal.z(), 0.6, 1e-6);
    EXPECT_NEAR(found[0].manifold.points[0].separation, -0.05, 1e-6);
}

TEST_F(AboveATriangle, ALyingCapsuleHasTwoPointsAndAStandingOneOne) {
    const auto capsule = MakeCapsule(0.6f, 0.2f);
    const float h = std::sqrt(0.5f);
    auto found = Collide(*capsule, Vector3(0, 0.21f, 0), {h, 0, 0, h});
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].manifold.pointCount, 2);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(found[0].manifold.points[i].separation, 0.01, 1e-6);
    EXPECT_NE(found[0].manifold.points[0].feature, found[0].manifold.points[1].feature);
    found = Collide(*capsule, Vector3(0, 0.79f, 0));
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].manifold.pointCount, 1);
    EXPECT_NEAR(found[0].manifold.points[0].separation, -0.01, 1e-6);
}

// Along the side at z = -5, beyond it by 0.03 and 0.04 above: 0.05 away on its whole length.
TEST_F(AboveATriangle, ACapsuleAlongASideHasTwoPoints) {
    const float h = std::sqrt(0.5f);
    const Quaternion rotation{0, 0, h, h};
    const auto found = Collide(*MakeCapsule(0.6f, 0.1f), Vector3(0, 0.04f, -5.03f), rotation);
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].manifold.pointCount, 2);
    EXPECT_NEAR(Rotate(rotation, found[0].manifold.normal).y(), -0.8, 1e-5);
    for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(found[0].manifold.points[i].separation, -0.05, 1e-6);
        EXPECT_NEAR(std::fabs(found[0].manifold.points[i].positionOnA.y()), 0.6, 1e-5);
    }
}

TEST_F(AboveATriangle, ACapsuleOverItsSideIsCutThere) {
    const float h = std::sqrt(0.5f);
    // Along z from -5.6 to -4.4: from the side on it lies before the face, level.
    const Quaternion rotation{h, 0, 0, h};
    const auto found = Collide(*MakeCapsule(0.6f, 0.1f), Vector3(0, 0.1f, -5), rotation);
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].manifold.pointCount, 2);
    EXPECT_NEAR(Rotate(rotation, found[0].manifold.normal).y(), -1, 1e-6);
    float ends[2] = {found[0].manifold.points[0].positionOnA.y(), found[0].manifold.points[1].positionOnA.y()};
    if (ends[0] > ends[1]) std::swap(ends[0], ends[1]);
    // The capsule's y runs along z.
    EXPECT_NEAR(ends[0], 0, 1e-5);
    EXPECT_NEAR(ends[1], 0.6, 1e-5);
}

TEST_F(AboveATriangle, ABoxHasFourPointsAndFewerOverASide) {
    const auto box = MakeBox(Vector3(0.2f, 0.3f, 0.4f));
    auto found = Collide(*box, Vector3(0, 0.31f, 0));
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].manifold.pointCount, 4);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(found[0].manifold.points[i].separation, 0.01, 1e-6);
    found = Collide(*box, Vector3(0, 0.31f, -5));
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].manifold.pointCount, 4);
    for (int i = 0; i < 4; ++i) EXPECT_GT(found[0].manifold.points[i].positionOnA.z(), -1e-5f);
}

// A sheet of two triangles that face up. A ball of 5 cm is pressed through it, and slips to the neighbor of the
// triangle that it touched.
TEST(SurfaceContact, WhatWasPressedThroughAFaceIsPushedBackByItsNeighbor) {
    const std::vector<Vector3> vertices = {{0, 0, 0}, {0, 0, 2}, {2, 0, 2}, {2, 0, 0}};
    const std::vector<uint32_t> up = {0, 1, 2, 0, 2, 3}, upAndDown = {0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0};
    const float radius = 0.05f;
    const std::shared_ptr<const Sphere> ball = Sphere::Create(radius).Value();
    SurfaceContacts contacts;
    // Over the second triangle. touched: a point of the triangle that it touched, in the sheet's plane.
    const auto collide = [&](const std::vector<uint32_t>& indices, float height, std::optional<Vector3> touched) {
        const auto sheet = TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
        const Vector3 center = sheet->Mass().centerOfMass, place = Vector3(1.2f, height, 0.8f) - center;
        std::vector<uint32_t> ids;
        for (uint32_t id = 0; touched && id < sheet->TriangleCount(); ++id) {
            const TriangleView view = sheet->GetTriangle(id);
            if (view.normal.y() > 0 && IsOver(view, *touched - center, 0)) ids.push_back(id);
        }
        EXPECT_EQ(ids.size(), touched ? 1u : 0u);
        CollideSurface(*ball, *sheet, {-place, Quaternion()}, {.speculativeDistance = kReach}, {.touched = ids},
                       contacts);
        return contacts.Manifolds();
    };
    const Vector3 here(1.2f, 0, 0.8f), neighbor(0.8f, 0, 1.2f);
    EXPECT_TRUE(collide(up, -0.01f, {}).empty()) << "what comes from behind passes";
    for (const Vector3& touched : {here, neighbor}) {
        const auto found = collide(up, -0.01f, touched);
        ASSERT_EQ(found.size(), 1u);
        EXPECT_NEAR(found[0].manifold.normal.y(), -1, 1e-5f);
        EXPECT_NEAR(found[0].manifold.points[0].separation, -radius - 0.01f, 1e-4f);
    }
    // The back of a thin wall is no neighbor of its front, though they share corners.
    const auto found = collide(upAndDown, 0.04f, here);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].manifold.normal.y(), -1, 1e-5f);
    EXPECT_NEAR(found[0].manifold.points[0].separation, -0.01f, 1e-5f);
}

}  // namespace
}  // namespace fulcrum::testing
