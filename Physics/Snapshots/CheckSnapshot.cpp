#include <Fulcrum/Physics/Snapshots/Snapshots.h>
#include <Fulcrum/Version.h>

#include <bit>

namespace fulcrum {

uint64_t SnapshotFormat() {
    static const uint64_t format = [] {
        uint64_t hash = kHashSeed;
        for (const uint64_t part :
             {uint64_t{2}, uint64_t{FULCRUM_VERSION}, uint64_t{std::endian::native == std::endian::little},
              uint64_t{sizeof(SystemSettings)}, uint64_t{sizeof(BodyDynamics)}, uint64_t{sizeof(BodyCold)},
              uint64_t{sizeof(Collider)}, uint64_t{sizeof(Pair)}, uint64_t{sizeof(PairContact)},
              uint64_t{sizeof(ContactRecord)}, uint64_t{sizeof(Joint)}, uint64_t{sizeof(JointRecord)},
              uint64_t{sizeof(JointType)}, uint64_t{sizeof(AxisControl)}, uint64_t{sizeof(Sensor)},
              uint64_t{sizeof(DispersingBody)}})
            hash = HashWord(hash, part);
        return hash;
    }();
    return format;
}

Result<SnapshotParts> CheckSnapshot(std::span<const std::byte> bytes, uint64_t wanted) {
    const auto damaged = [](const char* what) {
        return Error{ErrorCode::Degenerate, std::string("damaged snapshot: ") + what};
    };
    SnapshotParts parts{};
    SnapshotHeader& header = parts.header;
    uint64_t magic = 0;
    if (bytes.size() >= sizeof magic) std::memcpy(&magic, bytes.data(), sizeof magic);
    if (magic != wanted) return Error{ErrorCode::Unsupported, "this is no snapshot"};
    if (bytes.size() < sizeof header) return damaged("it breaks off");
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.format != SnapshotFormat())
        return Error{ErrorCode::Unsupported, "the snapshot is of another version or build of the library"};
    const size_t rest = bytes.size() - sizeof header;
    if (header.dataSize > rest || header.blocks != (rest - header.dataSize) / sizeof(SnapshotBlock) ||
        (rest - header.dataSize) % sizeof(SnapshotBlock) != 0)
        return damaged("its length is not what it says");
    parts.data = bytes.subspan(sizeof header, header.dataSize);
    parts.table = bytes.subspan(sizeof header + header.dataSize);
    const uint64_t checksum =
        HashBytes(parts.table.data(), parts.table.size(), HashBytes(&header, sizeof header - sizeof header.checksum));
    if (checksum != header.checksum) return damaged("the checksum of its parts is wrong");
    uint64_t stateHash = kHashSeed, dataHash = kHashSeed;
    size_t at = 0;
    for (size_t i = 0; i < header.blocks; ++i) {
        const SnapshotBlock block = parts.BlockAt(i);
        if (block.size > header.dataSize - at) return damaged("its blocks are longer than it");
        dataHash = HashWord(dataHash, HashBytes(parts.data.data() + at, block.size));
        if (block.Section() != SnapshotSection::UserData) stateHash = dataHash;
        at += block.size;
    }
    if (at != header.dataSize || dataHash != header.dataHash || stateHash != header.stateHash)
        return damaged("the checksum of its data is wrong");
    return parts;
}

}  // namespace fulcrum
