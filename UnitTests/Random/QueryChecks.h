// What queries must agree with: each other, and the functions of single shapes asked of every body by itself. All
// return what is wrong, empty where nothing is.
#pragma once

#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/UnitTests/Random/Twin.h>

#include <sstream>
#include <string>

namespace fulcrum::testing {

// All parts, one after the other.
template <class... Parts>
std::string Text(const Parts&... parts) {
    std::ostringstream text;
    text.precision(9);
    (text << ... << parts);
    return text.str();
}

// A shape where its body has it: `pose` is that of the shape's center frame.
struct BodyShape {
    BodyId id;
    ShapePtr shape;
    Pose pose;
};

// How far two answers about the body, asked from `from`, may be apart, m: what floats of the shape's size, and doubles
// of its place, leave open.
double ToleranceOf(const BodyShape& body, const Position& from);

// All that queries without a filter see.
std::vector<BodyShape> ShapesOf(const PhysicsSystem& system);

bool AreSame(const WorldRayHit& a, const WorldRayHit& b);
std::string ToText(const WorldRayHit& hit);
std::string ToText(const WorldShapeHit& hit);
std::string ToText(const WorldClosest& hit);
bool AreSame(const WorldShapeHit& a, const WorldShapeHit& b);
bool AreSame(const WorldClosest& a, const WorldClosest& b);

// The closest hit of a ray against that of every body by itself; a ray that grazes may hit or not.
std::string CompareRay(const std::vector<BodyShape>& bodies, const Ray& ray, const WorldRayHit& hit);
// The closest body to a point that lies in the bodies of `inside`: none of them may be farther than what floats of its
// size leave open.
std::string CheckClosestInside(const std::vector<BodyShape>& bodies, const std::vector<OverlapHit>& inside,
                               const Position& point, const WorldClosest& closest);
// Whether the shape touches the body where it is hit, and the hit is finite.
std::string CheckShapeHit(const std::vector<BodyShape>& bodies, const MovingShape& moving, const WorldShapeHit& hit);
// The closest body against that of every body by itself.
std::string CompareClosest(const std::vector<BodyShape>& bodies, const PlacedShape& placed, float maxDistance,
                           const WorldClosest& closest);
// Whether two convex shapes are as far apart along the normal as the distance says.
std::string CheckClosest(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA,
                         const ClosestPoints& closest);

}  // namespace fulcrum::testing
