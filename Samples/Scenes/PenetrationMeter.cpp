#include <Fulcrum/Samples/Scenes/PenetrationMeter.h>

#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Shapes/Plane.h>

#include <algorithm>

namespace fulcrum {
namespace {

constexpr double kStartsOverlapped = 0.01;  // of the inner radius

Vector3 Lowest(const ConvexShape& shape, const RelativePose& pose, const Vector3& up) {
    return pose.Transform(shape.Support(InverseRotate(pose.rotation, Vector3(-up))));
}

// An upper bound of the depth: the overlap along one direction in A's frame.
float OverlapAlong(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, const Vector3& direction) {
    return Dot(direction, Vector3(a.Support(direction) - Lowest(b, bInA, direction)));
}

// Whether a point lies behind a triangle, within its prism.
bool IsBehind(const TriangleView& t, const Vector3& point) {
    if (Dot(t.normal, Vector3(point - t.vertices[0])) >= 0) return false;
    for (int i = 0; i < 3; ++i) {
        const Vector3& from = t.vertices[i];
        if (Dot(t.normal, Cross<float>(Vector3(t.vertices[(i + 1) % 3] - from), Vector3(point - from))) < 0)
            return false;
    }
    return true;
}

// The depth of two shapes, computed only if it may exceed the maximum so far.
class DepthSearch {
public:
    explicit DepthSearch(double leastRelative) : relative_(leastRelative) {}

    void Search(const Shape& a, const Shape& b, const RelativePose& bInA) {
        const RelativePose aInB = Inverse(bInA);
        VisitPieces(a, BoundsAt(bInA, b.LocalBounds()), [&](const Piece& piece) {
            if (b.Type() == ShapeType::Plane)
                return AgainstPlane(piece.shape, aInB * piece.pose, static_cast<const Plane&>(b));
            const RelativePose inB = aInB * piece.pose;
            VisitPieces(b, BoundsAt(inB, piece.shape.LocalBounds()), [&](const Piece& other) {
                Consider(piece.shape, other, Inverse(inB) * other.pose);
                if (other.triangle && !other.isTwoSided)
                    BehindTriangle(piece.shape, inB, static_cast<const SurfaceShape&>(b), other.subShape.triangle);
            });
        });
    }
    double Relative() const { return relative_; }
    double Depth() const { return depth_; }

private:
    void Note(float depth, float innerRadius) {
        const double relative = double{depth} / double{innerRadius};
        if (!(relative > relative_)) return;
        relative_ = relative;
        depth_ = depth;
    }
    void AgainstPlane(const ConvexShape& a, const RelativePose& inPlane, const Plane& plane) {
        Note(-plane.Distance(Lowest(a, inPlane, plane.Normal())), a.InnerRadius());
    }
    void Consider(const ConvexShape& a, const Piece& piece, const RelativePose& bInA) {
        const ConvexShape& b = piece.shape;
        const float inner = piece.triangle ? a.InnerRadius() : std::min(a.InnerRadius(), b.InnerRadius());
        const float least = static_cast<float>(relative_) * inner;
        const float length = Length(bInA.position);
        if (length > 0 && OverlapAlong(a, b, bInA, bInA.position * (1 / length)) <= least) return;
        const ConvexSeparation found = MeasureConvex(a, b, bInA, 0);
        if (!found.isBeyond) Note(-found.separation, inner);
    }
    // Behind a wall's far side is also what is in front of its near side: the nearest triangle tells which.
    void BehindTriangle(const ConvexShape& a, const RelativePose& inB, const SurfaceShape& surface, uint32_t id) {
        const TriangleView triangle = surface.GetTriangle(id);
        if (!IsBehind(triangle, inB.position)) return;
        const float depth = Dot(triangle.normal, Vector3(triangle.vertices[0] - Lowest(a, inB, triangle.normal)));
        if (depth <= static_cast<float>(relative_) * a.InnerRadius()) return;
        const float distance = Dot(triangle.normal, Vector3(triangle.vertices[0] - inB.position));
        const float margin = RoundingOfDistances(distance + surface.OuterRadius());
        ClosestPoints nearest;
        if (FindClosestPoint(surface, inB.position, distance, nearest) && nearest.distance < distance - margin) return;
        Note(depth, a.InnerRadius());
    }

    double relative_, depth_ = 0;
};

}  // namespace

PenetrationMeter::PenetrationMeter(const SceneWorld& world) : world_(world) { FindAll(true); }

bool PenetrationMeter::Measure() {
    const double before = worst_.relative;
    FindAll(false);
    return worst_.relative > before;
}

const PenetrationMeter::Placed& PenetrationMeter::Place(BodyId id) {
    if (bodies_.size() <= id.index) bodies_.resize(id.index + 1);
    Placed& body = bodies_[id.index];
    if (body.seenIn == round_) return body;
    const BodyInterface& bodies = world_.Bodies();
    body = {round_, id, bodies.GetShape(id), {bodies.GetCenterOfMass(id), bodies.GetPose(id).rotation}};
    return body;
}

bool PenetrationMeter::IsMobile(BodyId id, bool first) const {
    const BodyInterface& bodies = world_.Bodies();
    return bodies.GetMotionType(id) == MotionType::Dynamic && (first || bodies.IsAwake(id)) && !bodies.IsSensor(id);
}

void PenetrationMeter::FindAll(bool first) {
    ++round_;
    mobile_.clear();
    world_.System().VisitBodies([&](BodyId id) {
        if (!IsMobile(id, first)) return;
        mobile_.push_back(id);
        Place(id);
    });
    const auto hold = world_.Queries().Hold();
    for (const BodyId id : mobile_) {
        const Placed a = Place(id);
        const Bounds box = BoundsAbout(a.center.position, *a.shape, a.center);
        world_.Queries().FindInBox(a.center.position + box.lower.cast<double>(),
                                   a.center.position + box.upper.cast<double>(), near_);
        BodyId last{};
        for (const OverlapHit& hit : near_) {
            if (hit.body == last || hit.body == id || (hit.body < id && IsMobile(hit.body, first))) continue;
            last = hit.body;
            MeasurePair(a, Place(hit.body), first);
        }
    }
}

void PenetrationMeter::MeasurePair(const Placed& a, const Placed& b, bool first) {
    const auto overlapped = overlapped_.find({a.id, b.id});
    const bool since = overlapped != overlapped_.end();
    DepthSearch search(first || since ? 0 : worst_.relative);
    search.Search(*a.shape, *b.shape, Relative(a.center, b.center));
    if (since) {
        if (search.Relative() <= 0) overlapped_.erase(overlapped);
        return;
    }
    if (search.Depth() <= 0 || !world_.Queries().MayCollide(a.id, b.id)) return;
    if (first && search.Relative() > kStartsOverlapped) overlapped_.insert({a.id, b.id});
    else if (search.Relative() > worst_.relative)
        worst_ = {search.Relative(), search.Depth(), a.id, b.id, world_.StepCount()};
}

}  // namespace fulcrum
