// What reads a body or a joint, with ids that nothing has and axes that there are not: zeros, as the headers say, and
// no bit has changed. The list is held to the headers.
#include <Fulcrum/Physics/Fields/Fields.h>
#include <Fulcrum/UnitTests/Physics/BadInput/Room.h>

#include <set>
#include <tuple>

namespace fulcrum::testing {
namespace {

template <auto kFunction>
struct Getter {
    const char* name;
};

constexpr std::tuple kGetters{
    Getter<&BodyInterface::Exists>{"BodyInterface::Exists"},
    Getter<&BodyInterface::GetChildren>{"BodyInterface::GetChildren"},
    Getter<&BodyInterface::GetPose>{"BodyInterface::GetPose"},
    Getter<&BodyInterface::GetCenterOfMass>{"BodyInterface::GetCenterOfMass"},
    Getter<&BodyInterface::GetLinearVelocity>{"BodyInterface::GetLinearVelocity"},
    Getter<&BodyInterface::GetAngularVelocity>{"BodyInterface::GetAngularVelocity"},
    Getter<&BodyInterface::GetVelocityAt>{"BodyInterface::GetVelocityAt"},
    Getter<&BodyInterface::GetMass>{"BodyInterface::GetMass"},
    Getter<&BodyInterface::GetInertia>{"BodyInterface::GetInertia"},
    Getter<&BodyInterface::GetBounds>{"BodyInterface::GetBounds"},
    Getter<&BodyInterface::GetAngularMomentum>{"BodyInterface::GetAngularMomentum"},
    Getter<&BodyInterface::GetKineticEnergy>{"BodyInterface::GetKineticEnergy"},
    Getter<&BodyInterface::GetMotionType>{"BodyInterface::GetMotionType"},
    Getter<&BodyInterface::GetContinuous>{"BodyInterface::GetContinuous"},
    Getter<&BodyInterface::GetShape>{"BodyInterface::GetShape"},
    Getter<&BodyInterface::GetMaterial>{"BodyInterface::GetMaterial"},
    Getter<&BodyInterface::GetLayer>{"BodyInterface::GetLayer"},
    Getter<&BodyInterface::GetGravityFactor>{"BodyInterface::GetGravityFactor"},
    Getter<&BodyInterface::GetGravity>{"BodyInterface::GetGravity"},
    Getter<&BodyInterface::GetLinearDamping>{"BodyInterface::GetLinearDamping"},
    Getter<&BodyInterface::GetAngularDamping>{"BodyInterface::GetAngularDamping"},
    Getter<&BodyInterface::GetLockedAxes>{"BodyInterface::GetLockedAxes"},
    Getter<&BodyInterface::GetMaxLinearSpeed>{"BodyInterface::GetMaxLinearSpeed"},
    Getter<&BodyInterface::GetMaxAngularSpeed>{"BodyInterface::GetMaxAngularSpeed"},
    Getter<&BodyInterface::HasGyroscopicTorque>{"BodyInterface::HasGyroscopicTorque"},
    Getter<&BodyInterface::AllowsSleep>{"BodyInterface::AllowsSleep"},
    Getter<&BodyInterface::GetCategory>{"BodyInterface::GetCategory"},
    Getter<&BodyInterface::GetMask>{"BodyInterface::GetMask"},
    Getter<&BodyInterface::GetGroup>{"BodyInterface::GetGroup"},
    Getter<&BodyInterface::GetUserData>{"BodyInterface::GetUserData"},
    Getter<&BodyInterface::GetPenetrationTarget>{"BodyInterface::GetPenetrationTarget"},
    Getter<&BodyInterface::ReportsContacts>{"BodyInterface::ReportsContacts"},
    Getter<&BodyInterface::IsSensor>{"BodyInterface::IsSensor"},
    Getter<&BodyInterface::GetSensorSees>{"BodyInterface::GetSensorSees"},
    Getter<&BodyInterface::SensorReportsStay>{"BodyInterface::SensorReportsStay"},
    Getter<&BodyInterface::IsAwake>{"BodyInterface::IsAwake"},
    Getter<&BodyInterface::IsFrozen>{"BodyInterface::IsFrozen"},
    Getter<&JointInterface::Exists>{"JointInterface::Exists"},
    Getter<&JointInterface::IsEnabled>{"JointInterface::IsEnabled"},
    Getter<&JointInterface::GetControl>{"JointInterface::GetControl"},
    Getter<&JointInterface::GetCoordinate>{"JointInterface::GetCoordinate"},
    Getter<&JointInterface::GetError>{"JointInterface::GetError"},
    Getter<&JointInterface::GetForce>{"JointInterface::GetForce"},
    Getter<&JointInterface::GetTorque>{"JointInterface::GetTorque"},
    Getter<&JointInterface::GetLockForce>{"JointInterface::GetLockForce"},
    Getter<&JointInterface::GetLockTorque>{"JointInterface::GetLockTorque"},
    Getter<&JointInterface::GetAxisForces>{"JointInterface::GetAxisForces"},
    Getter<&JointInterface::GetFrameA>{"JointInterface::GetFrameA"},
    Getter<&JointInterface::GetFrameB>{"JointInterface::GetFrameB"},
    Getter<&JointInterface::GetBodyA>{"JointInterface::GetBodyA"},
    Getter<&JointInterface::GetBodyB>{"JointInterface::GetBodyB"},
    Getter<&JointInterface::GetErrorTarget>{"JointInterface::GetErrorTarget"},
    Getter<&JointInterface::GetUserData>{"JointInterface::GetUserData"},
    Getter<&JointInterface::GetMassOverride>{"JointInterface::GetMassOverride"},
    Getter<&JointInterface::GetType>{"JointInterface::GetType"},
};

// Tried by tests of their own below.
const std::set<std::string> kOthers = {"JointInterface::VisitOf", "PhysicsSystem::VisitContactsOf",
                                       "PhysicsSystem::BodiesInside", "PhysicsSystem::SaveBodies"};
// That hand ids to the caller.
const std::set<std::string> kWithoutIds = {"JointInterface::Visit", "PhysicsSystem::VisitBodies",
                                           "PhysicsSystem::VisitIslands"};

TEST(BadGetters, AreAllInTheList) {
    std::set<std::string> listed = kOthers;
    std::apply([&](const auto&... getter) { (listed.insert(getter.name), ...); }, kGetters);
    for (const char* type : {"PhysicsSystem", "BodyInterface", "JointInterface"})
        for (const PublicFunction& function : PublicFunctionsOf("Physics/" + std::string(type) + ".h", type)) {
            const std::string name = std::string(type) + "::" + function.name;
            const bool takesId = function.parameters.find("BodyId") != std::string::npos ||
                                 function.parameters.find("JointId") != std::string::npos;
            if (!function.isConst || !takesId || kWithoutIds.contains(name)) continue;
            EXPECT_TRUE(listed.contains(name)) << name;
        }
}

template <class T>
bool IsZero(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) return value == T(0);
    else if constexpr (std::is_pointer_v<T> || std::is_same_v<T, ShapePtr>) return value == nullptr;
    else if constexpr (std::is_same_v<T, Vector3> || std::is_same_v<T, Position>) return value.isZero(0);
    else if constexpr (std::is_same_v<T, Pose>) return IsZero(Position(value.position)) && value.rotation.w == 1;
    else if constexpr (std::is_same_v<T, BodyBounds>) return IsZero(value.lower) && IsZero(value.upper);
    else if constexpr (std::is_same_v<T, SymmetricMatrix3>)
        return IsZero(Vector3(value.xx, value.yy, value.zz)) && IsZero(Vector3(value.xy, value.xz, value.yz));
    else if constexpr (std::is_same_v<T, Material>) return value.friction == 0 && value.restitution == 0;
    else if constexpr (std::is_same_v<T, CollisionGroup>)
        return !value.filter && value.group == 0 && value.subGroup == 0;
    else if constexpr (std::is_same_v<T, JointError>) return value.distance == 0 && value.angle == 0;
    else if constexpr (std::is_same_v<T, JointAxisForces>)
        return value.limit == 0 && value.motor == 0 && value.friction == 0;
    else if constexpr (std::is_same_v<T, MassOverride>) return value.IsNone();
    else return value == T{};  // ids
}

template <class Value, class Class, class Id, class... Rest>
void TryIds(Value (Class::*function)(Id, Rest...) const, const Class& object, const char* name, const Room& room) {
    const auto call = [&](Id id, JointAxis axis) {
        if constexpr (sizeof...(Rest) == 0) return (object.*function)(id);
        else if constexpr (std::is_same_v<std::tuple<std::remove_cvref_t<Rest>...>, std::tuple<JointAxis>>)
            return (object.*function)(id, axis);
        else return (object.*function)(id, Position(1, 2, 3));
    };
    if constexpr (std::is_same_v<Id, BodyId>) {
        for (const BodyId id : room.bad.bodies) EXPECT_TRUE(IsZero(call(id, {}))) << name << " of body " << id.index;
        EXPECT_TRUE(IsZero(call(kWorldBody, {}))) << name << " of the world";
    } else {
        for (const JointId id : room.bad.joints) EXPECT_TRUE(IsZero(call(id, {}))) << name << " of joint " << id.index;
        if constexpr (sizeof...(Rest) == 0) return;
        for (const int axis : {6, 7, 77, 255})
            EXPECT_TRUE(IsZero(call(room.hinge, static_cast<JointAxis>(axis)))) << name << " of axis " << axis;
    }
}

TEST(BadGetters, ReturnZerosForIdsThatNothingHas) {
    Room room;
    const auto object = [&]<class Value, class Class, class... Rest>(Value (Class::*)(Rest...) const) -> const Class& {
        if constexpr (std::is_same_v<Class, BodyInterface>) return room.system.Bodies();
        else return room.system.Joints();
    };
    std::apply(
        [&]<auto... kFunction>(const Getter<kFunction>&... getter) {
            (TryIds(kFunction, object(kFunction), getter.name, room), ...);
        },
        kGetters);
    int visited = 0;
    for (const BodyId id : room.bad.bodies) {
        room.system.Joints().VisitOf(id, [&](JointId) { ++visited; });
        room.system.VisitContactsOf(id, [&](const ContactView&) { ++visited; });
        visited += static_cast<int>(room.system.BodiesInside(id).size());
        EXPECT_FALSE(room.system.Queries().MayCollide(id, room.body));
        EXPECT_FALSE(room.system.Queries().MayCollide(room.body, id));
        EXPECT_EQ(SubmergedVolume(room.system.Bodies(), id, {0, 1, 0}, 5).volume, 0);
        std::vector<std::byte> bytes;
        const Status saved = room.system.SaveBodies({&id, 1}, bytes);
        ASSERT_FALSE(saved);
        EXPECT_EQ(saved.GetError().code, ErrorCode::UnknownId);
    }
    EXPECT_EQ(visited, 0);
    EXPECT_TRUE(room.system.BodiesInside(room.body).empty());  // no sensor
    EXPECT_EQ(room.system.HashState(), room.Hash());
}

}  // namespace
}  // namespace fulcrum::testing
