// The contact of the ball inside a shape with the triangle that it hits first within the step. A thin body that lands
// on its edge may turn over within the step: it comes down on a side that faced away as the step began, for which there
// are no contacts yet, and its center ends up behind the surface. The inner ball belongs to the shape however it turns.
// Called by SurfaceContact where the center moves far. Thread-safe.
#pragma once

#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

namespace fulcrum {

struct InnerBall {
    float radius;    // m
    Vector3 center;  // m, in the surface's frame
    Vector3 motion;  // m, of the center within the step, likewise

    // The motion that the other contacts do not cover, m. A face that is approached by less is left to them.
    float FarMotion() const { return kFar * radius; }
    bool MovesFar() const { return LengthSquared(motion) > FarMotion() * FarMotion(); }

private:
    static constexpr float kFar = 0.75f;
};

struct InnerBallHit {
    bool exists = false;
    TriangleView triangle;  // with its front to the ball
    float separation = 0;   // m, of the ball from the triangle's plane as the step begins
};
InnerBallHit FindInnerBallHit(const InnerBall& ball, std::span<const TriangleView> triangles, bool twoSided);

}  // namespace fulcrum
