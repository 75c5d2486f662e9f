// Disables joints whose force or torque exceeded their limit. Their bodies search for pairs, since they may collide
// now.
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

// Serial, in the order of the joints.
void BreakJoints(const BodyStore& bodies, ColliderStore& colliders, JointStore& joints, ConstraintColoring& coloring,
                 Array<BrokenJoint>& broken) {
    joints.breakable.Visit([&](uint32_t index) {
        Joint& joint = joints.joints[index];
        if (joint.color.color == 0xFF) return;
        const JointRecord& record = joints.records[index];
        const auto toVector = [](const float(&v)[3]) { return Vector3(v[0], v[1], v[2]); };
        const Vector3 force = toVector(record.totalForce), torque = toVector(record.totalTorque);
        if (Length(force) <= joint.breakForce && Length(torque) <= joint.breakTorque) return;
        joint.enabled = false;
        joints.Forget(index);
        UncolorJoint(joints, coloring, index);
        for (uint32_t body : joint.body) RequeueColliders(bodies, colliders, body);
        broken.push_back({joints.IdOf(index), force, torque});
    });
}

}  // namespace fulcrum
