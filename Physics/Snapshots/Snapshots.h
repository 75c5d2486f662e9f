// Snapshots as PhysicsSystem offers them: written, checked, restored. Called under the world's lock; one thread.
#pragma once

#include <Fulcrum/Physics/Snapshot.h>
#include <Fulcrum/Physics/Snapshots/SnapshotStream.h>
#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// Group filters of bodies in the order in which bodies first name them.
struct NumberedFilters {
    std::vector<const GroupFilter*> filters;
    std::vector<uint32_t> bodies;                  // of each with a filter its index, and the filter's number
    uint32_t NumberOf(const GroupFilter* filter);  // not null
};

// Lists that are made anew by each snapshot, and keep their memory.
struct SnapshotRoom {
    std::vector<SnapshotBlock> blocks;
    std::vector<std::byte> block;  // of HashOfState
    std::vector<std::byte> settings;
    std::vector<uint32_t> changed;
    NumberedFilters filters;
    SavedEfforts efforts;
};
size_t HeapBytes(const SnapshotRoom& room);

// How a snapshot begins: one of the whole state, and one of some bodies.
inline constexpr uint64_t kSnapshotMagic = 0x50414E534C554675,
                          kPartMagic = 0x54524150'4C554675;  // "uFULSNAP", "uFULPART"
// Which build wrote a snapshot: its layout, not the machine's threads and lanes.
uint64_t SnapshotFormat();

// Error: Unsupported (children of a custom shape in a mutable compound). `bytes` are empty then.
Status WriteSnapshot(const WorldState& world, const StepState& step, SnapshotRoom& room, std::vector<std::byte>& bytes);
uint64_t HashOfState(const WorldState& world, const StepState& step, SnapshotRoom& room);

// The parts of a snapshot that is whole.
struct SnapshotParts {
    SnapshotHeader header;
    std::span<const std::byte> data, table;

    SnapshotBlock BlockAt(size_t i) const {
        SnapshotBlock block;
        std::memcpy(&block, table.data() + i * sizeof block, sizeof block);
        return block;
    }
};
// Errors: Unsupported (no snapshot, or of another build), Degenerate (damaged).
Result<SnapshotParts> CheckSnapshot(std::span<const std::byte> bytes, uint64_t magic = kSnapshotMagic);
// Completes what was written: its header, and its table of blocks. stateHash: see SnapshotHeader.
void FinishSnapshot(uint64_t magic, uint64_t stateHash, const SnapshotWriter& writer,
                    std::span<const SnapshotBlock> blocks, std::vector<std::byte>& bytes);

// Errors: those of CheckSnapshot; UnknownId (a shape, a group filter or a type of joint is not known), Unsupported (the
// world has a contact listener and the snapshot's had none, or the other way round). The world is as it was then.
Status ReadSnapshot(std::span<const std::byte> bytes, const SnapshotSources& sources, SnapshotRoom& room,
                    WorldState& world, StepState& step);

// What the type's VisitSettings shows, in place of what the list had.
void ReadSettings(JointType& type, std::vector<std::byte>& settings);
// Of its Kind().
uint64_t KindHash(const JointType& type);

}  // namespace fulcrum
