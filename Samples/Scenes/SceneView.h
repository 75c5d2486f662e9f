// How a scene is first shown, and what its bodies look like in a recording. Filled in by scenes, read by the recorder;
// the simulation knows nothing of it. Plain data, any thread.
#pragma once

#include <Fulcrum/Math/Pose.h>

#include <cstdint>
#include <string>

namespace fulcrum {

// What the colors of bodies say: the shape, the island, the speed, whether they are awake.
enum class ColorMode : uint8_t { Plain, Island, Speed, Awake };

// What is not given the page finds by itself: it frames all that moves in the run.
struct SceneView {
    ColorMode color = ColorMode::Island;
    // Where the camera is, seen from what it looks at; any length. Zero: in front, to the right and a little above.
    Vector3 from = Vector3::Zero();
    // The box that is to fill the picture, m; lower == upper: not given.
    Position lower = Position::Zero(), upper = Position::Zero();
    // The part of the run after which the gallery takes its picture, 0 .. 1.
    double picture = 0.6;
    // Whether what a scene draws of joints is shown from the start, where it has joints.
    bool showsJoints = true;
    // Index into SceneWorld::watched of the body that the camera goes with; -1: it stays.
    int follows = -1;
    // A box of water, m, for the eye alone; lower == upper: none.
    Position waterLower = Position::Zero(), waterUpper = Position::Zero();
};

// What something is made of, for the eye alone.
enum class Look : uint8_t { Default, Grass, Ice, Rubber, Brass, Wood, Stone, Belt, Glass };

struct BodyLook {
    std::string label{};  // stands beside the body in the picture; empty: none
    Look look = Look::Default;
    int teeth = 0;         // > 0: a gear of so many teeth about the z axis of its own frame
    float toothAngle = 0;  // rad, where the middle of the first tooth is
    // How the surface of a belt moves, world axes, m/s; where `beltTurning` (rad/s) is not zero, about the pivot.
    Vector3 beltVelocity = Vector3::Zero(), beltTurning = Vector3::Zero();
    Position beltPivot = Position::Zero();
};

}  // namespace fulcrum
