// Four doubles that are added, multiplied, compared and selected at once, for kernels that need more precision than
// float. Templates over Real = double or WideDouble give the same bits. The arithmetic is the compilers' vector
// extension, on any CPU.
#pragma once

#include <Fulcrum/Math/Trigonometry.h>

#include <cmath>

namespace fulcrum {

struct WideDouble {
    static constexpr int kCount = 4;
    // Aligned no more strictly than any CPU's registers.
    typedef double Double __attribute__((vector_size(32), aligned(16)));
    typedef int64_t Int __attribute__((vector_size(32), aligned(16)));
    struct Mask {
        Int bits;  // -1 true, 0 false
    };
    Double v;

    WideDouble() = default;
    WideDouble(double x) : v(Double{x, x, x, x}) {}  // all lanes x
    explicit WideDouble(int x) : WideDouble(static_cast<double>(x)) {}
    static WideDouble Of(Double x) {
        WideDouble w;
        w.v = x;
        return w;
    }

    double operator[](int lane) const { return v[lane]; }
    void Set(int lane, double x) { v[lane] = x; }

    friend WideDouble operator+(const WideDouble& a, const WideDouble& b) { return Of(a.v + b.v); }
    friend WideDouble operator-(const WideDouble& a, const WideDouble& b) { return Of(a.v - b.v); }
    friend WideDouble operator*(const WideDouble& a, const WideDouble& b) { return Of(a.v * b.v); }
    friend WideDouble operator/(const WideDouble& a, const WideDouble& b) { return Of(a.v / b.v); }
    WideDouble operator-() const { return Of(-v); }
    WideDouble& operator+=(const WideDouble& b) { return *this = *this + b; }

    friend Mask operator<(const WideDouble& a, const WideDouble& b) { return {a.v < b.v}; }
    friend Mask operator>(const WideDouble& a, const WideDouble& b) { return {a.v > b.v}; }
    friend Mask operator==(const WideDouble& a, const WideDouble& b) { return {a.v == b.v}; }
};

// mask ? a : b
inline WideDouble Select(WideDouble::Mask mask, const WideDouble& a, const WideDouble& b) {
    return WideDouble::Of(mask.bits ? a.v : b.v);
}
inline WideDouble Abs(const WideDouble& a) { return Select(a < WideDouble(0.0), -a, a); }
inline WideDouble Sqrt(const WideDouble& a) {
    WideDouble r;
    for (int i = 0; i < WideDouble::kCount; ++i) r.Set(i, std::sqrt(a[i]));
    return r;
}

// Uses the constants and argument reductions of double.
namespace detail {
template <>
inline constexpr bool kIsDouble<WideDouble> = true;
}  // namespace detail

}  // namespace fulcrum
