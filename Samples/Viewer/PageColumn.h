// A column of a page's numbers: varints, see PageData.h. Called by PageData and PageJoints, one thread.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace fulcrum {

class Column {
public:
    void PutUnsigned(uint64_t value) {
        for (; value >= 128; value >>= 7) bytes_.push_back(static_cast<char>(128 | (value & 127)));
        bytes_.push_back(static_cast<char>(value));
    }
    void PutSigned(int64_t value) {
        PutUnsigned(static_cast<uint64_t>(value) << 1 ^ static_cast<uint64_t>(value >> 63));
    }
    template <size_t N>
    void PutDifference(const std::array<int64_t, N>& value, const std::array<int64_t, N>& expected) {
        for (size_t i = 0; i < N; ++i) PutSigned(value[i] - expected[i]);
    }
    void Append(const Column& other) { bytes_ += other.bytes_; }
    const std::string& Bytes() const { return bytes_; }

private:
    std::string bytes_;
};

using Steps3 = std::array<int64_t, 3>;

inline Steps3 Quantized(const Vector3& v, double step) {
    return {std::llround(v.x() / step), std::llround(v.y() / step), std::llround(v.z() / step)};
}

}  // namespace fulcrum
