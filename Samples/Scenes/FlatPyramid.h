// A pyramid one cube thick, the unit of two performance scenes.
#pragma once

#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <cmath>

namespace fulcrum {

// `base` cubes of 1 m in the lowest row, one fewer in each above, touching one another; the base is centered on x =
// shiftX. Watches the top cube.
inline void AddFlatPyramid(SceneWorld& world, const ShapePtr& cube, int base, double shiftX, double z) {
    for (int i = 0; i < base; ++i)
        for (int j = i; j < base; ++j) {
            const Position place(0.5 * (i + 1) + (j - i) - 0.5 * base + shiftX, i + 0.5, z);
            const BodyId id = world.Add({.shape = cube, .position = place});
            if (i == base - 1) world.watched.push_back(id);
        }
}

// The difference between a watched body's height and `height` with the largest magnitude, with its sign; NaN counts as
// the largest.
inline double WorstHeightError(const SceneWorld& world, double height) {
    double worst = 0;
    for (BodyId id : world.watched) {
        const double error = world.Bodies().GetPose(id).position.y() - height;
        if (!(std::fabs(error) <= std::fabs(worst))) worst = error;
    }
    return worst;
}

}  // namespace fulcrum
