// Writer and reader of snapshots: values in sequence, without padding, in blocks. Both have the same interface, so that
// one function describes an element for both. A block is hashed when it is written, while it is in the cache. Used by
// Snapshots/; one thread.
#pragma once

#include <Fulcrum/Math/Assert.h>
#include <Fulcrum/Math/Bounds.h>
#include <Fulcrum/Math/Hash.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Math/Pose.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace fulcrum {

// The sections of a snapshot: deltas compare blocks with the same number and section of another snapshot.
enum class SnapshotSection : uint8_t {
    Head,
    Shapes,
    Compounds,
    GroupFilters,
    JointTypes,
    Bodies,
    BodyLists,
    Colliders,
    ColliderLists,
    Pairs,
    PairLists,
    Joints,
    JointLists,
    Sleeping,
    Sensors,
    Step,
    UserData,  // the last; not part of HashState
};

// One per block, after the data.
struct SnapshotBlock {
    uint32_t size;  // bytes
    uint32_t key;   // section << 24 | number of the block within it
    SnapshotSection Section() const { return static_cast<SnapshotSection>(key >> 24); }
};

struct SnapshotHeader {
    uint64_t magic, format;  // see SnapshotFormat
    uint64_t dataSize;       // bytes, of all blocks
    uint64_t stateHash;      // of the blocks before UserData: HashState
    uint64_t dataHash;       // of all blocks
    uint64_t blocks;         // their number
    uint64_t checksum;       // of the members above and the table of blocks
};
static_assert(std::has_unique_object_representations_v<SnapshotHeader>);

// Types without padding that own no memory.
template <class T>
struct IsPlain : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::byte>> {};
template <class Real>
struct IsPlain<Vec3<Real>> : std::true_type {};
template <class Real>
struct IsPlain<Quat<Real>> : std::true_type {};
template <>
struct IsPlain<Bounds> : std::true_type {};
template <>
struct IsPlain<RelativePose> : std::true_type {};
template <class T, size_t kCount>
struct IsPlain<T[kCount]> : IsPlain<T> {};
template <class T, size_t kCount>
struct IsPlain<std::array<T, kCount>> : IsPlain<T> {};
static_assert(sizeof(Bounds) == 24 && sizeof(RelativePose) == 28 && sizeof(Position) == 24);

#define FULCRUM_INLINE_IN_LOOP __attribute__((always_inline)) inline  // see VisitElements

// A call with several values is faster than several calls: the write position stays in a register, which the compiler
// cannot do across calls, since written bytes may alias it.
class SnapshotWriter {
public:
    static constexpr bool kWrites = true;

    // Overwrites `bytes`, a std::vector or Array of them, from the beginning, growing as needed; with keeps = false it
    // only hashes, and uses `bytes` as buffer.
    template <class Bytes>
    SnapshotWriter(Bytes& bytes, Array<SnapshotBlock>& blocks, bool keeps)
        : owner_(&bytes),
          resize_([](void* owner, size_t size) {
              static_cast<Bytes*>(owner)->resize(size);
              return static_cast<Bytes*>(owner)->data();
          }),
          bytes_(bytes.data(), bytes.size()),
          blocks_(blocks),
          keeps_(keeps) {
        blocks_.clear();
        Reserve(sizeof(SnapshotHeader));
        if (keeps) at_ = blockStart_ += sizeof(SnapshotHeader);
    }

    // Call before writing values: at most this many bytes may follow until the next Reserve.
    void Reserve(size_t bytes) {
        if (bytes > static_cast<size_t>(end_ - at_)) [[unlikely]]
            Grow(bytes);
    }
    template <class... T>
    void operator()(const T&... values) {
        static_assert((IsPlain<T>::value && ...));
        FULCRUM_ASSERT((sizeof(T) + ...) <= static_cast<size_t>(end_ - at_));
        std::byte* at = at_;
        ((std::memcpy(at, &values, sizeof values), at += sizeof values), ...);
        at_ = at;
    }
    // An array of values; reserves by itself.
    template <class T, class AnyAllocator>
    void List(const std::vector<T, AnyAllocator>& values) {
        static_assert(IsPlain<T>::value);
        Reserve(sizeof(uint32_t) + values.size() * sizeof(T));
        (*this)(static_cast<uint32_t>(values.size()));
        if (values.empty()) return;
        std::memcpy(at_, values.data(), values.size() * sizeof(T));
        at_ += values.size() * sizeof(T);
    }
    void Begin(SnapshotSection section) { key_ = static_cast<uint32_t>(section) << 24; }
    // Ends a block of the section, unless it is empty.
    void EndBlock() {
        const auto size = static_cast<size_t>(at_ - blockStart_);
        if (size == 0) return;
        blocks_.push_back({static_cast<uint32_t>(size), key_++});
        hash_ = HashWord(hash_, HashBytes(blockStart_, size));
        if (keeps_) blockStart_ = at_;
        else at_ = blockStart_;
    }

    uint64_t Hash() const { return hash_; }  // of the blocks so far
    size_t Size() const { return static_cast<size_t>(at_ - bytes_.data()); }

private:
    // Grows by at least an eighth: new bytes are zeroed before they are written.
    void Grow(size_t bytes) {
        const size_t at = Size(), start = static_cast<size_t>(blockStart_ - bytes_.data());
        const size_t size = std::max(at + bytes, bytes_.size() + bytes_.size() / 8);
        bytes_ = {resize_(owner_, size), size};
        at_ = bytes_.data() + at;
        blockStart_ = bytes_.data() + start;
        end_ = bytes_.data() + bytes_.size();
    }

    void* owner_;  // the container of the bytes
    std::byte* (*resize_)(void* owner, size_t size);
    std::span<std::byte> bytes_;
    Array<SnapshotBlock>& blocks_;
    bool keeps_;
    std::byte *at_ = bytes_.data(), *blockStart_ = at_, *end_ = at_ + bytes_.size();
    uint64_t hash_ = kHashSeed;
    uint32_t key_ = 0;
};

// Reads data whose checksum is valid. Never reads beyond the end: it then returns zeros, and HasFailed is true.
class SnapshotReader {
public:
    static constexpr bool kWrites = false;

    explicit SnapshotReader(std::span<const std::byte> data) : at_(data.data()), end_(data.data() + data.size()) {}

    template <class... T>
    FULCRUM_INLINE_IN_LOOP void operator()(T&... values) {
        static_assert((IsPlain<T>::value && ...));
        if (!Has((sizeof(T) + ...))) [[unlikely]] {
            (std::memset(static_cast<void*>(&values), 0, sizeof values), ...);
            return;
        }
        const std::byte* at = at_;
        ((std::memcpy(static_cast<void*>(&values), at, sizeof values), at += sizeof values), ...);
        at_ = at;
    }
    template <class T>
    T Get() {
        T value{};
        (*this)(value);
        return value;
    }
    template <class T, class AnyAllocator>
    void List(std::vector<T, AnyAllocator>& values) {
        static_assert(IsPlain<T>::value);
        const size_t count = Get<uint32_t>();
        values.resize(Has(count * sizeof(T)) ? count : 0);
        Raw(values.data(), values.size() * sizeof(T));
    }
    void Raw(void* to, size_t size) {
        if (size == 0 || !Has(size)) return;
        std::memcpy(to, at_, size);
        at_ += size;
    }
    void Reserve(size_t) {}
    void Begin(SnapshotSection) {}
    void EndBlock() {}
    std::span<const std::byte> Left() const { return {at_, end_}; }
    void SkipTo(const std::byte* at) { at_ = at; }
    bool HasFailed() const { return hasFailed_; }
    bool IsAtEnd() const { return at_ == end_; }

private:
    // Of more than 0 bytes; false once it has failed, since it is at the end then.
    bool Has(size_t size) {
        if (size <= static_cast<size_t>(end_ - at_)) [[likely]]
            return true;
        hasFailed_ = true;
        at_ = end_;
        return false;
    }

    const std::byte* at_;
    const std::byte* end_;
    bool hasFailed_ = false;
};

// Reads elements of which it is known that the data has them whole.
class UncheckedSnapshotReader {
public:
    static constexpr bool kWrites = false;

    explicit UncheckedSnapshotReader(std::span<const std::byte> data)
        : at_(data.data()), end_(data.data() + data.size()) {}
    bool HasLeft(size_t size) const { return size <= static_cast<size_t>(end_ - at_); }
    const std::byte* At() const { return at_; }

    template <class... T>
    FULCRUM_INLINE_IN_LOOP void operator()(T&... values) {
        static_assert((IsPlain<T>::value && ...));
        FULCRUM_ASSERT(HasLeft((sizeof(T) + ...)));
        ((std::memcpy(static_cast<void*>(&values), at_, sizeof values), at_ += sizeof values), ...);
    }

private:
    const std::byte* at_;
    const std::byte* end_;
};

// Array elements per block: unchanged blocks cost almost nothing in deltas.
inline constexpr uint32_t kElementsPerBlock = 64;
template <class Stream>
void EndElement(Stream& stream, uint32_t index) {
    if (index % kElementsPerBlock == kElementsPerBlock - 1) stream.EndBlock();
}

// Calls visit(stream, i) for each element i of a large array, and ends their blocks. An element has `most` bytes at
// most: while as many are left the reader need not check. That reader is a variable of its own, which stays in
// registers if all functions that read it are inlined (FULCRUM_INLINE_IN_LOOP); bytes that are read may alias another.
template <class Stream, class Visit>
void VisitElements(Stream& stream, uint32_t count, size_t most, Visit&& visit) {
    uint32_t i = 0;
    if constexpr (!Stream::kWrites) {
        UncheckedSnapshotReader reader(stream.Left());
        for (; i < count && reader.HasLeft(most); ++i) visit(reader, i);
        stream.SkipTo(reader.At());
    }
    for (; i < count; ++i) {
        stream.Reserve(most);
        visit(stream, i);
        EndElement(stream, i);
    }
    stream.EndBlock();
}

}  // namespace fulcrum
