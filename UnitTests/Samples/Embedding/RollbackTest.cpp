// Two peers play one world over a line with a delay: each steps at once, guessing that the other goes on as before, and
// goes back where it did not.
#include <Fulcrum/Samples/Embedding/Rollback.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <array>
#include <deque>

namespace fulcrum::testing {
namespace {

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
    void Step(const std::array<Input, 2>& inputs) {
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

using Peer = samples::RollbackPeer<Input>;

struct Player {
    explicit Player(size_t player)
        : peer(game.System(), player, [this](const std::array<Input, 2>& inputs) { game.Step(inputs); }) {}
    Game game;
    Peer peer;
};

// delays: of the line to each player, in frames. Returns how often the two went back.
int Play(int steps, const int (&delays)[2]) {
    Player first(0), second(1);
    Player* const players[2] = {&first, &second};
    std::deque<std::pair<int, Input>> lines[2];  // to each, with the time at which it comes
    for (int time = 0; first.peer.Known() < steps || second.peer.Known() < steps; ++time) {
        for (size_t i = 0; i < 2; ++i) {
            Peer& peer = players[i]->peer;
            if (peer.Now() < steps && peer.MayAdvance()) {
                const Input own = InputOf(static_cast<int>(i), peer.Now());
                EXPECT_TRUE(peer.Advance(own));
                lines[1 - i].emplace_back(time + delays[1 - i], own);
            }
            for (; !lines[i].empty() && lines[i].front().first <= time; lines[i].pop_front())
                EXPECT_TRUE(peer.Receive(lines[i].front().second));
        }
    }
    Game game;
    for (int frame = 0; frame < steps; ++frame) game.Step({InputOf(0, frame), InputOf(1, frame)});
    for (Player* player : players) {
        EXPECT_EQ(player->peer.Now(), steps);
        EXPECT_EQ(player->game.System().HashState(), game.System().HashState());
    }
    return first.peer.Rollbacks() + second.peer.Rollbacks();
}

TEST(Rollback, TwoPeersThatGuessEndWhereOneWorldEnds) { EXPECT_GT(Play(200, {7, 7}), 20); }

// One hears the other late, and never has to wait; a line that is slower than what is kept makes it wait.
TEST(Rollback, LinesMayBeUnevenAndSlow) {
    EXPECT_GT(Play(120, {12, 1}), 10);
    EXPECT_GT(Play(120, {30, 30}), 10);
}

}  // namespace
}  // namespace fulcrum::testing
