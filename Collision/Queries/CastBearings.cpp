// ShapeCaster: what the moving shape rests on at the start, see Bearings.h.
#include <Fulcrum/Collision/NarrowPhase/ContactTolerances.h>
#include <Fulcrum/Collision/Queries/Bearings.h>
#include <Fulcrum/Collision/Queries/CoreCast.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>

namespace fulcrum {

float ShapeCaster::ReachOfBearings(const ShapeCastSettings& settings) const {
    const DefaultFloats floats;
    return settings.separation + FlushHeight(shape_.OuterRadius());
}

bool ShapeCaster::Continues(const ConvexShape& piece, const Pose& at) const {
    return bearings_ && bearings_->Hide(piece, {at.position - motion_.pose.position, at.rotation},
                                        FlushHeight(shape_.OuterRadius()));
}

void ShapeCaster::AddBearing(const ShapeHit& touched, Bearings& bearings) const {
    if (!Separates(touched)) return;
    const float flush = FlushHeight(shape_.OuterRadius());
    const Vector3 point = (touched.position - motion_.pose.position).cast<float>();
    const auto add = [&](const Vector3& normal) {
        const float height = Dot(normal, point);
        // Only a surface in front of which the center is bears the shape, not the back of a floor above it.
        if (!(height < 0)) return;
        const Quaternion& rotation = motion_.pose.rotation;
        const float lowest = Dot(normal, Rotate(rotation, shape_.Support(InverseRotate(rotation, Vector3(-normal)))));
        // A rotation about another axis than the normal may turn a part down, but not beyond the outer radius.
        const float turn = Length(Vector3(motion_.turn - normal * Dot(motion_.turn, normal)));
        const float outer = shape_.OuterRadius(), dip = std::min(outer - shape_.InnerRadius(), turn * outer);
        if (height - lowest <= touched.depth + flush && dip <= flush) bearings.Add(normal, height);
    };
    add(touched.normal);
    // Over a gap, which a round shape enters a little, the normal points along the motion a little. It is the plane
    // through the same point that the motion follows which what lies beyond the gap continues.
    const Vector3 along = Normalized(motion_.displacement, Vector3::Zero());
    add(Normalized(Vector3(touched.normal - along * Dot(touched.normal, along)), Vector3::Zero()));
}

void ShapeCaster::FindBearings(const Shape& other, const Pose& pose, const ShapeCastSettings& settings,
                               Bearings& bearings) const {
    const DefaultFloats floats;
    const Position between = motion_.pose.position - pose.position;
    const bool isOtherTurning = !motion_.turnOfOther.isZero(0);
    if (!isValid_ || !settings.IsValid() || isOtherTurning || !IsWithinReach(between)) return;
    const CoreMotion motion = RelativeTo(pose);
    const float reach = ReachOfBearings(settings);
    if (other.Type() == ShapeType::Plane) {
        const Plane& plane = static_cast<const Plane&>(other);
        const double height = HeightAbove(plane, motion);
        if (!(height <= double{reach})) return;
        ShapeHit touched;
        touched.normal = Rotate(pose.rotation, plane.Normal());
        touched.depth = std::max(0.0f, static_cast<float>(-height));
        const double ofCenter = Dot<double>(plane.Normal().cast<double>(), motion.position) - double{plane.Offset()};
        touched.position = motion_.pose.position - touched.normal.cast<double>() * ofCenter;
        return AddBearing(touched, bearings);
    }
    const Bounds box = BoundsAt({motion.position.cast<float>(), motion.rotation}, shape_.LocalBounds());
    VisitPieces(other, Inflated(box, reach), [&](const Piece& piece) {
        const Pose at = pose * piece.pose;
        ShapeHit touched;
        if (MeasureDepth(piece, at, RelativeTo(at), settings, reach, touched)) AddBearing(touched, bearings);
    });
}

}  // namespace fulcrum
