#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Physics/Snapshots/SnapshotAccess.h>
#include <Fulcrum/Physics/Snapshots/Snapshots.h>

#include <algorithm>
#include <cstring>

namespace fulcrum {

uint32_t NumberedFilters::NumberOf(const GroupFilter* filter) {
    // Consecutive bodies, such as the limbs of a ragdoll, mostly share one.
    const auto found = std::find(filters.rbegin(), filters.rend(), filter);
    if (found != filters.rend()) return static_cast<uint32_t>(filters.rend() - found) - 1;
    filters.push_back(filter);
    return static_cast<uint32_t>(filters.size()) - 1;
}

size_t HeapBytes(const SnapshotRoom& room) {
    const auto& [blocks, block, settings, changed, filters, efforts] = room;
    return HeapBytes(blocks, block, settings, changed, filters.filters, filters.bodies, efforts);
}

void ReadSettings(JointType& type, Array<std::byte>& settings) {
    settings.clear();
    type.VisitSettings(SettingVisitor(
        [](void* to, void* bytes, size_t size) {
            auto& list = *static_cast<Array<std::byte>*>(to);
            list.resize(list.size() + size);
            std::memcpy(list.data() + list.size() - size, bytes, size);
        },
        &settings, false));
}

uint64_t KindHash(const JointType& type) { return HashBytes(type.Kind(), std::strlen(type.Kind())); }

SnapshotHead SnapshotAccess::HeadOf(const WorldState& world, const StepState& step) {
    const auto count = [](const auto& list) { return static_cast<uint32_t>(list.size()); };
    return {world.settings,
            world.step,
            step.lastSubstepDt,
            step.stiffnessDt,
            count(world.bodies.cold),
            count(world.colliders.colliders),
            count(world.pairs.pairs),
            count(world.joints.joints),
            world.pairs.keepsListenersData_};
}

namespace {

// Shapes are written as hashes, edited compounds in full.
MaybeError WriteShapes(SnapshotWriter& s, const BodyStore& bodies, bool keeps) {
    s.Begin(SnapshotSection::Shapes);
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        s.Reserve(sizeof(uint64_t));
        const BodyCold& body = bodies.cold[i];
        s(!body.shape ? kNoShape : body.children ? kOwnCompound : ContentHash(*body.shape));
        EndElement(s, i);
    }
    s.EndBlock();
    s.Begin(SnapshotSection::Compounds);
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        if (!bodies.cold[i].children) continue;
        const Result<std::vector<uint8_t>> shape = SaveShape(*bodies.cold[i].shape);
        if (!shape && keeps) return shape.GetError();
        s.Reserve(2 * sizeof(uint64_t));
        if (shape) s.List(shape.Value());
        else s(ContentHash(*bodies.cold[i].shape));
        s.EndBlock();
    }
    return std::nullopt;
}

// Filters are written as hashes, followed by the bodies that use them.
void WriteFilters(SnapshotWriter& s, const BodyStore& bodies, NumberedFilters& numbered) {
    auto& [filters, bodiesOf] = numbered;
    filters.clear();
    bodiesOf.clear();
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        if (!bodies.cold[i].filter || !bodies.cold[i].filter->group.filter) continue;
        bodiesOf.push_back(i);
        bodiesOf.push_back(numbered.NumberOf(bodies.cold[i].filter->group.filter.get()));
    }
    s.Begin(SnapshotSection::GroupFilters);
    VisitList(s, filters, sizeof(uint64_t), [&](const GroupFilter* filter) { s(filter->ContentHash()); });
    s.List(bodiesOf);
    s.EndBlock();
}

void WriteJointTypes(SnapshotWriter& s, const JointStore& joints, Array<std::byte>& settings) {
    s.Begin(SnapshotSection::JointTypes);
    for (uint32_t i = 0; i < joints.joints.size(); ++i) {
        const Joint& joint = joints.joints[i];
        s.Reserve(2 * sizeof(uint64_t));
        s(joint.exists, joint.generation);
        if (joint.exists) {
            ReadSettings(*joint.type, settings);
            s(KindHash(*joint.type));
            s.List(settings);
        }
        EndElement(s, i);
    }
    s.EndBlock();
}

// See SnapshotAccess::VisitPairs.
struct NothingAttached {
    void OfPair(uint32_t, const SnapshotAccess::PairPlace&) const {}
    void OfContact(const Pair&, const ColorSlot&) const {}
};

// All sections that are part of the state.
MaybeError WriteState(SnapshotWriter& s, const WorldState& world, const StepState& step, SnapshotRoom& room,
                      bool keeps) {
    SnapshotHead head = SnapshotAccess::HeadOf(world, step);
    SnapshotAccess::VisitHead(s, head);
    if (MaybeError error = WriteShapes(s, world.bodies, keeps)) return error;
    WriteFilters(s, world.bodies, room.filters);
    WriteJointTypes(s, world.joints, room.settings);
    SnapshotAccess::VisitBodies(s, world.bodies);
    SnapshotAccess::VisitColliders(s, world.colliders);
    SnapshotAccess::VisitPairs(s, world.pairs, NothingAttached());
    SnapshotAccess::VisitJoints(s, world.joints);
    SnapshotAccess::VisitSleeping(s, world.sleeping);
    room.changed = world.sensors.changed;
    std::ranges::sort(room.changed);
    room.changed.erase(std::unique(room.changed.begin(), room.changed.end()), room.changed.end());
    SnapshotAccess::VisitSensors(s, world.sensors, room.changed);
    DescribeEfforts(step.solver, world.coloring, world.pairs, step.savedEfforts, room.efforts);
    SnapshotAccess::VisitStep(s, world, step, room.efforts);
    return std::nullopt;
}

}  // namespace

Status WriteSnapshot(const WorldState& world, const StepState& step, SnapshotRoom& room,
                     std::vector<std::byte>& bytes) {
    SnapshotWriter s(bytes, room.blocks, true);
    if (MaybeError error = WriteState(s, world, step, room, true)) {
        bytes.clear();
        return *error;
    }
    const uint64_t stateHash = s.Hash();
    SnapshotAccess::VisitUserData(s, world);
    FinishSnapshot(kSnapshotMagic, stateHash, s, room.blocks, bytes);
    return Done{};
}

void FinishSnapshot(uint64_t magic, uint64_t stateHash, const SnapshotWriter& writer,
                    std::span<const SnapshotBlock> blocks, std::vector<std::byte>& bytes) {
    SnapshotHeader header{
        magic, SnapshotFormat(), writer.Size() - sizeof header, stateHash, writer.Hash(), blocks.size(), 0};
    header.checksum =
        HashBytes(blocks.data(), blocks.size_bytes(), HashBytes(&header, sizeof header - sizeof header.checksum));
    bytes.resize(writer.Size() + blocks.size_bytes());
    std::memcpy(bytes.data(), &header, sizeof header);
    if (!blocks.empty())
        std::memcpy(bytes.data() + sizeof header + header.dataSize, blocks.data(), blocks.size_bytes());
}

uint64_t HashOfState(const WorldState& world, const StepState& step, SnapshotRoom& room) {
    SnapshotWriter s(room.block, room.blocks, false);
    WriteState(s, world, step, room, false);
    return s.Hash();
}

}  // namespace fulcrum
