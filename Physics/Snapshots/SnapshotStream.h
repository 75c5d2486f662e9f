// How snapshots are written and read: numbers one after the other, without padding, in blocks. Writer and reader are
// called alike, so that one function describes an element for both. A block is hashed as it is written, while it is in
// the cache. Used by Snapshots/; one thread.
#pragma once

#include <Fulcrum/Math/Assert.h>
#include <Fulcrum/Math/Bounds.h>
#include <Fulcrum/Math/Hash.h>
#include <Fulcrum/Math/Pose.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace fulcrum {

// What arrays of a snapshot hold: deltas compare it with the same block of the same section of another snapshot.
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
    UserData,  // the last; no part of the state, as far as HashState is concerned
};

// One for each block, behind the data.
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
    uint64_t checksum;       // of the rows above and the table of blocks
};
static_assert(std::has_unique_object_representations_v<SnapshotHeader>);

// What has no padding and owns nothing.
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

class SnapshotWriter {
public:
    static constexpr bool kWrites = true;

    // Writes to `bytes`, from its beginning, which grow as needed; or, with keeps = false, only hashes, and uses them
    // as room.
    SnapshotWriter(std::vector<std::byte>& bytes, std::vector<SnapshotBlock>& blocks, bool keeps)
        : bytes_(bytes), blocks_(blocks), keeps_(keeps), size_(keeps ? sizeof(SnapshotHeader) : 0) {
        blocks_.clear();
    }

    // Before numbers are written: at most so many bytes follow until the next Reserve.
    void Reserve(size_t bytes) {
        if (size_ + bytes > bytes_.size()) bytes_.resize(size_ + bytes);
    }
    template <class... T>
    void operator()(const T&... values) {
        (WriteOne(values), ...);
    }
    // Numbers of any number, after a Reserve of their own.
    template <class T>
    void List(const std::vector<T>& values) {
        static_assert(IsPlain<T>::value);
        Reserve(sizeof(uint32_t) + values.size() * sizeof(T));
        WriteOne(static_cast<uint32_t>(values.size()));
        Raw(values.data(), values.size() * sizeof(T));
    }
    void Raw(const void* from, size_t size) {
        FULCRUM_ASSERT(size_ + size <= bytes_.size());
        if (size > 0) std::memcpy(bytes_.data() + size_, from, size);
        size_ += size;
    }
    void Begin(SnapshotSection section) { key_ = static_cast<uint32_t>(section) << 24; }
    // Ends a block of the section, if there is anything in it.
    void EndBlock() {
        if (size_ == BlockStart()) return;
        blocks_.push_back({static_cast<uint32_t>(size_ - BlockStart()), key_++});
        hash_ = HashWord(hash_, HashBytes(bytes_.data() + BlockStart(), size_ - BlockStart()));
        if (keeps_) blockStart_ = size_;
        else size_ = 0;
    }

    uint64_t Hash() const { return hash_; }  // of the blocks so far
    size_t Size() const { return size_; }

private:
    template <class T>
    void WriteOne(const T& value) {
        static_assert(IsPlain<T>::value);
        Raw(&value, sizeof value);
    }
    size_t BlockStart() const { return keeps_ ? blockStart_ : 0; }

    std::vector<std::byte>& bytes_;
    std::vector<SnapshotBlock>& blocks_;
    bool keeps_;
    size_t size_, blockStart_ = sizeof(SnapshotHeader);
    uint64_t hash_ = kHashSeed;
    uint32_t key_ = 0;
};

// Of data whose hash is right; still it never reads beyond them: then it gives zeros, and HasFailed is true.
class SnapshotReader {
public:
    static constexpr bool kWrites = false;

    explicit SnapshotReader(std::span<const std::byte> data) : at_(data.data()), end_(data.data() + data.size()) {}

    template <class... T>
    void operator()(T&... values) {
        (ReadOne(values), ...);
    }
    template <class T>
    T Get() {
        T value{};
        ReadOne(value);
        return value;
    }
    template <class T>
    void List(std::vector<T>& values) {
        static_assert(IsPlain<T>::value);
        const size_t count = Get<uint32_t>();
        values.resize(Has(count * sizeof(T)) ? count : 0);
        Raw(values.data(), values.size() * sizeof(T));
    }
    void Raw(void* to, size_t size) {
        if (!Has(size)) {
            std::memset(to, 0, size);
            return;
        }
        if (size > 0) std::memcpy(to, at_, size);
        at_ += size;
    }
    std::span<const std::byte> Bytes(size_t size) {
        if (!Has(size)) return {};
        at_ += size;
        return {at_ - size, size};
    }
    void Reserve(size_t) {}
    void Begin(SnapshotSection) {}
    void EndBlock() {}
    bool HasFailed() const { return hasFailed_; }
    bool IsAtEnd() const { return at_ == end_; }

private:
    template <class T>
    void ReadOne(T& value) {
        static_assert(IsPlain<T>::value);
        Raw(&value, sizeof value);
    }
    bool Has(size_t size) {
        if (size > static_cast<size_t>(end_ - at_)) [[unlikely]] {
            hasFailed_ = true;
            at_ = end_;
        }
        return !hasFailed_;
    }

    const std::byte* at_;
    const std::byte* end_;
    bool hasFailed_ = false;
};

// Elements of an array end a block after so many: what does not change stays a block of its own in deltas.
inline constexpr uint32_t kElementsPerBlock = 64;
template <class Stream>
void EndElement(Stream& stream, uint32_t index) {
    if (index % kElementsPerBlock == kElementsPerBlock - 1) stream.EndBlock();
}

}  // namespace fulcrum
