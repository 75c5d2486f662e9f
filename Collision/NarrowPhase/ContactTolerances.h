// Tolerances of one narrow-phase query. Used by the pair functions.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>
#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

// m: what is no higher than this above the surface on which a shape rests continues it. outerRadius: of the shape, m.
inline float FlushHeight(float outerRadius) { return Min(1e-3f, 0.01f * outerRadius); }

struct ContactTolerances {
    // Fraction of the two shapes' radii: with a larger speculative distance, points other than the closest may touch
    // within the step.
    static constexpr float kFarAhead = 0.1f;
    // Likewise: the speculative distance of resting bodies is smaller, that of fast ones includes their motion.
    static constexpr float kRestingAhead = 0.25f;

    float reach;    // m: the cores' separation up to which there are points
    float prefer;   // m: a face contact is preferred if its separation is at most this much below the best axis
    float feature;  // m: vertices this close to the extreme one belong to the supporting feature
    // A face of A is also preferred if the cosine between its normal and the best axis is at least this.
    float faceOfACosine = 2;
    float closing = 0;  // m, for contacts with surfaces: motion of the shape towards it within the step
    bool rests;         // whether the shapes move little within the step
    bool facesAhead;    // whether contacts of edges get points of the adjacent faces, too

    // `innerRadii`: the sum of the radii of the balls inside the two cores, or a size for flat ones; `rounding`: the
    // sum of their convex radii. In m.
    ContactTolerances(float innerRadii, float rounding, const CollideSettings& settings)
        : reach(settings.speculativeDistance + rounding),
          prefer(Min(0.02f * settings.speculativeDistance, 0.002f * (innerRadii + rounding))),
          feature(1e-4f * (innerRadii + rounding)),
          rests(settings.speculativeDistance <= kRestingAhead * (innerRadii + rounding)),
          facesAhead(settings.speculativeDistance > kFarAhead * (innerRadii + rounding)) {}

    // For contacts of convex shapes. Of those that move fast the corners that touch next need not be the nearest.
    PointWeights Weights() const { return rests ? PointWeights{kLeastPointWeight, 0, 1e-3f} : PointWeights{}; }
    float Apart() const { return 500 * feature; }  // m: points closer to each other than this are redundant
};

}  // namespace fulcrum
