// Lines and points that a scene draws into the picture of a step: rays, hits, normals, shapes on their way. Filled in
// by a scene's afterStep through SceneWorld::Draw(), read by the recorder. Off unless somebody records: a call is a
// test then. One thread.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Math/Pose.h>

#include <cstdint>
#include <span>
#include <vector>

namespace fulcrum {

// What something means, and its color: 0xRRGGBB.
enum class Ink : uint32_t {
    Path = 0x2f6fb4,  // of a ray or a shape that looks for something
    Hit = 0xd7263d,   // what it found
    Normal = 0x0f7a43,
    Miss = 0x9aa3ad,   // a search that found nothing
    Shape = 0x7b4fb0,  // a shape that is asked about
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
    // Whether anything is kept: saves finding out what to draw.
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
    // The edges of a box or a hull, three silhouettes of what is round. `pose`: of the shape's own frame.
    void Outline(const ConvexShape& shape, const Pose& pose, Ink ink);

    std::span<const DrawnLine> Lines() const { return lines_; }
    std::span<const DrawnPoint> Points() const { return points_; }

private:
    bool isOn_ = false;
    std::vector<DrawnLine> lines_;
    std::vector<DrawnPoint> points_;
};

}  // namespace fulcrum
