#include <Fulcrum/Collision/NarrowPhase/RoundTriangles.h>

#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/Segments.h>

namespace fulcrum {

namespace {

using Lanes = TriangleLanes;
using Vector = Vec3<TriangleLanes>;

Vector Spread(const Vector3& v) { return Vector(Lanes(v.x()), Lanes(v.y()), Lanes(v.z())); }

}  // namespace

void WriteBallContact(const Vector3& normal, float distance, float radius, Manifold& manifold) {
    manifold.normal = normal;
    manifold.pointCount = 1;
    manifold.points[0] = {normal * radius, distance - radius, VertexFeature(true, 0)};
}

SegmentContact::SegmentContact(const SurfaceProbe& probe, const TriangleBatch& batch, uint32_t asked, float slop)
    : probe_(probe),
      batch_(batch),
      halfHeight_(probe.core->vertices[1].y()),
      radius_(probe.core->radius),
      half_(probe.axes.TransposeMultiply(probe.core->vertices[1])) {
    const Lanes rise = Along(batch.normal, Spread(half_));
    lowHeight_ = batch.height - rise;
    highHeight_ = batch.height + rise;
    crossing = ((lowHeight_ < Lanes(0.0f)) | (highHeight_ < Lanes(0.0f))).ToBits() & asked;
    Clip(batch, slop);
    before &= asked & ~crossing;
    onFace &= before;
    onSide = 0;
    if (const uint32_t left = asked & ~(onFace | crossing)) FindSide(batch, left);
}

// Clips the segment by each side. Ends less than the slop beyond a side are kept.
void SegmentContact::Clip(const TriangleBatch& batch, float slop) {
    from_ = Lanes(0.0f);
    to_ = Lanes(1.0f);
    fromSide_ = toSide_ = Lanes(-1.0f);
    auto cut = from_ > to_;
    for (int i = 0; i < 3; ++i) {
        const Lanes rise = Along(batch.outwards[i], Spread(half_)), allowed = Lanes(slop) * batch.length[i];
        const Lanes low = batch.beyond[i] - rise, high = batch.beyond[i] + rise;
        const auto cutsLow = low > allowed, cutsHigh = high > allowed;
        cut = cut | (cutsLow & cutsHigh);
        const Lanes t = Clamp(low / (low - high), Lanes(0.0f), Lanes(1.0f));
        const auto later = cutsLow & (t > from_), earlier = cutsHigh & (t < to_);
        from_ = Select(later, t, from_);
        fromSide_ = Select(later, Lanes(static_cast<float>(i)), fromSide_);
        to_ = Select(earlier, t, to_);
        toSide_ = Select(earlier, Lanes(static_cast<float>(i)), toSide_);
    }
    before = (~cut & (from_ <= to_)).ToBits();
    const Lanes fall = highHeight_ - lowHeight_;
    const Lanes least = Min(lowHeight_ + fall * from_, lowHeight_ + fall * to_);
    onFace = (least <= batch.separation + Lanes(slop)).ToBits() & before;
}

// The least of the distances from the three sides. Source: C. Ericson, Real-Time Collision Detection, 5.1.9.
void SegmentContact::FindSide(const TriangleBatch& batch, uint32_t asked) {
    const Lanes zero(0.0f), one(1.0f), tiny(1e-30f);
    const Vector d1 = Spread(half_ * 2.0f), start = Spread(-half_);
    const Lanes a = Max(Along(d1, d1), tiny);
    for (int i = 0; i < 3; ++i) {
        const Vector d2 = batch.corners[(i + 1) % 3] - batch.corners[i], r = start - batch.corners[i];
        const Lanes e = Max(Along(d2, d2), tiny), f = Along(d2, r), c = Along(d1, r), b = Along(d1, d2);
        const Lanes across = a * e - b * b;
        Lanes s = Select(across > Lanes(1e-6f) * a * e, Clamp((b * f - c * e) / Max(across, tiny), zero, one), zero);
        Lanes t = (b * s + f) / e;
        s = Select(t < zero, Clamp(-c / a, zero, one), Select(t > one, Clamp((b - c) / a, zero, one), s));
        t = Clamp(t, zero, one);
        const Vector difference = batch.corners[i] + d2 * t - (start + d1 * s);
        const Lanes squared = Along(difference, difference);
        if (i == 0) {
            squared_ = squared;
            between_ = difference;
            at_ = s;
            sideAt_ = t;
            side_ = zero;
            continue;
        }
        const auto closer = squared < squared_;
        squared_ = Min(squared, squared_);
        for (int axis = 0; axis < 3; ++axis) between_[axis] = Select(closer, difference[axis], between_[axis]);
        at_ = Select(closer, s, at_);
        sideAt_ = Select(closer, t, sideAt_);
        side_ = Select(closer, Lanes(static_cast<float>(i)), side_);
    }
    const float reach = radius_ + probe_.reach;
    onSide = (squared_ <= Lanes(reach * reach)).ToBits() & asked;
}

void SegmentContact::WriteFaceContact(int i, const Vector3& normal, Manifold& manifold) const {
    manifold.normal = normal;
    manifold.pointCount = 0;
    const float low = lowHeight_[i], high = highHeight_[i];
    const float ends[2] = {from_[i], to_[i]}, sides[2] = {fromSide_[i], toSide_[i]};
    for (int k = 0; k < 2; ++k) {
        const float separation = low + (high - low) * ends[k] - radius_;
        if (separation > probe_.reach) continue;
        const auto side = static_cast<uint32_t>(sides[k] < 0 ? 0 : sides[k]);
        const uint32_t feature = sides[k] < 0
                                     ? VertexFeature(true, static_cast<uint32_t>(k))
                                     : CrossingFeature(EdgeName(0, 1), EdgeName(side, side == 2 ? 0 : side + 1));
        manifold.points[manifold.pointCount++] = {Vector3(0, halfHeight_ * (2 * ends[k] - 1), 0) + normal * radius_,
                                                  separation, feature};
    }
}

Vector3 SegmentContact::Axis(int i) const {
    return Normalized(LaneOf(between_, i), Vector3(-LaneOf(batch_.normal, i)));
}

void SegmentContact::WriteSideContact(int i, const uint32_t (&vertexOf)[3], Manifold& manifold) const {
    const auto side = static_cast<uint32_t>(side_[i]), next = side == 2 ? 0u : side + 1;
    const uint32_t crossingFeature = CrossingFeature(EdgeName(0, 1), EdgeName(vertexOf[side], vertexOf[next]));
    const Vector3 normal = probe_.axes * Axis(i);
    manifold.normal = normal;
    manifold.pointCount = 0;
    if (WriteParallel(i, normal, crossingFeature & ~1u, manifold)) return;
    const float at = at_[i], sideAt = sideAt_[i];
    uint32_t feature = crossingFeature;
    if (at <= 0 || at >= 1) feature = VertexFeature(true, at <= 0 ? 0 : 1);
    else if (sideAt <= 0 || sideAt >= 1) feature = VertexFeature(false, vertexOf[sideAt <= 0 ? side : next]);
    manifold.pointCount = 1;
    manifold.points[0] = {Vector3(0, halfHeight_ * (2 * at - 1), 0) + normal * radius_, Sqrt(squared_[i]) - radius_,
                          feature};
}

// Two points where the capsule lies along the side.
bool SegmentContact::WriteParallel(int i, const Vector3& normal, uint32_t feature, Manifold& manifold) const {
    const int side = static_cast<int>(side_[i]);
    const Segment core{-half_, half_}, edge{LaneOf(batch_.corners[side], i), LaneOf(batch_.corners[(side + 1) % 3], i)};
    if (!NearlyParallel(core, edge)) return false;
    const CommonLength common(core, edge);
    if (!common.exists) return false;
    const Vector3 axis = Axis(i);
    for (int k = 0; k < 2; ++k) {
        const float separation = common.SeparationAlong(axis, k) - radius_;
        if (separation > probe_.reach) continue;
        manifold.points[manifold.pointCount++] = {
            Vector3(0, halfHeight_ * (2 * common.at[k] - 1), 0) + normal * radius_, separation,
            feature + static_cast<uint32_t>(k)};
    }
    return manifold.pointCount > 0;
}

}  // namespace fulcrum
