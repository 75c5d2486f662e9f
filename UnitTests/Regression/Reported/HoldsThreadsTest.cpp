// Threads that hold a world: more of them than the lock once counted, and holds that end in another order than they
// began.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/Deadline.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <latch>
#include <memory>
#include <system_error>
#include <thread>

namespace fulcrum::testing {
namespace {

constexpr double kDeadline = 60;  // s
// The lock once counted threads by ten bits. Sanitizers look at what the threads do, which fewer do as well.
constexpr int kThreads = kIsSanitized ? 60 : 1100;

class Threads {
public:
    explicit Threads(const std::function<void(int)>& run) {
        threads_.reserve(kThreads);
        for (int i = 0; i < kThreads; ++i) threads_.emplace_back(run, i);
    }
    ~Threads() {
        for (std::thread& thread : threads_) thread.join();
    }

private:
    std::vector<std::thread> threads_;
};

// Some systems, and containers, have limits. A test that ran into them would wait for threads that never begin.
bool CanStartThreads() {
    std::latch end(1);
    std::vector<std::thread> threads;
    constexpr int kMore = 10;  // beside them
    threads.reserve(kThreads + kMore);
    bool areStarted = true;
    try {
        for (int i = 0; i < kThreads + kMore; ++i) threads.emplace_back([&] { end.wait(); });
    } catch (const std::system_error&) {
        areStarted = false;
    }
    end.count_down();
    for (std::thread& thread : threads) thread.join();
    return areStarted;
}

class ManyThreads : public ::testing::Test {
protected:
    void SetUp() override {
        if (!CanStartThreads()) GTEST_SKIP() << kThreads << " threads cannot be started here";
    }
};

struct Ball {
    TestWorld world;
    BodyId id;
    Ball() { id = world.Add({.shape = SphereOf(1), .position = {0, 5, 0}}); }
    bool IsHit() {
        WorldRayHit hit;
        return world.System().Queries().CastRay({{0, 20, 0}, {0, -20, 0}}, hit);
    }
};

// What a thread holds, until it lets it go.
class Hold {
public:
    virtual ~Hold() = default;
};
template <class Make>
std::unique_ptr<Hold> HoldBy(const Make& make) {
    struct Held final : Hold {
        decltype(make()) held;
        explicit Held(const Make& m) : held(m()) {}
    };
    return std::make_unique<Held>(make);
}

TEST_F(ManyThreads, QueryAtOnceAndThenTheWorldSteps) {
    Within(kDeadline, [] {
        Ball ball;
        std::latch inside(kThreads);
        {
            // Each stays in its query until all are in theirs.
            const Threads threads([&](int i) {
                const QueryInterface& queries = ball.world.System().Queries();
                if (i % 3 == 0) {
                    const auto held = queries.Hold();
                    inside.arrive_and_wait();
                } else {
                    queries.VisitRay({{0, 20, 0}, {0, -20, 0}}, [&](const WorldRayHit&) {
                        inside.arrive_and_wait();
                        return 1.0f;
                    });
                }
            });
            inside.wait();
            ball.world.Step();
        }
        ball.world.Step();
        EXPECT_TRUE(ball.IsHit());
    });
}

TEST_F(ManyThreads, WaitForAChangeAndAreAllLetIn) {
    Within(kDeadline, [] {
        Ball ball;
        std::atomic<int> hits{0}, stepped{0};
        std::unique_ptr<Hold> held = HoldBy([&] { return ball.world.System().HoldForChanges(); });
        std::latch begun(kThreads);
        const Threads threads([&](int i) {
            begun.count_down();
            if (i % 100 == 0) stepped += static_cast<bool>(ball.world.System().Update(kStep));
            else if (i % 3 == 0) hits += ball.world.System().LockingBodies().GetLinearVelocity(ball.id).y() <= 0;
            else hits += ball.IsHit();
        });
        begun.wait();
        held.reset();
        while (hits + stepped < kThreads) std::this_thread::yield();
        EXPECT_EQ(stepped, (kThreads + 99) / 100);
    });
}

TEST_F(ManyThreads, QueryDuringAStep) {
    struct Observer : StepObserver {
        Ball& ball;
        std::atomic<int> hits{0};
        explicit Observer(Ball& b) : ball(b) {}
        void BeginStage(int, const char* name) override {
            if (std::string(name) != "Collide") return;
            std::latch inside(kThreads);
            const Threads threads([&](int) {
                ball.world.System().Queries().VisitRay({{0, 20, 0}, {0, -20, 0}}, [&](const WorldRayHit&) {
                    inside.arrive_and_wait();
                    ++hits;
                    return 1.0f;
                });
            });
        }
    };
    Within(kDeadline, [] {
        Ball ball;
        Observer observer(ball);
        ball.world.System().SetStepObserver(&observer);
        ball.world.Step();
        ball.world.System().SetStepObserver(nullptr);
        EXPECT_EQ(observer.hits, kThreads);
    });
}

// ---- Orders

// Takes its memory from a place of its own, so that it is noticed whose memory is current.
struct OwnMemory : MemoryResource {
    void* Allocate(size_t bytes, size_t alignment) override { return AllocateFrom(nullptr, bytes, alignment); }
    void Deallocate(void* memory, size_t bytes, size_t alignment) override {
        DeallocateTo(nullptr, memory, bytes, alignment);
    }
};

struct TwoWorlds {
    OwnMemory memory[2];
    std::unique_ptr<PhysicsSystem> systems[2] = {PhysicsSystem::Create({}, nullptr, &memory[0]).Value(),
                                                 PhysicsSystem::Create({}, nullptr, &memory[1]).Value()};
};

using MakeHold = std::function<std::unique_ptr<Hold>(TwoWorlds&)>;

template <size_t kWorld>
MakeHold ForQueries() {
    return [](TwoWorlds& worlds) {
        return HoldBy([&] { return worlds.systems[kWorld]->Queries().Hold(HoldFor::Queries); });
    };
}
template <size_t kWorld>
MakeHold ForEverything() {
    return [](TwoWorlds& worlds) { return HoldBy([&] { return worlds.systems[kWorld]->Queries().Hold(); }); };
}
template <size_t kWorld>
MakeHold ForChanges() {
    return [](TwoWorlds& worlds) { return HoldBy([&] { return worlds.systems[kWorld]->HoldForChanges(); }); };
}

// Three holds of two worlds, begun in all combinations, ended in all orders: the world is held to the last of them, and
// then free; the thread's memory is what it was.
TEST(Holds, EndInAnyOrder) {
    Within(kDeadline, [] {
        SetMisuseHandler([](const Error&) {});  // some are refused within others
        const MakeHold makers[] = {ForQueries<0>(), ForEverything<0>(), ForChanges<0>(), ForQueries<1>(),
                                   ForChanges<1>()};
        for (size_t a = 0; a < std::size(makers); ++a)
            for (size_t b = 0; b < std::size(makers); ++b)
                for (size_t c = 0; c < std::size(makers); ++c) {
                    std::array<size_t, 3> order = {0, 1, 2};
                    do {
                        TwoWorlds worlds;
                        std::unique_ptr<Hold> holds[3];
                        size_t next = 0;
                        for (const size_t maker : {a, b, c}) holds[next++] = makers[maker](worlds);
                        for (const size_t i : order) {
                            holds[i].reset();
                            for (const auto& system : worlds.systems) {
                                WorldRayHit hit;
                                EXPECT_FALSE(system->Queries().CastRay({{0, 5, 0}, {0, -5, 0}}, hit));
                            }
                        }
                        EXPECT_EQ(tCurrentMemory, nullptr);
                        for (const auto& system : worlds.systems) {
                            EXPECT_TRUE(system->Update(kStep));
                            // A lock that is still taken would stop the other thread for ever.
                            std::thread([&] { EXPECT_TRUE(system->Update(kStep)); }).join();
                        }
                    } while (std::next_permutation(order.begin(), order.end()));
                }
        SetMisuseHandler(nullptr);
    });
}

TEST(Holds, KeepTheWorldUntilTheLastEnds) {
    Within(kDeadline, [] {
        Ball ball;
        std::atomic<bool> isDone{false};
        const auto hold = [&] { return ball.world.System().Queries().Hold(); };
        std::unique_ptr<Hold> first = HoldBy(hold), second = HoldBy(hold);
        first.reset();
        std::thread other([&] {
            ball.world.System().SetStepObserver(nullptr);
            isDone = true;
        });
        for (int i = 0; i < 1000; ++i) std::this_thread::yield();
        EXPECT_FALSE(isDone);
        EXPECT_FALSE(ball.world.System().Update(kStep));  // it still holds the world
        second.reset();
        other.join();
        EXPECT_TRUE(ball.world.System().Update(kStep));
    });
}

}  // namespace
}  // namespace fulcrum::testing
