// Chooses at most four of many contact points, for depth and area. Used by the contact builders. Thread-safe.
#pragma once

#include <Fulcrum/Math/Vector.h>

namespace fulcrum {

// Writes the chosen indices in increasing order and returns how many: first a deepest point, then the point farthest
// from it, then those that span the largest area on each side of the line of the two. A later point replaces an earlier one
// only where it is better by more than rounding and tiny motions make it: by `depthSlop` metres, or by a hundredth.
// `position(i)` and `separation(i)` describe point i; `normal` is the plane that areas are measured in.
template <class PositionOf, class SeparationOf>
int ChooseFour(int count, const Vector3& normal, float depthSlop, const PositionOf& position,
               const SeparationOf& separation, int (&chosen)[4]) {
    constexpr float kClearly = 1.01f;
    if (count <= 4) {
        for (int i = 0; i < count; ++i) chosen[i] = i;
        return count;
    }
    float least = separation(0);
    for (int i = 1; i < count; ++i) least = separation(i) < least ? separation(i) : least;
    int first = 0;
    while (separation(first) > least + depthSlop) ++first;

    const Vector3 p0 = position(first);
    int second = -1;
    float farthest = 0;
    for (int i = 0; i < count; ++i) {
        const float distance = LengthSquared(Vector3(position(i) - p0));
        if (distance > farthest * kClearly) {
            farthest = distance;
            second = i;
        }
    }
    if (second < 0) {  // all in one place
        chosen[0] = first;
        return 1;
    }

    const Vector3 across = Cross<float>(normal, Vector3(position(second) - p0));
    int third = -1, fourth = -1;
    const float nothing = 1e-6f * farthest;  // as an area, against the square of the longest distance
    float left = nothing, right = nothing;
    for (int i = 0; i < count; ++i) {
        const float side = Dot(across, Vector3(position(i) - p0));
        if (side > left * kClearly) {
            left = side;
            third = i;
        } else if (-side > right * kClearly) {
            right = -side;
            fourth = i;
        }
    }
    int found = 0;
    for (int i = 0; i < count; ++i)
        if (i == first || i == second || i == third || i == fourth) chosen[found++] = i;
    return found;
}

}  // namespace fulcrum
