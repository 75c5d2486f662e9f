// The shapes of a pair's colliders. A pair has no room for them: in a scene in motion most pairs are of bounds that
// overlap while the shapes do not touch.
#pragma once

#include <Fulcrum/Physics/World/ColliderStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

namespace fulcrum {

struct PairShapes {
    const ConvexShape& a;
    const Shape& b;  // convex, a plane or a surface
};

inline PairShapes ShapesOf(const ColliderStore& colliders, const Pair& pair) {
    // Body A is dynamic: such bodies have convex shapes.
    return {static_cast<const ConvexShape&>(*colliders.shapes[pair.colliderA].shape),
            *colliders.shapes[pair.colliderB].shape};
}

}  // namespace fulcrum
