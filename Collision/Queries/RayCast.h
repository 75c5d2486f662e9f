// Rays against a single shape at a pose. Called by the world's queries and by users who have shapes and no world.
// Thread-safe; allocates nothing.
//
// Convex shapes and half spaces are solid: a ray that starts inside, or on the surface, hits at fraction 0, with a normal
// against the ray. Hollow ones, on request, are hit from inside only where they are left, and only with `backFaces`. Triangles
// follow SurfaceShape. A ray that is not finite or has no length hits nothing.
#pragma once

#include <Fulcrum/Collision/Queries/ConvexRay.h>
#include <Fulcrum/Collision/Queries/SubShape.h>

namespace fulcrum {

// From `origin` to origin + displacement, m.
struct Ray {
    Position origin = Position::Zero();
    Vector3 displacement = Vector3::Zero();
};

struct RayCastSettings {
    bool backFaces = false;   // triangles are hit from behind, hollow shapes from inside
    bool hollow = false;      // a ray that starts inside a convex shape or half space does not hit it there
    float maxFraction = 1;    // >= 0, of the displacement; only hits up to here
};

struct RayHit {
    float fraction = 0;                // of the displacement
    SubShape subShape;
    Vector3 normal = Vector3::Zero();  // unit, outwards; against the ray where that came from behind or began inside
    bool isBackFace = false;
};

// A ray, ready to be cast at any number of shapes. Everything is in the frame of the ray, the world's or another, and exact
// however far from its origin: only differences become floats.
class RayCaster {
public:
    explicit RayCaster(const Ray& ray);
    bool IsValid() const { return length_ > 0; }  // else it hits nothing
    const Ray& GetRay() const { return ray_; }

    // The closest hit; of equally close ones that of the lowest child, then triangle. `pose` is that of the shape's centre
    // frame. False: none, `hit` is unchanged.
    bool CastClosest(const Shape& shape, const Pose& pose, const RayCastSettings& settings, RayHit& hit) const;
    // Whether there is any.
    bool IsHit(const Shape& shape, const Pose& pose, const RayCastSettings& settings) const;
    // Calls visit(const RayHit&) for the hit of each convex shape, child or half space and for all hits of triangles, in no
    // order, until it returns false. False: it did.
    template <class Visitor>
    bool CastAll(const Shape& shape, const Pose& pose, const RayCastSettings& settings, Visitor&& visit) const;

private:
    using HitFunction = bool (*)(void* context, const RayHit& hit);
    bool CastConvex(const ConvexShape& shape, const Pose& pose, const RayCastSettings& settings, RayHit& hit) const;
    bool CastPlane(const Shape& shape, const Pose& pose, const RayCastSettings& settings, RayHit& hit) const;
    bool CastSurface(const SurfaceShape& shape, const Pose& pose, const RayCastSettings& settings, RayHit& hit) const;
    bool Search(const Shape& shape, const Pose& pose, const RayCastSettings& settings, void* context, HitFunction found) const;
    // The ray in the frame of a surface, begun where it may first meet it; how much of it that leaves out.
    SurfaceRay InFrameOf(const SurfaceShape& shape, const Pose& pose, bool backFaces, double& skipped) const;

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
