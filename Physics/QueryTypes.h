// What queries are asked with, and what they answer: see QueryInterface.h.
#pragma once

#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Physics/Settings.h>

#include <array>
#include <optional>
#include <span>

namespace fulcrum {

// Which bodies a query sees. Batches call the predicates from several threads at once.
struct QueryFilter {
    uint32_t layers = 0xFFFFFFFFu;  // bit i: bodies of layer i
    // Those that a body of this category and mask would collide with; 0: whatever their mask, ~0: whatever their
    // category.
    uint64_t category = 0, mask = ~uint64_t(0);
    std::span<const BodyId> ignore{};                    // but not these
    bool sensors = false;                                // sensors, too: else queries pass through them
    std::optional<FunctionRef<bool(BodyId)>> accepts{};  // and those it says yes to
    std::optional<FunctionRef<bool(BodyId, uint32_t child)>> acceptsChild{};  // and their children likewise
};

// The body is invalid (BodyId{}) where nothing was found.
struct WorldRayHit {
    BodyId body;
    SubShape subShape{};
    float fraction = 0;                    // of the displacement
    Vector3 normal = Vector3::Zero();      // unit, world space, see RayHit
    Position position = Position::Zero();  // m
    bool isBackFace = false;
};

struct WorldShapeHit {
    BodyId body;
    SubShape subShape{};                   // of the body
    float fraction = 0;                    // of the motion
    Vector3 normal = Vector3::Zero();      // unit, world space, from the body towards the moving shape
    Position position = Position::Zero();  // m, on the body's surface
    float depth = 0;                       // m, of an overlap at the start
    bool isEarly = false;                  // see ShapeHit
};

struct OverlapHit {
    BodyId body;
    uint32_t child = 0;  // of a compound; else 0
    friend auto operator<=>(const OverlapHit&, const OverlapHit&) = default;
};

// A convex piece of a shape in touch with a piece of a body: points with one normal.
struct WorldContact {
    struct Point {
        Position onBody = Position::Zero(), onQuery = Position::Zero();  // m
        float separation = 0;  // m, from the body to the shape along the normal; negative where they overlap
    };
    BodyId body;
    SubShape subShape{};               // of the body; a triangle is that of the deepest point
    uint32_t childOfQuery = 0;         // of a compound; else 0
    Vector3 normal = Vector3::Zero();  // unit, world space, from the body towards the shape asked for
    uint32_t pointCount = 0;           // 1..4
    std::array<Point, 4> points{};

    std::span<const Point> Points() const { return {points.data(), pointCount}; }
};

struct WorldClosest {
    BodyId body;
    SubShape subShape{}, subShapeOfQuery{};
    float distance = 0;                // m; negative: how deep they overlap
    Vector3 normal = Vector3::Zero();  // unit, world space, from the body towards the shape or point asked for
    Position onBody = Position::Zero(), onQuery = Position::Zero();  // m
};

// A shape somewhere; `pose` is that of the shape's own frame, as the user described it.
struct PlacedShape {
    const Shape* shape = nullptr;  // not null
    Pose pose{};
};

// A convex shape in motion: its center of mass moves straight, it turns about it at a constant rate.
struct MovingShape {
    const ConvexShape* shape = nullptr;      // not null
    Pose pose{};                             // of the shape's own frame at the start
    Vector3 displacement = Vector3::Zero();  // m
    Vector3 turn = Vector3::Zero();          // rad, rotation vector over the whole motion
};

}  // namespace fulcrum
