#include <Fulcrum/Physics/Recording/CallTable.h>

#include <Fulcrum/Physics/Recording/PublicCalls.h>

#include <array>
#include <utility>

namespace fulcrum {

namespace {

template <class Arguments>
struct ArgumentCodec;
template <class... Argument>
struct ArgumentCodec<std::tuple<Argument...>> {
    using Stored = std::tuple<typename StoredArgument<Argument>::Type...>;

    static void Write(CallWriter& writer, std::span<const void* const> addresses) {
        size_t i = 0;
        (writer.Write(*static_cast<const Argument*>(addresses[i++])), ...);
    }
    static uint64_t Layout() {
        CallLayout layout;
        (layout.Add<typename StoredArgument<Argument>::Type>(), ...);
        return layout.Hash();
    }
};

void Note(const void* value, CreatedIds& created, const BodyId*) {
    created.bodies = {*static_cast<const BodyId*>(value)};
}
void Note(const void* value, CreatedIds& created, const BatchIds*) {
    const auto& ids = *static_cast<const BatchIds*>(value);
    created.bodies = ids.bodies;
    created.joints = ids.joints;
}
void Note(const void* value, CreatedIds& created, const JointId*) {
    created.joints = {*static_cast<const JointId*>(value)};
}
void Note(const void* value, CreatedIds& created, const ChildId*) {
    created.children = {*static_cast<const ChildId*>(value)};
}
template <class Value>
void NoteCreated(const void* value, CreatedIds& created) {
    Note(value, created, static_cast<const Value*>(nullptr));
}

PhysicsSystem& ObjectOf(PhysicsSystem& system, const PhysicsSystem*) { return system; }
BodyInterface& ObjectOf(PhysicsSystem& system, const BodyInterface*) { return system.Bodies(); }
JointInterface& ObjectOf(PhysicsSystem& system, const JointInterface*) { return system.Joints(); }
template <class Returned, class Class, class... Parameters>
Class* ClassOf(Returned (Class::*)(Parameters...));

// A user-defined joint gets its type by the id that it had when it was recorded.
void GiveMaker(CustomJointSettings& settings, JointId recorded, const ReplaySources& sources) {
    if (sources.makeJoint) settings.make = [&sources, recorded] { return sources.makeJoint(recorded); };
}

}  // namespace

void GiveMakers(std::span<BodyBatch::Joint> joints, std::span<const JointId> recorded, const ReplaySources& sources) {
    for (size_t i = 0; i < std::min(joints.size(), recorded.size()); ++i)
        if (auto* const custom = std::get_if<CustomJointSettings>(&joints[i])) GiveMaker(*custom, recorded[i], sources);
}

namespace {

// A call whose arguments are there.
template <auto kFunction, class... Stored>
MaybeError Call(PhysicsSystem& system, CreatedIds& created, const Stored&... arguments) {
    auto& object = ObjectOf(system, decltype(ClassOf(kFunction))(nullptr));
    using Value = CallResult<kFunction>;
    if constexpr (std::is_void_v<decltype((object.*kFunction)(arguments...))>) {
        (object.*kFunction)(arguments...);
    } else {
        const Result<Value> result = (object.*kFunction)(arguments...);
        if (!result) return result.GetError();
        if constexpr (!std::is_same_v<Value, Done>) NoteCreated<Value>(&result.Value(), created);
    }
    return {};
}

template <auto kFunction>
MaybeError Play(PhysicsSystem& system, CallReader& reader, [[maybe_unused]] const CreatedIds& recorded,
                CreatedIds& created) {
    using Arguments = CallArguments<kFunction>;
    typename ArgumentCodec<Arguments>::Stored stored;
    std::apply([&](auto&... argument) { (reader.Read(argument), ...); }, stored);
    if (reader.IsBad() || !reader.IsAtEnd() || reader.NamesWhatIsMissing() || reader.LacksListener()) return {};
    if constexpr (std::is_same_v<Arguments, std::tuple<BodyBatch>>) {
        BatchSettings& settings = std::get<0>(stored);
        GiveMakers(settings.joints, recorded.joints, reader.Sources());
        const Result<BodyBatch> batch = BodyBatch::Prepare(std::move(settings.bodies), std::move(settings.joints));
        if (!batch) return batch.GetError();
        return Call<kFunction>(system, created, batch.Value());
    } else if constexpr (std::is_same_v<Arguments, std::tuple<CustomJointSettings>>) {
        if (!recorded.joints.empty()) GiveMaker(std::get<0>(stored), recorded.joints[0], reader.Sources());
        return Call<kFunction>(system, created, std::get<0>(stored));
    } else {
        return std::apply([&](const auto&... argument) { return Call<kFunction>(system, created, argument...); },
                          stored);
    }
}

template <auto kFunction>
CallRow RowOf(const PublicCall<kFunction>& call) {
    using Value = CallResult<kFunction>;
    using Codec = ArgumentCodec<CallArguments<kFunction>>;
    CallRow row{call.name, &kCallTag<kFunction>, Codec::Layout(), Codec::Write, nullptr, Play<kFunction>};
    if constexpr (!std::is_same_v<Value, Done>) row.noteCreated = NoteCreated<Value>;
    return row;
}

}  // namespace

std::span<const CallRow> CallRows() {
    static const auto kRows = std::apply([](const auto&... call) { return std::array{RowOf(call)...}; }, kPublicCalls);
    return kRows;
}

const void* StepTag() { return &kCallTag<&PhysicsSystem::Update>; }
const void* BatchTag() { return &kCallTag<&BodyInterface::Commit>; }
const void* RestoreTag() { return &kCallTag<&PhysicsSystem::RestoreSnapshot>; }
const void* CreateTag() { return &kCallTag<&BodyInterface::Create>; }

}  // namespace fulcrum
