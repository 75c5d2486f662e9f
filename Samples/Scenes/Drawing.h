// Debug drawing of a scene: lines and points of a step, such as rays, hits, normals and moving shapes. Filled in by a
// scene's afterStep through SceneWorld::Draw(), read by the recorder. Disabled unless a recording is made: calls then
// do nothing. One thread.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Math/Pose.h>

#include <cstdint>
#include <span>
#include <vector>

namespace fulcrum {

// What something means, and its color: 0xRRGGBB.
enum class Ink : uint32_t {
    Path = 0x2f6fb4,  // of a ray cast or shape cast
    Hit = 0xd7263d,   // a hit
    Normal = 0x0f7a43,
    Miss = 0x9aa3ad,   // a query without result
    Shape = 0x7b4fb0,  // the shape of a query
};

struct DrawnLine {
    Position from, to;  // m
    Ink ink;
};
struct DrawnPoint {
    Position at;  // m
    Ink ink;
};

class Drawing {
public:
    void TurnOn() { isOn_ = true; }
    // Whether drawing is enabled, for skipping work that only serves drawing.
    bool IsOn() const { return isOn_; }
    void Clear() {
        lines_.clear();
        points_.clear();
    }

    void Line(const Position& from, const Position& to, Ink ink) {
        if (isOn_) lines_.push_back({from, to, ink});
    }
    void Point(const Position& at, Ink ink) {
        if (isOn_) points_.push_back({at, ink});
    }
    // A point with a line of `length` meters along a unit vector.
    void Normal(const Position& at, const Vector3& normal, double length = 0.5) {
        Line(at, at + normal.cast<double>() * length, Ink::Normal);
        Point(at, Ink::Hit);
    }
    void Box(const Position& lower, const Position& upper, Ink ink);
    // The edges of a box or a hull, three silhouettes of round shapes. `pose`: of the shape's own frame.
    void Outline(const ConvexShape& shape, const Pose& pose, Ink ink);

    std::span<const DrawnLine> Lines() const { return lines_; }
    std::span<const DrawnPoint> Points() const { return points_; }

private:
    bool isOn_ = false;
    std::vector<DrawnLine> lines_;
    std::vector<DrawnPoint> points_;
};

}  // namespace fulcrum
