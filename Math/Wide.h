// SIMD lanes: Wide<N> is N floats (N = 1, 4, 8, 16) that are added, multiplied, compared and selected at once. Kernels
// are templates over Real = float or Wide<N> and give the same bits for every N. The only file with intrinsics and CPU
// conditionals. The arithmetic uses the compilers' vector extension, so any width works on any CPU; intrinsics are used
// where compilers generate poor code.
#pragma once

#include <Fulcrum/Math/ForceInline.h>
#include <Fulcrum/Math/Vector.h>

#include <cstdint>
#include <cstring>

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

// GCC and Clang warn that functions with vectors wider than a register have another ABI than on CPUs with such
// registers. The two are never mixed: the inline namespace below is part of their names.
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace fulcrum {

// A program may be compiled for another CPU than the library that it links. The inline namespaces keep the linker from
// merging inline functions that differ in alignment, calling convention and instructions (ODR).
#if defined(FULCRUM_SCALAR_LANES)
inline namespace scalar_lanes {
#elif defined(__AVX512F__)
inline namespace avx512_lanes {
#elif defined(__AVX2__)
inline namespace avx2_lanes {
#elif defined(__AVX__)
inline namespace avx_lanes {
#else
inline namespace vector_lanes {
#endif

// Lanes of a batch of constraints in this build.
#if defined(FULCRUM_SCALAR_LANES)
#define FULCRUM_LANES 1
#elif defined(__AVX2__)
#define FULCRUM_LANES 8
#else
#define FULCRUM_LANES 4
#endif
inline constexpr int kLanes = FULCRUM_LANES;

// Calls a macro of (lanes, ...) for the lanes that kernels are compiled for: one, and those of this build.
#if FULCRUM_LANES == 1
#define FULCRUM_FOR_EACH_WIDTH(instantiate, ...) instantiate(1 __VA_OPT__(, ) __VA_ARGS__)
#else
#define FULCRUM_FOR_EACH_WIDTH(instantiate, ...) \
    instantiate(1 __VA_OPT__(, ) __VA_ARGS__) instantiate(FULCRUM_LANES __VA_OPT__(, ) __VA_ARGS__)
#endif

// "scalar", "SSE2", "AVX2", "SIMD128" (of WebAssembly) or "vector": what this build was compiled for.
#if defined(FULCRUM_SCALAR_LANES)
inline constexpr const char* kSimdName = "scalar";
#elif defined(__AVX2__)
inline constexpr const char* kSimdName = "AVX2";
#elif defined(__SSE2__)
inline constexpr const char* kSimdName = "SSE2";
#elif defined(__wasm_simd128__)
inline constexpr const char* kSimdName = "SIMD128";
#else
inline constexpr const char* kSimdName = "vector";
#endif

namespace registers {
// No type is aligned more strictly than a register of this build, as Eigen's storage expects.
#if defined(__AVX512F__)
#define FULCRUM_LANES_OF(lanes) __attribute__((vector_size(4 * lanes)))
inline constexpr int kRegisterBytes = 64;
#elif defined(__AVX__)
#define FULCRUM_LANES_OF(lanes) __attribute__((vector_size(4 * lanes), aligned(lanes < 8 ? 4 * lanes : 32)))
inline constexpr int kRegisterBytes = 32;
#else
#define FULCRUM_LANES_OF(lanes) __attribute__((vector_size(4 * lanes), aligned(16)))
inline constexpr int kRegisterBytes = 16;
#endif
template <int N>
struct LaneTypes;
template <>
struct LaneTypes<1> {
    using Float = float;
    using Int = int32_t;
};
template <>
struct LaneTypes<4> {
    typedef float Float FULCRUM_LANES_OF(4);
    typedef int32_t Int FULCRUM_LANES_OF(4);
};
template <>
struct LaneTypes<8> {
    typedef float Float FULCRUM_LANES_OF(8);
    typedef int32_t Int FULCRUM_LANES_OF(8);
};
template <>
struct LaneTypes<16> {
    typedef float Float FULCRUM_LANES_OF(16);
    typedef int32_t Int FULCRUM_LANES_OF(16);
};
#undef FULCRUM_LANES_OF

#if defined(__wasm_simd128__)
// Applies an operation of WebAssembly to each register of `V`, which is one or several of them.
template <class V, class Operation, class... More>
FULCRUM_FORCE_INLINE V ByRegister(Operation operation, const V& first, const More&... more) {
    V result;
    for (size_t i = 0; i < sizeof(V) / 16; ++i) {
        const auto part = [&](const auto& v) { return wasm_v128_load(reinterpret_cast<const char*>(&v) + 16 * i); };
        wasm_v128_store(reinterpret_cast<char*>(&result) + 16 * i, operation(part(first), part(more)...));
    }
    return result;
}
#endif
}  // namespace registers

// A mask: one truth value per lane.
template <int N>
struct WideMask {
    using Int = typename registers::LaneTypes<N>::Int;
    Int bits;  // -1 true, 0 false

    friend WideMask operator&(WideMask a, WideMask b) { return {a.bits & b.bits}; }
    friend WideMask operator|(WideMask a, WideMask b) { return {a.bits | b.bits}; }
    WideMask operator~() const { return {~bits}; }
    bool operator[](int lane) const {
        if constexpr (N == 1) return bits != 0;
        else return bits[lane] != 0;
    }
    // Bit i is lane i.
    uint32_t ToBits() const {
#if defined(__AVX2__)
        if constexpr (N == 8) return static_cast<uint32_t>(_mm256_movemask_ps((__m256)bits));
#endif
#if defined(__SSE2__)
        if constexpr (N == 4) return static_cast<uint32_t>(_mm_movemask_ps((__m128)bits));
#endif
#if defined(__wasm_simd128__)
        if constexpr (N >= 4) {
            uint32_t found = 0;
            for (int i = 0; i < N / 4; ++i)
                found |= static_cast<uint32_t>(
                             wasm_i32x4_bitmask(wasm_v128_load(reinterpret_cast<const char*>(&bits) + 16 * i)))
                         << 4 * i;
            return found;
        }
#endif
        uint32_t result = 0;
        for (int i = 0; i < N; ++i) result |= static_cast<uint32_t>((*this)[i]) << i;
        return result;
    }
    bool Any() const { return ToBits() != 0; }
    bool All() const { return ToBits() == (N == 32 ? ~0u : (1u << N) - 1u); }
};

template <int N>
struct alignas(4 * N < registers::kRegisterBytes ? 4 * N : registers::kRegisterBytes) Wide {
    using Float = typename registers::LaneTypes<N>::Float;
    using Mask = WideMask<N>;
    static constexpr int kCount = N;
    Float v;

    Wide() = default;
    Wide(float x) : v(Float{} + x) {}  // all lanes x
    explicit Wide(int x) : Wide(static_cast<float>(x)) {}
    explicit Wide(double x) : Wide(static_cast<float>(x)) {}
    static Wide Of(Float x) {
        Wide w;
        w.v = x;
        return w;
    }
    // From and to N floats at any address.
    static Wide Load(const float* from) {
        Wide w;
        std::memcpy(&w.v, from, sizeof(Float));
        return w;
    }
    void Store(float* to) const { std::memcpy(to, &v, sizeof(Float)); }
    // N bytes at any address as numbers 0 .. 255.
    static Wide FromBytes(const uint8_t* from) {
#if defined(__AVX2__)
        if constexpr (N == 8) {
            const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
            return Of((Float)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(bytes)));
        }
#endif
#if defined(__SSE2__)
        if constexpr (N == 4) {
            int32_t four;
            std::memcpy(&four, from, 4);
            const __m128i zero = _mm_setzero_si128();
            const __m128i words = _mm_unpacklo_epi8(_mm_cvtsi32_si128(four), zero);
            return Of((Float)_mm_cvtepi32_ps(_mm_unpacklo_epi16(words, zero)));
        }
#endif
        Wide w;
        for (int i = 0; i < N; ++i) w.Set(i, static_cast<float>(from[i]));
        return w;
    }

    float operator[](int lane) const {
        if constexpr (N == 1) return v;
        else return v[lane];
    }
    void Set(int lane, float x) {
        if constexpr (N == 1) v = x;
        else v[lane] = x;
    }

    friend Wide operator+(Wide a, Wide b) { return Of(a.v + b.v); }
    friend Wide operator-(Wide a, Wide b) { return Of(a.v - b.v); }
    friend Wide operator*(Wide a, Wide b) { return Of(a.v * b.v); }
    friend Wide operator/(Wide a, Wide b) { return Of(a.v / b.v); }
    Wide operator-() const { return Of(-v); }
    Wide& operator+=(Wide b) { return *this = *this + b; }
    Wide& operator-=(Wide b) { return *this = *this - b; }
    Wide& operator*=(Wide b) { return *this = *this * b; }

    friend Mask operator<(Wide a, Wide b) {
        return Compare(a, b, [](auto x, auto y) { return x < y; });
    }
    friend Mask operator<=(Wide a, Wide b) {
        return Compare(a, b, [](auto x, auto y) { return x <= y; });
    }
    friend Mask operator>(Wide a, Wide b) {
        return Compare(a, b, [](auto x, auto y) { return x > y; });
    }
    friend Mask operator>=(Wide a, Wide b) {
        return Compare(a, b, [](auto x, auto y) { return x >= y; });
    }
    friend Mask operator==(Wide a, Wide b) {
        return Compare(a, b, [](auto x, auto y) { return x == y; });
    }

private:
    template <class F>
    static Mask Compare(Wide a, Wide b, F compare) {
        if constexpr (N == 1) return {compare(a.v, b.v) ? -1 : 0};
        else return {compare(a.v, b.v)};
    }
};

// mask ? a : b
template <int N>
inline Wide<N> Select(WideMask<N> mask, Wide<N> a, Wide<N> b) {
#if defined(__AVX2__)
    if constexpr (N == 8)
        return Wide<N>::Of((typename Wide<N>::Float)_mm256_blendv_ps((__m256)b.v, (__m256)a.v, (__m256)mask.bits));
#endif
#if defined(__wasm_simd128__)
    if constexpr (N >= 4)
        return Wide<N>::Of(registers::ByRegister(
            [](v128_t x, v128_t y, v128_t m) { return wasm_v128_bitselect(x, y, m); }, a.v, b.v, mask.bits));
#endif
    return Wide<N>::Of(mask.bits ? a.v : b.v);
}
inline float Select(bool mask, float a, float b) { return mask ? a : b; }

// a < b ? a : b and a > b ? a : b: the second operand if one is NaN or both are zeros, like the CPU instructions.
template <int N>
inline Wide<N> Min(Wide<N> a, Wide<N> b) {
#if defined(__AVX2__)
    if constexpr (N == 8) return Wide<N>::Of((typename Wide<N>::Float)_mm256_min_ps((__m256)a.v, (__m256)b.v));
#endif
#if defined(__SSE2__)
    if constexpr (N == 4) return Wide<N>::Of((typename Wide<N>::Float)_mm_min_ps((__m128)a.v, (__m128)b.v));
#endif
#if defined(__wasm_simd128__)
    if constexpr (N >= 4)
        return Wide<N>::Of(registers::ByRegister([](v128_t x, v128_t y) { return wasm_f32x4_pmin(y, x); }, a.v, b.v));
#endif
    return Select(a < b, a, b);
}
template <int N>
inline Wide<N> Max(Wide<N> a, Wide<N> b) {
#if defined(__AVX2__)
    if constexpr (N == 8) return Wide<N>::Of((typename Wide<N>::Float)_mm256_max_ps((__m256)a.v, (__m256)b.v));
#endif
#if defined(__SSE2__)
    if constexpr (N == 4) return Wide<N>::Of((typename Wide<N>::Float)_mm_max_ps((__m128)a.v, (__m128)b.v));
#endif
#if defined(__wasm_simd128__)
    if constexpr (N >= 4)
        return Wide<N>::Of(registers::ByRegister([](v128_t x, v128_t y) { return wasm_f32x4_pmax(y, x); }, a.v, b.v));
#endif
    return Select(a > b, a, b);
}
inline float Min(float a, float b) { return a < b ? a : b; }
inline float Max(float a, float b) { return a > b ? a : b; }

template <class Real>
inline Real Clamp(Real x, Real low, Real high) {
    return Max(low, Min(high, x));
}

// Correctly rounded, as IEEE 754 asks.
template <int N>
inline Wide<N> Sqrt(Wide<N> a) {
#if defined(__AVX2__)
    if constexpr (N == 8) return Wide<N>::Of((typename Wide<N>::Float)_mm256_sqrt_ps((__m256)a.v));
#endif
#if defined(__SSE2__)
    if constexpr (N == 4) return Wide<N>::Of((typename Wide<N>::Float)_mm_sqrt_ps((__m128)a.v));
#endif
#if defined(__wasm_simd128__)
    if constexpr (N >= 4) return Wide<N>::Of(registers::ByRegister([](v128_t x) { return wasm_f32x4_sqrt(x); }, a.v));
#endif
    Wide<N> r;
    for (int i = 0; i < N; ++i) r.Set(i, detail::SquareRoot(a[i]));
    return r;
}
inline float Sqrt(float a) { return detail::SquareRoot(a); }

template <int N>
inline Wide<N> Abs(Wide<N> a) {
    return Select(a < Wide<N>(0.0f), -a, a);
}
inline float Abs(float a) { return a < 0.0f ? -a : a; }

// Sum, smallest and largest over the lanes, lane by lane: the order is the same for every width of one array.
template <int N>
inline float HorizontalMax(Wide<N> a) {
    float m = a[0];
    for (int i = 1; i < N; ++i) m = a[i] > m ? a[i] : m;
    return m;
}
template <int N>
inline float HorizontalMin(Wide<N> a) {
    float m = a[0];
    for (int i = 1; i < N; ++i) m = a[i] < m ? a[i] : m;
    return m;
}

namespace registers {
#if defined(__AVX2__)
// Rows to columns of an 8x8 block; its own inverse.
FULCRUM_FORCE_INLINE void Transpose8(__m256 (&r)[8]) {
    const __m256 a0 = _mm256_unpacklo_ps(r[0], r[1]), a1 = _mm256_unpackhi_ps(r[0], r[1]);
    const __m256 a2 = _mm256_unpacklo_ps(r[2], r[3]), a3 = _mm256_unpackhi_ps(r[2], r[3]);
    const __m256 a4 = _mm256_unpacklo_ps(r[4], r[5]), a5 = _mm256_unpackhi_ps(r[4], r[5]);
    const __m256 a6 = _mm256_unpacklo_ps(r[6], r[7]), a7 = _mm256_unpackhi_ps(r[6], r[7]);
    const __m256 b0 = _mm256_shuffle_ps(a0, a2, 0x44), b1 = _mm256_shuffle_ps(a0, a2, 0xEE);
    const __m256 b2 = _mm256_shuffle_ps(a1, a3, 0x44), b3 = _mm256_shuffle_ps(a1, a3, 0xEE);
    const __m256 b4 = _mm256_shuffle_ps(a4, a6, 0x44), b5 = _mm256_shuffle_ps(a4, a6, 0xEE);
    const __m256 b6 = _mm256_shuffle_ps(a5, a7, 0x44), b7 = _mm256_shuffle_ps(a5, a7, 0xEE);
    r[0] = _mm256_permute2f128_ps(b0, b4, 0x20);
    r[1] = _mm256_permute2f128_ps(b1, b5, 0x20);
    r[2] = _mm256_permute2f128_ps(b2, b6, 0x20);
    r[3] = _mm256_permute2f128_ps(b3, b7, 0x20);
    r[4] = _mm256_permute2f128_ps(b0, b4, 0x31);
    r[5] = _mm256_permute2f128_ps(b1, b5, 0x31);
    r[6] = _mm256_permute2f128_ps(b2, b6, 0x31);
    r[7] = _mm256_permute2f128_ps(b3, b7, 0x31);
}
#endif
#if defined(__SSE2__)
FULCRUM_FORCE_INLINE void Transpose4(__m128& r0, __m128& r1, __m128& r2, __m128& r3) {
    _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
}
#elif defined(__wasm_simd128__)
FULCRUM_FORCE_INLINE void Transpose4(v128_t& r0, v128_t& r1, v128_t& r2, v128_t& r3) {
    const v128_t a = wasm_i32x4_shuffle(r0, r1, 0, 4, 1, 5), b = wasm_i32x4_shuffle(r0, r1, 2, 6, 3, 7);
    const v128_t c = wasm_i32x4_shuffle(r2, r3, 0, 4, 1, 5), d = wasm_i32x4_shuffle(r2, r3, 2, 6, 3, 7);
    r0 = wasm_i64x2_shuffle(a, c, 0, 2);
    r1 = wasm_i64x2_shuffle(a, c, 1, 3);
    r2 = wasm_i64x2_shuffle(b, d, 0, 2);
    r3 = wasm_i64x2_shuffle(b, d, 1, 3);
}
#endif
}  // namespace registers

template <int N>
inline Vector3 LaneOf(const Vec3<Wide<N>>& v, int lane) {
    return Vector3(v.x()[lane], v.y()[lane], v.z()[lane]);
}

// Reads eight floats at rows[lane] for each of N lanes into eight wide values: out[k][lane] = rows[lane][k].
// The rows are 32-byte aligned.
template <int N>
FULCRUM_FORCE_INLINE void GatherRows(const float* const (&rows)[N], Wide<N> (&out)[8]) {
#if defined(__AVX2__)
    if constexpr (N == 8) {
        __m256 r[8];
        for (int i = 0; i < 8; ++i) r[i] = _mm256_load_ps(rows[i]);
        registers::Transpose8(r);
        for (int i = 0; i < 8; ++i) out[i].v = (typename Wide<N>::Float)r[i];
        return;
    }
#endif
#if defined(__SSE2__)
    if constexpr (N == 4) {
        for (int half = 0; half < 2; ++half) {
            __m128 r0 = _mm_load_ps(rows[0] + 4 * half), r1 = _mm_load_ps(rows[1] + 4 * half);
            __m128 r2 = _mm_load_ps(rows[2] + 4 * half), r3 = _mm_load_ps(rows[3] + 4 * half);
            registers::Transpose4(r0, r1, r2, r3);
            out[4 * half].v = (typename Wide<N>::Float)r0;
            out[4 * half + 1].v = (typename Wide<N>::Float)r1;
            out[4 * half + 2].v = (typename Wide<N>::Float)r2;
            out[4 * half + 3].v = (typename Wide<N>::Float)r3;
        }
        return;
    }
#endif
#if defined(__wasm_simd128__)
    if constexpr (N == 4) {
        for (int half = 0; half < 2; ++half) {
            v128_t r[4];
            for (int i = 0; i < 4; ++i) r[i] = wasm_v128_load(rows[i] + 4 * half);
            registers::Transpose4(r[0], r[1], r[2], r[3]);
            for (int k = 0; k < 4; ++k) out[4 * half + k].v = (typename Wide<N>::Float)r[k];
        }
        return;
    }
#endif
    for (int k = 0; k < 8; ++k)
        for (int i = 0; i < N; ++i) out[k].Set(i, rows[i][k]);
}

// Reads points: the first three of four readable floats at rows[lane], for each of N lanes, into three wide values:
// out[k][lane] = rows[lane][k]. Rows at any address.
template <int N>
FULCRUM_FORCE_INLINE void GatherPoints(const float* const (&rows)[N], Wide<N> (&out)[3]) {
#if defined(__AVX2__)
    if constexpr (N == 8) {
        __m256 r[4];  // rows i and i + 4
        for (int i = 0; i < 4; ++i)
            r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(rows[i])), _mm_loadu_ps(rows[i + 4]), 1);
        const __m256 xy0 = _mm256_unpacklo_ps(r[0], r[1]), xy1 = _mm256_unpacklo_ps(r[2], r[3]);
        const __m256 z0 = _mm256_unpackhi_ps(r[0], r[1]), z1 = _mm256_unpackhi_ps(r[2], r[3]);
        out[0].v = (typename Wide<N>::Float)_mm256_shuffle_ps(xy0, xy1, 0x44);
        out[1].v = (typename Wide<N>::Float)_mm256_shuffle_ps(xy0, xy1, 0xEE);
        out[2].v = (typename Wide<N>::Float)_mm256_shuffle_ps(z0, z1, 0x44);
        return;
    }
#endif
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < N; ++i) out[k].Set(i, rows[i][k]);
}

// The reverse of GatherRows, for the first `count` lanes: rows[lane][k] = in[k][lane].
template <int N>
FULCRUM_FORCE_INLINE void ScatterRows(float* const (&rows)[N], const Wide<N> (&in)[8], int count) {
#if defined(__AVX2__)
    if constexpr (N == 8) {
        __m256 r[8];
        for (int i = 0; i < 8; ++i) r[i] = (__m256)in[i].v;
        registers::Transpose8(r);
        if (count == 8) {
            for (int i = 0; i < 8; ++i) _mm256_store_ps(rows[i], r[i]);
        } else {
            for (int i = 0; i < count; ++i) _mm256_store_ps(rows[i], r[i]);
        }
        return;
    }
#endif
#if defined(__SSE2__)
    if constexpr (N == 4) {
        for (int half = 0; half < 2; ++half) {
            __m128 r[4] = {(__m128)in[4 * half].v, (__m128)in[4 * half + 1].v, (__m128)in[4 * half + 2].v,
                           (__m128)in[4 * half + 3].v};
            registers::Transpose4(r[0], r[1], r[2], r[3]);
            for (int i = 0; i < count; ++i) _mm_store_ps(rows[i] + 4 * half, r[i]);
        }
        return;
    }
#endif
#if defined(__wasm_simd128__)
    if constexpr (N == 4) {
        for (int half = 0; half < 2; ++half) {
            v128_t r[4];
            for (int k = 0; k < 4; ++k) r[k] = (v128_t)in[4 * half + k].v;
            registers::Transpose4(r[0], r[1], r[2], r[3]);
            for (int i = 0; i < count; ++i) wasm_v128_store(rows[i] + 4 * half, r[i]);
        }
        return;
    }
#endif
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < 8; ++k) rows[i][k] = in[k][i];
}

}  // inline namespace
}  // namespace fulcrum

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
