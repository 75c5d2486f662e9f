// Numbers as little-endian bytes and back. Used by the shape files. The reader checks every length before it reads or
// allocates; past the end it returns zeros, and HasFailed() is true.
#pragma once

#include <Fulcrum/Math/Quaternion.h>

#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace fulcrum {

template <class T>
concept PlainNumber = std::is_integral_v<T> || std::is_same_v<T, float>;

class ByteWriter {
public:
    template <PlainNumber T>
    void Write(T value) {
        if constexpr (std::is_same_v<T, float>) {
            Write(std::bit_cast<uint32_t>(value));
        } else {
            const auto bits = static_cast<std::make_unsigned_t<T>>(value);
            for (size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(static_cast<uint8_t>(uint64_t{bits} >> (8 * i)));
        }
    }
    void Write(const Vector3& v) {
        for (int i = 0; i < 3; ++i) Write(v[i]);
    }
    void Write(const Quaternion& q) {
        for (const float x : {q.x, q.y, q.z, q.w}) Write(x);
    }
    template <class T>
    void WriteAll(std::span<const T> values) {
        for (const T& value : values) Write(value);
    }
    // Writes the output of `content`, preceded by its length in 8 bytes.
    template <class Content>
    void WriteWithLength(Content&& content) {
        const size_t at = bytes_.size();
        Write(uint64_t{0});
        content();
        const uint64_t length = bytes_.size() - at - 8;
        for (size_t i = 0; i < 8; ++i) bytes_[at + i] = static_cast<uint8_t>(length >> (8 * i));
    }
    std::vector<uint8_t>& Bytes() { return bytes_; }

private:
    std::vector<uint8_t> bytes_;
};

class ByteReader {
public:
    explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

    bool HasFailed() const { return hasFailed_; }
    // Whether exactly all bytes were read.
    bool IsAtEnd() const { return !hasFailed_ && bytes_.empty(); }

    void Read(float& value) {
        uint32_t bits = 0;
        Read(bits);
        value = std::bit_cast<float>(bits);
    }
    template <class T>
    requires(std::is_unsigned_v<T>) void Read(T& value) {
        uint64_t bits = 0;
        for (size_t i = 0; i < sizeof(T) && Has(sizeof(T)); ++i) bits |= uint64_t{bytes_[i]} << (8 * i);
        value = static_cast<T>(bits);
        Skip(sizeof(T));
    }
    void Read(Vector3& v) {
        for (int i = 0; i < 3; ++i) Read(v[i]);
    }
    void Read(Quaternion& q) {
        Read(q.x);
        Read(q.y);
        Read(q.z);
        Read(q.w);
    }
    template <class T>
    T Get() {
        T value{};
        Read(value);
        return value;
    }
    // `count` values of `size` bytes each; none if there are fewer.
    template <class T>
    void ReadAll(std::vector<T>& values, uint64_t count, size_t size = sizeof(T)) {
        values.clear();
        if (count > bytes_.size() / size) hasFailed_ = true;
        if (hasFailed_) return;
        values.resize(count);
        for (T& value : values) Read(value);
    }
    // A block preceded by its length.
    ByteReader ReadBlock() {
        const uint64_t length = Get<uint64_t>();
        if (length > bytes_.size()) hasFailed_ = true;
        ByteReader block(hasFailed_ ? std::span<const uint8_t>{} : bytes_.first(length));
        block.hasFailed_ = hasFailed_;
        if (!hasFailed_) bytes_ = bytes_.subspan(length);
        return block;
    }
    std::span<const uint8_t> Rest() const { return bytes_; }

private:
    bool Has(size_t count) const { return !hasFailed_ && bytes_.size() >= count; }
    void Skip(size_t count) {
        if (Has(count)) bytes_ = bytes_.subspan(count);
        else hasFailed_ = true;
    }

    std::span<const uint8_t> bytes_;
    bool hasFailed_ = false;
};

}  // namespace fulcrum
