// The result of the narrow phase for a pair of convex shapes. All in the center frame of shape A.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <cstdint>

namespace fulcrum {

struct ManifoldPoint {
    Vector3 positionOnA = Vector3::Zero();  // m; the point on B is positionOnA + normal * separation
    float separation = 0;                   // m along the normal; negative where the shapes overlap
    uint32_t feature = 0;                   // the same from step to step while the same features touch; not 0
};

struct Manifold {
    static constexpr int kMaxPoints = 4;
    Vector3 normal = Vector3::Zero();  // unit, from A towards B
    int pointCount = 0;                // 0: farther apart than the speculative distance
    ManifoldPoint points[kMaxPoints];
};

// The warm-start data of a pair function from the last step. Part of the simulation's state. All zero: empty.
struct PairCache {
    enum class Kind : uint8_t { None, FaceOfA, FaceOfB, EdgePair, Axis };
    Kind kind = Kind::None;
    uint16_t indexA = 0, indexB = 0;  // the faces that touched; of an EdgePair, the edges (each function's own numbers)
    float axis[3] = {0, 0, 0};        // in A's frame, if the kind is Axis

    Vector3 Axis() const { return Vector3(axis[0], axis[1], axis[2]); }
    void RememberAxis(Kind itsKind, const Vector3& itsAxis) {
        kind = itsKind;
        for (int i = 0; i < 3; ++i) axis[i] = itsAxis[i];
    }
};

}  // namespace fulcrum
