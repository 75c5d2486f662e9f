// Checks that queries agree with each other and with the single-shape functions applied to every body. All return what
// is wrong, or an empty text.
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

// The tolerance of two results about the body, queried from `from`, m: the rounding of floats of the shape's size and
// of doubles of its position.
double ToleranceOf(const BodyShape& body, const Position& from);

// All bodies that queries without a filter find.
std::vector<BodyShape> ShapesOf(const PhysicsSystem& system);

bool AreSame(const WorldRayHit& a, const WorldRayHit& b);
std::string ToText(const WorldRayHit& hit);
std::string ToText(const WorldShapeHit& hit);
std::string ToText(const WorldClosest& hit);
bool AreSame(const WorldShapeHit& a, const WorldShapeHit& b);
bool AreSame(const WorldClosest& a, const WorldClosest& b);

// Compares the closest hit of a ray with that of every single body; grazing rays may hit or not.
std::string CompareRay(const std::vector<BodyShape>& bodies, const Ray& ray, const WorldRayHit& hit);
// The closest body to a point inside the bodies of `inside`: none of those may be farther away than its tolerance.
std::string CheckClosestInside(const std::vector<BodyShape>& bodies, const std::vector<OverlapHit>& inside,
                               const Position& point, const WorldClosest& closest);
// Whether the shape touches the body where it is hit, and the hit is finite.
std::string CheckShapeHit(const std::vector<BodyShape>& bodies, const MovingShape& moving, const WorldShapeHit& hit);
// Compares the closest body with the distances of every single body.
std::string CompareClosest(const std::vector<BodyShape>& bodies, const PlacedShape& placed, float maxDistance,
                           const WorldClosest& closest);
// Whether two convex shapes are as far apart along the normal as the distance says.
std::string CheckClosest(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA,
                         const ClosestPoints& closest);

}  // namespace fulcrum::testing
