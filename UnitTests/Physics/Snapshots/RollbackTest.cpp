// Two peers play one world over a line with a delay: each steps at once, guessing that the other goes on as before, and
// goes back where it did not.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <array>
#include <deque>

namespace fulcrum::testing {
namespace {

constexpr int kFrames = 16;  // that are kept: as far as a peer can go back
constexpr int kDelay = 7;    // frames that an input is on its way

// Which way a player pushes.
struct Input {
    int x = 0, z = 0;
    friend bool operator==(const Input&, const Input&) = default;
};

// What the players do: they change their minds from time to time.
Input InputOf(int player, int frame) {
    const auto random = static_cast<uint32_t>(frame / 9 + 100 * player) * 2654435761u;
    return {static_cast<int>(random >> 8 & 3) - 1, static_cast<int>(random >> 16 & 3) - 1};
}

// The game: two balls that players push, and boxes to push about.
class Game {
public:
    Game() {
        world_.AddFloor({.friction = 0.4f});
        for (int player = 0; player < 2; ++player)
            players_.push_back(world_.Add({.shape = SphereOf(0.5f), .position = {4.0 * player - 2, 0.5, 0}}));
        for (int i = 0; i < 40; ++i)
            world_.Add({.shape = CubeOf(0.3f),
                        .position = {0.65 * (i % 5) - 1.3, 0.3 + 0.6 * (i / 20), 1.5 + 0.65 * (i / 5 % 4)}});
    }
    void Step(const Input (&inputs)[2]) {
        for (size_t player = 0; player < 2; ++player) {
            const Vector3 push(static_cast<float>(inputs[player].x), 0, static_cast<float>(inputs[player].z));
            EXPECT_TRUE(world_.Bodies().AddImpulse(players_[player], push * 80.0f));
        }
        world_.Step();
    }
    PhysicsSystem& System() { return world_.System(); }

private:
    TestWorld world_;
    std::vector<BodyId> players_;
};

class Peer {
public:
    explicit Peer(int player) : player_(player) {}

    // A frame with its own input and a guess of the other's. Returns the input, to be sent.
    Input Advance() {
        const Input own = InputOf(player_, now_);
        inputs_.push_back({own, inputs_.empty() ? Input{} : inputs_.back().theirs});
        StepFrame(now_++);
        return own;
    }
    // The other's input of the next frame of which it was not known.
    void Receive(const Input& input) {
        const int frame = known_++;
        const bool wasGuessed = inputs_[static_cast<size_t>(frame)].theirs == input;
        for (int i = frame; i < now_; ++i)
            inputs_[static_cast<size_t>(i)].theirs = input;  // a better guess of those after it
        if (wasGuessed) return;
        ++rollbacks_;
        ASSERT_TRUE(game_.System().RestoreSnapshot(frames_[static_cast<size_t>(frame % kFrames)]));
        for (int again = frame; again < now_; ++again) StepFrame(again);
    }
    uint64_t Hash() { return game_.System().HashState(); }
    int Rollbacks() const { return rollbacks_; }

private:
    struct Inputs {
        Input own, theirs;
    };

    void StepFrame(int frame) {
        ASSERT_TRUE(game_.System().SaveSnapshot(frames_[static_cast<size_t>(frame % kFrames)]));
        const Inputs& inputs = inputs_[static_cast<size_t>(frame)];
        if (player_ == 0) game_.Step({inputs.own, inputs.theirs});
        else game_.Step({inputs.theirs, inputs.own});
    }

    int player_;
    int now_ = 0;    // frames stepped
    int known_ = 0;  // frames of which both inputs are known
    int rollbacks_ = 0;
    std::vector<Inputs> inputs_;                          // by frame
    std::array<std::vector<std::byte>, kFrames> frames_;  // before each of the last frames
    Game game_;
};

TEST(Rollback, TwoPeersThatGuessEndWhereOneWorldEnds) {
    constexpr int kSteps = 200;
    Peer peers[] = {Peer(0), Peer(1)};
    std::deque<Input> lines[2];  // to each
    for (int frame = 0; frame < kSteps + kDelay; ++frame) {
        if (frame < kSteps)
            for (size_t player = 0; player < 2; ++player) lines[1 - player].push_back(peers[player].Advance());
        if (frame < kDelay) continue;
        for (size_t player = 0; player < 2; ++player) {
            peers[player].Receive(lines[player].front());
            lines[player].pop_front();
        }
    }
    Game game;
    for (int frame = 0; frame < kSteps; ++frame) game.Step({InputOf(0, frame), InputOf(1, frame)});
    for (Peer& peer : peers) {
        EXPECT_EQ(peer.Hash(), game.System().HashState());
        EXPECT_GT(peer.Rollbacks(), 10);
    }
}

}  // namespace
}  // namespace fulcrum::testing
