#include <Fulcrum/Physics/World/FatBounds.h>

namespace fulcrum {

namespace {

// Extends bounds about the center of a shape by the motion of points inside due to a rotation vector, rad: |turn x p|
// along each axis for points p within the extended bounds; never beyond the bounding sphere. For rotations that move
// no point by half the inner radius the bounds are unchanged.
void ExtendByTurn(const Shape& shape, const Vector3& turn, Vector3& lower, Vector3& upper) {
    const float outer = shape.OuterRadius(), angle = Length(turn);
    if (!(angle * outer > 0.5f * shape.InnerRadius())) return;
    const Vector3 sphere = Vector3::Constant(outer), rate = turn.cwiseAbs();
    const Vector3 far = Vector3(lower.cwiseAbs().cwiseMax(upper.cwiseAbs()) + sphere * angle).cwiseMin(sphere);
    const Vector3 swept(rate.y() * far.z() + rate.z() * far.y(), rate.z() * far.x() + rate.x() * far.z(),
                        rate.x() * far.y() + rate.y() * far.x());
    lower = Vector3(lower - swept).cwiseMax(-sphere);
    upper = Vector3(upper + swept).cwiseMin(sphere);
}

}  // namespace

Bounds TightBounds(const Shape& shape, const Pose& pose, const Matrix3& rotation, const Vector3& turn) {
    const Bounds& local = shape.LocalBounds();
    const Vector3 center = rotation * local.Center(), half = local.HalfExtents();
    const Vector3 reach =
        rotation.x.cwiseAbs() * half.x() + rotation.y.cwiseAbs() * half.y() + rotation.z.cwiseAbs() * half.z();
    const Vector3 sphere = Vector3::Constant(shape.OuterRadius());
    Vector3 lower = Vector3(center - reach).cwiseMax(-sphere), upper = Vector3(center + reach).cwiseMin(sphere);
    ExtendByTurn(shape, turn, lower, upper);
    return RoundedOutwards(pose.position + lower.cast<double>(), pose.position + upper.cast<double>());
}

Bounds TightBoundsOf(const BodyStore& bodies, const ColliderStore& colliders, uint32_t index) {
    return TightBoundsAt(bodies.CenterPoseOf(colliders.colliders[index].body), bodies, colliders, index);
}

Bounds TightBoundsAt(Pose body, const BodyStore& bodies, const ColliderStore& colliders, uint32_t index) {
    const ColliderShape& piece = colliders.shapes[index];
    body.position -= colliders.boundsOrigin;
    const Pose pose = body * LocalOf(bodies, colliders, index);
    return TightBounds(*piece.shape, pose, ToMatrix(pose.rotation), Vector3::Zero());
}

void SetFatBounds(const SystemSettings& settings, const BodyStore& bodies, ColliderStore& colliders, uint32_t index) {
    const Shape& shape = *colliders.shapes[index].shape;
    const float margin = 0.5f * SpeculativeDistance(settings, shape) + BoundsMargin(settings, shape);
    colliders.colliders[index].fat = BoundsAlong(TightBoundsOf(bodies, colliders, index), Vector3::Zero(), margin);
}

}  // namespace fulcrum
