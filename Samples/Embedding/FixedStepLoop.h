// A game loop: frames have any length, steps a fixed one. Poses are interpolated between the last two steps, so that
// motion is smooth at any frame rate; what is drawn lags one step behind. One thread.
#pragma once

#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/PhysicsSystem.h>

#include <vector>

namespace fulcrum::samples {

class FixedStepLoop {
public:
    // The system's settings must have events.bodies on, which lists the poses to store. `mostSteps`: largest number of
    // steps in a frame; a frame that would need more slows the game down, instead of making the next one longer still.
    explicit FixedStepLoop(PhysicsSystem& system, double stepSeconds = 1.0 / 60, int mostSteps = 4)
        : system_(system), stepSeconds_(stepSeconds), mostSteps_(mostSteps) {}

    // A frame of the given seconds. Calls beforeStep(dt) before each step, for inputs and forces. Returns the number of
    // steps, or the error of one.
    Result<int> Advance(double frameSeconds, FunctionRef<void(double dt)> beforeStep) {
        left_ = std::min(left_ + frameSeconds, mostSteps_ * stepSeconds_);
        int steps = 0;
        // A millionth of a step allows for rounding of the frame times.
        for (; left_ >= stepSeconds_ * (1 - 1e-6); ++steps) {
            beforeStep(stepSeconds_);
            if (Status status = system_.Update(stepSeconds_); !status) return status.GetError();
            left_ -= stepSeconds_;
            KeepPoses();
        }
        return steps;
    }

    // The fraction between the last step but one, 0, and the last, 1.
    double Part() const { return std::max(left_ / stepSeconds_, 0.0); }

    // The pose to draw a body at; its present pose if it did not move.
    Pose PoseOf(BodyId id) const {
        const Pose now = system_.Bodies().GetPose(id);
        if (id.index >= kept_.size() || kept_[id.index].id != id || kept_[id.index].step != steps_) return now;
        const Pose& before = kept_[id.index].before;
        const double part = Part();
        const Vector3 turn = RotationVectorOf<float>(now.rotation * before.rotation.Conjugate());
        return {before.position + (now.position - before.position) * part,
                Normalized(RotationFromVector(Vector3(turn * static_cast<float>(part))) * before.rotation)};
    }

    // After SetPose: it is drawn there at once, without interpolation.
    void Jump(BodyId id) {
        if (id.index < kept_.size()) kept_[id.index] = {};
    }

private:
    struct Kept {
        BodyId id{};
        uint64_t step = 0;  // after which `now` was taken
        Pose before{}, now{};
    };

    // The pose of a moved body before this step is that after the last step in which it moved.
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
