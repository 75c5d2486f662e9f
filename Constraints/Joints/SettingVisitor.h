// Visitor that copies, compares or replaces the numbers of an object. Called by joint types, JointType::VisitSettings;
// one thread.
#pragma once

#include <Fulcrum/Constraints/Parts/SpringSettings.h>
#include <Fulcrum/Math/Quaternion.h>

#include <cstddef>
#include <type_traits>

namespace fulcrum {

class SettingVisitor {
public:
    // Called with the bytes of each number, which it may replace. isReplacing: whether it does.
    using OnBytes = void (*)(void* context, void* bytes, size_t size);
    SettingVisitor(OnBytes onBytes, void* context, bool isReplacing)
        : onBytes_(onBytes), context_(context), isReplacing_(isReplacing) {}

    // If so, the type must update everything derived from the settings afterwards.
    bool IsReplacing() const { return isReplacing_; }

    template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void operator()(T& number) const {
        onBytes_(context_, &number, sizeof number);
    }
    template <class Real>
    void operator()(Vec3<Real>& v) const {
        for (int i = 0; i < 3; ++i) (*this)(v[i]);
    }
    void operator()(Quaternion& q) const {
        for (float* x : {&q.x, &q.y, &q.z, &q.w}) (*this)(*x);
    }
    void operator()(SpringSettings& spring) const {
        auto& [mode, frequency, dampingRatio, stiffness, damping, form] = spring;
        (*this)(mode);
        for (float* x : {&frequency, &dampingRatio, &stiffness, &damping}) (*this)(*x);
        (*this)(form);
    }

private:
    OnBytes onBytes_;
    void* context_;
    bool isReplacing_;
};

}  // namespace fulcrum
