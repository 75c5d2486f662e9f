// Creates shapes from given ones: scaled, mirrored, moved, rotated, with another center of mass. The results are
// ordinary shapes. Pure functions.
#pragma once

#include <Fulcrum/Collision/Shapes/Compound.h>

namespace fulcrum {

// The shape with its user's frame multiplied by `scale`, negative factors mirror. Boxes, sharp hulls, flat triangles
// and sharp custom shapes take any factors but 0; cylinders the same across (x and z); round shapes uniform ones;
// compounds those that all their children take, as they are rotated; meshes and planes any but 0. A scaled mesh shares
// the data of the first. Rounding scales by the smallest factor. Errors: NonFinite, OutOfRange (a factor of 0; sizes
// out of range), Unsupported (factors that the shape does not support: the message names the nearest supported ones; a
// hull with a convex radius; a height field).
Result<ShapePtr> Scaled(const ShapePtr& shape, const Vector3& scale);

// The shape at a pose in its user's frame: a compound of one, or of the same children. Errors: those of
// Compound::Create.
Result<ShapePtr> RotatedTranslated(const ShapePtr& shape, const Vector3& position, const Quaternion& rotation);

// The shape with its center of mass moved by `offset` meters (user's frame), as ballast would; the inertia is that
// about the new center. Errors: those of Compound::Create.
Result<ShapePtr> OffsetCenterOfMass(const ShapePtr& shape, const Vector3& offset);

}  // namespace fulcrum
