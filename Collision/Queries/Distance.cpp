#include <Fulcrum/Collision/Queries/Distance.h>

#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Shapes/Plane.h>

#include <algorithm>
#include <limits>
#include <tuple>

namespace fulcrum {

namespace {

Bounds Everywhere() {
    Bounds bounds;
    bounds.lower = Vector3::Constant(-std::numeric_limits<float>::infinity());
    bounds.upper = Vector3::Constant(std::numeric_limits<float>::infinity());
    return bounds;
}

// Calls visit(pieceOfA, pieceOfB, pose of the latter in the former) for the pairs of pieces whose boxes are within
// `reach`.
template <class Visitor>
void VisitPairs(const Shape& a, const Shape& b, const RelativePose& bInA, float reach, Visitor&& visit) {
    const RelativePose aInB = Inverse(bInA);
    VisitPieces(a, Inflated(BoundsAt(bInA, b.LocalBounds()), reach), [&](const Piece& pieceOfA) {
        const Bounds near = BoundsAt(aInB * pieceOfA.pose, pieceOfA.shape.LocalBounds());
        const RelativePose bInPiece = Inverse(pieceOfA.pose) * bInA;
        VisitPieces(b, Inflated(near, reach),
                    [&](const Piece& pieceOfB) { visit(pieceOfA, pieceOfB, bInPiece * pieceOfB.pose); });
    });
}

class ClosestSearch {
public:
    ClosestSearch(float maxDistance, ClosestPoints& result, NarrowPhaseMethod method = NarrowPhaseMethod::Automatic)
        : limit_(maxDistance), result_(result), method_(method) {}

    void Consider(const Piece& a, const Piece& b, const RelativePose& bInA) {
        const float size = std::max(a.shape.OuterRadius(), b.shape.OuterRadius());
        const float reach = std::max(limit_, 0.0f) + RoundingOfDistances(size);
        const ConvexSeparation found = MeasureConvex(a.shape, b.shape, bInA, reach, method_);
        if (found.isBeyond) return;
        Consider(found.separation, Rotate(a.pose.rotation, found.normal), a.pose.Transform(found.onA),
                 a.pose.Transform(found.onB), a.subShape, b.subShape);
    }
    void Consider(float distance, const Vector3& normal, const Vector3& onA, const Vector3& onB, const SubShape& ofA,
                  const SubShape& ofB) {
        if (distance > limit_) return;
        if (found_ && distance == result_.distance &&
            std::tie(ofA, ofB) >= std::tie(result_.subShapeOfA, result_.subShapeOfB))
            return;
        found_ = true;
        limit_ = distance;
        result_ = {distance, normal, onA, onB, ofA, ofB};
    }
    bool Found() const { return found_; }
    float Best() const { return limit_; }

private:
    float limit_;  // m: largest distance of interest
    bool found_ = false;
    ClosestPoints& result_;
    NarrowPhaseMethod method_;
};

// All pieces of a shape against a half space, both in the plane's frame.
bool ClosestToPlane(const Plane& plane, const Shape& other, const RelativePose& otherInPlane, float maxDistance,
                    ClosestPoints& result) {
    ClosestSearch search(maxDistance, result);
    const Vector3 n = plane.Normal();
    if (other.Type() == ShapeType::Plane) {
        const Plane& second = static_cast<const Plane&>(other);
        const Vector3 normal = Rotate(otherInPlane.rotation, second.Normal());
        const bool isOpposite = Dot(n, normal) < -1 + 1e-6f;
        const Vector3 onSecond = otherInPlane.Transform(second.Normal() * second.Offset());
        const float distance = isOpposite ? plane.Distance(onSecond) : 0.0f;
        search.Consider(distance, n, onSecond - n * plane.Distance(onSecond), onSecond, {}, {});
        return search.Found();
    }
    VisitPieces(other, Everywhere(), [&](const Piece& piece) {
        const RelativePose pose = otherInPlane * piece.pose;
        const Vector3 lowest = pose.Transform(piece.shape.Support(InverseRotate(pose.rotation, Vector3(-n))));
        const float distance = plane.Distance(lowest);
        search.Consider(distance, n, lowest - n * distance, lowest, {}, piece.subShape);
    });
    return search.Found();
}

// A result in the second shape's frame, converted to the first one's.
ClosestPoints Swapped(const ClosestPoints& found, const RelativePose& secondInFirst) {
    return {found.distance,
            Rotate(secondInFirst.rotation, Vector3(-found.normal)),
            secondInFirst.Transform(found.onB),
            secondInFirst.Transform(found.onA),
            found.subShapeOfB,
            found.subShapeOfA};
}

bool IsUsable(const RelativePose& pose, float maxDistance) {
    return IsWithinReach(pose.position.cast<double>()) && IsRotation(pose.rotation) && maxDistance >= 0;
}

}  // namespace

bool FindClosestPoints(const Shape& a, const Shape& b, const RelativePose& bInA, float maxDistance,
                       ClosestPoints& result, NarrowPhaseMethod method) {
    if (!IsUsable(bInA, maxDistance)) return false;
    if (a.Type() == ShapeType::Plane) return ClosestToPlane(static_cast<const Plane&>(a), b, bInA, maxDistance, result);
    if (b.Type() == ShapeType::Plane) {
        const RelativePose aInB = Inverse(bInA);
        if (!ClosestToPlane(static_cast<const Plane&>(b), a, aInB, maxDistance, result)) return false;
        result = Swapped(result, bInA);
        return true;
    }
    ClosestSearch search(maxDistance, result, method);
    const auto consider = [&](const Piece& pieceOfA, const Piece& pieceOfB, const RelativePose& pose) {
        search.Consider(pieceOfA, pieceOfB, pose);
    };
    if (a.IsConvex() && b.IsConvex()) {
        VisitPairs(a, b, bInA, 0, consider);
        return search.Found();
    }
    // Searches growing boxes, until one contains everything closer than the best result.
    const Bounds boxOfB = BoundsAt(bInA, b.LocalBounds()), &boxOfA = a.LocalBounds();
    const Vector3 gap = Vector3(boxOfB.lower - boxOfA.upper).cwiseMax(boxOfA.lower - boxOfB.upper).cwiseMax(0.0f);
    const Vector3 span = boxOfA.upper.cwiseMax(boxOfB.upper) - boxOfA.lower.cwiseMin(boxOfB.lower);
    const float most = std::min(maxDistance, Length(span));
    if (gap.maxCoeff() > maxDistance) return false;
    float reach = std::min(most, gap.maxCoeff() * 1.1f + 0.25f * std::min(a.OuterRadius(), b.OuterRadius()) + 1e-6f);
    for (;;) {
        VisitPairs(a, b, bInA, reach, consider);
        if (search.Found() && search.Best() <= reach) return true;
        if (reach >= most) return search.Found();
        reach = std::min(most, search.Found() ? search.Best() * 1.001f : 4 * reach);
    }
}

bool FindClosestPoint(const Shape& shape, const Vector3& point, float maxDistance, ClosestPoints& result,
                      NarrowPhaseMethod method) {
    return FindClosestPoints(shape, PointCore(), {point, {}}, maxDistance, result, method);
}

bool Overlap(const Shape& a, const Shape& b, const RelativePose& bInA, NarrowPhaseMethod method) {
    if (!IsUsable(bInA, 0)) return false;
    ClosestPoints unused;
    if (a.Type() == ShapeType::Plane || b.Type() == ShapeType::Plane) return FindClosestPoints(a, b, bInA, 0, unused);
    bool overlap = false;
    VisitPairs(a, b, bInA, 0, [&](const Piece& pieceOfA, const Piece& pieceOfB, const RelativePose& pose) {
        overlap = overlap || OverlapConvex(pieceOfA.shape, pieceOfB.shape, pose, method);
    });
    return overlap;
}

bool Contains(const Shape& shape, const Vector3& point, NarrowPhaseMethod method) {
    return !shape.IsSurface() && Overlap(shape, PointCore(), {point, {}}, method);
}

}  // namespace fulcrum
