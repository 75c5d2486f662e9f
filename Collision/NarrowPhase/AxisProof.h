// Proves that a contact's axis is the one of least penetration, so that GJK and EPA can be skipped. Used by the contact
// builders.
#pragma once

#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

// True if no axis can separate the cores by more than -depth, the separation along the unit vector `normal`, given that
// a disc of radius r = discRadius in the plane at that depth belongs to the Minkowski difference, its center on the
// normal. So does the ball of radius R = innerRadii about the difference c = centers of the two. Along a direction at
// the angle t from the normal the disc bounds the separation by -depth cos t - r sin t, which is at most -depth while
// tan(t / 2) <= r / depth; the ball bounds it by c_n cos t + c_t sin t - R, which must suffice for all larger angles:
// there it falls, so it is enough to test the first angle. If the cores are apart (depth <= 0), it is sufficient that
// the features touch.
inline bool NoBetterAxis(const Vector3& centers, float innerRadii, const Vector3& normal, float depth,
                         float discRadius) {
    if (depth <= 0.0f) return true;
    if (!(discRadius > 0.0f)) return false;
    const float along = Dot(normal, centers);
    const float across = Sqrt(Max(0.0f, LengthSquared(centers) - along * along));
    const float u = discRadius / depth, scale = 1.0f / (1.0f + u * u);
    const float cosine = (1.0f - u * u) * scale, sine = 2.0f * u * scale;
    const bool falls = across * cosine <= along * sine;
    return falls && along * cosine + across * sine - innerRadii <= -depth;
}

}  // namespace fulcrum
