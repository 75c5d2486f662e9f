// Helpers of the tests of the queries: shapes given by a support function alone, a surface without a tree, and
// independent reference measures.
#pragma once

#include <Fulcrum/UnitTests/Collision/NarrowPhase/NarrowPhaseTesting.h>

#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <gtest/gtest.h>

namespace fulcrum::testing {

// Curved everywhere. For EnterBySupport and the casts; it is not in the pair table.
class RoundedEllipsoid final : public ConvexShape {
public:
    explicit RoundedEllipsoid(const Vector3& radii, float rounding = 0)
        : ConvexShape(ShapeType::Custom), radii_(radii) {
        convexRadius_ = rounding;
        innerRadius_ = radii.minCoeff() + rounding;
        outerRadius_ = radii.maxCoeff() + rounding;
        bounds_.upper = radii + Vector3::Constant(rounding);
        bounds_.lower = -bounds_.upper;
    }
    Vector3 SupportCore(const Vector3& d) const override {
        const Vector3 scaled = d.cwiseProduct(radii_);
        return scaled.cwiseProduct(radii_) * (1.0f / Length(scaled));
    }

private:
    Vector3 radii_;
};

inline std::vector<NamedShape> QueryShapes() {
    return {{"sphere", MakeSphere(0.5f)},
            {"box", MakeBox(Vector3(0.5f, 0.4f, 0.7f))},
            {"rounded box", MakeBox(Vector3(0.5f, 0.4f, 0.7f), 0.1f)},
            {"capsule", MakeCapsule(0.5f, 0.25f)},
            {"hull", MakeRoundHull(32, 0.6f)},
            {"prism", MakePrism(8, 0.5f, 0.4f)},
            {"plank", MakeBox(Vector3(3, 0.01f, 0.5f))}};
}

// Brute force over a list of triangles, in double where it matters.
class TriangleList final : public SurfaceShape {
public:
    explicit TriangleList(const std::vector<std::array<Vector3, 3>>& triangles, bool isTwoSided = false)
        : SurfaceShape(ShapeType::TriangleMesh), triangles_(triangles) {
        isTwoSided_ = isTwoSided;
        for (const auto& t : triangles)
            for (const Vector3& v : t) {
                bounds_.Include(v);
                outerRadius_ = std::max(outerRadius_, Length(v));
            }
    }
    uint32_t TriangleIdEnd() const override { return static_cast<uint32_t>(triangles_.size()); }
    uint32_t TriangleCount() const override { return TriangleIdEnd(); }
    TriangleView GetTriangle(uint32_t id) const override {
        TriangleView view{};
        for (int i = 0; i < 3; ++i) view.vertices[i] = triangles_[id][static_cast<size_t>(i)];
        view.normal =
            Normalized(Cross<float>(view.vertices[1] - view.vertices[0], view.vertices[2] - view.vertices[0]));
        view.id = id;
        return view;
    }
    void GetTriangles(std::span<const uint32_t> ids, TriangleView* views) const override {
        for (size_t i = 0; i < ids.size(); ++i) views[i] = GetTriangle(ids[i]);
    }
    bool CastRay(const SurfaceRay& ray, SurfaceHit& hit, float maxFraction) const override {
        bool found = false;
        for (uint32_t id = 0; id < TriangleIdEnd(); ++id) {
            SurfaceHit here;
            if (!HitTriangle(ray, id, here, maxFraction) || (found && here.fraction >= hit.fraction)) continue;
            found = true;
            hit = here;
        }
        return found;
    }
    bool IsHit(const SurfaceRay& ray, float maxFraction) const override {
        SurfaceHit hit;
        return CastRay(ray, hit, maxFraction);
    }
    size_t MemoryUsed() const override { return sizeof(*this); }

private:
    void SearchBox(const Bounds& box, void* context, BatchFunction found) const override {
        for (uint32_t id = 0; id < TriangleIdEnd(); ++id) {
            Bounds b;
            for (const Vector3& v : triangles_[id]) b.Include(v);
            if (b.Overlaps(box)) found(context, &id, 1);
        }
    }
    void SearchNear(const Bounds&, const float& maxDistance, void* context, BatchFunction found) const override {
        for (uint32_t id = 0; id < TriangleIdEnd() && maxDistance >= 0; ++id) found(context, &id, 1);
    }
    void SearchRay(const SurfaceRay& ray, float maxFraction, void* context, HitFunction found) const override {
        for (uint32_t id = 0; id < TriangleIdEnd(); ++id) {
            SurfaceHit hit;
            if (HitTriangle(ray, id, hit, maxFraction) && !found(context, hit)) return;
        }
    }
    bool HitTriangle(const SurfaceRay& ray, uint32_t id, SurfaceHit& hit, float maxFraction) const {
        const Position o = ray.origin.cast<double>(), d = ray.displacement.cast<double>();
        const Position a = triangles_[id][0].cast<double>(), b = triangles_[id][1].cast<double>(),
                       c = triangles_[id][2].cast<double>();
        const Position n = Cross<double>(b - a, c - a);
        const double speed = Dot<double>(n, d);
        const bool back = speed > 0;
        if (speed == 0 || (back && !isTwoSided_ && !ray.backFaces)) return false;
        const double t = Dot<double>(n, Position(a - o)) / speed;
        if (!(t >= 0 && t <= double{maxFraction})) return false;
        const Position p = o + d * t;
        const auto inside = [&](const Position& from, const Position& to) {
            return Dot<double>(n, Cross<double>(Position(to - from), Position(p - from))) >= 0;
        };
        if (!inside(a, b) || !inside(b, c) || !inside(c, a)) return false;
        const Vector3 normal = GetTriangle(id).normal;
        hit = {static_cast<float>(t), id, back ? Vector3(-normal) : normal, back};
        return true;
    }

    std::vector<std::array<Vector3, 3>> triangles_;
};

// A square of 2 n n triangles in the x-z plane, y up, heights by a function.
template <class Height>
std::shared_ptr<TriangleList> MakeTerrain(int n, float cell, const Height& height, bool isTwoSided = false) {
    std::vector<std::array<Vector3, 3>> triangles;
    const auto at = [&](int i, int k) {
        const float x = (static_cast<float>(i) - 0.5f * static_cast<float>(n)) * cell,
                    z = (static_cast<float>(k) - 0.5f * static_cast<float>(n)) * cell;
        return Vector3(x, height(x, z), z);
    };
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
            triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
            triangles.push_back({at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)});
        }
    return std::make_shared<TriangleList>(triangles, isTwoSided);
}

inline std::shared_ptr<const Compound> MakeCompound(RandomPoses& random, int count, float spread) {
    std::vector<Compound::ChildSettings> children;
    const std::vector<NamedShape> shapes = QueryShapes();
    for (int i = 0; i < count; ++i)
        children.push_back({shapes[static_cast<size_t>(i) % (shapes.size() - 1)].shape, random.InCube() * spread,
                            random.Rotation(), 1});
    return Compound::Create(children).Value();
}

}  // namespace fulcrum::testing
