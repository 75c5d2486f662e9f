// QueryInterface::CollideShape: the narrow phase for a shape that is not a body.
#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Physics/Queries/ColliderSearch.h>
#include <Fulcrum/Physics/QueryInterface.h>

#include <algorithm>
#include <tuple>

namespace fulcrum {

namespace {

// The convex piece of the query, and the piece of the body, in the world.
struct Pieces {
    const ConvexShape& shape;
    Pose pose;
    uint32_t child;
    const Shape& other;
    Pose poseOfOther;
};

// A manifold in the piece's frame, with its normal towards the body; empty if no point is near enough.
void Add(const Pieces& pieces, const WorldContact& of, const Manifold& manifold, float maxSeparation,
         std::vector<WorldContact>& contacts) {
    WorldContact contact = of;
    contact.childOfQuery = pieces.child;
    contact.normal = Normalized(Vector3(-Rotate(pieces.pose.rotation, manifold.normal)), Vector3::Zero());
    // Shapes of extreme sizes, or far apart, can bring any pair function beyond the floats.
    if (contact.normal.isZero(0) || !IsFinite(contact.normal)) return;
    for (int i = 0; i < manifold.pointCount; ++i) {
        const ManifoldPoint& point = manifold.points[i];
        if (!(point.separation <= maxSeparation)) continue;
        const Position onBody = pieces.pose.Transform(point.positionOnA + manifold.normal * point.separation),
                       onQuery = pieces.pose.Transform(point.positionOnA);
        if (IsFinite(onBody) && IsFinite(onQuery))
            contact.points[contact.pointCount++] = {onBody, onQuery, point.separation};
    }
    if (contact.pointCount > 0) contacts.push_back(contact);
}

void CollidePieces(const Pieces& pieces, const WorldContact& of, float maxSeparation, NarrowPhaseMethod method,
                   SurfaceContacts& surface, std::vector<WorldContact>& contacts) {
    // The narrow phase needs a positive distance; points beyond maxSeparation are removed later.
    const CollideSettings settings{std::max(maxSeparation, 1e-3f * pieces.shape.OuterRadius()), method};
    const RelativePose relative = Relative(pieces.pose, pieces.poseOfOther);
    if (pieces.other.IsSurface()) {
        CollideSurface(pieces.shape, static_cast<const SurfaceShape&>(pieces.other), relative, settings, {}, surface);
        for (const SurfaceManifold& found : surface.Manifolds()) {
            WorldContact here = of;
            here.subShape.triangle = found.triangle;
            Add(pieces, here, found.manifold, maxSeparation, contacts);
        }
        return;
    }
    Manifold manifold;
    PairCache cache;
    CollideCounters counters;
    if (pieces.other.Type() == ShapeType::Plane)
        Collide(pieces.shape, static_cast<const Plane&>(pieces.other), relative, settings, cache, manifold, counters);
    else
        Collide(pieces.shape, static_cast<const ConvexShape&>(pieces.other), relative, settings, cache, manifold,
                counters);
    Add(pieces, of, manifold, maxSeparation, contacts);
}

bool ComesBefore(const WorldContact& a, const WorldContact& b) {
    const auto keyOf = [](const WorldContact& c) {
        return std::tuple(c.body, c.subShape.child, c.childOfQuery, c.subShape.triangle, c.normal.x(), c.normal.y(),
                          c.normal.z());
    };
    return keyOf(a) < keyOf(b);
}

}  // namespace

void QueryInterface::CollideShape(const PlacedShape& shape, float maxSeparation, std::vector<WorldContact>& contacts,
                                  const QueryFilter& filter) const {
    contacts.clear();
    const QueryScope scope(world_);
    if (!scope) return;
    if (!shape.shape || !(shape.shape->IsConvex() || shape.shape->IsCompound()))
        return ReportMisuse({ErrorCode::Unsupported, "CollideShape needs a convex shape or a compound"});
    if (!IsRotation(shape.pose.rotation) || !(maxSeparation >= 0)) return;
    const Pose center = CenterPoseOf(*shape.shape, {shape.pose.position, Normalized(shape.pose.rotation)});
    if (!IsFinite(center.position)) return;
    const ColliderSearch search(world_, filter);
    const NarrowPhaseMethod method = world_.settings.narrowPhase;
    const Bounds bounds = Inflated(BoundsAbout(search.Origin(), *shape.shape, center), maxSeparation);
    SurfaceContacts surface;
    search.Run([&](const BoundsTree& tree, const auto& found) { tree.Query(bounds, found); },
               [&](uint32_t collider) {
                   WorldContact of;
                   of.body = search.IdOf(collider);
                   of.subShape.child = search.ChildOf(collider);
                   const Shape& other = search.ShapeOf(collider);
                   const Pose at = search.PoseOf(collider);
                   if (!IsWithinReach(center.position - at.position)) return;
                   const auto collide = [&](const ConvexShape& piece, const Pose& pose, uint32_t child) {
                       CollidePieces({piece, pose, child, other, at}, of, maxSeparation, method, surface, contacts);
                   };
                   if (shape.shape->IsConvex())
                       return collide(static_cast<const ConvexShape&>(*shape.shape), center, 0);
                   const auto& compound = static_cast<const CompoundShape&>(*shape.shape);
                   for (uint32_t child = 0; child < compound.Children().size(); ++child) {
                       const CompoundShape::Child& entry = compound.ChildAt(child);
                       if (entry.shape) collide(*entry.shape, center * compound.PoseOf(entry), child);
                   }
               });
    std::ranges::sort(contacts, ComesBefore);
}

}  // namespace fulcrum
