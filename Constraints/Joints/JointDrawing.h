// What to draw of a joint besides its frames, locks and error. Provided by the joint's type, so that renderers need not
// know the types. Plain data.
#pragma once

#include <Fulcrum/Constraints/Joints/Path.h>

#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace fulcrum {

struct JointDrawing {
    // Ranges: the current limits of axes.
    bool rotations = false;     // about the axes left free by the locks: a sector, or a swing cone and a twist sector
    bool translations = false;  // along x, y and z of frame A together: a line, a rectangle or a box
    bool steering = false;      // about y of frame A: a sector about its x axis
    std::optional<int> trackA{}, trackB{};                     // along one axis of a frame: 0, 1, 2 for x, y, z
    bool isPyramid = false;                                    // shape of the swing cone; else an ellipse
    float coneAngle = std::numeric_limits<float>::infinity();  // rad: a circular cone in addition to the limits of axes

    // Circles about the x axes of the frames, each with a spoke along y. m; 0: sized like the rest of the drawing.
    std::optional<float> circleA{}, circleB{};

    // A rope from A's anchor over the points to B's. Its length, with B's side counted `ropeRatio` times, is the
    // coordinate LinearX.
    bool isRope = false;
    float ropeRatio = 1.0f;
    std::vector<Position> ropePoints{};  // m, world space

    std::shared_ptr<const Path> path{};  // in frame A; null: none
};

}  // namespace fulcrum
