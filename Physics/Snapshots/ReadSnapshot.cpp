// A snapshot is restored in two passes. The first finds, or makes, all that may be missing, and leaves the world as it
// is; the second writes over it, and can fail only where memory for what is larger than before runs out.
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/Physics/Snapshots/SnapshotAccess.h>
#include <Fulcrum/Physics/Snapshots/Snapshots.h>
#include <Fulcrum/Physics/World/Colors.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace fulcrum {

inline void SnapshotAccess::ListColor(ConstraintColoring& coloring, ConstraintColoring::Kind kind,
                                      const ConstraintColoring::Entry& entry, const ColorSlot& place) {
    if (place.color == ColorSlot{}.color) return;
    Array<ConstraintColoring::Entry>& list = coloring.List(place.color, kind);
    if (place.slot >= list.size()) list.resize(place.slot + 1);
    list[place.slot] = entry;
    ++coloring.size_;
    ConstraintColoring::VisitMoving(entry, [&](uint32_t body) {
        if (place.color == ConstraintColoring::kOverflow) ++coloring.overflows_[body];
        else coloring.used_[body] |= uint64_t(1) << place.color;
    });
}

inline void SnapshotAccess::AttachPair(const ColliderStore& colliders, bool areBodiesSame, PairStore& store,
                                       uint32_t index, const PairPlace& before) {
    // Few pairs differ from the previous ones.
    Pair& pair = store.pairs[index];
    const PairPlace place = PlaceOf(pair);
    if (place != before) {
        if (before.isInTable) store.RemoveKey(before.Key(), index);
        if (place.isInTable) store.AddKey(place.Key(), index);
    }
    if (!pair.exists) return;
    if (!areBodiesSame || place != before || !place.isInTable) {
        pair.bodyA = colliders.colliders[pair.colliderA].body;
        pair.bodyB = colliders.colliders[pair.colliderB].body;
    }
    FULCRUM_ASSERT(pair.bodyA == colliders.colliders[pair.colliderA].body &&
                   pair.bodyB == colliders.colliders[pair.colliderB].body);
}

namespace {

Error Missing(const char* what, uint64_t hash, const char* remedy) {
    char text[40];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return {ErrorCode::UnknownId, std::string("the snapshot names ") + what + " (hash " + text + ") that " + remedy};
}

// Results of the first pass.
struct Found {
    SnapshotHead head;
    // Of bodies that do not keep their current ones.
    template <class T>
    struct Of {
        uint32_t body;
        T is;
    };
    Array<Of<ShapePtr>> shapes;
    Array<Of<std::shared_ptr<MutableCompound>>> compounds;
    Array<std::shared_ptr<const GroupFilter>> filters;  // by number
    Array<uint32_t> filtered;                 // for each body with a filter: its index, then the filter's number
    Array<bool> hasJoint;                     // by joint
    Array<std::unique_ptr<JointType>> types;  // by joint; null: keeps its current one
};

// ---- Shapes

// Known shapes by their hashes; collected when the first lookup needs them.
class KnownShapes {
public:
    KnownShapes(const BodyStore& bodies, std::span<const ShapePtr> given) : bodies_(bodies), given_(given) {}

    ShapePtr Find(uint64_t hash) {
        if (shapes_.empty()) Gather();
        const auto found = std::ranges::lower_bound(shapes_, hash, {}, &Entry::first);
        return found != shapes_.end() && found->first == hash ? found->second : nullptr;
    }

private:
    using Entry = std::pair<uint64_t, ShapePtr>;

    void Gather() {
        const auto add = [&](const ShapePtr& shape) {
            if (shape && shape->Type() != ShapeType::MutableCompound) shapes_.emplace_back(ContentHash(*shape), shape);
        };
        for (const BodyCold& body : bodies_.cold) add(body.shape);
        for (const ShapePtr& shape : given_) add(shape);
        add(EmptyShape::Create());                      // that of the world body
        std::ranges::sort(shapes_, {}, &Entry::first);  // equal ones are as good as each other
    }

    const BodyStore& bodies_;
    std::span<const ShapePtr> given_;
    Array<Entry> shapes_;
};

Status FindShapes(SnapshotReader& s, const BodyStore& bodies, std::span<const ShapePtr> given, Found& found) {
    const uint32_t count = found.head.bodies;
    KnownShapes known(bodies, given);
    Array<uint32_t> ownCompounds;
    for (uint32_t i = 0; i < count; ++i) {
        const uint64_t hash = s.Get<uint64_t>();
        if (hash == kOwnCompound) ownCompounds.push_back(i);
        if (hash == kNoShape || hash == kOwnCompound) continue;
        const BodyCold* now = i < bodies.Size() ? &bodies.cold[i] : nullptr;
        if (now && now->shape && !now->children && ContentHash(*now->shape) == hash) continue;
        ShapePtr shape = known.Find(hash);
        if (!shape)
            return Missing("a shape", hash,
                           "no body of the world has, since it is gone or was edited; give it in "
                           "SnapshotSources::shapes");
        found.shapes.push_back({i, std::move(shape)});
    }
    Array<uint8_t> bytes;
    for (const uint32_t i : ownCompounds) {
        s.List(bytes);
        if (i < bodies.Size() && bodies.cold[i].children) {
            const Result<std::vector<uint8_t>> now = SaveShape(*bodies.cold[i].shape);
            if (now && std::ranges::equal(now.Value(), bytes)) continue;
        }
        const Result<ShapePtr> shape = LoadShape(bytes);
        if (!shape) return shape.GetError();
        if (shape.Value()->Type() != ShapeType::MutableCompound)
            return Error{ErrorCode::Degenerate, "damaged snapshot: a shape is no compound that can be edited"};
        found.compounds.push_back({i, static_cast<const MutableCompound&>(*shape.Value()).Copy()});
    }
    return Done{};
}

// ---- Group filters

// Several filter objects may have the same content; each filter of the snapshot maps to a different object. Candidates
// are first the body's own, then those of other bodies, then the given ones.
Status FindFilters(SnapshotReader& s, const BodyStore& bodies,
                   std::span<const std::shared_ptr<const GroupFilter>> given, Found& found) {
    Array<uint64_t> hashes(s.Get<uint32_t>());
    for (uint64_t& hash : hashes) s(hash);
    s.List(found.filtered);
    found.filters.resize(hashes.size());
    if (hashes.empty()) return Done{};
    const auto tryTo = [&](size_t number, const std::shared_ptr<const GroupFilter>& filter) {
        if (!filter || found.filters[number] || filter->ContentHash() != hashes[number]) return;
        if (std::ranges::find(found.filters, filter) == found.filters.end()) found.filters[number] = filter;
    };
    for (size_t i = 0; i + 1 < found.filtered.size(); i += 2) {
        const uint32_t body = found.filtered[i];
        if (body < bodies.Size() && bodies.cold[body].filter && found.filtered[i + 1] < hashes.size())
            tryTo(found.filtered[i + 1], bodies.cold[body].filter->group.filter);
    }
    for (size_t number = 0; number < hashes.size(); ++number) {
        for (uint32_t body = 0; body < bodies.Size() && !found.filters[number]; ++body)
            if (bodies.cold[body].filter) tryTo(number, bodies.cold[body].filter->group.filter);
        for (const std::shared_ptr<const GroupFilter>& filter : given) tryTo(number, filter);
        if (!found.filters[number])
            return Missing("a group filter", hashes[number],
                           "no body of the world has; give it in SnapshotSources::groupFilters");
    }
    return Done{};
}

// ---- Types of joints

// A type of one of the engine's kinds, whose settings are then overwritten; null for user-defined kinds.
std::unique_ptr<JointType> MakeOfKind(uint64_t kind) {
    std::unique_ptr<JointType> made;
    const auto tryTo = [&](const auto& settings) {
        if (made) return;
        if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(settings)>, CustomJointSettings>) {
            made = MakeType(settings);
            if (KindHash(*made) != kind) made = nullptr;
        }
    };
#define FULCRUM_TRY_KIND(kind) tryTo(kind##JointSettings{});
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_TRY_KIND)
#undef FULCRUM_TRY_KIND
    return made;
}

// Returns whether the type has as many settings as there are bytes.
bool WriteSettings(JointType& type, std::span<const std::byte> settings) {
    SnapshotReader reader(settings);
    type.VisitSettings(SettingVisitor(
        [](void* from, void* bytes, size_t size) { static_cast<SnapshotReader*>(from)->Raw(bytes, size); }, &reader,
        true));
    return !reader.HasFailed() && reader.IsAtEnd();
}

Status FindJointTypes(SnapshotReader& s, const JointStore& joints, const SnapshotSources& sources,
                      Array<std::byte>& now, Found& found) {
    const uint32_t count = found.head.joints;
    found.hasJoint.resize(count);
    found.types.resize(count);
    Array<std::byte> settings;
    for (uint32_t i = 0; i < count; ++i) {
        const bool exists = s.Get<bool>();
        const uint32_t generation = s.Get<uint32_t>();
        found.hasJoint[i] = exists;
        if (!exists) continue;
        const uint64_t kind = s.Get<uint64_t>();
        s.List(settings);
        if (i < joints.joints.size() && joints.joints[i].exists && KindHash(*joints.types[i]) == kind) {
            ReadSettings(*joints.types[i], now);
            if (now == settings) continue;
        }
        std::unique_ptr<JointType>& type = found.types[i];
        type = MakeOfKind(kind);
        if (!type && sources.makeJoint) type = sources.makeJoint({i, generation});
        if (!type || KindHash(*type) != kind || !WriteSettings(*type, settings))
            return Missing("a type of joint", kind,
                           "the world does not have there; make it in SnapshotSources::makeJoint");
    }
    return Done{};
}

// ---- The second pass

void RestoreBodies(SnapshotReader& s, Found& found, BodyStore& bodies) {
    SnapshotAccess::Resize(bodies, found.head.bodies);
    SnapshotAccess::VisitBodies(s, bodies);
    for (auto& [body, shape] : found.shapes) bodies.cold[body].shape = std::move(shape);
    for (auto& [body, compound] : found.compounds) {
        bodies.cold[body].children->compound = compound.get();
        bodies.cold[body].shape = std::move(compound);
    }
    for (size_t i = 0; i + 1 < found.filtered.size(); i += 2)
        bodies.cold[found.filtered[i]].filter->group.filter = found.filters[found.filtered[i + 1]];
    SnapshotAccess::FindAwakePlaces(bodies);
    SnapshotAccess::ListSpecial(bodies);
}

void RestoreJoints(SnapshotReader& s, Found& found, JointStore& joints, ConstraintColoring& coloring) {
    SnapshotAccess::Resize(joints, found.head.joints);
    for (uint32_t i = 0; i < joints.joints.size(); ++i) {
        Joint& joint = joints.joints[i];
        if (!found.hasJoint[i]) joint = {};
        else if (found.types[i]) joint.type = std::move(found.types[i]);
        joints.types[i] = joint.type.get();
    }
    SnapshotAccess::VisitJoints(s, joints);
    for (uint32_t i = 0; i < joints.joints.size(); ++i) {
        const Joint& joint = joints.joints[i];
        if (joint.exists)
            SnapshotAccess::ListColor(coloring, ConstraintColoring::Kind::Joint, EntryOf(joint, i), joint.color);
    }
}

// See SnapshotAccess::VisitPairs.
struct PairAttachment {
    WorldState& world;
    bool areBodiesSame;

    FULCRUM_INLINE_IN_LOOP void OfPair(uint32_t pair, const SnapshotAccess::PairPlace& before) const {
        SnapshotAccess::AttachPair(world.colliders, areBodiesSame, world.pairs, pair, before);
    }
    FULCRUM_INLINE_IN_LOOP void OfContact(const Pair& pair, const ColorSlot& color) const {
        SnapshotAccess::ListColor(world.coloring, KindOf(pair), EntryOf(pair), color);
    }
};

// State that a step keeps for the next step, and its report.
void RestoreStep(SnapshotReader& s, WorldState& world, StepState& step) {
    SavedEfforts& efforts = step.savedEfforts;
    SnapshotAccess::VisitStep(s, world, step, efforts);
    step.events.events = {};
    step.events.events.brokenJoints = step.events.broken;
    world.coloring.Invalidate();
    ++world.pairs.loadVersion;
    efforts.areRestored = true;
    efforts.version = world.coloring.Version();
    efforts.loadVersion = world.pairs.loadVersion;
    // Invalidates start poses noted for step numbers that will occur again.
    std::ranges::fill(step.sweeps.starts, SweepStore::Start{});
    std::ranges::fill(step.sensing.changedIn, uint64_t{0});
    std::ranges::fill(step.pairs.changes, PairChange::None);
    world.outsideFatBounds.MarkStale();
    world.heededShapeVersion = LatestShapeVersion();  // all shapes are as they were
}

// A broken world gets new stores in place of those that the second pass only adjusts; bodies, and types of joints, are
// whole: nothing that may break a world creates or removes any.
void DropBroken(WorldState& world, StepState& step) {
    StepState fresh;
    fresh.findings.resize(step.findings.size());
    fresh.ofWorkers.resize(step.ofWorkers.size());
    fresh.report = step.report;
    ConstraintColoring coloring;
    step = std::move(fresh);
    world.coloring = std::move(coloring);
    world.colliders = {};
    world.pairs = {};
    world.sleeping = {};
    world.sensors = {};
    world.pairs.KeepListenersData(world.listener != nullptr);
    world.outsideFatBounds.Clear();
    world.seenPoses.Hide();
}

}  // namespace

Status ReadSnapshot(std::span<const std::byte> bytes, const SnapshotSources& sources, SnapshotRoom& room,
                    WorldState& world, StepState& step, const WorldLock::Exclusive& change) {
    const Result<SnapshotParts> parts = CheckSnapshot(bytes);
    if (!parts) return parts.GetError();
    SnapshotReader s(parts.Value().data);
    Found found;
    SnapshotAccess::VisitHead(s, found.head);
    if (found.head.keepsListenersData != (world.listener != nullptr))
        return Error{ErrorCode::Unsupported,
                     world.listener ? "the world has a contact listener, and had none when the snapshot was saved"
                                    : "the world has no contact listener, and had one when the snapshot was saved"};
    if (Status shapes = FindShapes(s, world.bodies, sources.shapes, found); !shapes) return shapes;
    if (Status filters = FindFilters(s, world.bodies, sources.groupFilters, found); !filters) return filters;
    if (Status types = FindJointTypes(s, world.joints, sources, room.settings, found); !types) return types;

    change.Begin();
    if (world.lock.IsBroken()) DropBroken(world, step);
    world.settings = found.head.settings;
    KeepForEvents(world);
    world.step = found.head.step;
    step.lastSubstepDt = found.head.lastSubstepDt;
    step.stiffnessDt = found.head.stiffnessDt;
    RestoreBodies(s, found, world.bodies);
    SnapshotAccess::Resize(world.colliders, found.head.colliders);
    SnapshotAccess::VisitColliders(s, world.colliders);
    const bool areBodiesSame = SnapshotAccess::AttachPieces(world.bodies, world.colliders);
    SnapshotAccess::ListMoved(world.colliders);
    SnapshotAccess::UpdateTrees(world.bodies, world.colliders);
    SnapshotAccess::ClearColors(world.bodies.Size(), world.coloring);
    SnapshotAccess::Resize(world.pairs, found.head.pairs);
    SnapshotAccess::VisitPairs(s, world.pairs, PairAttachment{world, areBodiesSame});
    RestoreJoints(s, found, world.joints, world.coloring);
    SnapshotAccess::VisitSleeping(s, world.sleeping);
    SnapshotAccess::VisitSensors(s, world.sensors, world.sensors.changed);
    RestoreStep(s, world, step);
    SnapshotAccess::VisitUserData(s, world);
    FULCRUM_ASSERT(!s.HasFailed() && s.IsAtEnd());
    world.lock.Mend();
    return Done{};
}

}  // namespace fulcrum
