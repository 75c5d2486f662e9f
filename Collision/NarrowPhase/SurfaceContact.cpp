#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>
#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/Gjk.h>
#include <Fulcrum/Collision/NarrowPhase/InnerBall.h>
#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/NarrowPhase/RoundTriangles.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleFaceContact.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleSide.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <algorithm>
#include <bit>

namespace fulcrum {

namespace {

// If the cosine between a face of the shape and the normal of an edge contact is larger, the face rests on the edge, on
// two points: 4 degrees, more than a rocking body rotates in a step.
constexpr float kRestingCosine = 0.9976f;

// Bounds of a shape in the surface's frame, enlarged by `reach`.
Bounds BoundsInSurface(const ConvexShape& a, const RelativePose& bInA, float reach) {
    const Matrix3 axes = ToMatrix(bInA.rotation.Conjugate());
    const Vector3 origin = -(axes * bInA.position), half = a.LocalBounds().HalfExtents();
    const Vector3 center = axes * a.LocalBounds().Center();
    const Vector3 extent = axes.x.cwiseAbs() * half.x() + axes.y.cwiseAbs() * half.y() + axes.z.cwiseAbs() * half.z();
    const Vector3 sphere = Vector3::Constant(a.OuterRadius()), margin = Vector3::Constant(reach);
    Bounds bounds;
    bounds.lower = origin + Vector3(center - extent).cwiseMax(-sphere) - margin;
    bounds.upper = origin + Vector3(center + extent).cwiseMin(sphere) + margin;
    return bounds;
}

}  // namespace

class SurfaceCollider {
public:
    SurfaceCollider(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA,
                    const CollideSettings& settings, const SurfaceApproach& approach, SurfaceContacts& contacts)
        : a_(a),
          b_(b),
          bInA_(bInA),
          settings_(settings),
          contacts_(contacts),
          axes_(ToMatrix(bInA.rotation)),
          center_(bInA.InverseTransform(Vector3::Zero())),
          motion_(InverseRotate(bInA.rotation, approach.motion)),
          touched_(approach.touched),
          isPolyhedral_(HasPolyhedralCore(a.Type())),
          asksLibccd_(settings.method == NarrowPhaseMethod::Libccd) {
        if (isPolyhedral_) core_ = CoreOf(a, storage_);
    }

    void Run() {
        contacts_.filter_.Begin(settings_.speculativeDistance > ContactTolerances::kFarAhead * a_.InnerRadius());
        contacts_.counters_ = {};
        Collect();
        const SurfaceProbe probe{a_,      isPolyhedral_ ? &core_ : nullptr, axes_,
                                 center_, settings_.speculativeDistance,    b_.IsTwoSided()};
        Array<TriangleView>& views = contacts_.views_;
        for (size_t first = 0; first < views.size(); first += 8)
            CollideBatch(probe, first, std::min<size_t>(views.size() - first, 8));
        MergeContacts(contacts_.filter_.Resolve(), a_.InnerRadius(), Vector3(axes_ * motion_), contacts_.manifolds_,
                      contacts_.manifoldCount_);
        const InnerBall ball{a_.InnerRadius(), center_, motion_};
        if (contacts_.manifoldCount_ > 0 && ball.MovesFar()) AddInnerBall(ball);
    }

private:
    void Collect() {
        Array<uint32_t>& ids = contacts_.ids_;
        ids.clear();
        b_.VisitTriangles(BoundsInSurface(a_, bInA_, settings_.speculativeDistance),
                          [&](uint32_t id) { ids.push_back(id); });
        contacts_.views_.resize(ids.size());
        b_.GetTriangles(ids, contacts_.views_.data());
    }

    void CollideBatch(const SurfaceProbe& probe, size_t first, size_t count) {
        TriangleBatch batch;
        uint32_t reversed;
        const uint32_t near = batch.FindInReach(probe, &contacts_.views_[first], static_cast<int>(count), reversed);
        if (!touched_.empty() && !b_.IsTwoSided()) CollideTunneled(first, count);
        if (near == 0) return;
        for (uint32_t bits = reversed & near; bits != 0; bits &= bits - 1) {
            TriangleView& view = contacts_.views_[first + static_cast<size_t>(std::countr_zero(bits))];
            view = Reversed(view);
        }
        const auto index = static_cast<uint32_t>(first);
        if (asksLibccd_) return CollideByLibccd(batch, near, reversed, index);
        if (a_.Type() == ShapeType::Sphere) return CollideSphere(batch, near, index);
        if (a_.Type() == ShapeType::Capsule) return CollideCapsule(probe, batch, near, reversed, index);
        for (uint32_t bits = near; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            if (isPolyhedral_) CollideFaces(batch, i, (reversed >> i & 1) != 0, index + static_cast<uint32_t>(i));
            else CollideTriangle(index + static_cast<uint32_t>(i));
        }
    }

    void CollideByLibccd(const TriangleBatch& batch, uint32_t near, uint32_t reversed, uint32_t first) {
        const bool hasFaces = isPolyhedral_ && core_.faceCount > 0;
        for (uint32_t bits = near; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const uint32_t index = first + static_cast<uint32_t>(i);
            const PlacedTriangle triangle = Place(index);
            const std::optional<KnownContact> found = AskAbout(triangle);
            if (!found) continue;
            if (hasFaces) CollideFaces(batch, i, (reversed >> i & 1) != 0, index, &*found);
            else CollideTriangle(index, nullptr, &*found);
        }
    }

    // A batch skips one-sided triangles with the center behind them. Those that the shape touched in the last step, and
    // their neighbors, still count: the center has tunneled through them.
    void CollideTunneled(size_t first, size_t count) {
        for (size_t i = first; i < first + count; ++i)
            if (HasTunneled(contacts_.views_[i])) CollideTriangle(static_cast<uint32_t>(i));
    }
    // Only over the triangle itself: a body that tips over its edge also gets behind it.
    bool HasTunneled(const TriangleView& view) {
        const float height = HeightAbove(view, center_);
        if (!(height < 0 && height > -a_.OuterRadius()) || !IsOver(view, center_, 0)) return false;
        return std::find(touched_.begin(), touched_.end(), view.id) != touched_.end() || ContinuesTouched(view);
    }
    // Whether it shares a corner with a triangle that the shape touched and faces the same way: excludes triangles
    // behind an edge and the other side of a thin wall.
    bool ContinuesTouched(const TriangleView& view) {
        Array<TriangleView>& touched = contacts_.touched_;
        touched.resize(touched_.size());
        b_.GetTriangles(touched_, touched.data());
        return std::any_of(touched.begin(), touched.end(), [&](const TriangleView& before) {
            return Dot(before.normal, view.normal) > 0.5f &&
                   std::find_first_of(before.vertexIds, before.vertexIds + 3, view.vertexIds, view.vertexIds + 3) !=
                       before.vertexIds + 3;
        });
    }

    void CollideSphere(const TriangleBatch& batch, uint32_t near, uint32_t first) {
        Manifold none, nearest;
        for (uint32_t bits = near; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const uint32_t index = first + static_cast<uint32_t>(i);
            const float distance = batch.distance[i];
            Vector3 axis(batch.closest.x()[i], batch.closest.y()[i], batch.closest.z()[i]);
            // A center in the surface itself is pushed out through the face.
            axis = distance > 1e-6f * core_.radius ? Vector3(axis * (1.0f / distance))
                                                   : Vector3(-contacts_.views_[index].normal);
            WriteBallContact(Vector3(axes_ * axis), distance, core_.radius, nearest);
            contacts_.filter_.AddNearest(contacts_.views_[index], axis, false, none, nearest);
        }
    }

    void CollideCapsule(const SurfaceProbe& probe, const TriangleBatch& batch, uint32_t near, uint32_t reversed,
                        uint32_t first) {
        const float slop = std::min(0.02f * settings_.speculativeDistance, 0.002f * core_.radius);
        const SegmentContact segment(probe, batch, near, slop);
        for (uint32_t bits = near; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const uint32_t bit = 1u << i, index = first + static_cast<uint32_t>(i);
            const TriangleView& view = contacts_.views_[index];
            if (segment.crossing & bit) {
                CollideTriangle(index);
                continue;
            }
            if (((segment.onFace | segment.onSide) & bit) == 0) continue;
            Manifold onFace, nearest;
            if (segment.before & bit) segment.WriteFaceContact(i, Vector3(-(axes_ * view.normal)), onFace);
            if (segment.onFace & bit) {
                AddFace(view, onFace);
                continue;
            }
            constexpr uint32_t kOrders[2][3] = {{0, 1, 2}, {2, 1, 0}};
            segment.WriteSideContact(i, kOrders[reversed >> i & 1], nearest);
            contacts_.filter_.AddNearest(view, segment.Axis(i), false, onFace, nearest);
        }
    }

    // A triangle about its centroid, and that in the shape's frame.
    struct PlacedTriangle {
        Vector3 corners[3];
        Vector3 normal;
        RelativePose pose;
    };
    PlacedTriangle Place(uint32_t index) const {
        const TriangleView& view = contacts_.views_[index];
        const Vector3 middle = (view.vertices[0] + view.vertices[1] + view.vertices[2]) * (1.0f / 3.0f);
        return {{view.vertices[0] - middle, view.vertices[1] - middle, view.vertices[2] - middle},
                view.normal,
                {bInA_.Transform(middle), bInA_.rotation}};
    }
    std::optional<KnownContact> AskAbout(const PlacedTriangle& placed) {
        const Triangle triangle(placed.corners, placed.normal);
        return FindLibccdContact(SupportPair(a_, triangle, placed.pose), placed.pose, settings_.speculativeDistance,
                                 contacts_.counters_);
    }

    // onFace: the points with the triangle's face, if known; its edges and corners are still to be tested. found:
    // libccd's contact, if any.
    void CollideTriangle(uint32_t index, const Manifold* onFace = nullptr, const KnownContact* found = nullptr) {
        const PlacedTriangle triangle = Place(index);
        std::optional<KnownContact> asked;
        if (asksLibccd_ && !found) {
            asked = AskAbout(triangle);
            if (!asked) return;
            found = &*asked;
        }
        if (isPolyhedral_) CollidePolyhedron(index, triangle.corners, triangle.pose, onFace, found);
        else CollideCurved(index, triangle.corners, triangle.pose, found);
    }

    // The contact with the triangle's face first: most contacts are of that kind.
    void CollideFaces(const TriangleBatch& batch, int lane, bool isReversed, uint32_t index,
                      const KnownContact* byLibccd = nullptr) {
        const TriangleView& view = contacts_.views_[index];
        const int incident = FaceAlong(core_, -(axes_ * view.normal));
        if (core_.faces[incident].cornerCount > kMostCorners) return CollideTriangle(index, nullptr, byLibccd);
        TriangleInShape triangle;
        batch.Extract(lane, isReversed, axes_, triangle.corners, triangle.outwards);
        triangle.normal = axes_ * view.normal;
        triangle.middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) * (1.0f / 3.0f);
        float size = std::numeric_limits<float>::infinity();
        for (const Vector3& corner : triangle.corners)
            size = Min(size, LengthSquared(Vector3(corner - triangle.middle)));
        ContactTolerances tolerances(core_.size + Sqrt(size), core_.radius, settings_);
        tolerances.closing = -Dot(view.normal, motion_);
        Manifold onFace;
        const FaceContact contact =
            BuildTriangleFaceContact(core_, incident, triangle, batch.separation[lane], tolerances, onFace);
        const bool found = onFace.pointCount > 0 && contact.isDeepest;
        if (found && contact.proven) return AddFace(view, onFace);
        if (ReachesActiveEdge(view, triangle, tolerances.reach)) return CollideTriangle(index, &onFace, byLibccd);
        if (onFace.pointCount == 0) return;
        if (found) return AddFace(view, onFace);
        if (!contacts_.filter_.DeferToNeighbor(view, triangle, tolerances.prefer + 1e-3f * Sqrt(size), onFace))
            CollideTriangle(index, &onFace, byLibccd);
    }

    // A shape without rounding that reaches no active edge can touch only the face.
    bool ReachesActiveEdge(const TriangleView& view, const TriangleInShape& triangle, float reach) const {
        if (core_.radius > 0) return true;
        for (uint32_t bits = view.activeEdges; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const float edge = Dot(triangle.outwards[i], triangle.corners[i]);
            if (FarthestVertex(core_, triangle.outwards[i]).value >= edge - reach) return true;
        }
        return false;
    }

    // A shape without rounding can touch only the face of a triangle whose edges are inactive.
    bool FacesAlone(const TriangleView& view) const { return core_.radius <= 0 && view.activeEdges == 0; }
    bool IsFaceContact(const TriangleView& view, const FaceContact& contact, const Manifold& onFace) const {
        return onFace.pointCount > 0 && contact.isDeepest && (contact.proven || FacesAlone(view));
    }

    void CollidePolyhedron(uint32_t index, const Vector3 (&corners)[3], const RelativePose& pose,
                           const Manifold* knownOnFace, const KnownContact* byLibccd) {
        const TriangleView& view = contacts_.views_[index];
        PolyhedronStorage storage;
        const PolyhedronPair pair(core_, CoreOf(corners, view.normal, 0, storage), pose);
        ContactTolerances tolerances = pair.Tolerances(settings_);
        tolerances.faceOfACosine = kRestingCosine;
        tolerances.facesAhead = false;
        Manifold onFace;
        if (knownOnFace) {
            onFace = *knownOnFace;
        } else {
            const ReferenceFace face = MeasureFace(pair, false, 0);
            if (face.separation > tolerances.reach) return;
            const FaceContact contact = BuildFaceContact(pair, face, tolerances, onFace);
            if (HeightAbove(view, center_) < 0) return AddTunneled(view, onFace);
            if (onFace.pointCount == 0 && FacesAlone(view)) return;
            if (IsFaceContact(view, contact, onFace)) return AddFace(view, onFace);
        }

        KnownAxis known{};
        bool overlaps;
        if (byLibccd) {
            known = {byLibccd->axis, pair.SeparationAlong(byLibccd->axis), tolerances.feature};
            overlaps = byLibccd->separation <= 0;
        } else {
            const Vector3 inwards = -(pair.rotation * view.normal);
            const auto gjk = Gjk(pair, inwards, tolerances.reach);
            if (gjk.status == GjkStatus::BeyondReach) return;
            known = {gjk.axis, gjk.separation, tolerances.feature};
            overlaps = gjk.status == GjkStatus::Overlapping;
            if (overlaps) {
                const EpaResult epa = Epa(pair, gjk.simplex);
                const FoundAxis found =
                    epa.status == EpaResult::Status::Found ? FoundAxis{epa.axis, epa.separation} : SearchAllAxes(pair);
                known.axis = found.axis;
                known.separation = found.separation;
            }
        }
        Manifold nearest;
        PairCache none;
        BuildContactFromAxis(pair, known, tolerances, none, nearest);
        contacts_.filter_.AddNearest(view, pair.DirectionInB(known.axis), overlaps, onFace, nearest);
    }

    void CollideCurved(uint32_t index, const Vector3 (&corners)[3], const RelativePose& pose,
                       const KnownContact* byLibccd) {
        const TriangleView& view = contacts_.views_[index];
        const Triangle triangle(corners, view.normal);
        const SupportPair pair(a_, triangle, pose);
        ContactTolerances tolerances(pair.InnerRadii(), pair.RadiusSum(), settings_);
        tolerances.facesAhead = false;
        const Vector3 inwards = -(pair.rotation * view.normal);
        Manifold onFace, nearest;
        PairCache none;
        onFace.pointCount = nearest.pointCount = 0;
        const float separation = pair.SeparationAlong(inwards);
        if (separation <= tolerances.reach) BuildOverFaceOfB(pair, inwards, tolerances, onFace);
        if (HeightAbove(view, center_) < 0) return AddTunneled(view, onFace);
        KnownContact known{};
        bool overlaps;
        if (byLibccd) {
            known = *byLibccd;
            overlaps = known.separation <= 0;
        } else {
            const ConvexGjkResult gjk = ConvexGjk(pair, inwards, tolerances.reach);
            if (gjk.status == GjkStatus::BeyondReach) return;
            overlaps = gjk.status == GjkStatus::Overlapping;
            known = overlaps ? FindDepth(pair, gjk.simplex, inwards) : KnownContact{gjk.axis, gjk.separation, gjk.onA};
        }
        none = {};
        BuildConvexContact(pair, known, tolerances, none, nearest);
        contacts_.filter_.AddNearest(view, pair.DirectionInB(known.axis), overlaps, onFace, nearest);
    }

    // For a shape whose center has tunneled through the face: contacts push to the front, although the back is closer.
    void AddTunneled(const TriangleView& view, const Manifold& onFace) {
        if (onFace.pointCount > 0) AddFace(view, onFace);
    }
    void AddFace(const TriangleView& view, const Manifold& manifold) { contacts_.filter_.AddFace(view, manifold); }

    void AddInnerBall(const InnerBall& ball) {
        const InnerBallHit hit = FindInnerBallHit(ball, contacts_.views_, b_.IsTwoSided());
        if (!hit.exists) return;
        SurfaceManifold contact{{}, hit.triangle.id, hit.triangle.material};
        contact.manifold.normal = -(axes_ * hit.triangle.normal);
        contact.manifold.pointCount = 1;
        contact.manifold.points[0] = {contact.manifold.normal * ball.radius, hit.separation, kInnerBall};
        AppendManifold(contacts_.manifolds_, contacts_.manifoldCount_) = contact;
    }

    const ConvexShape& a_;
    const SurfaceShape& b_;
    const RelativePose& bInA_;
    const CollideSettings& settings_;
    SurfaceContacts& contacts_;
    PolyhedronStorage storage_;
    Polyhedron core_;  // if it is polyhedral
    Matrix3 axes_;     // of the surface, in the shape's frame
    Vector3 center_;   // of the shape, in the surface's frame
    Vector3 motion_;   // of the center within the step, likewise
    std::span<const uint32_t> touched_;
    bool isPolyhedral_;
    bool asksLibccd_;
};

size_t SurfaceContacts::MemoryUsed() const {
    return ids_.capacity() * sizeof(uint32_t) + (views_.capacity() + touched_.capacity()) * sizeof(TriangleView) +
           filter_.MemoryUsed() + manifolds_.capacity() * sizeof(SurfaceManifold);
}

void CollideSurface(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA,
                    const CollideSettings& settings, const SurfaceApproach& approach, SurfaceContacts& contacts) {
    SurfaceCollider(a, b, bInA, settings, approach, contacts).Run();
}

}  // namespace fulcrum
