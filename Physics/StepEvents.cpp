#include <Fulcrum/Physics/StepEvents.h>

#include <Fulcrum/Math/FloatEnvironment.h>

namespace fulcrum {

float ContactEvent::NormalImpulse() const {
    const DefaultFloats floats;
    float sum = 0;
    for (const Manifold& manifold : manifolds)
        for (const Point& point : manifold.Points()) sum += point.impulse;
    return sum;
}

Vector3 ContactEvent::Impulse() const {
    const DefaultFloats floats;
    Vector3 sum = Vector3::Zero();
    for (const Manifold& manifold : manifolds) {
        sum += manifold.frictionImpulse;
        for (const Point& point : manifold.Points()) sum += manifold.normal * point.impulse;
    }
    return sum;
}

}  // namespace fulcrum
