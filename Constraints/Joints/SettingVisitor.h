// Shows the numbers that an object is made of to whoever copies, compares or replaces them. Called by types of joints,
// JointType::VisitSettings; one thread.
#pragma once

#include <Fulcrum/Constraints/Parts/SpringSettings.h>
#include <Fulcrum/Math/Quaternion.h>

#include <cstddef>
#include <type_traits>

namespace fulcrum {

class SettingVisitor {
public:
    // Called with each number's bytes, which it may replace. isReplacing: whether it does.
    using OnBytes = void (*)(void* context, void* bytes, size_t size);
    SettingVisitor(OnBytes onBytes, void* context, bool isReplacing)
        : onBytes_(onBytes), context_(context), isReplacing_(isReplacing) {}

    // What follows from the settings is to be brought up to date afterwards.
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
