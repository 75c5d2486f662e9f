// Several threads and one world: queries and getters beside a step, changes that are seen as a whole, and a time of all
// of it at once, for ThreadSanitizer. FULCRUM_STRESS_SECONDS sets how long, 3 s by default.
#include <Fulcrum/UnitTests/Support/Deadline.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <future>
#include <mutex>
#include <string>
#include <thread>

namespace fulcrum::testing {
namespace {

constexpr double kDeadline = 60;  // s

// Bodies of several shapes that fall onto each other, fast enough that steps move them out of their fat bounds; some
// fall asleep, some are sensors, some collide continuously.
struct Heap {
    TestWorld world;
    std::vector<BodyId> ids;
    std::vector<ShapePtr> shapes = {
        SphereOf(0.3f), CubeOf(0.3f), CapsuleOf(0.3f, 0.2f),
        CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.4f, 0, 0}}})};

    explicit Heap(uint32_t threads, int count = 120) : world({}, threads) {
        world.AddFloor();
        RandomPoses random(3);
        for (int i = 0; i < count; ++i) ids.push_back(world.Add(Settings(random, i)));
    }
    BodySettings Settings(RandomPoses& random, int i) {
        const Vector3 at = random.InBox(3), velocity = random.InBox(12);
        return {.shape = shapes[static_cast<size_t>(i) % shapes.size()],
                .motion = i % 17 == 0 ? MotionType::Kinematic : MotionType::Dynamic,
                .position = (at + Vector3(0, 4, 0)).cast<double>(),
                .rotation = random.Rotation(),
                .linearVelocity = velocity,
                .layer = static_cast<uint8_t>(i % 3),
                .continuous = i % 4 == 0 ? ContinuousCollision::Linear : ContinuousCollision::Off,
                .isSensor = i % 4 != 0 && i % 13 == 0};
    }
};

// What many queries and getters return, as bits.
struct Seen {
    std::vector<WorldRayHit> rays;
    std::vector<uint8_t> shapes;
    std::vector<float> distances;
    std::vector<OverlapHit> overlaps;
    std::vector<Pose> poses;
    std::vector<BodyBounds> bounds;

    bool operator==(const Seen& other) const {
        const auto same = [](const auto& a, const auto& b, const auto& equal) {
            return std::equal(a.begin(), a.end(), b.begin(), b.end(), equal);
        };
        return same(rays, other.rays,
                    [](const WorldRayHit& a, const WorldRayHit& b) {
                        return a.body == b.body && a.fraction == b.fraction && a.normal == b.normal;
                    }) &&
               shapes == other.shapes && distances == other.distances && overlaps == other.overlaps &&
               same(poses, other.poses,
                    [](const Pose& a, const Pose& b) {
                        return a.position == b.position && a.rotation.x == b.rotation.x && a.rotation.w == b.rotation.w;
                    }) &&
               same(bounds, other.bounds,
                    [](const BodyBounds& a, const BodyBounds& b) { return a.lower == b.lower && a.upper == b.upper; });
    }
};

Seen Look(Heap& heap, std::span<const BodyId> ids) {
    Seen seen;
    RandomPoses random(8);
    const QueryInterface& queries = heap.world.System().Queries();
    const auto held = queries.Hold(HoldFor::Queries);
    std::vector<Ray> rays(100);
    for (Ray& ray : rays) {
        const Vector3 from = random.InBox(5), to = random.InBox(5);
        ray = {(from + Vector3(0, 3, 0)).cast<double>(), to - from};
    }
    seen.rays.resize(rays.size());
    queries.CastRays(rays, seen.rays, {}, {.layers = 3, .sensors = true});
    for (int i = 0; i < 30; ++i) {
        const Vector3 at = random.InBox(4) + Vector3(0, 3, 0), way = random.InBox(4);
        const Quaternion rotation = random.Rotation();
        const ShapePtr& shape = heap.shapes[static_cast<size_t>(i) % 3];
        const PlacedShape placed{shape.get(), {at.cast<double>(), rotation}};
        seen.shapes.push_back(queries.IsHit(MovingShape{
            .shape = static_cast<const ConvexShape*>(shape.get()), .pose = placed.pose, .displacement = way}));
        WorldClosest closest;
        seen.distances.push_back(queries.FindClosest(placed, 5, closest) ? closest.distance : -100.0f);
        std::vector<OverlapHit> found;
        queries.FindOverlaps(placed, found);
        seen.overlaps.insert(seen.overlaps.end(), found.begin(), found.end());
    }
    for (const BodyId id : ids) {
        seen.poses.push_back(heap.world.System().LockingBodies().GetPose(id));
        seen.bounds.push_back(heap.world.System().LockingBodies().GetBounds(id));
    }
    return seen;
}

// In each stage between the first and Store, and in Continuous, another thread looks, and the step waits for it: if the
// step kept queries out, nobody would return.
TEST(WorldThreads, QueriesDuringAStepSeeTheStateOfTheLastOne) {
    struct Observer : StepObserver {
        Heap& heap;
        Seen before;
        int looked = 0;
        explicit Observer(Heap& h) : heap(h) {}
        void BeginStage(int, const char* name) override {
            const std::string stage = name;
            for (const char* inside :
                 {"FindPairs", "Collide", "Color", "BuildIslands", "Prepare", "Solve", "Store", "Continuous"}) {
                if (stage != inside) continue;
                const Seen now = std::async(std::launch::async, [this] { return Look(heap, heap.ids); }).get();
                EXPECT_TRUE(now == before) << stage;
                ++looked;
            }
        }
    };
    Within(kDeadline, [] {
        Heap heap(2);
        Observer observer(heap);
        heap.world.System().SetStepObserver(&observer);
        for (int step = 0; step < 25; ++step) {
            observer.before = Look(heap, heap.ids);
            heap.world.Step();
        }
        EXPECT_EQ(observer.looked, 25 * 8);
        heap.world.System().SetStepObserver(nullptr);
    });
}

// In the middle of continuous collision, when some hits have been resolved, and bodies that slept are hit. What the
// step itself calls back sees the poses to which the bodies have moved.
TEST(WorldThreads, QueriesDuringContinuousCollisionSeeTheStateOfTheLastStep) {
    struct Observer : StepObserver, ContactListener {
        Heap& heap;
        Seen before;
        bool isContinuous = false;
        mutable int looked = 0, moved = 0;
        explicit Observer(Heap& h) : heap(h) {}
        void BeginStage(int, const char* name) override { isContinuous = std::string(name) == "Continuous"; }
        void ModifyContact(const ContactView& contact, ContactChange&) const override {
            if (!isContinuous) return;
            const Seen now = std::async(std::launch::async, [this] { return Look(heap, heap.ids); }).get();
            EXPECT_TRUE(now == before);
            const Pose own = heap.world.Bodies().GetPose(contact.bodyA);
            const auto at = std::ranges::find(heap.ids, contact.bodyA) - heap.ids.begin();
            if (at < std::ssize(heap.ids)) moved += !(own.position == before.poses[static_cast<size_t>(at)].position);
            ++looked;
        }
    };
    Within(kDeadline, [] {
        Heap heap(1, 60);
        Observer observer(heap);
        PhysicsSystem& system = heap.world.System();
        system.SetContactListener(&observer);
        system.SetStepObserver(&observer);
        RandomPoses random(5);
        for (int step = 0; step < 40; ++step) {
            // Bullets, also into those that sleep.
            for (size_t i = 0; step % 4 == 0 && i < heap.ids.size(); i += 8) {
                const Vector3 velocity = random.InBox(120);
                EXPECT_TRUE(system.Bodies().SetVelocity(heap.ids[i], velocity, {}));
            }
            observer.before = Look(heap, heap.ids);
            heap.world.Step();
        }
        EXPECT_GT(observer.looked, 40);
        EXPECT_GT(observer.moved, 20);
        system.SetStepObserver(nullptr);
        system.SetContactListener(nullptr);
    });
}

// The same bits, whether anybody looks or not.
TEST(WorldThreads, QueriesDuringStepsDoNotChangeThem) {
    Within(kDeadline, [] {
        Heap alone(1), watched(2);
        std::atomic<bool> stop{false};
        std::thread watcher([&] {
            while (!stop) static_cast<void>(Look(watched, watched.ids));
        });
        for (int step = 0; step < 60; ++step) {
            alone.world.Step();
            watched.world.Step();
            EXPECT_EQ(alone.world.System().HashState(), watched.world.System().HashState()) << step;
        }
        stop = true;
        watcher.join();
    });
}

// Velocities change while a step solves: their getters wait for its end. Poses do not.
TEST(WorldThreads, LockingGettersOfVelocitiesWaitForTheStep) {
    struct Observer : StepObserver {
        PhysicsSystem& system;
        BodyId id;
        std::future<Vector3> velocity;
        std::atomic<bool> isDone{false};
        Observer(PhysicsSystem& s, BodyId b) : system(s), id(b) {}
        void BeginStage(int, const char* name) override {
            if (std::string(name) == "Collide") {
                velocity = std::async(std::launch::async, [this] {
                    const Vector3 v = system.LockingBodies().GetLinearVelocity(id);
                    isDone = true;
                    return v;
                });
                EXPECT_EQ(std::async(std::launch::async, [this] { return system.LockingBodies().GetPose(id); })
                              .get()
                              .position.y(),
                          10);
            } else if (std::string(name) == "Store") {
                EXPECT_FALSE(isDone);
            }
        }
    };
    Within(kDeadline, [] {
        TestWorld world;
        const BodyId ball = world.Add({.shape = SphereOf(1), .position = {0, 10, 0}});
        Observer observer(world.System(), ball);
        world.System().SetStepObserver(&observer);
        world.Step();
        EXPECT_NEAR(observer.velocity.get().y(), -kGravity * kStep, 1e-6);
        world.System().SetStepObserver(nullptr);
        // In a query's callback it would wait for a step that waits for the query.
        static int refused;
        refused = 0;
        SetMisuseHandler([](const Error& error) { refused += error.code == ErrorCode::NotAllowedHere; });
        world.System().Queries().VisitRay({{0, 30, 0}, {0, -40, 0}}, [&](const WorldRayHit& hit) {
            EXPECT_EQ(world.System().LockingBodies().GetLinearVelocity(hit.body).y(), 0);
            EXPECT_NE(world.System().LockingBodies().GetPose(hit.body).position.y(), 0);
            return 1.0f;
        });
        EXPECT_EQ(refused, 1);
        const auto held = world.System().Queries().Hold();
        world.System().Queries().VisitRay({{0, 30, 0}, {0, -40, 0}}, [&](const WorldRayHit& hit) {
            EXPECT_NE(world.System().LockingBodies().GetLinearVelocity(hit.body).y(), 0);
            return 1.0f;
        });
        EXPECT_EQ(refused, 1);
        SetMisuseHandler(nullptr);
    });
}

// Two bodies that change places again and again are never seen at one.
TEST(WorldThreads, ChangesUnderHoldForChangesAreSeenTogether) {
    Within(kDeadline, [] {
        TestWorld world({}, 2);
        const BodyId a = world.Add({.shape = SphereOf(0.4f), .motion = MotionType::Static, .position = {0, 0, 0}}),
                     b = world.Add({.shape = SphereOf(0.4f), .motion = MotionType::Static, .position = {5, 0, 0}});
        std::atomic<bool> stop{false};
        std::atomic<int> looks{0};
        std::thread watcher([&] {
            const QueryInterface& queries = world.System().Queries();
            std::vector<OverlapHit> left, right;
            while (!stop) {
                const auto held = queries.Hold(HoldFor::Queries);
                queries.FindBodiesAt(Position(0, 0, 0), left);
                queries.FindBodiesAt(Position(5, 0, 0), right);
                EXPECT_EQ(left.size(), 1u);
                EXPECT_EQ(right.size(), 1u);
                ++looks;
            }
        });
        for (int i = 0; i < 200 || looks < 100; ++i) {
            {
                const auto held = world.System().HoldForChanges();
                ASSERT_TRUE(world.Bodies().SetPose(a, {i % 2 ? 0.0 : 5.0, 0, 0}, {}));
                // What is held may also be read and queried by the thread that holds it.
                EXPECT_EQ(world.System().LockingBodies().GetPose(a).position, world.Bodies().GetPose(a).position);
                WorldRayHit hit;
                EXPECT_TRUE(world.System().Queries().CastRay({{5, 3, 0}, {0, -6, 0}}, hit) || i % 2);
                ASSERT_TRUE(world.Bodies().SetPose(b, {i % 2 ? 5.0 : 0.0, 0, 0}, {}));
                if (i % 8 == 0) world.Step();
            }
            if (i % 3 == 0) world.Step();
        }
        stop = true;
        watcher.join();
    });
}

TEST(WorldThreads, CallbacksOfQueriesMustNotChangeWhatIsHeldForChanges) {
    TestWorld world;
    const BodyId ball = world.Add({.shape = SphereOf(1)});
    const auto held = world.System().HoldForChanges();
    int asked = 0;
    world.System().Queries().VisitRay({{0, 3, 0}, {0, -6, 0}}, [&](const WorldRayHit& hit) {
        EXPECT_FALSE(world.Bodies().SetVelocity(hit.body, Vector3(1, 0, 0), Vector3::Zero()));
        return ++asked, 1.0f;
    });
    EXPECT_EQ(asked, 1);
    EXPECT_TRUE(world.Bodies().SetVelocity(ball, Vector3(1, 0, 0), Vector3::Zero()));
}

// A thread that steps without pause leaves room for all others.
TEST(WorldThreads, NobodyStarves) {
    Within(kDeadline, [] {
        Heap heap(1, 20);
        std::atomic<bool> stop{false};
        std::thread stepping([&] {
            while (!stop) heap.world.Step();
        });
        for (int i = 0; i < 50; ++i) {
            WorldRayHit hit;
            heap.world.System().Queries().CastRay({{0, 30, 0}, {0, -40, 0}}, hit);
            { const auto held = heap.world.System().Queries().Hold(); }
            EXPECT_TRUE(heap.world.Bodies().SetUserData(heap.ids[0], 7));
        }
        stop = true;
        stepping.join();
    });
}

double StressSeconds() {
    const char* given = std::getenv("FULCRUM_STRESS_SECONDS");
    return given ? std::atof(given) : 3;
}

// Two threads add and remove, two change, three ask, one steps. Nothing must race, deadlock or become infinite.
TEST(WorldThreads, EditCastAndStepAtOnce) {
    const double seconds = StressSeconds();
    Within(kDeadline + 3 * seconds, [&] {
        Heap heap(2);
        PhysicsSystem& system = heap.world.System();
        std::atomic<bool> stop{false};
        std::atomic<uint64_t> edits{0}, asked{0};
        std::mutex mutex;  // of the ids
        const auto allIds = [&] {
            const std::lock_guard guard(mutex);
            return heap.ids;
        };
        const auto anyId = [&](RandomPoses& random) {
            const std::lock_guard guard(mutex);
            return heap.ids[random.Below(static_cast<uint32_t>(heap.ids.size()))];
        };
        std::vector<std::thread> threads;
        for (uint32_t t = 0; t < 2; ++t)
            threads.emplace_back([&, t] {
                RandomPoses random(50 + t);
                for (int i = 0; !stop; ++i) {
                    std::vector<BodySettings> bodies;
                    for (int k = 0; k < 5; ++k)
                        bodies.push_back(heap.Settings(random, static_cast<int>(random.Below(1000))));
                    bodies[0].motion = MotionType::Dynamic;
                    PointJointSettings joint;
                    joint.bodyA = BodyBatch::Body(0);
                    joint.bodyB = BodyBatch::Body(1);
                    joint.anchorA.point = bodies[0].position;
                    const BodyBatch batch = BodyBatch::Prepare(std::move(bodies), {joint}).Value();
                    const std::vector<BodyId> ids = system.Bodies().Commit(batch).Value().bodies;
                    std::vector<BodyId> old;
                    {
                        const std::lock_guard guard(mutex);
                        for (const BodyId id : ids) {
                            const size_t at = random.Below(static_cast<uint32_t>(heap.ids.size()));
                            old.push_back(std::exchange(heap.ids[at], id));
                        }
                    }
                    const auto held = system.HoldForChanges();
                    for (const BodyId id : old) EXPECT_TRUE(system.Bodies().Remove(id));
                    edits += 2;
                }
            });
        for (uint32_t t = 0; t < 2; ++t)
            threads.emplace_back([&, t] {
                RandomPoses random(70 + t);
                while (!stop) {
                    const BodyId id = anyId(random), other = anyId(random);
                    const Vector3 v = random.InBox(5);
                    static_cast<void>(system.Bodies().SetVelocity(id, v, v));
                    static_cast<void>(system.Bodies().AddImpulse(id, v));
                    static_cast<void>(system.Bodies().SetLayer(other, static_cast<uint8_t>(random.Below(3))));
                    static_cast<void>(system.Bodies().SetMaterial(id, {.friction = random.Between(0, 1)}));
                    static_cast<void>(system.Bodies().SetShape(other, heap.shapes[random.Below(3)]));
                    const BodySettings place = heap.Settings(random, 1);
                    static_cast<void>(system.Bodies().SetPose(id, place.position, place.rotation));
                    static_cast<void>(
                        system.Bodies().AddRadialImpulse({.center = place.position, .radius = 2, .impulse = 3}));
                    if (random.Chance(0.2f)) {
                        PointJointSettings joint;
                        joint.bodyA = id;
                        joint.bodyB = other;
                        if (const auto made = system.Joints().Create(joint)) {
                            std::this_thread::yield();
                            static_cast<void>(system.Joints().Remove(made.Value()));
                        }
                    }
                    edits += 7;
                }
            });
        for (uint32_t t = 0; t < 3; ++t)
            threads.emplace_back([&, t] {
                RandomPoses random(90 + t);
                while (!stop) {
                    static_cast<void>(Look(heap, allIds()));
                    const BodyId id = anyId(random);
                    const BodyInterface& bodies = system.LockingBodies();
                    if (bodies.Exists(id)) {
                        EXPECT_TRUE(IsFinite(bodies.GetPose(id).position));
                        EXPECT_TRUE(IsFinite(bodies.GetLinearVelocity(id)));
                        static_cast<void>(bodies.GetBounds(id));
                        static_cast<void>(bodies.IsAwake(id));
                        static_cast<void>(bodies.GetGravity(id));
                        static_cast<void>(bodies.GetLayer(id));
                        static_cast<void>(bodies.GetShape(id));
                    }
                    if (random.Chance(0.1f)) {
                        const auto held = system.Queries().Hold();
                        system.VisitContacts([](const ContactView& view) { EXPECT_TRUE(IsFinite(view.normal)); });
                    }
                    if (random.Chance(0.02f)) {
                        EXPECT_NE(system.HashState(), 0u);
                    }
                    ++asked;
                }
            });
        uint64_t steps = 0;
        for (const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
             std::chrono::steady_clock::now() < end || asked < 10 || edits < 100; ++steps)
            ASSERT_TRUE(system.Update(kStep));
        stop = true;
        for (std::thread& thread : threads) thread.join();
        EXPECT_TRUE(heap.world.AllFinite());
        RecordProperty("steps", static_cast<int>(steps));
        RecordProperty("edits", static_cast<int>(edits));
        RecordProperty("asked", static_cast<int>(asked));
    });
}

}  // namespace
}  // namespace fulcrum::testing
