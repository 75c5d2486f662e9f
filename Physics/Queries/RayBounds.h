// The box around the origins of some rays and that around their displacements: how close together they lie. Used by the batches of
// ray casts. Pure.
#pragma once

#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Math/Bounds.h>

namespace fulcrum {

struct RayBounds {
    Position low = Position::Constant(kFar), high = Position::Constant(-kFar);
    Bounds displacements;

    // What is not finite counts as near.
    void Include(const Ray& ray) {
        for (int axis = 0; axis < 3; ++axis) {
            const double at = ray.origin[axis];
            const float along = ray.displacement[axis];
            low[axis] = at < low[axis] ? at : low[axis];
            high[axis] = at > high[axis] ? at : high[axis];
            displacements.lower[axis] = Min(along, displacements.lower[axis]);
            displacements.upper[axis] = Max(along, displacements.upper[axis]);
        }
    }

    // Half the sides of a box that holds all rays on their way, begun in the middle of their origins.
    Vector3 Reach() const { return Vector3(Position((high - low) * 0.5).cast<float>()) + displacements.HalfExtents(); }
    // Whether that box is so small beside its way that it will hardly find more than its rays do.
    bool IsTight() const { return Reach().sum() <= kTight * displacements.Centre().cwiseAbs().sum(); }

    static constexpr float kTight = 0.25f;
    static constexpr double kFar = 1e300;

    template <class Rays>
    static RayBounds Of(const Rays& rays) {
        RayBounds bounds;
        for (const Ray& ray : rays) bounds.Include(ray);
        return bounds;
    }
};

}  // namespace fulcrum
