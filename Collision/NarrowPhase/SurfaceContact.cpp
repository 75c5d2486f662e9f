#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>
#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/Gjk.h>
#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>
#include <Fulcrum/Collision/NarrowPhase/RoundTriangles.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleFaceContact.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <algorithm>
#include <bit>

namespace fulcrum {

namespace {

// A direction this near to the face's is the face's: a tenth of a degree.
constexpr float kFaceCosine = 0.9999985f;
// One this near may be that of an edge which counts as flat: 6 degrees, a little more than what makes an edge active.
constexpr float kFlatCosine = 0.9945f;
// Contacts whose directions are this near become one manifold: 2 degrees.
constexpr float kSameDirection = 0.9994f;
// A face of the shape that is this near to the direction of an edge rests on it, on two points: 4 degrees, more than a
// body turns in a step while it rocks from one point to the other.
constexpr float kRestingCosine = 0.9976f;
// The ball inside a shape matters where a step takes it farther than this part of its radius.
constexpr float kFastPart = 0.75f;

// The side of a triangle that a shape is on, as a one-sided triangle.
TriangleView Reversed(const TriangleView& view) {
    TriangleView r = view;
    std::swap(r.vertices[0], r.vertices[2]);
    std::swap(r.vertexIds[0], r.vertexIds[2]);
    r.normal = -view.normal;
    r.activeEdges =
        static_cast<uint8_t>((view.activeEdges & 4) | (view.activeEdges & 1) << 1 | (view.activeEdges >> 1 & 1));
    return r;
}

// Bounds of a shape in the surface's frame, by `reach` larger.
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

// Names that last from step to step: corners of A are the same on every triangle, corners of the surface on all around
// them.
uint32_t SurfaceFeature(uint32_t feature, const TriangleView& view) {
    const uint32_t kind = feature & kCrossing;
    if (kind == kVertexOfA) return feature;
    if (kind == kVertexOfB) return kVertexOfB | (view.vertexIds[(feature & 255u) % 3] & ~kCrossing);
    return kCrossing | ((feature * 0x9E3779B1u ^ view.id * 0x85EBCA6Bu) >> 2);
}

float DeepestOf(const Manifold& manifold) {
    float least = manifold.points[0].separation;
    for (int i = 1; i < manifold.pointCount; ++i) least = std::min(least, manifold.points[i].separation);
    return least;
}

// The deepest of so many directions hold any shape; a huge one may touch thousands of triangles, each turned otherwise.
constexpr size_t kMostManifolds = 128;

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
        contacts_.deferred_.clear();
        contacts_.known_.clear();
        contacts_.found_.clear();
        contacts_.manifoldCount_ = 0;
        contacts_.counters_ = {};
        Collect();
        const SurfaceProbe probe{a_,      isPolyhedral_ ? &core_ : nullptr, axes_,
                                 center_, settings_.speculativeDistance,    b_.IsTwoSided()};
        std::vector<TriangleView>& views = contacts_.views_;
        for (size_t first = 0; first < views.size(); first += 8)
            CollideBatch(probe, first, std::min<size_t>(views.size() - first, 8));
        if (!contacts_.deferred_.empty()) AddDeferredEdgeContacts();
        Join();
        const float fast = kFastPart * a_.InnerRadius();
        if (contacts_.manifoldCount_ > 0 && LengthSquared(motion_) > fast * fast) AddInnerBall(fast);
    }

private:
    void Collect() {
        std::vector<uint32_t>& ids = contacts_.ids_;
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

    // Those that the center has tunneled through: it is behind them, for which a batch leaves them out, but they were
    // touched before.
    void CollideTunneled(size_t first, size_t count) {
        for (size_t i = first; i < first + count; ++i)
            if (HasTunneled(contacts_.views_[i])) CollideTriangle(static_cast<uint32_t>(i));
    }
    // Only over the triangle itself: what tips over its edge gets behind it, too.
    bool HasTunneled(const TriangleView& view) const {
        return Height(view) < 0 && std::find(touched_.begin(), touched_.end(), view.id) != touched_.end() &&
               IsOver(view, center_, 0);
    }
    float Height(const TriangleView& view) const { return Dot(view.normal, Vector3(center_ - view.vertices[0])); }

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
            ResolveTriangleContact(index, axis, false, none, nearest);
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
            ResolveTriangleContact(index, segment.Axis(i), false, onFace, nearest);
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

    // `onFace`: what lies before its face, where that is known and is not all. `found`: by libccd, where it was asked.
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

    // Before the face first: most contacts are there.
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
        const ContactTolerances tolerances(core_.size + Sqrt(size), core_.radius, settings_);
        Manifold onFace;
        const FaceContact contact =
            BuildTriangleFaceContact(core_, incident, triangle, batch.separation[lane], tolerances, onFace);
        const bool found = onFace.pointCount > 0 && contact.touches;
        if (found && contact.proven) return AddFace(view, onFace);
        if (MeetsEdges(view, triangle, tolerances.reach)) return CollideTriangle(index, &onFace, byLibccd);
        if (onFace.pointCount == 0) return;
        if (found) return AddFace(view, onFace);
        if (!WaitForNeighbor(index, triangle, tolerances.prefer + 1e-3f * Sqrt(size), onFace))
            CollideTriangle(index, &onFace, byLibccd);
    }

    // Whether there is more to the triangle than its face. A shape without rounding that reaches no active edge lies
    // before the face, or has nothing to do with it.
    bool MeetsEdges(const TriangleView& view, const TriangleInShape& triangle, float reach) const {
        if (core_.radius > 0) return true;
        for (uint32_t bits = view.activeEdges; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const float edge = Dot(triangle.outwards[i], triangle.corners[i]);
            if (FarthestVertex(core_, triangle.outwards[i]).value >= edge - reach) return true;
        }
        return false;
    }

    // What lies before the face is not the deepest part of the shape: that lies beyond an inactive edge or corner,
    // where what is left comes nearest, and is the neighbor's. False: it is not clear beyond which.
    bool WaitForNeighbor(uint32_t index, const TriangleInShape& triangle, float slop, const Manifold& onFace) {
        const TriangleView& view = contacts_.views_[index];
        int deepest = 0;
        for (int i = 1; i < onFace.pointCount; ++i)
            if (onFace.points[i].separation < onFace.points[deepest].separation) deepest = i;
        const Vector3& point = onFace.points[deepest].positionOnA;
        int sides[3], count = 0;
        for (int i = 0; i < 3; ++i)
            if (Dot(triangle.outwards[i], Vector3(point - triangle.corners[i])) >= -slop) sides[count++] = i;
        if (count != 1 && count != 2) return false;
        // Side i ends where side i + 1 begins.
        const int first = count == 1 ? sides[0] : (sides[1] - sides[0] == 1 ? sides[1] : 0);
        SurfaceContacts::DeferredEdgeContact deferred;
        deferred.contact = deferred.onFace = Named(view, onFace);
        deferred.triangle = index;
        deferred.vertices[0] = view.vertexIds[first];
        deferred.vertices[1] = view.vertexIds[count == 1 ? (first + 1) % 3 : first];
        deferred.separation = DeepestOf(onFace);
        deferred.active = false;
        contacts_.deferred_.push_back(deferred);
        return true;
    }

    // A shape without rounding lies before a face, or has nothing to do with one whose edges are inactive.
    bool FacesAlone(const TriangleView& view) const { return core_.radius <= 0 && view.activeEdges == 0; }
    bool IsFaceContact(const TriangleView& view, const FaceContact& contact, const Manifold& onFace) const {
        return onFace.pointCount > 0 && contact.touches && (contact.proven || FacesAlone(view));
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
        ResolveTriangleContact(index, pair.DirectionInB(known.axis), overlaps, onFace, nearest);
    }

    void CollideCurved(uint32_t index, const Vector3 (&corners)[3], const RelativePose& pose,
                       const KnownContact* byLibccd) {
        const TriangleView& view = contacts_.views_[index];
        const Triangle triangle(corners, view.normal);
        const SupportPair pair(a_, triangle, pose);
        ContactTolerances tolerances(pair.InnerRadii(), pair.RadiusSum(), settings_);
        tolerances.facesAhead = false;
        const Vector3 inwards = -(pair.rotation * view.normal);
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
        Manifold onFace, nearest;
        PairCache none;
        onFace.pointCount = nearest.pointCount = 0;
        const float separation = pair.SeparationAlong(inwards);
        if (separation <= tolerances.reach) {
            BuildConvexContact(pair, {inwards, separation, pair.a.SupportCore(inwards)}, tolerances, none, onFace);
            if (onFace.pointCount > 0 && Dot(onFace.normal, inwards) < kFlatCosine) onFace.pointCount = 0;
        }
        none = {};
        BuildConvexContact(pair, known, tolerances, none, nearest);
        ResolveTriangleContact(index, pair.DirectionInB(known.axis), overlaps, onFace, nearest);
    }

    // Decides what a triangle's contact is: before its face, or at what is nearest along `axis` (towards the triangle,
    // in the surface's frame).
    void ResolveTriangleContact(uint32_t index, const Vector3& axis, bool overlaps, const Manifold& onFace,
                                const Manifold& nearest) {
        const TriangleView& view = contacts_.views_[index];
        if (Dot(axis, view.normal) > 0) {
            // Out through the back is no way out of a surface.
            if (overlaps && onFace.pointCount > 0) AddFace(view, onFace);
            return;
        }
        if (nearest.pointCount == 0) return;
        if (-Dot(axis, view.normal) > kFaceCosine) AddFace(view, nearest);
        else Wait(index, axis, nearest, onFace);
    }

    void Wait(uint32_t index, const Vector3& axis, const Manifold& manifold, const Manifold& onFace) {
        const TriangleView& view = contacts_.views_[index];
        float along[3], least = 0, most = 0;
        for (int i = 0; i < 3; ++i) {
            along[i] = Dot(axis, Vector3(view.vertices[i] - view.vertices[0]));
            least = std::min(least, along[i]);
            most = std::max(most, along[i]);
        }
        const float nearly = least + 1e-3f * (most - least);
        int nearest[3], count = 0;
        for (int i = 0; i < 3; ++i)
            if (along[i] <= nearly) nearest[count++] = i;
        SurfaceContacts::DeferredEdgeContact deferred;
        const auto isActive = [&](int edge) { return (view.activeEdges >> edge & 1) != 0; };
        if (count >= 2) {
            // Corners 0 and 1 are edge 0, 1 and 2 edge 1, 2 and 0 edge 2.
            deferred.active = isActive(nearest[1] - nearest[0] == 1 ? nearest[0] : 2);
        } else {
            deferred.active = isActive(nearest[0]) || isActive((nearest[0] + 2) % 3);
        }
        deferred.active |= -Dot(axis, view.normal) > kFlatCosine;
        if (!deferred.active && onFace.pointCount == 0) return;
        deferred.vertices[0] = view.vertexIds[nearest[0]];
        deferred.vertices[1] = view.vertexIds[nearest[count >= 2 ? 1 : 0]];
        deferred.triangle = index;
        deferred.onFace = Named(view, onFace);
        deferred.contact = deferred.active ? Named(view, manifold) : deferred.onFace;
        deferred.separation = DeepestOf(deferred.contact.manifold);
        contacts_.deferred_.push_back(deferred);
    }

    SurfaceManifold Named(const TriangleView& view, const Manifold& manifold) const {
        SurfaceManifold named{manifold, view.id, view.material};
        for (int i = 0; i < manifold.pointCount; ++i)
            named.manifold.points[i].feature = SurfaceFeature(manifold.points[i].feature, view);
        return named;
    }
    void AddFace(const TriangleView& view, const Manifold& manifold) {
        contacts_.found_.push_back(Named(view, manifold));
        contacts_.known_.insert(contacts_.known_.end(), view.vertexIds, view.vertexIds + 3);
    }

    void AddDeferredEdgeContacts() {
        // The vertices of faces that touch; all vertices of what waits; for each of these whether it is known. Sorted,
        // since a large shape may touch any number of them.
        std::vector<uint32_t>& known = contacts_.known_;
        std::sort(known.begin(), known.end());
        const ptrdiff_t faces = static_cast<ptrdiff_t>(known.size());
        for (const SurfaceContacts::DeferredEdgeContact& deferred : contacts_.deferred_)
            known.insert(known.end(), deferred.vertices, deferred.vertices + 2);
        std::sort(known.begin() + faces, known.end());
        known.erase(std::unique(known.begin() + faces, known.end()), known.end());
        const ptrdiff_t asked = static_cast<ptrdiff_t>(known.size()) - faces;
        known.resize(known.size() + static_cast<size_t>(asked));
        for (ptrdiff_t i = 0; i < asked; ++i)
            known[static_cast<size_t>(faces + asked + i)] =
                std::binary_search(known.begin(), known.begin() + faces, known[static_cast<size_t>(faces + i)]);
        const auto isKnown = [&](uint32_t vertex) -> uint32_t& {
            return *(std::lower_bound(known.begin() + faces, known.begin() + faces + asked, vertex) + asked);
        };
        std::sort(contacts_.deferred_.begin(), contacts_.deferred_.end(), [](const auto& x, const auto& y) {
            if (x.active != y.active) return x.active;
            return x.separation < y.separation ||
                   (x.separation == y.separation && x.contact.triangle < y.contact.triangle);
        });
        for (const SurfaceContacts::DeferredEdgeContact& deferred : contacts_.deferred_) {
            const bool isOfOther = isKnown(deferred.vertices[0]) && isKnown(deferred.vertices[1]);
            // What lies before a face rests on it, though the neighbor is nearer: without it a shape across two faces
            // would rock.
            if (!isOfOther) contacts_.found_.push_back(deferred.contact);
            else if (deferred.onFace.manifold.pointCount > 0) contacts_.found_.push_back(deferred.onFace);
            isKnown(deferred.vertices[0]) = isKnown(deferred.vertices[1]) = 1;
        }
    }

    // Makes manifolds of what was found, the deepest of each direction giving the normal.
    void Join() {
        std::vector<SurfaceManifold>& found = contacts_.found_;
        if (found.size() > 1)
            std::sort(found.begin(), found.end(), [](const SurfaceManifold& x, const SurfaceManifold& y) {
                const float dx = DeepestOf(x.manifold), dy = DeepestOf(y.manifold);
                return dx < dy || (dx == dy && x.triangle < y.triangle);
            });
        for (size_t i = 0; i < found.size() && contacts_.manifoldCount_ < kMostManifolds; ++i) {
            if (found[i].manifold.pointCount == 0) continue;  // already part of another
            if (contacts_.manifolds_.size() == contacts_.manifoldCount_) contacts_.manifolds_.emplace_back();
            contacts_.manifolds_[contacts_.manifoldCount_++] = JoinInto(found, i);
        }
    }

    // The contact of the ball inside the shape with the face that it meets first, if it meets one.
    void AddInnerBall(float fast) {
        const TriangleView* first = nullptr;
        float earliest = 1, gap = 0;
        for (const TriangleView& original : contacts_.views_) {
            const TriangleView view = b_.IsTwoSided() && Height(original) < 0 ? Reversed(original) : original;
            const float height = Height(view), approach = -Dot(motion_, view.normal),
                        above = std::max(height - a_.InnerRadius(), 0.0f);
            if (height < 0 || approach <= fast || above >= earliest * approach ||
                !IsOver(view, center_ + motion_ * (above / approach), a_.InnerRadius()))
                continue;
            earliest = above / approach;
            gap = height - a_.InnerRadius();
            first = &original;
        }
        if (!first) return;
        const TriangleView view = b_.IsTwoSided() && Height(*first) < 0 ? Reversed(*first) : *first;
        SurfaceManifold ball{{}, view.id, view.material};
        ball.manifold.normal = -(axes_ * view.normal);
        ball.manifold.pointCount = 1;
        ball.manifold.points[0] = {ball.manifold.normal * a_.InnerRadius(), gap, kInnerBall};
        if (contacts_.manifolds_.size() == contacts_.manifoldCount_) contacts_.manifolds_.emplace_back();
        contacts_.manifolds_[contacts_.manifoldCount_++] = ball;
    }

    // Whether a ball of that radius is over the triangle, in part at least.
    static bool IsOver(const TriangleView& view, const Vector3& at, float radius) {
        for (int i = 0; i < 3; ++i) {
            const Vector3 edge = view.vertices[(i + 1) % 3] - view.vertices[i];
            if (Dot(Cross<float>(edge, view.normal), Vector3(at - view.vertices[i])) > radius * Length(edge))
                return false;
        }
        return true;
    }

    SurfaceManifold JoinInto(std::vector<SurfaceManifold>& found, size_t first) const {
        SurfaceManifold joined = found[first];
        found[first].manifold.pointCount = 0;
        const auto isSame = [&](const SurfaceManifold& other) {
            return other.manifold.pointCount > 0 && other.material == joined.material &&
                   Dot(other.manifold.normal, joined.manifold.normal) >= kSameDirection;
        };
        if (std::none_of(found.begin() + static_cast<ptrdiff_t>(first) + 1, found.end(), isSame)) return joined;
        Points points(joined.manifold.normal, 1e-3f * a_.InnerRadius());
        points.Add(joined.manifold);
        for (size_t i = first + 1; i < found.size(); ++i) {
            if (!isSame(found[i])) continue;
            points.Add(found[i].manifold);
            found[i].manifold.pointCount = 0;
        }
        points.Write(joined.manifold);
        return joined;
    }

    // Points of several manifolds, along one normal.
    class Points {
    public:
        Points(const Vector3& normal, float slop)
            : normal_(normal), u_(Perpendicular(normal)), v_(Cross<float>(normal, u_)), slop_(slop) {}

        void Add(const Manifold& manifold) {
            for (int i = 0; i < manifold.pointCount; ++i) Add(manifold.points[i], manifold.normal);
        }
        void Write(Manifold& manifold) {
            Reduce();
            manifold.pointCount = count_;
            std::copy(points_, points_ + count_, manifold.points);
        }

    private:
        static constexpr int kRoom = 64;

        void Add(ManifoldPoint point, const Vector3& itsNormal) {
            point.separation *= Dot(itsNormal, normal_);
            for (int i = 0; i < count_; ++i) {
                if (points_[i].feature != point.feature) continue;
                if (point.separation < points_[i].separation) points_[i] = point;
                return;
            }
            if (count_ == kRoom) Reduce();
            points_[count_++] = point;
        }
        void Reduce() {
            // Corners of the shape first: the choice prefers what comes first, and they last while it slides from
            // triangle to triangle.
            int order[kRoom], n = 0;
            for (const bool corners : {true, false})
                for (int i = 0; i < count_; ++i)
                    if (((points_[i].feature & kCrossing) == kVertexOfA) == corners) order[n++] = i;
            FlatPoints<kRoom> flat;
            for (int i = 0; i < count_; ++i) {
                const ManifoldPoint& point = points_[order[i]];
                flat.Add(Dot(u_, point.positionOnA), Dot(v_, point.positionOnA), point.separation);
            }
            int chosen[4];
            count_ = ChooseFour(flat, slop_, chosen, kLeastWeightOnSurfaces);
            ManifoldPoint kept[4];
            for (int i = 0; i < count_; ++i) kept[i] = points_[order[chosen[i]]];
            std::copy(kept, kept + count_, points_);
        }

        Vector3 normal_, u_, v_;
        float slop_;
        ManifoldPoint points_[kRoom];
        int count_ = 0;
    };

    const ConvexShape& a_;
    const SurfaceShape& b_;
    const RelativePose& bInA_;
    const CollideSettings& settings_;
    SurfaceContacts& contacts_;
    PolyhedronStorage storage_;
    Polyhedron core_;  // where it is one
    Matrix3 axes_;     // of the surface, in the shape's frame
    Vector3 center_;   // of the shape, in the surface's frame
    Vector3 motion_;   // of the center within the step, likewise
    std::span<const uint32_t> touched_;
    bool isPolyhedral_;
    bool asksLibccd_;
};

size_t SurfaceContacts::MemoryUsed() const {
    return (ids_.capacity() + known_.capacity()) * sizeof(uint32_t) + views_.capacity() * sizeof(TriangleView) +
           deferred_.capacity() * sizeof(DeferredEdgeContact) +
           (found_.capacity() + manifolds_.capacity()) * sizeof(SurfaceManifold);
}

void CollideSurface(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA,
                    const CollideSettings& settings, const SurfaceApproach& approach, SurfaceContacts& contacts) {
    SurfaceCollider(a, b, bInA, settings, approach, contacts).Run();
}

}  // namespace fulcrum
