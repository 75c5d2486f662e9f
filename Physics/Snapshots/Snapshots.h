// Writes, checks and restores snapshots for PhysicsSystem. Called under the world's lock; one thread.
#pragma once

#include <Fulcrum/Physics/Snapshot.h>
#include <Fulcrum/Physics/Snapshots/SnapshotStream.h>
#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// Group filters of bodies in the order of their first use.
struct NumberedFilters {
    Array<const GroupFilter*> filters;
    Array<uint32_t> bodies;                        // for each body with a filter: its index, then the filter's number
    uint32_t NumberOf(const GroupFilter* filter);  // not null
};

// Temporary lists of a snapshot, which keep their memory.
struct SnapshotRoom {
    FULCRUM_WORLD_MEMORY

    Array<SnapshotBlock> blocks;
    Array<std::byte> block;  // for HashOfState
    Array<std::byte> settings;
    Array<uint32_t> changed;
    NumberedFilters filters;
    SavedEfforts efforts;
};
size_t HeapBytes(const SnapshotRoom& room);

// Magic numbers of snapshots of the whole state, and of some bodies.
inline constexpr uint64_t kSnapshotMagic = 0x50414E534C554675,
                          kPartMagic = 0x54524150'4C554675;  // "uFULSNAP", "uFULPART"
// Identifies the layout of a build's snapshots, which depends neither on threads nor on lanes.
uint64_t SnapshotFormat();

// Error: Unsupported (children of a custom shape in a mutable compound). `bytes` are empty then.
Status WriteSnapshot(const WorldState& world, const StepState& step, SnapshotRoom& room, std::vector<std::byte>& bytes);
uint64_t HashOfState(const WorldState& world, const StepState& step, SnapshotRoom& room);

// The parts of a valid snapshot.
struct SnapshotParts {
    SnapshotHeader header;
    std::span<const std::byte> data, table;

    SnapshotBlock BlockAt(size_t i) const {
        SnapshotBlock block;
        std::memcpy(&block, table.data() + i * sizeof block, sizeof block);
        return block;
    }
};
// Errors: Unsupported (not a snapshot, or of another build), Degenerate (damaged).
Result<SnapshotParts> CheckSnapshot(std::span<const std::byte> bytes, uint64_t magic = kSnapshotMagic);
// Completes a snapshot: writes its header and its table of blocks. stateHash: see SnapshotHeader.
void FinishSnapshot(uint64_t magic, uint64_t stateHash, const SnapshotWriter& writer,
                    std::span<const SnapshotBlock> blocks, std::vector<std::byte>& bytes);

// Errors: those of CheckSnapshot; UnknownId (a shape, a group filter or a joint type is unknown), Unsupported (only one
// of the world and the snapshot has a contact listener). The world is unchanged then. A broken world is whole again
// afterwards. change: begins when the world begins to be written.
Status ReadSnapshot(std::span<const std::byte> bytes, const SnapshotSources& sources, SnapshotRoom& room,
                    WorldState& world, StepState& step, const WorldLock::Exclusive& change);

// Writes the data shown by the type's VisitSettings to the list, replacing its contents.
void ReadSettings(JointType& type, Array<std::byte>& settings);
// Hash of its Kind().
uint64_t KindHash(const JointType& type);

}  // namespace fulcrum
