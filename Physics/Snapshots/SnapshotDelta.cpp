// Deltas compare a snapshot's blocks with those of the base. Equal blocks are only counted. For others the XOR with the
// base's block of the same key is written in words of eight bytes: a mask of the non-zero bytes followed by these, or a
// zero followed by the number of zero words. A new block is compared with zeros.
#include <Fulcrum/Physics/Files/ErrorBoundary.h>
#include <Fulcrum/Physics/Snapshots/Snapshots.h>

#include <algorithm>
#include <bit>

namespace fulcrum {

namespace {

constexpr uint64_t kDeltaMagic = 0x41544C45444C5546;  // "FULDELTA"

struct DeltaHeader {
    uint64_t magic, format;
    uint64_t base;            // checksum of the base snapshot
    SnapshotHeader snapshot;  // header of the resulting snapshot
    uint64_t checksum;        // of the following data and the members above
};
static_assert(std::has_unique_object_representations_v<DeltaHeader>);

uint64_t ChecksumOf(const DeltaHeader& header, std::span<const std::byte> rest) {
    return HashBytes(rest.data(), rest.size(), HashBytes(&header, sizeof header - sizeof header.checksum));
}

// The blocks of a snapshot, one after the other.
class Blocks {
public:
    explicit Blocks(const SnapshotParts& parts) : parts_(parts) {}

    bool IsAtEnd() const { return next_ == parts_.header.blocks; }
    uint32_t Key() const { return parts_.BlockAt(next_).key; }
    std::span<const std::byte> Bytes() const { return parts_.data.subspan(at_, parts_.BlockAt(next_).size); }
    void Advance() { at_ += parts_.BlockAt(next_++).size; }
    // The bytes of the block with a key; empty if there is none. Keys must ascend from call to call.
    std::span<const std::byte> BytesOf(uint32_t key) {
        while (!IsAtEnd() && Key() < key) Advance();
        return !IsAtEnd() && Key() == key ? Bytes() : std::span<const std::byte>();
    }

private:
    const SnapshotParts& parts_;
    size_t next_ = 0, at_ = 0;
};

// The word at an offset, padded with zeros beyond the end.
uint64_t WordAt(std::span<const std::byte> bytes, size_t at) {
    uint64_t word = 0;
    if (at < bytes.size()) std::memcpy(&word, bytes.data() + at, std::min<size_t>(8, bytes.size() - at));
    return word;
}

class DeltaWriter {
public:
    explicit DeltaWriter(std::vector<std::byte>& bytes) : bytes_(bytes) { bytes_.resize(sizeof(DeltaHeader)); }

    // Variable-length integer: seven bits per byte, the lowest first.
    void Number(uint64_t number) {
        for (; number >= 0x80; number >>= 7) bytes_.push_back(static_cast<std::byte>(number | 0x80));
        bytes_.push_back(static_cast<std::byte>(number));
    }
    void Block(std::span<const std::byte> from, std::span<const std::byte> to) {
        for (size_t at = 0; at < to.size();) {
            size_t same = at;
            while (same < to.size() && Change(from, to, same) == 0) same += 8;
            if (same > at) {
                bytes_.push_back(std::byte{0});
                Number((same - at) / 8);
                at = same;
                continue;
            }
            Word(Change(from, to, at));
            at += 8;
        }
    }

private:
    // The last word is cut to the block's size.
    static uint64_t Change(std::span<const std::byte> from, std::span<const std::byte> to, size_t at) {
        return WordAt(from.first(std::min(from.size(), to.size())), at) ^ WordAt(to, at);
    }
    void Word(uint64_t change) {
        std::byte room[9];
        size_t count = 1;
        unsigned mask = 0;
        for (unsigned i = 0; i < 8; ++i) {
            const auto byte = static_cast<std::byte>(change >> 8 * i);
            if (byte == std::byte{0}) continue;
            mask |= 1u << i;
            room[count++] = byte;
        }
        room[0] = static_cast<std::byte>(mask);
        bytes_.insert(bytes_.end(), room, room + count);
    }

    std::vector<std::byte>& bytes_;
};

class DeltaReader {
public:
    explicit DeltaReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    bool HasFailed() const { return hasFailed_; }
    bool IsAtEnd() const { return bytes_.empty(); }
    uint64_t Number() {
        uint64_t number = 0;
        for (unsigned shift = 0; shift < 64; shift += 7) {
            const auto byte = static_cast<uint64_t>(Byte());
            number |= (byte & 0x7F) << shift;
            if (byte < 0x80) break;
        }
        return number;
    }
    // Applies the changes to `to`, which contains the base's block.
    void Block(std::span<std::byte> to) {
        for (size_t at = 0; at < to.size() && !hasFailed_;) {
            const auto mask = static_cast<unsigned>(Byte());
            if (mask == 0) {
                const uint64_t words = Number();
                if (words == 0 || words > (to.size() - at + 7) / 8) hasFailed_ = true;
                at += 8 * words;
                continue;
            }
            for (unsigned i = 0; i < 8; ++i) {
                if (!(mask >> i & 1)) continue;
                if (at + i >= to.size()) hasFailed_ = true;
                else to[at + i] ^= Byte();
            }
            at += 8;
        }
    }

private:
    std::byte Byte() {
        if (bytes_.empty()) {
            hasFailed_ = true;
            return std::byte{0};
        }
        const std::byte byte = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return byte;
    }

    std::span<const std::byte> bytes_;
    bool hasFailed_ = false;
};

bool AreSame(std::span<const std::byte> a, std::span<const std::byte> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size()) == 0);
}

Error Damaged(const char* what) { return {ErrorCode::Degenerate, std::string("damaged delta: ") + what}; }

void Append(std::vector<std::byte>& bytes, const void* from, size_t size) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + size);
}

// Writes the snapshot's data and its table of blocks, after space for its header.
MaybeError ApplyBlocks(const SnapshotParts& base, const SnapshotHeader& header, DeltaReader& in,
                       std::vector<std::byte>& snapshot) {
    Blocks from(base);
    std::vector<SnapshotBlock> table;
    const auto add = [&](std::span<const std::byte> bytes, uint32_t key) {
        Append(snapshot, bytes.data(), bytes.size());
        table.push_back({static_cast<uint32_t>(bytes.size()), key});
    };
    while (table.size() < header.blocks) {
        for (uint64_t same = in.Number(); same > 0; --same) {
            if (from.IsAtEnd() || table.size() == header.blocks) return Damaged("it has too many blocks");
            add(from.Bytes(), from.Key());
            from.Advance();
        }
        if (table.size() == header.blocks) break;
        const auto key = static_cast<uint32_t>(in.Number());
        const uint64_t size = in.Number();
        if (in.HasFailed() || size > header.dataSize) return Damaged("it breaks off");
        const std::span<const std::byte> old = from.BytesOf(key);
        const size_t start = snapshot.size();
        add(old.first(std::min<size_t>(old.size(), size)), key);
        if (!from.IsAtEnd() && from.Key() == key) from.Advance();
        table.back().size = static_cast<uint32_t>(size);
        snapshot.resize(start + size, std::byte{0});
        in.Block(std::span(snapshot).subspan(start));
        if (in.HasFailed()) return Damaged("it breaks off");
    }
    if (in.HasFailed() || !in.IsAtEnd()) return Damaged("it is longer or shorter than what it makes");
    Append(snapshot, table.data(), table.size() * sizeof(SnapshotBlock));
    return std::nullopt;
}

}  // namespace

Status MakeSnapshotDelta(std::span<const std::byte> base, std::span<const std::byte> snapshot,
                         std::vector<std::byte>& delta) {
    const Result<SnapshotParts> before = CheckSnapshot(base), after = CheckSnapshot(snapshot);
    if (!before) return before.GetError();
    if (!after) return after.GetError();
    DeltaWriter out(delta);
    Blocks from(before.Value()), to(after.Value());
    for (uint64_t same = 0;; to.Advance()) {
        if (to.IsAtEnd()) {
            if (same > 0) out.Number(same);
            break;
        }
        if (!from.IsAtEnd() && from.Key() == to.Key() && AreSame(from.Bytes(), to.Bytes())) {
            ++same;
            from.Advance();
            continue;
        }
        out.Number(std::exchange(same, 0));
        out.Number(to.Key());
        out.Number(to.Bytes().size());
        out.Block(from.BytesOf(to.Key()), to.Bytes());
        if (!from.IsAtEnd() && from.Key() == to.Key()) from.Advance();
    }
    DeltaHeader header{kDeltaMagic, SnapshotFormat(), before.Value().header.checksum, after.Value().header, 0};
    header.checksum = ChecksumOf(header, std::span<const std::byte>(delta).subspan(sizeof header));
    std::memcpy(delta.data(), &header, sizeof header);
    return Done{};
}

Status ApplySnapshotDelta(std::span<const std::byte> base, std::span<const std::byte> delta,
                          std::vector<std::byte>& snapshot) {
    snapshot.clear();
    const Result<SnapshotParts> before = CheckSnapshot(base);
    if (!before) return before.GetError();
    DeltaHeader header{};
    if (!delta.empty()) std::memcpy(&header, delta.data(), std::min(delta.size(), sizeof header));
    if (header.magic != kDeltaMagic) return Error{ErrorCode::Unsupported, "this is no delta of snapshots"};
    if (header.format != SnapshotFormat())
        return Error{ErrorCode::Unsupported, "the delta is of another version or build of the library"};
    if (delta.size() < sizeof header || header.checksum != ChecksumOf(header, delta.subspan(sizeof header)))
        return Damaged("its checksum is wrong");
    if (header.base != before.Value().header.checksum)
        return Error{ErrorCode::Degenerate, "the delta starts from another snapshot than this base"};
    Append(snapshot, &header.snapshot, sizeof header.snapshot);
    DeltaReader in(delta.subspan(sizeof header));
    // A few bytes may say that very many follow.
    const Status applied = WithErrors("the delta", [&]() -> Status {
        if (MaybeError e = ApplyBlocks(before.Value(), header.snapshot, in, snapshot)) return *e;
        return Done{};
    });
    MaybeError error = applied ? MaybeError() : applied.GetError();
    if (!error)
        if (const Result<SnapshotParts> whole = CheckSnapshot(snapshot); !whole) error = whole.GetError();
    if (!error) return Done{};
    snapshot.clear();
    return *error;
}

}  // namespace fulcrum
