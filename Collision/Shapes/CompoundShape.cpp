#include <Fulcrum/Collision/Shapes/CompoundShape.h>

#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <cmath>

namespace fulcrum {

CompoundShape::~CompoundShape() = default;

std::span<const CompoundShape::Child> CompoundShape::Children() const { return children_; }

Status CompoundShape::Check(const ChildSettings& child, const char* name, bool mayBeCompound) {
    if (!child.shape) return Error{ErrorCode::Unsupported, Message("%s has no shape", name)};
    if (!child.shape->IsConvex() && !(mayBeCompound && child.shape->IsCompound())) {
        return Error{ErrorCode::Unsupported,
                     Message("%s is a %s: children must be convex", name, ShapeTypeName(child.shape->Type()))};
    }
    if (!IsFinite(child.position) || !IsFinite(child.rotation) || !std::isfinite(child.density))
        return Error{ErrorCode::NonFinite, Message("position, rotation or density of %s is not finite", name)};
    const double lengthSquared = double{LengthSquared(child.rotation)};
    if (!(std::fabs(lengthSquared - 1) < 1e-3)) {
        return Error{ErrorCode::Unnormalized,
                     Message("the rotation of %s has length %g: it must be 1", name, std::sqrt(lengthSquared))};
    }
    if (!(child.density > 0)) {
        return Error{ErrorCode::NonPositive,
                     Message("the density of %s is %g: it must be larger than 0", name, double{child.density})};
    }
    if (!std::isnormal(child.density)) {
        return Error{ErrorCode::OutOfRange,
                     Message("the density of %s is %g: it must be a normal float", name, double{child.density})};
    }
    return Done{};
}

// By the support function along the axes, and outwards by the rounding of the rotations: a few units in the last place
// of the child's size.
Bounds CompoundShape::BoundsOf(const Child& child) {
    const ConvexShape& shape = *child.shape;
    const Quaternion& q = child.pose.rotation;
    const Vector3& at = child.pose.position;
    const bool turned = q.x != 0 || q.y != 0 || q.z != 0;
    const double slack = turned ? 0x1p-21 * double{shape.OuterRadius()} : 0;
    Position lower, upper;
    for (int axis = 0; axis < 3; ++axis) {
        if (!turned) {
            lower[axis] = double{at[axis]} + double{shape.LocalBounds().lower[axis]};
            upper[axis] = double{at[axis]} + double{shape.LocalBounds().upper[axis]};
            continue;
        }
        const Vector3 direction = InverseRotate(q, Vector3(Vector3::Unit(axis)));
        const Vector3 high = Rotate(q, shape.Support(direction)), low = Rotate(q, shape.Support(Vector3(-direction)));
        lower[axis] = double{at[axis]} + double{low[axis]} - slack;
        upper[axis] = double{at[axis]} + double{high[axis]} + slack;
    }
    return RoundedOutwards(lower, upper);
}

CompoundShape::ChildSettings CompoundShape::SettingsOf(const Child& child) const {
    const DefaultFloats floats;
    // From the center frames to the users'.
    const Vector3 own = Rotate(child.pose.rotation, child.shape->Mass().centerOfMass);
    return {.shape = child.shape,
            .position = child.pose.position + (mass_.centerOfMass + Origin()) - own,
            .rotation = child.pose.rotation,
            .density = child.density};
}

std::vector<CompoundShape::ChildSettings> CompoundShape::Settings() const {
    const DefaultFloats floats;
    std::vector<ChildSettings> settings;
    for (const Child& child : children_)
        if (child.shape) settings.push_back(SettingsOf(child));
    return settings;
}

}  // namespace fulcrum
