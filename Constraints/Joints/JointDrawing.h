// What a picture of a joint shows besides its frames, its locks and its error. Made by the joint's type; whoever draws
// it knows no types. Plain data.
#pragma once

#include <Fulcrum/Constraints/Joints/Path.h>

#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace fulcrum {

struct JointDrawing {
    // Ranges: the limits of axes as they are at the moment.
    bool rotations = false;  // about what the locks leave free: a sector, or a cone for the swing and one for the twist
    bool translations = false;              // along x, y and z of frame A together: a line, a rectangle or a box
    bool steering = false;                  // about y of frame A: a sector about its x axis
    std::optional<int> trackA{}, trackB{};  // along one axis of a frame: 0, 1, 2 for x, y, z
    bool isPyramid = false;                 // the cone of the swing; else an ellipse
    float coneAngle = std::numeric_limits<float>::infinity();  // rad: a round cone beside the limits of axes

    // Circles about the x axes of the frames, each with a spoke along y. m; 0: as large as the joint is drawn.
    std::optional<float> circleA{}, circleB{};

    // A rope from A's anchor over the points to B's. Its length, to B's side `ropeRatio` times, is the coordinate
    // LinearX.
    bool isRope = false;
    float ropeRatio = 1.0f;
    std::vector<Position> ropePoints{};  // m, world space

    std::shared_ptr<const Path> path{};  // in frame A; null: none
};

}  // namespace fulcrum
