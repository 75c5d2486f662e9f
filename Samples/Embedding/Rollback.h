// Rollback network code for two players: each peer steps at once, with its own input and a prediction of the other's,
// and rolls back to the first frame with a wrong prediction. One thread; the game transmits the inputs.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <array>
#include <functional>
#include <vector>

namespace fulcrum::samples {

// Input: plain data with ==. The prediction of an unknown input is the last known one.
template <class Input>
class RollbackPeer {
public:
    static constexpr int kMostFrames = 16;  // a peer may be ahead of the last known input of the other

    // step(inputs): a frame of the game with the inputs of both players, in the order of the players; it must do the
    // same in both peers. shapes: of all bodies that the game creates or removes while it runs.
    RollbackPeer(PhysicsSystem& system, size_t player, std::function<void(const std::array<Input, 2>&)> step,
                 std::vector<ShapePtr> shapes = {})
        : system_(system), player_(player), step_(std::move(step)), shapes_(std::move(shapes)) {}

    // Whether the next frame may be played; otherwise the other's input of frame Known() must arrive first.
    bool MayAdvance() const { return now_ - known_ < kMostFrames; }
    // Plays a frame; `own` is to be sent to the other. Only if MayAdvance.
    Status Advance(const Input& own) {
        std::array<Input, 2>& inputs = inputs_[PlaceOf(now_)];
        inputs[player_] = own;
        if (now_ >= known_) inputs[1 - player_] = lastKnown_;
        return Play(now_++);
    }
    // The other's input of the frame Known(); inputs come in order, at most kMostFrames ahead of this peer. Frames with
    // a wrong prediction are played again.
    Status Receive(const Input& input) {
        const int frame = known_++;
        lastKnown_ = input;
        if (frame >= now_) {
            inputs_[PlaceOf(frame)][1 - player_] = input;
            return Done{};
        }
        bool isGuessed = true;
        for (int i = frame; i < now_; ++i) {
            Input& guess = inputs_[PlaceOf(i)][1 - player_];
            isGuessed &= guess == input;
            guess = input;
        }
        if (isGuessed) return Done{};
        ++rollbacks_;
        if (Status status = system_.RestoreSnapshot(frames_[PlaceOf(frame)], {.shapes = shapes_}); !status)
            return status;
        for (int again = frame; again < now_; ++again)
            if (Status status = Play(again); !status) return status;
        return Done{};
    }

    int Now() const { return now_; }      // frames played
    int Known() const { return known_; }  // frames of which the other's input is known
    int Rollbacks() const { return rollbacks_; }

private:
    static size_t PlaceOf(int frame) { return static_cast<size_t>(frame % kMostFrames); }

    Status Play(int frame) {
        if (Status status = system_.SaveSnapshot(frames_[PlaceOf(frame)]); !status) return status;
        step_(inputs_[PlaceOf(frame)]);
        return Done{};
    }

    PhysicsSystem& system_;
    size_t player_;
    std::function<void(const std::array<Input, 2>&)> step_;
    std::vector<ShapePtr> shapes_;
    int now_ = 0, known_ = 0, rollbacks_ = 0;
    Input lastKnown_{};
    std::array<std::array<Input, 2>, kMostFrames> inputs_{};
    std::array<std::vector<std::byte>, kMostFrames> frames_;  // before each of the last frames
};

}  // namespace fulcrum::samples
