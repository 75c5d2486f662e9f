// Arguments and results of queries: see QueryInterface.h.
#pragma once

#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Math/List.h>
#include <Fulcrum/Physics/Settings.h>

#include <array>
#include <span>

namespace fulcrum {

// Filter of the bodies that a query tests. Batches call the predicates from several threads at once.
struct QueryFilter {
    uint32_t layers = 0xFFFFFFFFu;  // bit i: bodies of layer i
    // Bodies that a body with this category and mask would collide with. category 0: any mask of theirs; mask ~0: any
    // category of theirs.
    uint64_t category = 0, mask = ~uint64_t(0);
    List<BodyId> ignore{};                                  // bodies to skip
    bool sensors = false;                                   // whether sensors are tested, too
    Function<bool(BodyId)> accepts{};                       // additional predicate on bodies
    Function<bool(BodyId, uint32_t child)> acceptsChild{};  // additional predicate on children
};

// The body is invalid (BodyId{}) if nothing was found.
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
    float depth = 0;                       // m, of the overlap at the start
    bool isEarly = false;                  // see ShapeHit
};

struct OverlapHit {
    BodyId body;
    uint32_t child = 0;  // of a compound; else 0
    friend auto operator<=>(const OverlapHit&, const OverlapHit&) = default;
};

// A contact of a convex piece of a shape with a piece of a body: points with one normal.
struct WorldContact {
    struct Point {
        Position onBody = Position::Zero(), onQuery = Position::Zero();  // m
        float separation = 0;  // m, from the body to the shape along the normal; negative if they overlap
    };
    BodyId body;
    SubShape subShape{};               // of the body; a triangle is that of the deepest point
    uint32_t childOfQuery = 0;         // of a compound; else 0
    Vector3 normal = Vector3::Zero();  // unit, world space, from the body towards the query's shape
    uint32_t pointCount = 0;           // 1..4
    std::array<Point, 4> points{};

    std::span<const Point> Points() const { return {points.data(), pointCount}; }
};

struct WorldClosest {
    BodyId body;
    SubShape subShape{}, subShapeOfQuery{};
    float distance = 0;                // m; negative: overlap depth
    Vector3 normal = Vector3::Zero();  // unit, world space, from the body towards the queried shape or point
    Position onBody = Position::Zero(), onQuery = Position::Zero();  // m
};

// A shape at a pose, that of the shape's own frame, in which the user described it.
struct PlacedShape {
    const Shape* shape = nullptr;  // not null; not owned
    Pose pose{};
};

// A moving convex shape: its center of mass moves along a line, and it rotates about it, both at constant rate.
struct MovingShape {
    const ConvexShape* shape = nullptr;      // not null; not owned
    Pose pose{};                             // of the shape's own frame at the start
    Vector3 displacement = Vector3::Zero();  // m
    Vector3 turn = Vector3::Zero();          // rad, rotation vector over the whole motion
};

}  // namespace fulcrum
