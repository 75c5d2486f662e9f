#include <Fulcrum/Collision/Queries/Distance.h>

#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Math/FloatEnvironment.h>

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

// How far two boxes are apart along the axis that separates them most, m; negative: by how much they overlap along
// that.
float SeparationOf(const Bounds& a, const Bounds& b) {
    return Vector3(a.lower - b.upper).cwiseMax(Vector3(b.lower - a.upper)).maxCoeff();
}

// Calls visit(pieceOfA, pieceOfB, pose of the latter in the former, separation of their boxes) for the pairs of pieces
// whose boxes are within `reach` m of each other: pieces of A that are near B first, and of B those near to each. The
// visitor may lower `reach`, so that most pairs are never visited; below 0 ends the search.
template <class Visitor>
void VisitPairs(const Shape& a, const Shape& b, const RelativePose& bInA, const float& reach, Visitor&& visit) {
    const RelativePose aInB = Inverse(bInA);
    VisitPiecesNear(a, BoundsAt(bInA, b.LocalBounds()), reach, [&](const Piece& pieceOfA) {
        const Bounds near = BoundsAt(aInB * pieceOfA.pose, pieceOfA.shape.LocalBounds());
        const RelativePose bInPiece = Inverse(pieceOfA.pose) * bInA;
        VisitPiecesNear(b, near, reach, [&](const Piece& pieceOfB) {
            const float separation = SeparationOf(near, BoundsAt(pieceOfB.pose, pieceOfB.shape.LocalBounds()));
            visit(pieceOfA, pieceOfB, bInPiece * pieceOfB.pose, separation);
        });
    });
}

class ClosestSearch {
public:
    // `rounding`: m, of the boxes of pieces.
    ClosestSearch(float maxDistance, float rounding, ClosestPoints& result,
                  NarrowPhaseMethod method = NarrowPhaseMethod::Automatic)
        : limit_(maxDistance), rounding_(rounding), reach_(maxDistance + rounding), result_(result), method_(method) {}

    // `ofBoxes`: the separation of their boxes. Pieces cannot overlap more deeply than these do.
    void Consider(const Piece& a, const Piece& b, const RelativePose& bInA, float ofBoxes) {
        const float rounding = RoundingOfDistances(std::max(a.shape.OuterRadius(), b.shape.OuterRadius()));
        const float reach = limit_ + rounding;
        if (ofBoxes > reach) return;
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
        reach_ = std::max(limit_, 0.0f) + rounding_;
        result_ = {distance, normal, onA, onB, ofA, ofB};
    }
    bool Found() const { return found_; }
    // m: how far apart the boxes of pieces may be that are still of interest.
    const float& Reach() const { return reach_; }

private:
    float limit_;  // m: largest distance of interest
    const float rounding_;
    float reach_;
    bool found_ = false;
    ClosestPoints& result_;
    NarrowPhaseMethod method_;
};

// All pieces of a shape against a half space, both in the plane's frame.
bool ClosestToPlane(const Plane& plane, const Shape& other, const RelativePose& otherInPlane, float maxDistance,
                    ClosestPoints& result) {
    ClosestSearch search(maxDistance, 0, result);
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
    const DefaultFloats floats;
    if (!IsUsable(bInA, maxDistance)) return false;
    if (a.Type() == ShapeType::Plane) return ClosestToPlane(static_cast<const Plane&>(a), b, bInA, maxDistance, result);
    if (b.Type() == ShapeType::Plane) {
        const RelativePose aInB = Inverse(bInA);
        if (!ClosestToPlane(static_cast<const Plane&>(b), a, aInB, maxDistance, result)) return false;
        result = Swapped(result, bInA);
        return true;
    }
    ClosestSearch search(maxDistance, RoundingOfDistances(std::max(a.OuterRadius(), b.OuterRadius())), result, method);
    const auto consider = [&](const Piece& pieceOfA, const Piece& pieceOfB, const RelativePose& pose, float ofBoxes) {
        search.Consider(pieceOfA, pieceOfB, pose, ofBoxes);
    };
    VisitPairs(a, b, bInA, search.Reach(), consider);
    return search.Found();
}

bool FindClosestPoint(const Shape& shape, const Vector3& point, float maxDistance, ClosestPoints& result,
                      NarrowPhaseMethod method) {
    const DefaultFloats floats;
    return FindClosestPoints(shape, PointCore(), {point, {}}, maxDistance, result, method);
}

bool Overlap(const Shape& a, const Shape& b, const RelativePose& bInA, NarrowPhaseMethod method) {
    const DefaultFloats floats;
    if (!IsUsable(bInA, 0)) return false;
    ClosestPoints unused;
    if (a.Type() == ShapeType::Plane || b.Type() == ShapeType::Plane) return FindClosestPoints(a, b, bInA, 0, unused);
    constexpr float kTouching = 0, kEnded = -1;
    float reach = kTouching;
    VisitPairs(a, b, bInA, reach, [&](const Piece& pieceOfA, const Piece& pieceOfB, const RelativePose& pose, float) {
        if (reach >= 0 && OverlapConvex(pieceOfA.shape, pieceOfB.shape, pose, method)) reach = kEnded;
    });
    return reach == kEnded;
}

bool Contains(const Shape& shape, const Vector3& point, NarrowPhaseMethod method) {
    const DefaultFloats floats;
    return !shape.IsSurface() && Overlap(shape, PointCore(), {point, {}}, method);
}

}  // namespace fulcrum
