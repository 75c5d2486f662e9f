#include <Fulcrum/Collision/NarrowPhase/TriangleBatch.h>

#include <Fulcrum/Collision/Shapes/Primitives.h>

#include <bit>

namespace fulcrum {

namespace {

using Lanes = TriangleLanes;
using Vector = Vec3<TriangleLanes>;

// The largest product with any vertex: directions in lanes, one vertex after another.
Lanes FarthestOfFew(const Polyhedron& core, const Vector& direction) {
    const auto value = [&](int i) {
        return direction.x() * Lanes(core.x[i]) + direction.y() * Lanes(core.y[i]) + direction.z() * Lanes(core.z[i]);
    };
    Lanes most = value(0);
    for (int i = 1; i < core.vertexCount; ++i) most = Max(most, value(i));
    return most;
}

}  // namespace

Lanes SurfaceProbe::Extent(const Vector& d, uint32_t lanes) const {
    // Up to this many vertices, FarthestOfFew is faster than one vectorized search per direction.
    constexpr int kFew = 24;
    if (core && core->vertexCount == 1) return Lanes(0.0f);
    Vector direction;
    for (int k = 0; k < 3; ++k)
        direction[k] = Lanes(axes.x[k]) * d.x() + Lanes(axes.y[k]) * d.y() + Lanes(axes.z[k]) * d.z();
    if (core && core->vertexCount == 2) return Abs(direction.y()) * Lanes(core->vertices[1].y());
    if (core && shape.Type() == ShapeType::Box) {
        const Vector3& half = core->vertices[7];
        return Abs(direction.x()) * Lanes(half.x()) + Abs(direction.y()) * Lanes(half.y()) +
               Abs(direction.z()) * Lanes(half.z());
    }
    if (core && core->vertexCount <= kFew) return FarthestOfFew(*core, direction);
    Lanes extent(0.0f);
    for (uint32_t bits = lanes; bits != 0; bits &= bits - 1) {
        const int lane = std::countr_zero(bits);
        const Vector3 one = LaneOf(direction, lane);
        extent.Set(lane, core ? FarthestVertex(*core, one).value : Dot(one, shape.SupportCore(one)));
    }
    return extent;
}

void TriangleBatch::Load(const SurfaceProbe& probe, const TriangleView* views) {
    const float* rows[4][8];
    for (int i = 0; i < 8; ++i) {
        const TriangleView& view = views[i < count ? i : 0];
        for (int k = 0; k < 3; ++k) rows[k][i] = view.vertices[k].data();
        rows[3][i] = view.normal.data();
    }
    Lanes columns[3];
    for (int k = 0; k < 3; ++k) {
        GatherPoints<8>(rows[k], columns);
        for (int axis = 0; axis < 3; ++axis) corners[k][axis] = columns[axis] - Lanes(probe.center[axis]);
    }
    GatherPoints<8>(rows[3], columns);
    for (int axis = 0; axis < 3; ++axis) normal[axis] = columns[axis];
}

// The projection of the center if it is inside the triangle, otherwise on the nearest side.
void TriangleBatch::FindClosest() {
    const auto inside = (beyond[0] <= Lanes(0.0f)) & (beyond[1] <= Lanes(0.0f)) & (beyond[2] <= Lanes(0.0f));
    Lanes least(0.0f);
    for (int i = 0; i < 3; ++i) {
        const Vector along = corners[(i + 1) % 3] - corners[i];
        const Lanes t =
            Clamp(-Along(corners[i], along) / Max(length[i] * length[i], Lanes(1e-30f)), Lanes(0.0f), Lanes(1.0f));
        const Vector point = corners[i] + along * t;
        const Lanes squared = Along(point, point);
        const auto closer = squared < least;
        for (int axis = 0; axis < 3; ++axis)
            closest[axis] = i == 0 ? point[axis] : Select(closer, point[axis], closest[axis]);
        least = i == 0 ? squared : Min(least, squared);
    }
    for (int axis = 0; axis < 3; ++axis) closest[axis] = Select(inside, -(normal[axis] * height), closest[axis]);
    distance = Select(inside, height, Sqrt(least));
}

uint32_t TriangleBatch::FindInReach(const SurfaceProbe& probe, const TriangleView* views, int viewCount,
                                    uint32_t& reversed) {
    count = viewCount;
    Load(probe, views);
    const ConvexShape& shape = probe.shape;
    const Lanes radius(shape.OuterRadius() + probe.reach), coreReach(shape.ConvexRadius() + probe.reach);
    height = -Along(normal, corners[0]);
    const auto behind = height < Lanes(0.0f);
    reversed = 0;
    Lanes sign(1.0f);
    if (probe.twoSided) {
        reversed = behind.ToBits();
        sign = Select(behind, Lanes(-1.0f), sign);
        height = height * sign;
    }
    auto near = (height >= Lanes(0.0f)) & (height <= radius);
    for (int i = 0; i < 3; ++i) {
        const Vector side = corners[(i + 1) % 3] - corners[i];
        outwards[i] = Cross<Lanes>(side, normal);
        length[i] = Sqrt(Along(outwards[i], outwards[i]));
        beyond[i] = -Along(outwards[i], corners[i]);
        near = near & (beyond[i] <= radius * length[i]);
    }
    const uint32_t all = (1u << count) - 1u;
    uint32_t bits = near.ToBits() & all;
    if (bits == 0) return 0;
    normal = normal * sign;
    separation = height - probe.Extent(-normal, bits);
    near = near & (separation <= coreReach);
    // Separating axis test: planes through a side, perpendicular to the face.
    const Lanes inner(shape.InnerRadius());
    for (int i = 0; i < 3; ++i) {
        const auto outside = beyond[i] > inner * length[i];
        const uint32_t asked = outside.ToBits() & bits;
        if (asked == 0) continue;
        near = near & (~outside | (beyond[i] - probe.Extent(-outwards[i], asked) <= coreReach * length[i]));
    }
    bits &= near.ToBits();
    if (bits == 0) return 0;
    // And the plane through the point closest to the center, perpendicular to the line to it.
    FindClosest();
    near = near & ((distance * distance) - probe.Extent(closest, bits) <= coreReach * distance);
    return bits & near.ToBits();
}

void TriangleBatch::Extract(int lane, bool isReversed, const Matrix3& axes, Vector3 (&itsCorners)[3],
                            Vector3 (&itsOutwards)[3]) const {
    // Reversed, corners 2, 1, 0; the sides between those.
    constexpr int kCorners[2][3] = {{0, 1, 2}, {2, 1, 0}}, kSides[2][3] = {{0, 1, 2}, {1, 0, 2}};
    for (int i = 0; i < 3; ++i) {
        const int side = kSides[isReversed][i];
        const float itsLength = length[side][lane];
        itsCorners[i] = axes * LaneOf(corners[kCorners[isReversed][i]], lane);
        itsOutwards[i] = axes * Vector3(LaneOf(outwards[side], lane) * (itsLength > 1e-12f ? 1.0f / itsLength : 0.0f));
    }
}

}  // namespace fulcrum
