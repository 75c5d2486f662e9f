// A rigid pose: double position, float rotation.
#pragma once

#include <Fulcrum/Math/Matrix.h>

namespace fulcrum {

struct Pose {
    Position position = Position::Zero();  // m, world space
    Quaternion rotation{};                 // unit

    // The world position of a point given in the pose's own frame.
    Position Transform(const Vector3& local) const { return position + Rotate(rotation, local).cast<double>(); }
    // A world position in the pose's own frame.
    Vector3 InverseTransform(const Position& world) const {
        return InverseRotate(rotation, Vector3((world - position).cast<float>()));
    }
};

// A pose relative to a nearby one, for which float is precise enough: frame b relative to frame a.
struct RelativePose {
    Vector3 position = Vector3::Zero();  // m
    Quaternion rotation;                 // unit

    Vector3 Transform(const Vector3& local) const { return position + Rotate(rotation, local); }
    Vector3 InverseTransform(const Vector3& point) const { return InverseRotate(rotation, Vector3(point - position)); }
};

inline RelativePose Relative(const Pose& a, const Pose& b) {
    return {InverseRotate(a.rotation, Vector3((b.position - a.position).cast<float>())),
            a.rotation.Conjugate() * b.rotation};
}

inline RelativePose operator*(const RelativePose& a, const RelativePose& b) {
    return {a.Transform(b.position), a.rotation * b.rotation};
}

inline Pose operator*(const Pose& a, const RelativePose& b) {
    return {a.Transform(b.position), a.rotation * b.rotation};
}

inline RelativePose Inverse(const RelativePose& a) {
    return {InverseRotate(a.rotation, Vector3(-a.position)), a.rotation.Conjugate()};
}

}  // namespace fulcrum
