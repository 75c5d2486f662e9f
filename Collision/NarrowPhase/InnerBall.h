// Finds the first triangle that the inscribed ball of a shape hits within the step. A thin body that lands on its edge
// may tip over within the step and land on a side that has no contacts yet, so that its center would end up behind the
// surface. The inner ball is inside the shape at any rotation. Called by SurfaceContact for fast bodies. Thread-safe.
#pragma once

#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

namespace fulcrum {

struct InnerBall {
    float radius;    // m
    Vector3 center;  // m, in the surface's frame
    Vector3 motion;  // m, of the center within the step, likewise

    // m: triangles approached by less than this are left to the other contacts.
    float FarMotion() const { return kFar * radius; }
    bool MovesFar() const { return LengthSquared(motion) > FarMotion() * FarMotion(); }

private:
    static constexpr float kFar = 0.75f;
};

struct InnerBallHit {
    bool exists = false;
    TriangleView triangle;  // front side towards the ball
    float separation = 0;   // m, of the ball from the triangle's plane at the start of the step
};
InnerBallHit FindInnerBallHit(const InnerBall& ball, std::span<const TriangleView> triangles, bool twoSided);

}  // namespace fulcrum
