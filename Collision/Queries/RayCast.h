// Rays against a single shape at a pose. Called by the world's queries and by users who have shapes and no world.
// Thread-safe; allocates nothing.
//
// Convex shapes and half spaces are solid: a ray that starts inside, or on the surface, hits at fraction 0, with a
// normal against the ray. With `hollow`, a ray that starts inside hits them at its exit, and only with `backFaces`.
// Triangles follow SurfaceShape. A ray that is not finite or has no length hits nothing.
#pragma once

#include <Fulcrum/Collision/Queries/SubShape.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

namespace fulcrum {

// From `origin` to origin + displacement, m.
struct Ray {
    Position origin = Position::Zero();
    Vector3 displacement = Vector3::Zero();
};

struct RayCastSettings {
    bool backFaces = false;  // triangles are hit from behind, hollow shapes from inside
    bool hollow = false;     // a ray that starts inside a convex shape or half space does not hit it there
    float maxFraction = 1;   // >= 0, of the displacement; only hits up to here
};

struct RayHit {
    float fraction = 0;  // of the displacement
    SubShape subShape{};
    Vector3 normal = Vector3::Zero();  // unit, outwards; opposite to the ray if it hit a back face or began inside
    bool isBackFace = false;
};

// A ray prepared for casts against any number of shapes. Everything is in the ray's frame (the world's or another), and
// precise however far from its origin: only differences are rounded to float.
class RayCaster {
public:
    RayCaster() = default;  // not valid
    explicit RayCaster(const Ray& ray);
    bool IsValid() const { return length_ > 0; }  // if not, it hits nothing
    const Ray& GetRay() const { return ray_; }

    // The closest hit; ties are resolved by the lowest child, then triangle. `pose` is that of the shape's center
    // frame. Returns false, leaving `hit` unchanged, if there is none.
    bool CastClosest(const Shape& shape, const Pose& pose, const RayCastSettings& settings, RayHit& hit) const {
        return CastClosest(shape, pose, settings, settings.maxFraction, hit);
    }
    // The same for hits up to `limit` <= settings.maxFraction. Hits within the limit are bit-identical for every limit;
    // one slightly beyond may be found or not. So the closest hit of many shapes does not depend on their order.
    bool CastClosest(const Shape& shape, const Pose& pose, const RayCastSettings& settings, float limit,
                     RayHit& hit) const;
    // The same for several rays against a surface, cheaper if they are close together: for casters[i], limits[i] and
    // hits[i] if bit i of `which` is set, i < kMostRays. Returns the bits of those that hit; the other hits are
    // unchanged.
    static constexpr int kMostRays = SurfaceShape::kMostRays;
    static uint32_t CastClosest(const RayCaster* casters, uint32_t which, const SurfaceShape& shape, const Pose& pose,
                                const RayCastSettings& settings, const float* limits, RayHit* hits);
    // Whether there is any.
    bool IsHit(const Shape& shape, const Pose& pose, const RayCastSettings& settings) const;
    // Calls visit(const RayHit&) for the hit of each convex shape, child or half space and for all hits of triangles,
    // in no particular order, until it returns false. Returns false if it did.
    template <class Visitor>
    bool CastAll(const Shape& shape, const Pose& pose, const RayCastSettings& settings, Visitor&& visit) const;

private:
    using HitFunction = bool (*)(void* context, const RayHit& hit);
    bool CastConvex(const ConvexShape& shape, const Pose& pose, const RayCastSettings& settings, float limit,
                    RayHit& hit) const;
    bool CastPlane(const Shape& shape, const Pose& pose, const RayCastSettings& settings, RayHit& hit) const;
    bool CastSurface(const SurfaceShape& shape, const Pose& pose, const RayCastSettings& settings, float limit,
                     RayHit& hit) const;
    bool Search(const Shape& shape, const Pose& pose, const RayCastSettings& settings, void* context,
                HitFunction found) const;
    // The ray in the frame of a surface, starting at the surface's bounds, and the length that was cut off.
    SurfaceRay InFrameOf(const SurfaceShape& shape, const Pose& pose, bool backFaces, double& skipped) const;
    // The largest fraction of the cut ray.
    static float LeftOf(const RayCastSettings& settings, float limit, double skipped);
    static RayHit FromSurface(const SurfaceHit& found, const Pose& pose, const RayCastSettings& settings,
                              double skipped);

    Ray ray_;
    Vector3 direction_ = Vector3::Zero();  // unit
    double length_ = 0;                    // m; 0: not valid
    double inverseSquare_ = 0;             // 1/m2, of the length
};

template <class Visitor>
bool RayCaster::CastAll(const Shape& shape, const Pose& pose, const RayCastSettings& settings, Visitor&& visit) const {
    return Search(shape, pose, settings, const_cast<void*>(static_cast<const void*>(&visit)),
                  [](void* context, const RayHit& hit) -> bool {
                      return (*static_cast<std::remove_reference_t<Visitor>*>(context))(hit);
                  });
}

// A single ray in the frame of the shape.
inline bool CastRay(const Shape& shape, const Ray& ray, const RayCastSettings& settings, RayHit& hit) {
    return RayCaster(ray).CastClosest(shape, {}, settings, hit);
}

}  // namespace fulcrum
