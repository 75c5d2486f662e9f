// Keeps a recording of the recent calls in memory, to be saved when something goes wrong: the last steps of a game of
// any length, at a bounded size. One thread.
#pragma once

#include <Fulcrum/Physics/Recording/CallRecorder.h>

#include <array>
#include <memory>
#include <vector>

namespace fulcrum::samples {

class RecentCalls {
public:
    // Keeps at least the last `steps` steps, at most twice as many, in two recordings of which each begins with a
    // snapshot. Must be destroyed before the system.
    explicit RecentCalls(PhysicsSystem& system, uint64_t steps = 600) : system_(system), steps_(steps) {}

    // Call after each step, before the next calls. Errors: those of CallRecorder, which is then tried again after the
    // next step: not every moment can be a beginning (a body's shape has just been removed).
    Status AfterStep() {
        if (recorder_) {
            if (Status status = recorder_->GetStatus(); !status) return status;
            if (++recorded_ < steps_) return Done{};
        }
        recorder_ = nullptr;  // ends the recording
        std::swap(earlier_, now_);
        now_.clear();
        recorded_ = 0;
        auto recorder = CallRecorder::Create(system_, [this](std::span<const std::byte> bytes) {
            now_.insert(now_.end(), bytes.begin(), bytes.end());
            return true;
        });
        if (!recorder) return recorder.GetError();
        recorder_ = std::move(recorder.Value());
        return Done{};
    }

    // Two recordings, for CallRecording::Read or for files: the second goes on where the first, which may be empty,
    // ends. Each is whole up to the last step.
    std::array<std::span<const std::byte>, 2> Recordings() const { return {earlier_, now_}; }

private:
    PhysicsSystem& system_;
    const uint64_t steps_;
    uint64_t recorded_ = 0;
    std::vector<std::byte> earlier_, now_;
    std::unique_ptr<CallRecorder> recorder_;
};

}  // namespace fulcrum::samples
