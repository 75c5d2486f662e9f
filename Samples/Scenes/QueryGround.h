// The world of the query scenes: bodies of all kinds on a wavy mesh, stirred by two bars.
#pragma once

#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum {

inline constexpr float kQueryGround = 8;  // m: half the length and width of the ground, with walls at its edges

// The ground, its walls, the bars and, in world.watched, 70 bodies.
void AddQueryGround(SceneWorld& world);

// Somewhere on a closed curve over the ground, at `height` m; `phase` in turns.
Position OverTheGround(double time, double phase, double height);

}  // namespace fulcrum
