// The wavy triangle mesh that several scenes stand on: 100 x 100 cells of 3 m, hills of 5 m. For scenes.
#pragma once

#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum {

inline constexpr int kWavyCells = 100;
inline constexpr double kWavyCell = 3;  // m

// Of the ground at (x, z), m; the ground reaches 150 m to all sides of the origin.
double WavyHeight(double x, double z);

// Static.
BodyId AddWavyGround(SceneWorld& world, const Material& material);

// The ground, and above it 21 x 4 x 21 boxes, balls, capsules and pyramids that bounce.
void AddShapesOverWaves(SceneWorld& world);

}  // namespace fulcrum
