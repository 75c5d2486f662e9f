#include <Fulcrum/Physics/ContactListener.h>

#include <Fulcrum/Math/FloatEnvironment.h>

namespace fulcrum {

Position ContactView::Center() const {
    const DefaultFloats floats;
    // Averages offsets from the first point: sums of large positions would lose digits.
    Position offset = Position::Zero();
    for (const Point& point : points) offset += point.position - points.front().position;
    return points.front().position + offset / static_cast<double>(points.size());
}

void ContactChange::MoveSurface(const ContactView& contact, BodyId belt, const Vector3& velocity) {
    const DefaultFloats floats;
    surfaceVelocity += belt == contact.bodyB ? velocity : Vector3(-velocity);
}

void ContactChange::RotateSurface(const ContactView& contact, BodyId belt, const Position& pivot,
                                  const Vector3& angularVelocity) {
    const DefaultFloats floats;
    const Vector3 arm = (contact.Center() - pivot).cast<float>();
    MoveSurface(contact, belt, Cross<float>(angularVelocity, arm));
    surfaceAngularVelocity += belt == contact.bodyB ? angularVelocity : Vector3(-angularVelocity);
}

void ContactChange::ScaleInverseMass(const ContactView& contact, BodyId body, float scale) {
    const DefaultFloats floats;
    MassOverride& m = massOverride;
    if (body == contact.bodyB) m.inverseMassScaleB = m.inverseInertiaScaleB = scale;
    else m.inverseMassScaleA = m.inverseInertiaScaleA = scale;
}

}  // namespace fulcrum
