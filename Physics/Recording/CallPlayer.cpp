#include <Fulcrum/Physics/Recording/CallPlayer.h>

#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Physics/Recording/RecordingFormat.h>

#include <algorithm>
#include <string>

namespace fulcrum {

namespace {

Result<ShapePtr> ReadShape(std::span<const std::byte> data, const ReplaySources& sources) {
    uint64_t hash = 0;
    std::memcpy(&hash, data.data(), sizeof hash);
    const std::span<const std::byte> file = data.subspan(sizeof hash);
    if (!file.empty())
        return LoadShape({reinterpret_cast<const uint8_t*>(file.data()), file.size()}, sources.customShapes);
    for (const ShapePtr& shape : sources.shapes)
        if (shape && ContentHash(*shape) == hash) return shape;
    return Error{
        ErrorCode::Unsupported,
        "the recording has a custom shape, which only the program that made it can give: ReplaySources::shapes"};
}

Result<std::shared_ptr<const GroupFilter>> ReadFilter(std::span<const std::byte> data, const ReplaySources& sources) {
    const RecordedObjects none;
    CallReader reader(data, none, sources, nullptr);
    uint64_t hash = 0;
    bool isTable = false;
    std::vector<uint32_t> numbers;
    reader.Read(hash);
    reader.Read(isTable);
    reader.Read(numbers);
    if (reader.IsBad() || numbers.size() % 2 != 0) return DamagedRecording("a group filter");
    if (isTable) {
        std::vector<GroupFilterTable::Pair> pairs;
        for (size_t i = 0; i < numbers.size(); i += 2) pairs.push_back({numbers[i], numbers[i + 1]});
        const auto table = GroupFilterTable::Create(pairs);
        if (!table) return table.GetError();
        return std::shared_ptr<const GroupFilter>(table.Value());
    }
    for (const std::shared_ptr<const GroupFilter>& filter : sources.groupFilters)
        if (filter && filter->ContentHash() == hash) return filter;
    return Error{ErrorCode::Unsupported,
                 "the recording has a group filter of its program's own, which only that can "
                 "give: ReplaySources::groupFilters"};
}

// What the call of an entry created; nothing if it was refused.
CreatedIds CreatedAfter(const CallRecording& recording, size_t entry, const RecordedObjects& objects,
                        const ReplaySources& sources) {
    CreatedIds created;
    if (entry + 1 >= recording.Entries().size()) return created;
    const CallRecording::Entry& next = recording.Entries()[entry + 1];
    if (next.kind != EntryKind::Created) return created;
    CallReader reader(recording.DataOf(next), objects, sources, nullptr);
    reader.Read(created);
    return created;
}

// Whether a call may be made: if not, an error says why, unless it only names what was left out.
MaybeError CheckRead(const CallReader& reader, const char* name) {
    if (reader.IsBad() || !reader.IsAtEnd()) return DamagedRecording(std::string("the arguments of ") + name);
    if (reader.LacksListener() && !reader.NamesWhatIsMissing())
        return Error{ErrorCode::Unsupported,
                     "the recording sets a contact listener, which only the program that made it "
                     "can give: ReplaySources::contactListeners"};
    return {};
}

}  // namespace

Result<RecordedObjects> ReadObjects(const CallRecording& recording, const ReplaySources& sources) {
    RecordedObjects objects;
    for (const CallRecording::Entry& entry : recording.Entries()) {
        if (entry.kind == EntryKind::Shape) {
            const Result<ShapePtr> shape = ReadShape(recording.DataOf(entry), sources);
            if (!shape) return shape.GetError();
            objects.shapes.push_back(shape.Value());
        } else if (entry.kind == EntryKind::Filter) {
            const auto filter = ReadFilter(recording.DataOf(entry), sources);
            if (!filter) return filter.GetError();
            objects.filters.push_back(filter.Value());
        }
    }
    return objects;
}

CallPlayer::CallPlayer(const CallRecording& recording, const RecordedObjects& objects, const ReplaySources& sources,
                       bool leavesOut)
    : recording_(recording), objects_(objects), sources_(sources), leavesOut_(leavesOut) {
    if (!leavesOut) return;
    for (size_t i = 0; i < recording.Entries().size(); ++i) {
        if (recording.Entries()[i].kind != EntryKind::Call) continue;
        const CreatedIds created = CreatedAfter(recording, i, objects, sources);
        ids_.allBodies.insert(created.bodies.begin(), created.bodies.end());
        ids_.allJoints.insert(created.joints.begin(), created.joints.end());
    }
}

Status CallPlayer::Start(JobSystem* jobs) {
    const auto entries = recording_.Entries();
    const auto world = std::ranges::find_if(entries, [](const CallRecording::Entry& entry) {
        return entry.kind == EntryKind::Settings || entry.kind == EntryKind::Snapshot;
    });
    CallReader reader(recording_.DataOf(*world), objects_, sources_, nullptr);
    SystemSettings settings;
    bool hasListener = false;
    std::vector<std::byte> snapshot;
    if (world->kind == EntryKind::Settings) {
        reader.Read(settings);
    } else {
        reader.Read(hasListener);
        reader.Read(snapshot);
    }
    if (reader.IsBad()) return DamagedRecording("its world");
    auto created = PhysicsSystem::Create(settings, jobs);
    if (!created) return created.GetError();
    system_ = std::move(created.Value());
    if (world->kind == EntryKind::Settings) return Done{};
    if (hasListener) {
        if (sources_.contactListeners.empty())
            return Error{ErrorCode::Unsupported,
                         "the recording begins in a world with a contact listener: "
                         "ReplaySources::contactListeners"};
        system_->SetContactListener(sources_.contactListeners[0]);
    }
    return system_->RestoreSnapshot(
        snapshot, {.shapes = objects_.shapes, .groupFilters = objects_.filters, .makeJoint = sources_.makeJoint});
}

void CallPlayer::Note(const PlayedCall& call) {
    const auto note = [](auto& ids, const auto& recorded, const auto& created) {
        for (size_t i = 0; i < std::min(recorded.size(), created.size()); ++i) ids[recorded[i]] = created[i];
    };
    note(ids_.bodies, call.recorded.bodies, call.created.bodies);
    note(ids_.joints, call.recorded.joints, call.created.joints);
}

Result<PlayedCall> CallPlayer::Play(size_t entry) {
    const CallRecording::Entry& its = recording_.Entries()[entry];
    const CallRow& row = CallRows()[its.row];
    PlayedCall call;
    call.recorded = CreatedAfter(recording_, entry, objects_, sources_);
    CallReader reader(recording_.DataOf(its), objects_, sources_, leavesOut_ ? &ids_ : nullptr);
    const MaybeError refused = row.play(*system_, reader, call.recorded, call.created);
    if (MaybeError error = CheckRead(reader, row.name)) return *error;
    call.isLeftOut = reader.NamesWhatIsMissing();
    call.isDone = !refused && !call.isLeftOut;
    if (refused) call.error = *refused;
    if (leavesOut_ && call.isDone && row.tag == RestoreTag()) {
        // Ids are those of the recording again.
        ids_.bodies.clear();
        ids_.joints.clear();
        for (const BodyId id : ids_.allBodies) ids_.bodies[id] = id;
        for (const JointId id : ids_.allJoints) ids_.joints[id] = id;
    }
    if (leavesOut_) Note(call);
    return call;
}

Result<PlayedCall> CallPlayer::PlayPart(size_t entry, size_t part) {
    const CallRecording::Entry& its = recording_.Entries()[entry];
    PlayedCall call;
    const CreatedIds all = CreatedAfter(recording_, entry, objects_, sources_);
    CallReader reader(recording_.DataOf(its), objects_, sources_, nullptr);
    BatchSettings batch;
    reader.Read(batch);
    if (MaybeError error = CheckRead(reader, CallRows()[its.row].name)) return *error;
    const size_t joint = part - batch.bodies.size();  // if it is none of the bodies
    if (batch.bodies.size() != all.bodies.size() || batch.joints.size() != all.joints.size() ||
        (part >= batch.bodies.size() && joint >= batch.joints.size()))
        return DamagedRecording("a batch");
    GiveMakers(batch.joints, all.joints, sources_);
    const auto take = [&](const auto& created, auto& ids) {
        call.isDone = static_cast<bool>(created);
        if (created) ids = {created.Value()};
        else call.error = created.GetError();
    };
    if (part < batch.bodies.size()) {
        call.recorded.bodies = {all.bodies[part]};
        take(system_->Bodies().Create(batch.bodies[part]), call.created.bodies);
    } else {
        call.recorded.joints = {all.joints[joint]};
        JointSettings& common = CommonOf(batch.joints[joint]);
        for (BodyId* const body : {&common.bodyA, &common.bodyB}) {
            if (BodyBatch::IsBody(*body)) {
                if (BodyBatch::IndexOf(*body) >= all.bodies.size()) return DamagedRecording("a batch");
                *body = all.bodies[BodyBatch::IndexOf(*body)];
            }
            const auto now = ids_.bodies.find(*body);
            if (now != ids_.bodies.end()) *body = now->second;
            else call.isLeftOut |= ids_.allBodies.contains(*body);
        }
        if (call.isLeftOut) return call;
        std::visit([&](const auto& settings) { take(system_->Joints().Create(settings), call.created.joints); },
                   batch.joints[joint]);
    }
    Note(call);
    return call;
}

BatchSize SizeOfBatch(const CallRecording& recording, size_t entry, const RecordedObjects& objects) {
    const CallRecording::Entry& its = recording.Entries()[entry];
    if (its.kind != EntryKind::Call || CallRows()[its.row].tag != BatchTag()) return {};
    const CreatedIds created = CreatedAfter(recording, entry, objects, {});
    return {created.bodies.size(), created.joints.size()};
}

}  // namespace fulcrum
