// The events of a step are the same, in the same order, byte for byte, for any number of threads.
#include <Fulcrum/UnitTests/Support/ContactEvents.h>
#include <Fulcrum/UnitTests/Support/JointScene.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <tuple>

namespace fulcrum::testing {
namespace {

using Kind = ContactEvent::Kind;

// All that events say, but for where it lies in memory.
class Bytes {
public:
    explicit Bytes(const StepEvents& events) {
        for (const ContactEvent& event : events.contacts) {
            Add(std::array{event.bodyA, event.bodyB});
            Add(std::array{event.childA, event.childB, static_cast<uint32_t>(event.kind)});
            Add(std::array{event.time, event.approachSpeed});
            for (const ContactEvent::Manifold& manifold : event.manifolds) {
                Add(manifold.normal);
                Add(manifold.frictionImpulse);
                Add(manifold.twistImpulse);
                Add(std::array{manifold.triangle, manifold.material, manifold.pointCount});
                for (const ContactEvent::Point& point : manifold.points) {
                    Add(point.position);
                    Add(std::array{point.separation, point.impulse});
                }
            }
        }
        for (const std::span<const BodyId> ids : {events.awake, events.moved, events.woke, events.fellAsleep}) {
            Add(ids.size());
            for (const BodyId id : ids) Add(id);
        }
        for (const BrokenJoint& joint : events.brokenJoints) {
            Add(joint.id);
            Add(joint.force);
            Add(joint.torque);
        }
    }
    friend bool operator==(const Bytes&, const Bytes&) = default;

private:
    template <class T>
    void Add(const T& value) {
        unsigned char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
    }
    std::vector<unsigned char> bytes_;
};

// What of it a game might keep: which pairs of pieces touch, by the events alone.
class Touching {
public:
    void Update(const StepEvents& events) {
        const auto sidesOf = [](const ContactEvent& e) { return std::tuple(e.bodyA, e.bodyB, e.childA, e.childB); };
        const ContactEvent* last = nullptr;
        for (const ContactEvent& event : events.contacts) {
            if (last) {
                EXPECT_LE(sidesOf(*last), sidesOf(event));
            }
            last = &event;
            ++counts[static_cast<size_t>(event.kind)];
            if (event.kind == Kind::Begin) {
                EXPECT_TRUE(touches_.insert({sidesOf(event), true}).second);
            }
            if (event.kind == Kind::Stay) {
                EXPECT_EQ(touches_.count(sidesOf(event)), 1u);
            }
            if (event.kind == Kind::End) {
                EXPECT_EQ(touches_.erase(sidesOf(event)), 1u);
            }
            EXPECT_EQ(event.manifolds.empty(), event.kind == Kind::End);
        }
    }
    std::array<int, 4> counts{};  // of events, by kind

private:
    std::map<std::tuple<BodyId, BodyId, uint32_t, uint32_t>, bool> touches_;
};

// Runs a scene with so many threads; each step's events.
template <class Scene>
std::vector<Bytes> Run(const SystemSettings& settings, uint32_t threads, int steps, Touching& touching) {
    TestWorld world(WithAllEvents(settings), threads);
    Scene scene(world);
    for (int i = 0; i < 8; ++i)
        world.Add({.shape = i % 2 ? SphereOf(0.1f) : CubeOf(0.08f),
                   .position = {-30.0 + i, 2.0 + 0.3 * i, 0.1 * i},
                   .linearVelocity = {200, -10, 0},
                   .material = {.restitution = 0.5f},
                   .continuous = ContinuousCollision::Linear});
    std::vector<Bytes> all;
    for (int step = 0; step < steps; ++step) {
        scene.BeforeStep(step);
        world.Step();
        touching.Update(world.System().Events());
        all.emplace_back(world.System().Events());
    }
    return all;
}

template <class Scene>
std::array<int, 4> ExpectTheSame(const SystemSettings& settings, int steps) {
    Touching touching;
    const std::vector<Bytes> one = Run<Scene>(settings, 1, steps, touching);
    for (const uint32_t threads : {2u, 4u}) {
        Touching again;
        const std::vector<Bytes> many = Run<Scene>(settings, threads, steps, again);
        for (size_t step = 0; step < one.size(); ++step) {
            EXPECT_TRUE(one[step] == many[step]) << threads << " threads, step " << step;
            if (!(one[step] == many[step])) break;
        }
        EXPECT_EQ(again.counts, touching.counts);
    }
    return touching.counts;
}

TEST(EventsDeterminism, OfAMixedScene) {
    const auto counts = ExpectTheSame<MixedScene>({}, 120);
    for (const Kind kind : {Kind::Begin, Kind::Stay, Kind::End, Kind::Hit})
        EXPECT_GT(counts[static_cast<size_t>(kind)], 5) << static_cast<int>(kind);
}

TEST(EventsDeterminism, OfASceneOfJoints) {
    const auto counts = ExpectTheSame<JointScene>(JointScene::Settings(), 90);
    EXPECT_GT(counts[static_cast<size_t>(Kind::Stay)], 100);
}

// Nobody asks, and nothing else changes: the same bits with events and without.
TEST(EventsDeterminism, TheyChangeNoResult) {
    uint64_t hashes[2];
    for (const bool asks : {false, true}) {
        TestWorld world(asks ? WithAllEvents() : SystemSettings{}, 2);
        MixedScene scene(world);
        for (int step = 0; step < 120; ++step) {
            scene.BeforeStep(step);
            world.Step();
        }
        hashes[asks] = world.System().HashPoses();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace fulcrum::testing
