// A face, segment or point of one core (the incident feature), clipped by the sides of a face of the other (the
// reference face): the candidates for contact points, with their separations and feature ids. Used by the contact
// builders; lives on the stack of one call.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Clipping.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>

#include <algorithm>

namespace fulcrum {

// kMost: the corners of both faces together, at most, filled up to a multiple of 8.
template <int kMost>
class ClippedFeature {
public:
    ClippedFeature() = default;
    ClippedFeature(const ClippedFeature&) = delete;
    ClippedFeature& operator=(const ClippedFeature&) = delete;

    // The feature's corners are cornerAt(0) to cornerAt(cornerCount - 1), in the frame of the sides. Vertices beyond a
    // side by less than `slop` meters are kept.
    template <class CornerAt>
    void Clip(int cornerCount, const CornerAt& cornerAt, const ClipSide* sides, int sideCount, float slop) {
        cornerCount_ = count_ = cornerCount;
        for (int i = 0; i < cornerCount; ++i) {
            current_[i].position = cornerAt(i);
            current_[i].label = static_cast<uint32_t>(i);
        }
        if (cornerCount > 2) ClipPolygon(sides, sideCount, slop);
        else ClipSegment(sides, sideCount, slop);
    }

    int Count() const { return count_; }
    const Vector3& operator[](int i) const { return current_[i].position; }

    // Measures how far each vertex lies above the plane normal . x = offset of the reference face; returns the least.
    float MeasureSeparations(const Vector3& normal, float offset) {
        float least = 0;
        for (int i = 0; i < count_; ++i) {
            separations_[i] = Dot(normal, current_[i].position) - offset;
            if (i == 0 || separations_[i] < least) least = separations_[i];
        }
        return least;
    }
    float Separation(int i) const { return separations_[i]; }  // m

    // How far inside all sides the centroid of the vertices at most `deepEnough` above the plane lies: a disc of that
    // radius about it, in the plane, belongs to the Minkowski difference.
    float DiscRadius(const ClipSide* sides, int sideCount, float deepEnough) const {
        Vector3 centroid = Vector3::Zero();
        float count = 0;
        for (int i = 0; i < count_; ++i) {
            if (separations_[i] > deepEnough) continue;
            centroid += current_[i].position;
            count += 1;
        }
        centroid *= 1.0f / count;
        float radius = sides[0].offset - Dot(sides[0].normal, centroid);
        for (int k = 1; k < sideCount; ++k) radius = Min(radius, sides[k].offset - Dot(sides[k].normal, centroid));
        return radius;
    }

    // Manifold reduction: writes the indices of at most four of the vertices whose separation is at most `reach`, and
    // returns how many.
    int ChooseFourWithin(float reach, const Vector3& normal, float depthSlop, int (&chosen)[4],
                         const PointWeights& weighting = {}) const {
        int near[kMost], nearCount = 0;
        for (int i = 0; i < count_; ++i) {
            near[nearCount] = i;
            nearCount += separations_[i] <= reach ? 1 : 0;
        }
        if (nearCount <= 4) {
            for (int i = 0; i < nearCount; ++i) chosen[i] = near[i];
            return nearCount;
        }
        FlatPoints<kMost> points;
        const Vector3 u = Perpendicular(normal), v = Cross<float>(normal, u);
        for (int i = 0; i < nearCount; ++i)
            points.Add(Dot(u, current_[near[i]].position), Dot(v, current_[near[i]].position), separations_[near[i]]);
        const int count = ChooseFour(points, depthSlop, chosen, weighting);
        for (int i = 0; i < count; ++i) chosen[i] = near[chosen[i]];
        return count;
    }

    // The feature id of vertex i. `incident` and `reference` name the corners and edges of the two features, like
    // FaceNames.
    template <class IncidentNames, class ReferenceNames>
    uint32_t FeatureOf(int i, const IncidentNames& incident, const ReferenceNames& reference, bool referenceOfA) const {
        const auto crossing = [&](uint32_t incidentEdge, uint32_t side) {
            const uint32_t referenceEdge = reference.Edge(side);
            return referenceOfA ? CrossingFeature(referenceEdge, incidentEdge)
                                : CrossingFeature(incidentEdge, referenceEdge);
        };
        const uint32_t starts = current_[i].label;
        if (cornerCount_ <= 2) {
            if (starts < kSideLabel) return VertexFeature(!referenceOfA, incident.Vertex(starts));
            return crossing(incident.Edge(0), starts - kSideLabel);
        }
        const uint32_t ends = current_[i == 0 ? count_ - 1 : i - 1].label;
        if (starts < kSideLabel && ends < kSideLabel) return VertexFeature(!referenceOfA, incident.Vertex(starts));
        if (starts < kSideLabel) return crossing(incident.Edge(starts), ends - kSideLabel);
        if (ends < kSideLabel) return crossing(incident.Edge(ends), starts - kSideLabel);
        // Two sides meet: a corner of the reference face, which begins the later of the two.
        const uint32_t low = std::min(starts, ends) - kSideLabel, high = std::max(starts, ends) - kSideLabel;
        const bool wraps = low == 0 && high + 1 == reference.count;
        return VertexFeature(referenceOfA, reference.Vertex(wraps ? 0 : high));
    }

private:
    static_assert(kMost % 8 == 0);

    void ClipPolygon(const ClipSide* sides, int sideCount, float slop) {
        ClipVertex* spare = second_;
        float outside[kMost];
        for (int k = 0; k < sideCount && count_ > 0; ++k) {
            bool cuts = false;
            for (int i = 0; i < count_; ++i) {
                outside[i] = Dot(sides[k].normal, current_[i].position) - sides[k].offset;
                cuts |= outside[i] > slop;
            }
            if (!cuts) continue;
            count_ = ClipBySide(current_, count_, outside, kSideLabel + static_cast<uint32_t>(k), slop, spare);
            std::swap(current_, spare);
        }
    }
    void ClipSegment(const ClipSide* sides, int sideCount, float slop) {
        if (count_ == 1) current_[1] = current_[0];
        int left = 2;
        for (int k = 0; k < sideCount && left > 0; ++k)
            left = ClipSegmentBySide(current_, sides[k], kSideLabel + static_cast<uint32_t>(k), slop);
        count_ = left == 0 ? 0 : count_;
    }

    int cornerCount_ = 0, count_ = 0;
    ClipVertex* current_ = first_;
    ClipVertex first_[kMost];
    ClipVertex second_[kMost];
    float separations_[kMost];
};

}  // namespace fulcrum
