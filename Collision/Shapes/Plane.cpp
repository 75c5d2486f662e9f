#include <Fulcrum/Collision/Shapes/Plane.h>

#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <cmath>

namespace fulcrum {

Result<std::shared_ptr<const Plane>> Plane::Create(const Vector3& normal, float offset) {
    const DefaultFloats floats;
    if (!IsFinite(normal) || !std::isfinite(offset)) {
        return Error{ErrorCode::NonFinite, "the normal or the offset of a plane is not finite"};
    }
    const Position exact = normal.cast<double>();
    const double length = std::sqrt(Dot(exact, exact));
    if (!(length > 0)) return Error{ErrorCode::Degenerate, "the normal of a plane is zero: it must be a direction"};
    if (!(std::fabs(offset) <= kUnboundedExtent)) {
        return Error{ErrorCode::OutOfRange,
                     Message("the offset is %g m: at most %g m", double{offset}, double{kUnboundedExtent})};
    }
    const std::shared_ptr<Plane> plane(new Plane);
    // A normal of unit length within rounding is not changed.
    plane->normal_ = std::fabs(length - 1) < 0x1p-23 ? normal : Vector3((exact / length).cast<float>());
    plane->offset_ = offset;
    // Infinite also along an axis where the half space ends: the center and extent of such a box would lose that end to
    // rounding.
    plane->bounds_.lower = Vector3::Constant(-kUnboundedExtent);
    plane->bounds_.upper = Vector3::Constant(kUnboundedExtent);
    plane->outerRadius_ = kUnboundedExtent;
    return std::shared_ptr<const Plane>(plane);
}

}  // namespace fulcrum
