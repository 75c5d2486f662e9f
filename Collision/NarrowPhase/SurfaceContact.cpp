#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>
#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/Gjk.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <algorithm>

namespace fulcrum {

namespace {

// A direction this near to the face's is the face's: a tenth of a degree.
constexpr float kFaceCosine = 0.9999985f;
// One this near may be that of an edge which counts as flat: 6 degrees, a little more than what makes an edge active.
constexpr float kFlatCosine = 0.9945f;
// Contacts whose directions are this near become one manifold: 2 degrees.
constexpr float kSameDirection = 0.9994f;

// The side of a triangle that a shape is on, as a one-sided triangle.
TriangleView Reversed(const TriangleView& view) {
    TriangleView r = view;
    std::swap(r.vertices[0], r.vertices[2]);
    std::swap(r.vertexIds[0], r.vertexIds[2]);
    r.normal = -view.normal;
    r.activeEdges = static_cast<uint8_t>((view.activeEdges & 4) | (view.activeEdges & 1) << 1 | (view.activeEdges >> 1 & 1));
    return r;
}

// Bounds of a shape in the surface's frame, by `reach` larger.
Bounds BoundsInSurface(const ConvexShape& a, const RelativePose& bInA, float reach) {
    const Matrix3 axes = ToMatrix(bInA.rotation.Conjugate());
    const Vector3 origin = -(axes * bInA.position), half = a.LocalBounds().HalfExtents();
    const Vector3 centre = axes * a.LocalBounds().Centre();
    const Vector3 extent = axes.x.cwiseAbs() * half.x() + axes.y.cwiseAbs() * half.y() + axes.z.cwiseAbs() * half.z();
    const Vector3 sphere = Vector3::Constant(a.OuterRadius()), margin = Vector3::Constant(reach);
    Bounds bounds;
    bounds.lower = origin + Vector3(centre - extent).cwiseMax(-sphere) - margin;
    bounds.upper = origin + Vector3(centre + extent).cwiseMin(sphere) + margin;
    return bounds;
}

// Names that last from step to step: corners of A are the same on every triangle, corners of the surface on all around them.
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

}  // namespace

class SurfaceCollider {
public:
    SurfaceCollider(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA, const CollideSettings& settings,
                    SurfaceContacts& contacts)
        : a_(a), b_(b), bInA_(bInA), settings_(settings), contacts_(contacts), axes_(ToMatrix(bInA.rotation)),
          centre_(bInA.InverseTransform(Vector3::Zero())), isPolyhedral_(HasPolyhedralCore(a.Type())) {
        if (isPolyhedral_) core_ = CoreOf(a, storage_);
    }

    void Run() {
        contacts_.waiting_.clear();
        contacts_.known_.clear();
        contacts_.found_.clear();
        contacts_.manifoldCount_ = 0;
        Collect();
        for (uint32_t i = 0; i < contacts_.views_.size(); ++i) {
            TriangleView& view = contacts_.views_[i];
            if (b_.IsTwoSided() && Height(view) < 0) view = Reversed(view);
            if (MayReach(view)) CollideTriangle(i);
        }
        if (!contacts_.waiting_.empty()) AddWaiting();
        Join();
    }

private:
    // Of the shape's centre above the face, m.
    float Height(const TriangleView& view) const { return Dot(view.normal, Vector3(centre_ - view.vertices[0])); }

    void Collect() {
        std::vector<uint32_t>& ids = contacts_.ids_;
        ids.clear();
        b_.VisitTriangles(BoundsInSurface(a_, bInA_, settings_.speculativeDistance), [&](uint32_t id) { ids.push_back(id); });
        contacts_.views_.resize(ids.size());
        b_.GetTriangles(ids, contacts_.views_.data());
    }

    // Whether the shape may come near the triangle, its centre being in front.
    bool MayReach(const TriangleView& view) const {
        const float reach = settings_.speculativeDistance, radius = a_.OuterRadius() + reach, height = Height(view);
        if (height < 0 || height > radius) return false;
        for (int i = 0; i < 3; ++i) {
            const Vector3& from = view.vertices[i];
            const Vector3 outwards = Cross<float>(Vector3(view.vertices[(i + 1) % 3] - from), view.normal);
            const float beyond = Dot(outwards, Vector3(centre_ - from));
            if (beyond <= 0) continue;
            const float length = Sqrt(Dot(outwards, outwards));
            if (beyond > radius * length) return false;
            // The plane through the edge separates the shape from the triangle where it lies beyond as a whole.
            if (beyond > a_.InnerRadius() * length && beyond - Reach(axes_ * outwards) > (reach + a_.ConvexRadius()) * length) return false;
        }
        return true;
    }

    // How far the core extends against a direction in its own frame.
    float Reach(const Vector3& direction) const {
        return isPolyhedral_ ? FarthestVertex(core_, -direction).value : -Dot(direction, a_.SupportCore(-direction));
    }

    void CollideTriangle(uint32_t index) {
        const TriangleView& view = contacts_.views_[index];
        const Vector3 middle = (view.vertices[0] + view.vertices[1] + view.vertices[2]) * (1.0f / 3.0f);
        const Vector3 corners[3] = {view.vertices[0] - middle, view.vertices[1] - middle, view.vertices[2] - middle};
        const RelativePose pose{bInA_.Transform(middle), bInA_.rotation};
        if (isPolyhedral_) CollidePolyhedron(index, corners, pose);
        else CollideCurved(index, corners, pose);
    }

    void CollidePolyhedron(uint32_t index, const Vector3 (&corners)[3], const RelativePose& pose) {
        const TriangleView& view = contacts_.views_[index];
        PolyhedronStorage storage;
        const PolyhedronPair pair(core_, CoreOf(corners, view.normal, 0, storage), pose);
        const ContactTolerances tolerances = pair.Tolerances(settings_);
        const ReferenceFace face = MeasureFace(pair, false, 0);
        if (face.separation > tolerances.reach) return;
        Manifold onFace;
        const FaceContact contact = BuildFaceContact(pair, face, tolerances, onFace);
        // A shape without rounding lies before a face, or has nothing to do with one whose edges are inactive.
        const bool facesAlone = core_.radius <= 0 && view.activeEdges == 0;
        if (onFace.pointCount == 0 && facesAlone) return;
        if (onFace.pointCount > 0 && contact.touches && (contact.proven || facesAlone)) return AddFace(view, onFace);

        const Vector3 inwards = -(pair.rotation * view.normal);
        const auto gjk = Gjk(pair, inwards, tolerances.reach);
        if (gjk.status == GjkStatus::BeyondReach) return;
        KnownAxis known{gjk.axis, gjk.separation, tolerances.feature};
        const bool overlaps = gjk.status == GjkStatus::Overlapping;
        if (overlaps) {
            const EpaResult epa = Epa(pair, gjk.simplex);
            const FoundAxis found = epa.status == EpaResult::Status::Found ? FoundAxis{epa.axis, epa.separation} : SearchAllAxes(pair);
            known.axis = found.axis;
            known.separation = found.separation;
        }
        Manifold nearest;
        PairCache none;
        BuildContactFromAxis(pair, known, tolerances, none, nearest);
        Settle(index, pair.DirectionInB(known.axis), overlaps, onFace, nearest);
    }

    void CollideCurved(uint32_t index, const Vector3 (&corners)[3], const RelativePose& pose) {
        const TriangleView& view = contacts_.views_[index];
        const Triangle triangle(corners, view.normal);
        const SupportPair pair(a_, triangle, pose);
        const ContactTolerances tolerances(pair.InnerRadii(), pair.RadiusSum(), settings_);
        const Vector3 inwards = -(pair.rotation * view.normal);
        const ConvexGjkResult gjk = ConvexGjk(pair, inwards, tolerances.reach);
        if (gjk.status == GjkStatus::BeyondReach) return;
        const bool overlaps = gjk.status == GjkStatus::Overlapping;
        const KnownContact known = overlaps ? FindDepth(pair, gjk.simplex, inwards) : KnownContact{gjk.axis, gjk.separation, gjk.onA};
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
        Settle(index, pair.DirectionInB(known.axis), overlaps, onFace, nearest);
    }

    // Decides what a triangle's contact is: before its face, or at what is nearest along `axis` (towards the triangle, in the
    // surface's frame).
    void Settle(uint32_t index, const Vector3& axis, bool overlaps, const Manifold& onFace, const Manifold& nearest) {
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
        SurfaceContacts::Waiting waiting;
        const auto isActive = [&](int edge) { return (view.activeEdges >> edge & 1) != 0; };
        if (count >= 2) {
            // Corners 0 and 1 are edge 0, 1 and 2 edge 1, 2 and 0 edge 2.
            waiting.active = isActive(nearest[1] - nearest[0] == 1 ? nearest[0] : 2);
        } else {
            waiting.active = isActive(nearest[0]) || isActive((nearest[0] + 2) % 3);
        }
        waiting.active |= -Dot(axis, view.normal) > kFlatCosine;
        if (!waiting.active && onFace.pointCount == 0) return;
        waiting.vertices[0] = view.vertexIds[nearest[0]];
        waiting.vertices[1] = view.vertexIds[nearest[count >= 2 ? 1 : 0]];
        waiting.triangle = index;
        waiting.contact = Named(view, waiting.active ? manifold : onFace);
        waiting.separation = DeepestOf(waiting.contact.manifold);
        contacts_.waiting_.push_back(waiting);
    }

    SurfaceManifold Named(const TriangleView& view, const Manifold& manifold) const {
        SurfaceManifold named{manifold, view.id, view.material};
        for (int i = 0; i < manifold.pointCount; ++i) named.manifold.points[i].feature = SurfaceFeature(manifold.points[i].feature, view);
        return named;
    }
    void AddFace(const TriangleView& view, const Manifold& manifold) {
        contacts_.found_.push_back(Named(view, manifold));
        contacts_.known_.insert(contacts_.known_.end(), view.vertexIds, view.vertexIds + 3);
    }

    void AddWaiting() {
        std::vector<uint32_t>& known = contacts_.known_;
        std::sort(known.begin(), known.end());
        const ptrdiff_t ofFaces = static_cast<ptrdiff_t>(known.size());
        const auto isKnown = [&](uint32_t vertex) {
            return std::binary_search(known.begin(), known.begin() + ofFaces, vertex) ||
                   std::find(known.begin() + ofFaces, known.end(), vertex) != known.end();
        };
        std::sort(contacts_.waiting_.begin(), contacts_.waiting_.end(), [](const auto& x, const auto& y) {
            if (x.active != y.active) return x.active;
            return x.separation < y.separation || (x.separation == y.separation && x.contact.triangle < y.contact.triangle);
        });
        for (const SurfaceContacts::Waiting& waiting : contacts_.waiting_) {
            if (isKnown(waiting.vertices[0]) && isKnown(waiting.vertices[1])) continue;
            contacts_.found_.push_back(waiting.contact);
            known.insert(known.end(), waiting.vertices, waiting.vertices + 2);
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
        for (size_t i = 0; i < found.size(); ++i) {
            if (found[i].manifold.pointCount == 0) continue;  // already part of another
            if (contacts_.manifolds_.size() == contacts_.manifoldCount_) contacts_.manifolds_.emplace_back();
            contacts_.manifolds_[contacts_.manifoldCount_++] = JoinInto(found, i);
        }
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
        Points(const Vector3& normal, float slop) : normal_(normal), u_(Perpendicular(normal)), v_(Cross<float>(normal, u_)), slop_(slop) {}

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
            // Corners of the shape first: the choice prefers what comes first, and they last while it slides from triangle to
            // triangle.
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
            count_ = ChooseFour(flat, slop_, chosen);
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
    Polyhedron core_;   // where it is one
    Matrix3 axes_;      // of the surface, in the shape's frame
    Vector3 centre_;    // of the shape, in the surface's frame
    bool isPolyhedral_;
};

void CollideSurface(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA, const CollideSettings& settings,
                    SurfaceContacts& contacts) {
    SurfaceCollider(a, b, bInA, settings, contacts).Run();
}

}  // namespace fulcrum
