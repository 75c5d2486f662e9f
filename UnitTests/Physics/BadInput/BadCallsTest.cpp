// Every call that changes the world, with one number, id, enumerator or shape at a time that is not a number, infinite,
// zero, negative, huge, stale, foreign, null or out of range: it is refused and no bit has changed, or it is valid and
// the world stays finite. The calls are those of Recording/PublicCalls.h, which another test holds to the headers; what
// must be refused follows from types and from the ranges in the comments of the settings.
#include <Fulcrum/Physics/Recording/PublicCalls.h>
#include <Fulcrum/UnitTests/Physics/BadInput/Room.h>

#include <set>

namespace fulcrum::testing {
namespace {

template <auto kOne, auto kOther>
constexpr bool IsSame() {
    if constexpr (std::is_same_v<decltype(kOne), decltype(kOther)>) return kOne == kOther;
    return false;
}

// ---- Arguments with which a call succeeds: by type, and for a few calls by name.

template <class T>
T Good(const Room& room) {
    if constexpr (std::is_same_v<T, BodyId>) return room.body;
    else if constexpr (std::is_same_v<T, JointId>) return room.hinge;
    else if constexpr (std::is_same_v<T, ChildId>) return room.child;
    else if constexpr (std::is_same_v<T, float>) return 0.5f;
    else if constexpr (std::is_same_v<T, double>) return kStep;
    else if constexpr (std::is_same_v<T, Position>) return Position(0, 3, 0);
    else if constexpr (std::is_same_v<T, Vector3>) return Vector3(0, 1, 0);
    else if constexpr (std::is_same_v<T, std::optional<Vector3>>) return Vector3(0, 1, 0);
    else if constexpr (std::is_same_v<T, SymmetricMatrix3>) return SymmetricMatrix3{1, 2, 2.5f, 0.1f, 0.1f, 0.1f};
    else if constexpr (std::is_same_v<T, ShapePtr>) return room.ball;
    else if constexpr (std::is_same_v<T, JointAxis>) return JointAxis::AngularX;
    else if constexpr (std::is_same_v<T, std::optional<JointLimits>>) return JointLimits{.min = -1, .max = 1};
    else if constexpr (std::is_same_v<T, CompoundShape::ChildSettings>) return T{.shape = room.ball};
    else if constexpr (std::is_same_v<T, BodySettings>) return T{.shape = room.ball, .position = {5, 5, 5}};
    else if constexpr (std::is_same_v<T, BatchSettings>) {
        HingeJointSettings hinge = Good<HingeJointSettings>(room);
        hinge.bodyB = BodyBatch::Body(1);
        return {{2, Good<BodySettings>(room)}, {hinge}};
    } else if constexpr (std::is_same_v<T, std::vector<BodyId>>) return {room.body, room.other};
    else if constexpr (std::is_same_v<T, std::vector<Pose>>) return {Pose{{0, 2, 0}, {}}, Pose{{2, 2, 0}, {}}};
    else if constexpr (std::is_same_v<T, std::vector<std::byte>>) return room.snapshot;
    else if constexpr (std::is_base_of_v<JointSettings, T>) {
        T settings;
        settings.bodyA = room.body;
        settings.bodyB = room.compound;
        settings.anchorA.normal = Vector3(0, 1, 0);
        settings.anchorB = settings.anchorA;
        // Limits, motors and friction as far as the kind has them: what is not used is not checked.
        constexpr AxisControl kControl{.limited = true,
                                       .limits = {.min = -0.5f, .max = 0.5f},
                                       .motor = {.mode = MotorMode::ToPosition},
                                       .friction = 1};
        if constexpr (std::is_same_v<T, HingeJointSettings>) settings.angle = kControl;
        if constexpr (std::is_same_v<T, SliderJointSettings>) settings.slide = kControl;
        if constexpr (std::is_same_v<T, SixDofJointSettings>) settings.axes.fill(kControl);
        if constexpr (std::is_same_v<T, SwingTwistJointSettings>)
            settings.twist = settings.swingY = settings.swingZ = kControl;
        if constexpr (std::is_same_v<T, PathJointSettings>) settings.along = kControl;
        if constexpr (std::is_same_v<T, PulleyJointSettings>) settings.fixedPointA = settings.fixedPointB = {0, 9, 0};
        if constexpr (std::is_same_v<T, DistanceJointSettings>)
            settings.minDistance = 1.0f, settings.maxDistance = 3.0f;
        if constexpr (std::is_same_v<T, CustomJointSettings>) settings.make = MakeScrew;
        return settings;
    } else return T{};
}

template <auto kFunction, class Arguments>
void Adjust(const Room& room, Arguments& arguments) {
    if constexpr (IsSame<kFunction, &BodyInterface::MoveKinematic>()) std::get<0>(arguments) = room.driven;
    if constexpr (IsSame<kFunction, &BodyInterface::SetSensorSees>() ||
                  IsSame<kFunction, &BodyInterface::SetSensorReportsStay>())
        std::get<0>(arguments) = room.sensor;
    if constexpr (IsSame<kFunction, &BodyInterface::AddChild>() || IsSame<kFunction, &BodyInterface::SetChild>() ||
                  IsSame<kFunction, &BodyInterface::MoveChild>() || IsSame<kFunction, &BodyInterface::RemoveChild>())
        std::get<0>(arguments) = room.compound;
    if constexpr (IsSame<kFunction, &JointInterface::SetTarget>()) std::get<0>(arguments) = room.toWorld;
    if constexpr (IsSame<kFunction, &PhysicsSystem::RestoreBodies>()) std::get<0>(arguments) = room.some;
}

// ---- Calls

PhysicsSystem& ObjectOf(PhysicsSystem& system, const PhysicsSystem*) { return system; }
BodyInterface& ObjectOf(PhysicsSystem& system, const BodyInterface*) { return system.Bodies(); }
JointInterface& ObjectOf(PhysicsSystem& system, const JointInterface*) { return system.Joints(); }
template <class Returned, class Class, class... Parameters>
Class* ClassOf(Returned (Class::*)(Parameters...));

template <auto kFunction, class Argument>
MaybeError Make(PhysicsSystem& system, const Argument& arguments) {
    auto& object = ObjectOf(system, decltype(ClassOf(kFunction))(nullptr));
    if constexpr (IsSame<kFunction, &BodyInterface::Commit>()) {
        const Result<BodyBatch> batch =
            BodyBatch::Prepare(std::get<0>(arguments).bodies, std::get<0>(arguments).joints);
        if (!batch) return batch.GetError();
        const Result<BatchIds> ids = object.Commit(batch.Value());
        if (ids) return {};
        return ids.GetError();
    } else if constexpr (IsSame<kFunction, &PhysicsSystem::SetContactListener>()) {
        system.SetContactListener(std::get<0>(arguments));
        return {};
    } else {
        const auto result =
            std::apply([&](const auto&... argument) { return (object.*kFunction)(argument...); }, arguments);
        if (result) return {};
        return result.GetError();
    }
}

// The parameters' names in the header.
std::vector<std::string> NamesOf(const std::string& call, size_t count) {
    const size_t colons = call.find("::");
    const std::string type = call.substr(0, colons), name = call.substr(colons + 2, call.find(' ') - colons - 2);
    for (const PublicFunction& function : PublicFunctionsOf("Physics/" + type + ".h", type)) {
        std::vector<std::string> names = function.ParameterNames();
        if (function.name == name && names.size() == count) return names;
    }
    ADD_FAILURE() << call << " is not in the header";
    return std::vector<std::string>(count);
}

// Valid although the type alone would not allow it.
bool IsAllowed(const std::string& call, const Spoiled& spoiled) {
    struct Allowed {
        const char* call;
        const char* path;  // its end
        const char* value;
    };
    constexpr Allowed kAllowed[] = {
        {"BodyInterface::SetPenetrationTarget", "target", "inf"},  // any penetration
        {"JointInterface::SetErrorTarget", "target", "inf"},       // any gap
        {"JointInterface::SetEffort", "effort.substeps", "0"},     // the system's
        {"JointInterface::SetEffort", "effort.velocityIterations", "0"},
    };
    // Of the effort only the substeps and iterations count.
    if (call == "JointInterface::SetEffort" && (spoiled.path.find("baumgarte") != std::string::npos ||
                                                spoiled.path.find("positionCorrection") != std::string::npos))
        return true;
    for (const Allowed& allowed : kAllowed)
        if (call == allowed.call && spoiled.path.ends_with(allowed.path) && spoiled.value == allowed.value) return true;
    return false;
}

struct Counts {
    int values = 0, refused = 0;
};

class SeenCalls final : public CallObserver {
public:
    void BeginCall(const void* function, std::span<const void* const>) override { calls.push_back(function); }
    void NoteCreated(const void*) override {}
    void EndStep(uint64_t) override {}
    std::vector<const void*> calls;
};

template <auto kFunction>
void TryBadValues(Room& room, const std::string& call, Counts& counts) {
    SCOPED_TRACE(call);
    using Stored = decltype([]<class... Argument>(std::tuple<Argument...>*) {
        return std::tuple<typename StoredArgument<Argument>::Type...>();
    }(static_cast<CallArguments<kFunction>*>(nullptr)));
    Stored good = []<class... Argument>(std::tuple<Argument...>*, const Room& r) {
        return std::tuple<Argument...>{Good<Argument>(r)...};
    }(static_cast<Stored*>(nullptr), room);
    Adjust<kFunction>(room, good);
    SeenCalls seen;
    room.system.SetCallObserver(&seen);
    const MaybeError refused = Make<kFunction>(room.system, good);
    room.system.SetCallObserver(nullptr);
    EXPECT_EQ(seen.calls, std::vector<const void*>{&kCallTag<kFunction>}) << "it needs a WorldChange in its first line";
    EXPECT_FALSE(refused) << "with good arguments: " << refused->message << "; give it others in Good or Adjust";
    room.Restore();
    const std::vector<std::string> names = NamesOf(call, std::tuple_size_v<Stored>);
    for (size_t which = 0;; ++which) {
        Stored arguments = good;
        Spoiler spoiler(which, room.bad);
        std::apply(
            [&](auto&... argument) {
                size_t i = 0;
                (spoiler.Argument(names[i++], argument), ...);
            },
            arguments);
        if (!spoiler.Done()) break;
        const Spoiled& spoiled = *spoiler.Done();
        const std::string what = spoiled.path + " = " + spoiled.value;
        ++counts.values;
        if (const MaybeError error = Make<kFunction>(room.system, arguments)) {
            ++counts.refused;
            EXPECT_FALSE(error->message.empty()) << what;
            if (room.system.HashState() == room.Hash()) continue;
            ADD_FAILURE() << what << " was refused, but the state has changed: " << error->message;
        } else if (spoiled.verdict == Verdict::MustBeRefused && !IsAllowed(call, spoiled)) {
            ADD_FAILURE() << what << " was not refused";
        } else if (const std::string wrong = room.WrongAfterSteps(); !wrong.empty()) {
            ADD_FAILURE() << "after " << what << " " << wrong;
        }
        room.Restore();
        if (::testing::Test::HasFatalFailure()) return;
    }
}

TEST(BadCalls, AreRefusedAndChangeNoBit) {
    Room room;
    Counts counts;
    std::apply(
        [&]<auto... kFunction>(const PublicCall<kFunction>&... call) {
            (TryBadValues<kFunction>(room, call.name, counts), ...);
        },
        kPublicCalls);
    // So that a change of the archives does not leave them out.
    EXPECT_GT(counts.values, 5000);
    EXPECT_GT(counts.refused, 3000);
}

}  // namespace
}  // namespace fulcrum::testing
