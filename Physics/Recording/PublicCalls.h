// The calls that are recorded and played again: a line per function that changes the world. A function that is not here
// fails CallRecorder.KnowsEveryCallThatChangesTheWorld. Used by Recording/.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <tuple>

namespace fulcrum {

template <auto kFunction>
struct PublicCall {
    const char* name;  // in files, unique
};

#define FULCRUM_JOINT_CALL(kind) \
    PublicCall<&JointInterface::Create<kind##JointSettings>>{"JointInterface::Create " #kind},

inline constexpr std::tuple kPublicCalls{
    PublicCall<&PhysicsSystem::Update>{"PhysicsSystem::Update"},
    PublicCall<&PhysicsSystem::SetSettings>{"PhysicsSystem::SetSettings"},
    PublicCall<&PhysicsSystem::SetContactListener>{"PhysicsSystem::SetContactListener"},
    PublicCall<&PhysicsSystem::RestoreSnapshot>{"PhysicsSystem::RestoreSnapshot"},
    PublicCall<&PhysicsSystem::RestoreBodies>{"PhysicsSystem::RestoreBodies"},
    PublicCall<&BodyInterface::Create>{"BodyInterface::Create"},
    PublicCall<&BodyInterface::Commit>{"BodyInterface::Commit"},
    PublicCall<&BodyInterface::Remove>{"BodyInterface::Remove"},
    PublicCall<&BodyInterface::SetPoses>{"BodyInterface::SetPoses"},
    PublicCall<&BodyInterface::MoveKinematic>{"BodyInterface::MoveKinematic"},
    PublicCall<&BodyInterface::SetVelocity>{"BodyInterface::SetVelocity"},
    PublicCall<&BodyInterface::AddForce>{"BodyInterface::AddForce"},
    PublicCall<&BodyInterface::AddForceAt>{"BodyInterface::AddForceAt"},
    PublicCall<&BodyInterface::AddTorque>{"BodyInterface::AddTorque"},
    PublicCall<&BodyInterface::AddImpulse>{"BodyInterface::AddImpulse"},
    PublicCall<&BodyInterface::AddImpulseAt>{"BodyInterface::AddImpulseAt"},
    PublicCall<&BodyInterface::AddAngularImpulse>{"BodyInterface::AddAngularImpulse"},
    PublicCall<&BodyInterface::SetMotionType>{"BodyInterface::SetMotionType"},
    PublicCall<Overload<BodyId, float>::Of(&BodyInterface::SetMass)>{"BodyInterface::SetMass"},
    PublicCall<Overload<BodyId, float, const SymmetricMatrix3&>::Of(&BodyInterface::SetMass)>{
        "BodyInterface::SetMass with inertia"},
    PublicCall<&BodyInterface::SetMaterial>{"BodyInterface::SetMaterial"},
    PublicCall<&BodyInterface::SetLayer>{"BodyInterface::SetLayer"},
    PublicCall<&BodyInterface::SetCategoryAndMask>{"BodyInterface::SetCategoryAndMask"},
    PublicCall<&BodyInterface::SetGroup>{"BodyInterface::SetGroup"},
    PublicCall<&BodyInterface::SetGravityFactor>{"BodyInterface::SetGravityFactor"},
    PublicCall<&BodyInterface::SetGravity>{"BodyInterface::SetGravity"},
    PublicCall<&BodyInterface::SetDamping>{"BodyInterface::SetDamping"},
    PublicCall<&BodyInterface::SetLockedAxes>{"BodyInterface::SetLockedAxes"},
    PublicCall<&BodyInterface::SetMaxSpeeds>{"BodyInterface::SetMaxSpeeds"},
    PublicCall<&BodyInterface::SetGyroscopicTorque>{"BodyInterface::SetGyroscopicTorque"},
    PublicCall<&BodyInterface::SetUserData>{"BodyInterface::SetUserData"},
    PublicCall<&BodyInterface::SetAllowSleep>{"BodyInterface::SetAllowSleep"},
    PublicCall<&BodyInterface::SetContinuous>{"BodyInterface::SetContinuous"},
    PublicCall<&BodyInterface::SetPenetrationTarget>{"BodyInterface::SetPenetrationTarget"},
    PublicCall<&BodyInterface::SetReportsContacts>{"BodyInterface::SetReportsContacts"},
    PublicCall<&BodyInterface::SetSensor>{"BodyInterface::SetSensor"},
    PublicCall<&BodyInterface::SetSensorSees>{"BodyInterface::SetSensorSees"},
    PublicCall<&BodyInterface::SetSensorReportsStay>{"BodyInterface::SetSensorReportsStay"},
    PublicCall<&BodyInterface::Wake>{"BodyInterface::Wake"},
    PublicCall<&BodyInterface::Sleep>{"BodyInterface::Sleep"},
    PublicCall<&BodyInterface::SetShape>{"BodyInterface::SetShape"},
    PublicCall<&BodyInterface::AddChild>{"BodyInterface::AddChild"},
    PublicCall<&BodyInterface::SetChild>{"BodyInterface::SetChild"},
    PublicCall<&BodyInterface::MoveChild>{"BodyInterface::MoveChild"},
    PublicCall<&BodyInterface::RemoveChild>{"BodyInterface::RemoveChild"},
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_JOINT_CALL)  //
    PublicCall<&JointInterface::SetTarget>{"JointInterface::SetTarget"},
    PublicCall<&JointInterface::Remove>{"JointInterface::Remove"},
    PublicCall<&JointInterface::SetEnabled>{"JointInterface::SetEnabled"},
    PublicCall<&JointInterface::SetLimits>{"JointInterface::SetLimits"},
    PublicCall<&JointInterface::SetMotor>{"JointInterface::SetMotor"},
    PublicCall<&JointInterface::SetFriction>{"JointInterface::SetFriction"},
    PublicCall<&JointInterface::SetTargetOrientation>{"JointInterface::SetTargetOrientation"},
    PublicCall<&JointInterface::SetEffort>{"JointInterface::SetEffort"},
    PublicCall<&JointInterface::SetErrorTarget>{"JointInterface::SetErrorTarget"},
    PublicCall<&JointInterface::SetMassOverride>{"JointInterface::SetMassOverride"},
};

#undef FULCRUM_JOINT_CALL

}  // namespace fulcrum
