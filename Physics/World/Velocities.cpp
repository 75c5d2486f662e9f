#include <Fulcrum/Physics/World/Velocities.h>

#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/JointChanges.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

void SetVelocityOf(WorldState& world, uint32_t body, Vector3 linear, Vector3 angular) {
    LimitLength(linear, kFastestLinear);
    LimitLength(angular, kFastestAngular);
    world.bodies.SetVelocity(body, linear, angular);
}

void GiveVelocity(WorldState& world, uint32_t body, const Vector3& linear, const Vector3& angular) {
    WakeBody(world, body);
    const BodyDynamics& d = world.bodies.dynamics[body];
    const bool isDriven = d.motion == MotionType::Kinematic && !(linear.isZero(0) && angular.isZero(0));
    if (isDriven && !d.awake) {
        world.bodies.MarkAwake(body);
        RequeueColliders(world.bodies, world.colliders, body);
    }
    if (isDriven) WakeJoined(world, body);
    if (world.bodies.singleMoves.Erase(body)) world.bodies.cold[body].singleMove = SingleMove::None;
    SetVelocityOf(world, body, linear, angular);
}

MaybeError ChangeVelocity(WorldState& world, const WorldLock::Exclusive& alone, BodyId id, const Vector3& linear,
                          const Vector3& angular) {
    if (!world.bodies.Find(id)) return Unknown(id);
    if (MaybeError e = FirstOf(CheckFinite("linear", linear), CheckFinite("angular", angular))) return e;
    const BodyDynamics& d = world.bodies.dynamics[id.index];
    if (d.motion == MotionType::Static) return Error{ErrorCode::Unsupported, "a static body has no velocity"};
    if (d.frozen) return Error{ErrorCode::Unsupported, "the body is frozen; SetPose revives it"};
    if (d.motion == MotionType::Kinematic) ReserveForChange(world);
    else ReserveToWake(world, id.index);
    alone.Begin();
    GiveVelocity(world, id.index, linear, angular);
    return std::nullopt;
}

}  // namespace fulcrum
