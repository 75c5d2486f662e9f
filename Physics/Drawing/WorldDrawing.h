// Draws a world for debugging, into whatever a program draws with: derive from DrawingTarget, and call Draw once a
// frame. Uses public interfaces only. Call it while no other thread changes or steps the world.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <string_view>

namespace fulcrum {

// 0xRRGGBB.
using DrawingColor = uint32_t;

class DrawingTarget {
public:
    virtual ~DrawingTarget() = default;

    // m, world.
    virtual void Line(const Position& from, const Position& to, DrawingColor color) = 0;
    // Counter-clockwise seen from outside.
    virtual void Triangle(const Position& a, const Position& b, const Position& c, DrawingColor color) = 0;
    virtual void Text(const Position& at, std::string_view text, DrawingColor color) {
        (void)at, (void)text, (void)color;
    }
};

// Colors by state; of several the first that applies.
struct DrawingColors {
    DrawingColor frozen = 0xff00ff;  // its state was not finite
    DrawingColor sensor = 0xf2c14e;
    DrawingColor fixed = 0x9aa3ad;  // static
    DrawingColor kinematic = 0x0f7a43;
    DrawingColor asleep = 0x5b6b8c;
    DrawingColor awake = 0xd98e4a;
    DrawingColor bounds = 0xc8ccd2, velocity = 0x2f6fb4, contact = 0xd7263d, joint = 0x7b4fb0, jointGap = 0xd7263d,
                 text = 0x202020;
};

struct DrawingSettings {
    bool triangles = true;    // of shapes, filled
    bool wireframe = false;   // their edges as lines
    bool bounds = false;      // of bodies
    bool centers = false;     // axes at the centers of mass
    bool velocities = false;  // lines, of 0.1 s
    bool contacts = false;    // points and normals, m per N s of the last substep: contactScale
    bool joints = true;       // anchors, frames, and the gap between anchors
    bool names = false;       // texts: indices of bodies, kinds of joints
    float contactScale = 0.1f;
    float axisLength = 0.25f;  // m, of frames
    int detail = 2;            // of round shapes, see ShapeTriangles.h
    float planeExtent = 100;   // m
    DrawingColors colors{};
    // Bodies to draw; none: all.
    Function<bool(BodyId)> accepts{};
};

void Draw(const PhysicsSystem& system, DrawingTarget& target, const DrawingSettings& settings = {});

// The color of a body by its state.
DrawingColor ColorOf(const BodyInterface& bodies, BodyId id, const DrawingColors& colors = {});

}  // namespace fulcrum
