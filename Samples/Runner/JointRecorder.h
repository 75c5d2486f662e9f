// Records the joints of a world: each once, when it is first seen, and their state frame by frame. Used by Recorder;
// one thread.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Samples/Viewer/RecordedJoint.h>

#include <functional>
#include <optional>
#include <vector>

namespace fulcrum {

class JointRecorder {
public:
    // bodyOf: index of the recorded body, none for one that is not recorded: its joints are not either. `system` must
    // outlive this.
    JointRecorder(const PhysicsSystem& system, const Position& origin,
                  std::function<std::optional<uint32_t>(BodyId)> bodyOf)
        : system_(system), origin_(origin), bodyOf_(std::move(bodyOf)) {}

    // The joints as they are now. Appends those that are new to `joints`; what is returned is valid until the next
    // call.
    RecordedFrameJoints Collect(std::vector<RecordedJoint>& joints);

private:
    void AddNew(JointId id, std::vector<RecordedJoint>& joints);

    const PhysicsSystem& system_;
    Position origin_;
    std::function<std::optional<uint32_t>(BodyId)> bodyOf_;
    std::vector<JointId> ids_;   // of the recorded joints
    std::vector<JointId> seen_;  // by JointId::index: the last id that was found there
    std::vector<RecordedJointState> states_;
};

}  // namespace fulcrum
