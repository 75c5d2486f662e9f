// Ragdolls as JSON: what RagdollSettings.h describes, with the same names of fields, in SI units and radians. A field
// that is left out has its default. Free functions, any thread.
//
// {"parts": [{"name": "pelvis", "body": {"shape": {"kind": "Capsule", "halfHeight": 0.08, "radius": 0.12}}},
//              {"name": "torso", "parent": "pelvis", "body": {...},
//               "joint": {"kind": "SwingTwist", "anchorA": {"point": [0, 0.1, 0], "axis": [0, 1, 0]},
//                         "twist": {"limited": true, "limits": {"min": -0.3, "max": 0.3}}}}]}
//
// Vectors are [x, y, z], rotations [x, y, z, w]; infinite numbers are "infinity" or "-infinity"; parents are given by
// name. Kinds of joints: Point, Fixed, Hinge, Cone, SwingTwist, SixDof (its axes are linearX .. angularZ). Kinds of
// shapes: those of Json/ShapeJson.h, of which Sphere, Box, Capsule and ConvexHull without a convex radius are written.
// Samples/Ragdoll/humanoid.json is a complete example.
#pragma once

#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace fulcrum {

// Errors name the path in the document, such as `parts[1].joint.twist.limits.min: a string; it must be a number`: a
// wrong type, an unknown name, what the settings' own checks find.
Result<RagdollSettings> RagdollFromJson(const nlohmann::ordered_json& document);
// Writes only what differs from the defaults. Reading it gives the same settings, bit by bit (hulls to rounding).
// Errors: those of Check; Unsupported (a shape of another kind, a hull with a convex radius).
Result<nlohmann::ordered_json> RagdollToJson(const RagdollSettings& settings);

// Errors also if the file cannot be read, or with the line of a syntax error.
Result<RagdollSettings> ReadRagdoll(const std::string& file);
Status WriteRagdoll(const std::string& file, const RagdollSettings& settings);

}  // namespace fulcrum
