// The format of recordings of calls. "FULCCALL", the version of the format (4 bytes, in the byte order of the machine),
// then pieces, each with its size, a hash of the size and a hash of the data (8 bytes each), so that an end that is
// missing and damage are told apart. Their data in sequence are entries: a byte for the kind, 8 for the size, the data.
// Used by Recording/.
#pragma once

#include <Fulcrum/Math/Hash.h>
#include <Fulcrum/Physics/PhysicsSystem.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fulcrum {

inline constexpr std::array<char, 8> kRecordingMagic = {'F', 'U', 'L', 'C', 'C', 'A', 'L', 'L'};
inline constexpr uint32_t kRecordingVersion = 1;

inline Error DamagedRecording(const std::string& what) {
    return {ErrorCode::Degenerate, "the recording is damaged: " + what};
}

struct RecordingPiece {
    uint64_t size, sizeHash, dataHash;
};
inline uint64_t HashOfSize(uint64_t size) { return HashWord(kHashSeed, size); }

enum class EntryKind : uint8_t {
    Functions,  // first: the names of the functions, in the order of their numbers, and the layouts of their arguments
    Shape,      // hash of its content, then the bytes of SaveShape, or nothing if they cannot be saved
    Filter,     // hash of its content, whether it is a GroupFilterTable, and its pairs
    Settings,   // of a new world; or
    Snapshot,   // of one that is not new
    Call,       // number of the function, then its arguments
    Created,    // what the last call created: CreatedIds
    Bodies,     // hashes of the bodies that changed since the last such entry: index, hash
    Step,       // after a step: hash of the state
    End,        // of a recording that was not interrupted
};

struct BodyHash {
    uint32_t body = 0;  // index
    uint32_t hash = 0;  // of pose, velocities, whether it is awake; 0: none
    friend bool operator==(const BodyHash&, const BodyHash&) = default;
};

// The hashes of all bodies by index, and which have changed since the last update.
class BodyHashes {
public:
    // The bodies that changed.
    const std::vector<BodyHash>& Update(const PhysicsSystem& system);
    const std::vector<uint32_t>& All() const { return hashes_; }

private:
    std::vector<uint32_t> hashes_, next_;
    std::vector<BodyHash> changed_;
};

}  // namespace fulcrum
