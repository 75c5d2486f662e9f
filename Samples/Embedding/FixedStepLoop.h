// A game's loop: frames take as long as they take, steps are all equally long. What is left of a frame's time is shown
// by interpolation between the last two steps, so that motion is even whatever the frame rate; the picture is one step
// behind. One thread.
#pragma once

#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/PhysicsSystem.h>

#include <vector>

namespace fulcrum::samples {

class FixedStepLoop {
public:
    // The system's settings have events.bodies on: by these the loop knows which poses it must keep. `mostSteps`: of a
    // frame; a frame that takes longer slows the game down, instead of taking the next one longer still.
    explicit FixedStepLoop(PhysicsSystem& system, double stepSeconds = 1.0 / 60, int mostSteps = 4)
        : system_(system), stepSeconds_(stepSeconds), mostSteps_(mostSteps) {}

    // A frame that took so many seconds. Calls beforeStep(dt) before each step that is due: there inputs and forces
    // belong. Returns the number of steps, or the error of one.
    Result<int> Advance(double frameSeconds, FunctionRef<void(double dt)> beforeStep) {
        left_ = std::min(left_ + frameSeconds, mostSteps_ * stepSeconds_);
        int steps = 0;
        // A millionth of a step is rounding of the frames' times.
        for (; left_ >= stepSeconds_ * (1 - 1e-6); ++steps) {
            beforeStep(stepSeconds_);
            if (Status status = system_.Update(stepSeconds_); !status) return status.GetError();
            left_ -= stepSeconds_;
            KeepPoses();
        }
        return steps;
    }

    // How far the frame is from the last step but one, 0, to the last, 1.
    double Part() const { return std::max(left_ / stepSeconds_, 0.0); }

    // Where a body is to be drawn; of one that did not move, where it is.
    Pose PoseOf(BodyId id) const {
        const Pose now = system_.Bodies().GetPose(id);
        if (id.index >= kept_.size() || kept_[id.index].id != id || kept_[id.index].step != steps_) return now;
        const Pose& before = kept_[id.index].before;
        const double part = Part();
        const Vector3 turn = RotationVectorOf<float>(now.rotation * before.rotation.Conjugate());
        return {before.position + (now.position - before.position) * part,
                Normalized(RotationFromVector(Vector3(turn * static_cast<float>(part))) * before.rotation)};
    }

    // After SetPose: it is drawn there at once, not on the way.
    void Jump(BodyId id) {
        if (id.index < kept_.size()) kept_[id.index] = {};
    }

private:
    struct Kept {
        BodyId id{};
        uint64_t step = 0;  // after which `now` was taken
        Pose before{}, now{};
    };

    // What moved in this step was before it where it was after the last in which it moved.
    void KeepPoses() {
        ++steps_;
        for (const BodyId id : system_.Events().moved) {
            if (id.index >= kept_.size()) kept_.resize(id.index + 1);
            Kept& kept = kept_[id.index];
            const Pose now = system_.Bodies().GetPose(id);
            kept = {id, steps_, kept.id == id ? kept.now : now, now};
        }
    }

    PhysicsSystem& system_;
    double stepSeconds_, left_ = 0;
    int mostSteps_;
    uint64_t steps_ = 0;
    std::vector<Kept> kept_;  // by index
};

}  // namespace fulcrum::samples
