// Reads and writes rows of eight floats of bodies, in lanes or of one body. Used by Integrate and ScaleWarmStarts; any
// thread, for bodies of its own.
#pragma once

#include <Fulcrum/Constraints/BodyLanes.h>

#include <algorithm>
#include <span>
#include <utility>

namespace fulcrum::rows {

using Lanes = Wide<kLanes>;
using Indices = uint32_t[kLanes];

// Kernels are templates over Real: float for one body, Lanes for kLanes bodies.
template <class Real>
inline constexpr int kBodies = sizeof(Real) / sizeof(float);

// Eight numbers of each body.
template <class Real>
struct Rows {
    static constexpr int kCount = kBodies<Real>;
    float* rows[kCount];
    Real at[8];

    template <class RowOf>
    FULCRUM_FORCE_INLINE Rows(const uint32_t (&bodies)[kCount], RowOf&& rowOf) {
        for (int i = 0; i < kCount; ++i) rows[i] = const_cast<float*>(rowOf(bodies[i]));
        if constexpr (std::is_same_v<Real, float>) std::copy_n(rows[0], 8, at);
        else GatherRows<kCount>(reinterpret_cast<const float* const(&)[kCount]>(rows), at);
    }
    Vec3<Real> First() const { return VectorAt<BodyState::kLinear>(at); }
    Vec3<Real> Second() const { return VectorAt<BodyState::kAngular>(at); }
    void Set(const Vec3<Real>& first, const Vec3<Real>& second) {
        SetVectorAt<BodyState::kLinear>(at, first);
        SetVectorAt<BodyState::kAngular>(at, second);
    }
    void Write(int count) const {
        if constexpr (std::is_same_v<Real, float>) std::copy_n(at, 8, rows[0]);
        else ScatterRows<kCount>(rows, at, count);
    }
    // Writes First and Second. For a single body the other two numbers of the row may have changed since they were
    // read, in lanes not.
    void WriteVectors(int count) const {
        if constexpr (std::is_same_v<Real, float>) std::copy_n(at, 6, rows[0]);
        else Write(count);
    }
    // Writes the lanes of the mask.
    void Write(int count, const WideMask<kCount>& mask) {
        const uint32_t lanes = mask.ToBits();
        alignas(32) float nowhere[8];
        for (int i = 0; i < kCount; ++i)
            if (!(lanes >> i & 1u)) rows[i] = nowhere;
        Write(count);
    }
    void Write(int count, bool mask) const {
        if (mask) Write(count);
    }
};

// Calls visit(indices, count) for kLanes bodies at a time. Lanes beyond the last body repeat it.
template <class Visit>
void VisitInLanes(std::span<const uint32_t> bodies, Visit&& visit) {
    while (!bodies.empty()) {
        const size_t count = std::min(bodies.size(), size_t(kLanes));
        Indices index;
        for (size_t i = 0; i < kLanes; ++i) index[i] = bodies[std::min(i, count - 1)];
        visit(std::as_const(index), static_cast<int>(count));
        bodies = bodies.subspan(count);
    }
}

}  // namespace fulcrum::rows
