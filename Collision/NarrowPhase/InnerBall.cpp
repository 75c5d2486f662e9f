#include <Fulcrum/Collision/NarrowPhase/InnerBall.h>

#include <Fulcrum/Collision/NarrowPhase/TriangleSide.h>

#include <algorithm>

namespace fulcrum {

InnerBallHit FindInnerBallHit(const InnerBall& ball, std::span<const TriangleView> triangles, bool twoSided) {
    const float far = ball.FarMotion();
    const auto frontOf = [&](const TriangleView& view) {
        return twoSided && HeightAbove(view, ball.center) < 0 ? Reversed(view) : view;
    };
    const TriangleView* first = nullptr;
    float earliest = 1;
    InnerBallHit hit;
    for (const TriangleView& original : triangles) {
        const TriangleView view = frontOf(original);
        const float height = HeightAbove(view, ball.center), approach = -Dot(ball.motion, view.normal),
                    above = std::max(height - ball.radius, 0.0f);
        if (height < 0 || approach <= far || above >= earliest * approach ||
            !IsOver(view, ball.center + ball.motion * (above / approach), ball.radius))
            continue;
        earliest = above / approach;
        hit.separation = height - ball.radius;
        first = &original;
    }
    if (!first) return hit;
    hit.exists = true;
    hit.triangle = frontOf(*first);
    return hit;
}

}  // namespace fulcrum
