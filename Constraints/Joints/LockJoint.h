// Point (ball) and fixed joints: locks and nothing else. Made by Physics from their settings; no threads.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>

namespace fulcrum {

class LockJoint final : public JointType {
public:
    explicit LockJoint(const JointLocks& locks) : locks_(locks) {}

    JointLocks Locks() const override { return locks_; }

private:
    JointLocks locks_;
};

}  // namespace fulcrum
