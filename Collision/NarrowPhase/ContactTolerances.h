// Tolerances of one narrow-phase query. Used by the pair functions.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

struct ContactTolerances {
    static constexpr float kFarAhead =
        0.1f;  // of the two shapes' radii: a step's motion that may bring more than the closest points together

    float reach;    // m: the cores' separation up to which there are points
    float prefer;   // m: a face contact is taken where its separation is at most this much below the best axis
    float feature;  // m: vertices this close to the extreme one belong to the supporting feature
    float faceOfACosine =
        2;  // or where it is one of A's and the cosine of the angle between its normal and the best axis at least this
    bool facesAhead;  // whether edges that touch take points of the faces beside them, too

    // `innerRadii`: the sum of the radii of the balls inside the two cores, or what measures those that are flat;
    // `rounding`: of their convex radii. In m.
    ContactTolerances(float innerRadii, float rounding, const CollideSettings& settings)
        : reach(settings.speculativeDistance + rounding),
          prefer(Min(0.02f * settings.speculativeDistance, 0.002f * (innerRadii + rounding))),
          feature(1e-4f * (innerRadii + rounding)),
          facesAhead(settings.speculativeDistance > kFarAhead * (innerRadii + rounding)) {}

    float Apart() const { return 500 * feature; }  // m: points that are closer to each other hold the same
};

}  // namespace fulcrum
