// Snapshots of some bodies. PhysicsSystem::RestoreBodies does what a user could do with SetPose etc., except that poses
// are bit-exact and the state of joints is restored.
#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Snapshots/SnapshotElements.h>
#include <Fulcrum/Physics/Snapshots/Snapshots.h>
#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/ShapeEdits.h>
#include <Fulcrum/Physics/World/Teleports.h>
#include <Fulcrum/Physics/World/Velocities.h>
#include <Fulcrum/Physics/World/WorldChange.h>

#include <algorithm>

namespace fulcrum {

namespace {

// A body in a snapshot of some bodies.
struct SavedBody {
    BodyId id;
    uint64_t shape = 0;  // ContentHash
    Pose center;         // rounded to the grid of positions
    Remainder remainder;
    Vector3 linear = Vector3::Zero(), angular = Vector3::Zero(), force = Vector3::Zero(), torque = Vector3::Zero();
    float slowSeconds = 0;
    SlowMotion slowMotion;
    BodyPush lastPush;
    bool isSteady = false;
    SingleMove singleMove = SingleMove::None;
};

// Identifies a joint and the size of its state.
struct SavedJoint {
    JointId id;
    uint64_t type = 0;   // hash of kind and settings
    uint32_t state = 0;  // size of JointType::State
    uint8_t controls = 0;
    friend bool operator==(const SavedJoint&, const SavedJoint&) = default;
};

template <class Stream>
void Visit(Stream& s, SavedBody& body) {
    auto& [id, shape, center, remainder, linear, angular, force, torque, slowSeconds, slowMotion, lastPush, isSteady,
           singleMove] = body;
    auto& [lately, before] = slowMotion;
    s(id, shape, center.position, center.rotation, remainder.value, remainder.isGiven, linear, angular, force, torque,
      slowSeconds, lately.linear, lately.angular, before.linear, before.angular, lastPush.force, lastPush.torque,
      isSteady, singleMove);
}
template <class Stream>
void Visit(Stream& s, SavedJoint& joint) {
    auto& [id, type, state, controls] = joint;
    s(id, type, state, controls);
}

SavedBody Describe(const BodyStore& bodies, BodyId id) {
    const BodyCold& cold = bodies.cold[id.index];
    return {id,
            ContentHash(*cold.shape),
            bodies.CenterPoseOf(id.index),
            bodies.remainders[id.index],
            bodies.LinearVelocityOf(id.index),
            bodies.AngularVelocityOf(id.index),
            cold.force,
            cold.torque,
            bodies.dynamics[id.index].slowSeconds,
            bodies.slowMotions[id.index],
            cold.lastPush,
            cold.isSteady,
            cold.singleMove};
}

SavedJoint Describe(const JointStore& joints, uint32_t index, Array<std::byte>& settings) {
    JointType& type = *joints.types[index];
    ReadSettings(type, settings);
    SavedJoint saved{joints.IdOf(index), HashBytes(settings.data(), settings.size(), KindHash(type)),
                     static_cast<uint32_t>(type.State().size())};
    for (unsigned axis = 0; axis < 6; ++axis)
        if (type.Control(static_cast<JointAxis>(axis)))
            saved.controls = static_cast<uint8_t>(saved.controls | 1u << axis);
    return saved;
}

// The joints both of whose bodies are among these.
Array<uint32_t> JointsBetween(const JointStore& joints, std::span<const BodyId> bodies) {
    Array<uint32_t> members, found;
    for (const BodyId body : bodies) members.push_back(body.index);
    std::ranges::sort(members);
    for (const BodyId body : bodies)
        joints.VisitOf(body.index, [&](uint32_t index) {
            const Joint& joint = joints.joints[index];
            if (std::ranges::binary_search(members, joint.body[0]) &&
                std::ranges::binary_search(members, joint.body[1]))
                found.push_back(index);
        });
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

MaybeError CheckBodies(const BodyStore& bodies, std::span<const SavedBody> saved) {
    for (const SavedBody& body : saved) {
        if (!bodies.Find(body.id)) return Unknown(body.id);
        if (ContentHash(*bodies.cold[body.id.index].shape) != body.shape)
            return Error{ErrorCode::Unsupported,
                         "body " + std::to_string(body.id.index) + " has another shape than when it was saved"};
    }
    return std::nullopt;
}

MaybeError CheckJoints(const JointStore& joints, std::span<const SavedJoint> saved, Array<std::byte>& settings) {
    for (const SavedJoint& joint : saved) {
        const std::string name = "joint " + std::to_string(joint.id.index);
        if (!joints.Find(joint.id)) return Error{ErrorCode::UnknownId, name + " does not exist any more"};
        if (Describe(joints, joint.id.index, settings) != joint)
            return Error{ErrorCode::Unsupported, name + " has another type than when it was saved"};
    }
    return std::nullopt;
}

// Restores the remaining state bit-exactly, after SetPose and SetVelocity, which wake bodies and have pairs searched
// for.
void Complete(BodyStore& bodies, const SavedBody& saved) {
    const uint32_t i = saved.id.index;
    bodies.SetCenterPose(i, saved.center);
    bodies.remainders[i] = saved.remainder;
    bodies.UpdateInertia(i);
    bodies.SetVelocity(i, saved.linear, saved.angular);
    bodies.cold[i].force = saved.force;
    bodies.cold[i].torque = saved.torque;
    bodies.dynamics[i].hasForce = !saved.force.isZero(0) || !saved.torque.isZero(0);
    bodies.dynamics[i].slowSeconds = saved.slowSeconds;
    bodies.slowMotions[i] = saved.slowMotion;
    bodies.cold[i].lastPush = saved.lastPush;
    bodies.cold[i].isSteady = saved.isSteady;
    if (bodies.dynamics[i].hasForce || !saved.lastPush.IsZero()) bodies.pushed.Insert(i);
    bodies.cold[i].singleMove = saved.singleMove;
    if (saved.singleMove != SingleMove::None) bodies.singleMoves.Insert(i);
}

}  // namespace

Status PhysicsSystem::SaveBodies(std::span<const BodyId> bodies, std::vector<std::byte>& bytes) const {
    const DefaultFloats floats;
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal()) return *alone.Refusal();
    HeedShapeEdits(*world_);
    for (const BodyId id : bodies)
        if (!world_->bodies.Find(id)) return Unknown(id);
    SnapshotWriter s(bytes, snapshots_->blocks, true);
    s.Begin(SnapshotSection::Bodies);
    VisitList(s, bodies, kMostOfBody, [&](BodyId id) {
        SavedBody body = Describe(world_->bodies, id);
        Visit(s, body);
    });
    s.EndBlock();
    s.Begin(SnapshotSection::Joints);
    const Array<uint32_t> joints = JointsBetween(world_->joints, bodies);
    VisitList(s, joints, sizeof(SavedJoint), [&](uint32_t index) {
        SavedJoint joint = Describe(world_->joints, index, snapshots_->settings);
        Visit(s, joint);
    });
    for (const uint32_t index : joints) {
        s.Reserve(kMostOfJoint);
        VisitJointRecord(s, world_->joints.records[index]);
        VisitType(s, *world_->joints.types[index]);
    }
    s.EndBlock();
    FinishSnapshot(kPartMagic, s.Hash(), s, snapshots_->blocks, bytes);
    return Done{};
}

Status PhysicsSystem::RestoreBodies(std::span<const std::byte> bytes) {
    const WorldChange<&PhysicsSystem::RestoreBodies> change(*world_, bytes);
    if (change.Refusal()) return *change.Refusal();
    const Result<SnapshotParts> parts = CheckSnapshot(bytes, kPartMagic);
    if (!parts) return parts.GetError();
    SnapshotReader s(parts.Value().data);
    Array<SavedBody> saved;
    Array<SavedJoint> joints;
    VisitList(s, saved, 0, [&](SavedBody& body) { Visit(s, body); });
    VisitList(s, joints, 0, [&](SavedJoint& joint) { Visit(s, joint); });
    if (MaybeError error = CheckBodies(world_->bodies, saved)) return *error;
    if (MaybeError error = CheckJoints(world_->joints, joints, snapshots_->settings)) return *error;

    ReserveForChange(*world_, {.placed = saved.size()});
    Array<BodyPlace> places;
    places.reserve(saved.size());
    for (const SavedBody& body : saved) {
        const Vector3 offset = world_->bodies.cold[body.id.index].shape->Mass().centerOfMass;
        const Position place =
            body.center.position + body.remainder.value - Rotate(body.center.rotation, offset).cast<double>();
        places.push_back({body.id.index, {place, body.center.rotation}});
    }
    change.Begin();
    for (size_t i = 0; i < saved.size(); ++i) {
        Teleport(*world_, {&places[i], 1});
        const bool isGiven = IsFinite(saved[i].linear) && IsFinite(saved[i].angular);
        if (world_->bodies.dynamics[places[i].body].motion != MotionType::Static && isGiven)
            GiveVelocity(*world_, places[i].body, saved[i].linear, saved[i].angular);
    }
    for (const SavedBody& body : saved) Complete(world_->bodies, body);
    for (const SavedJoint& joint : joints) {
        const JointRecord now = world_->joints.records[joint.id.index];
        JointRecord& record = world_->joints.records[joint.id.index];
        VisitJointRecord(s, record);
        std::ranges::copy(now.anchorA, record.anchorA);
        std::ranges::copy(now.anchorB, record.anchorB);
        VisitType(s, *world_->joints.types[joint.id.index]);
    }
    if (!joints.empty()) world_->coloring.Invalidate();
    return Done{};
}

}  // namespace fulcrum
