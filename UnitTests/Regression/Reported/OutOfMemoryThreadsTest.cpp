// A step that runs out of memory, wherever, leaves a world that says so at each later call, that can be destroyed, and
// that a snapshot makes as good as one that never did.
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/FailingMemory.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

namespace fulcrum::testing {
namespace {

std::atomic<int> reports{0};
void CountBroken(const Error& error) { reports += error.code == ErrorCode::BrokenWorld; }

struct Reporting {
    Reporting() { SetMisuseHandler(CountBroken); }
    ~Reporting() { SetMisuseHandler(nullptr); }
};

// A scene, and the step that runs out of memory.
struct Scene {
    std::string name;
    std::function<void(PhysicsSystem&)> fill;
    int stepsBefore = 0;
    std::function<void(PhysicsSystem&)> justBefore = [](PhysicsSystem&) {};
    SystemSettings settings{};
};

BodyId Add(PhysicsSystem& system, const BodySettings& settings) { return system.Bodies().Create(settings).Value(); }

void AddFloor(PhysicsSystem& system) {
    static const ShapePtr kFloor = BoxOf(50, 0.5f, 50);
    Add(system, {.shape = kFloor, .motion = MotionType::Static, .position = {0, -0.5, 0}});
}
void AddMesh(PhysicsSystem& system) {
    static const ShapePtr kMesh = [] {
        std::vector<Vector3> points;
        std::vector<uint32_t> corners;
        for (int i = 0; i < 9; ++i)
            points.push_back({4.0f * float(i % 3) - 4, i == 4 ? -0.2f : 0, 4.0f * float(i / 3) - 4});
        for (const uint32_t i : {0u, 1u, 3u, 4u}) corners.insert(corners.end(), {i, i + 3, i + 1, i + 1, i + 3, i + 4});
        return TriangleMesh::Create({.vertices = points, .indices = corners}).Value();
    }();
    Add(system, {.shape = kMesh, .motion = MotionType::Static});
}
const ShapePtr& Cube() {
    static const ShapePtr kCube = CubeOf(0.3f);
    return kCube;
}
const ShapePtr& Pair() {
    static const ShapePtr kPair =
        CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.4f, 0, 0}}});
    return kPair;
}
void AddPile(PhysicsSystem& system, int count) {
    for (int i = 0; i < count; ++i)
        Add(system, {.shape = i % 4 == 3 ? Pair() : Cube(), .position = {0.1 * (i % 2), 0.29 + 0.58 * i, 0}});
}
void AddChain(PhysicsSystem& system, int count, float lastMass) {
    BodyId last = kWorldBody;
    for (int i = 0; i < count; ++i) {
        const BodyId id =
            Add(system, {.shape = Cube(), .position = {6 + 0.8 * i, 5, 0}, .mass = i + 1 == count ? lastMass : 1.0f});
        HingeJointSettings hinge;
        hinge.bodyA = last;
        hinge.bodyB = id;
        hinge.anchorA.point = {5.6 + 0.8 * i, 5, 0};
        hinge.anchorA.axis = {0, 0, 1};
        hinge.anchorA.normal = Vector3(0, 1, 0);
        if (i == 0) hinge.breakForce = 1e-3f;
        EXPECT_TRUE(system.Joints().Create(hinge));
        last = id;
    }
}
void AddFast(PhysicsSystem& system) {
    Add(system, {.shape = BoxOf(0.05f, 2, 2), .motion = MotionType::Static, .position = {2, 2, 0}});
    for (int i = 0; i < 4; ++i)
        Add(system, {.shape = i % 2 ? Pair() : Cube(),
                     .position = {0, 0.6 + i, 0},
                     .linearVelocity = {300, 0, 0},
                     .continuous = ContinuousCollision::LinearAndAngular});
}
void AddSensor(PhysicsSystem& system) {
    Add(system, {.shape = CubeOf(1), .motion = MotionType::Static, .position = {0, 1, 0}, .isSensor = true});
}

SystemSettings Everything() {
    SystemSettings settings;
    settings.events.contacts = settings.events.bodies = true;
    settings.measuresErrors = true;
    return settings;
}
SystemSettings SoonAsleep() {
    SystemSettings settings = Everything();
    settings.sleep.seconds = 0.05f;
    return settings;
}

std::vector<Scene> Scenes() {
    std::vector<Scene> scenes = {
        {"first step of a pile",
         [](PhysicsSystem& s) {
             AddFloor(s);
             AddPile(s, 8);
         },
         0, [](PhysicsSystem&) {}, Everything()},
        {"mesh, sensor, continuous collision",
         [](PhysicsSystem& s) {
             AddMesh(s);
             AddPile(s, 3);
             AddFast(s);
             AddSensor(s);
         },
         0, [](PhysicsSystem&) {}, Everything()},
        {"the same one step later",
         [](PhysicsSystem& s) {
             AddMesh(s);
             AddPile(s, 3);
             AddFast(s);
             AddSensor(s);
         },
         1, [](PhysicsSystem&) {}, Everything()},
        {"a chain with a load, of which a joint breaks", [](PhysicsSystem& s) { AddChain(s, 12, 500); }},
        {"a sleeper that is hit",
         [](PhysicsSystem& s) {
             AddFloor(s);
             for (int i = 0; i < 3; ++i)
                 Add(s, {.shape = Cube(), .position = {1, 0.3 + 0.6 * i, 0}, .startAsleep = true});
             Add(s, {.shape = Cube(), .position = {0.3, 0.3, 0}, .linearVelocity = {9, 0, 0}});
         },
         0, [](PhysicsSystem&) {}, Everything()},
        {"a crowd",
         [](PhysicsSystem& s) {
             for (int i = 0; i < 12; ++i) Add(s, {.shape = Cube(), .position = {0.01 * i, 3, 0}});
         }},
        {"growth, and bodies that are removed",
         [](PhysicsSystem& s) {
             AddFloor(s);
             AddPile(s, 5);
         },
         2,
         [](PhysicsSystem& s) {
             BodyId first;
             s.VisitBodies([&](BodyId id) { first = id.index == 2 ? id : first; });
             EXPECT_TRUE(s.Bodies().Remove(first));
             for (int i = 0; i < 20; ++i)
                 Add(s, {.shape = Cube(), .position = {1 + 0.59 * (i % 5), 0.3 + 0.59 * (i / 5), 0}});
             AddSensor(s);
         },
         Everything()},
    };
    const auto fourBoxes = [](PhysicsSystem& s) {
        AddFloor(s);
        for (int i = 0; i < 4; ++i) Add(s, {.shape = Cube(), .position = {1.0 * i, 0.3, 0}});
    };
    for (int steps = 1; steps < 7; ++steps)
        scenes.push_back({"falling asleep", fourBoxes, steps, [](PhysicsSystem&) {}, SoonAsleep()});
    return scenes;
}

// What a world that never ran out of memory does, from the snapshot just before the step.
struct Course {
    std::vector<std::byte> snapshot;
    std::vector<ShapePtr> shapes;
    uint64_t before = 0, after = 0, later = 0;
};

std::unique_ptr<PhysicsSystem> Start(const Scene& scene, JobSystem* jobs, MemoryResource* memory) {
    auto system = PhysicsSystem::Create(scene.settings, jobs, memory).Value();
    scene.fill(*system);
    for (int i = 0; i < scene.stepsBefore; ++i) EXPECT_TRUE(system->Update(kStep));
    scene.justBefore(*system);
    return system;
}

Course CourseOf(const Scene& scene) {
    const auto system = Start(scene, nullptr, nullptr);
    Course course;
    EXPECT_TRUE(system->SaveSnapshot(course.snapshot));
    course.before = system->HashState();
    EXPECT_TRUE(system->Update(kStep));
    course.after = system->HashState();
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(system->Update(kStep));
    course.later = system->HashState();
    return course;
}

template <class T>
bool IsRefused(const Result<T>& result) {
    return !result && result.GetError().code == ErrorCode::BrokenWorld;
}

// Each kind of call.
void ExpectBroken(PhysicsSystem& system) {
    EXPECT_TRUE(IsRefused(system.Update(kStep)));
    EXPECT_TRUE(IsRefused(system.Bodies().Create({.shape = Cube()})));
    EXPECT_TRUE(IsRefused(system.Bodies().SetPose({0, 0}, {0, 0, 0}, {})));
    EXPECT_TRUE(IsRefused(system.Joints().Create(PointJointSettings{})));
    EXPECT_TRUE(IsRefused(system.SetSettings({})));
    std::vector<std::byte> bytes;
    EXPECT_TRUE(IsRefused(system.SaveSnapshot(bytes)));
    reports = 0;
    WorldRayHit hit;
    EXPECT_FALSE(system.Queries().CastRay({{0, 10, 0}, {0, -20, 0}}, hit));
    EXPECT_EQ(system.HashState(), 0u);
    EXPECT_FALSE(system.Bodies().Exists({0, 0}));
    EXPECT_FALSE(system.LockingBodies().Exists({0, 0}));
    EXPECT_FALSE(system.Joints().Exists({0, 0}));
    EXPECT_TRUE(system.Events().contacts.empty());
    EXPECT_TRUE(system.SensorEvents().empty());
    system.VisitContacts([](const ContactView&) {});
    EXPECT_EQ(reports, 8);
}

void ExpectGoodAgain(const Scene& scene, const Course& course, PhysicsSystem& system) {
    ASSERT_TRUE(system.RestoreSnapshot(course.snapshot)) << scene.name;
    EXPECT_EQ(system.HashState(), course.before) << scene.name;
    ASSERT_TRUE(system.Update(kStep)) << scene.name;
    EXPECT_EQ(system.HashState(), course.after) << scene.name;
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(system.Update(kStep));
    EXPECT_EQ(system.HashState(), course.later) << scene.name;
}

// Whether the step took place when its n-th request failed.
bool TryStep(const Scene& scene, const Course& course, JobSystem* jobs, int64_t n) {
    FailingMemory memory;
    bool isDone = false;
    {
        const auto system = Start(scene, jobs, &memory);
        memory.FailAt(n);
        try {
            isDone = bool(system->Update(kStep));
        } catch (const std::bad_alloc&) {}
        EXPECT_EQ(isDone, !memory.HasFailed()) << scene.name << ", request " << n;
        memory.FailAt(0);
        if (isDone) {
            EXPECT_EQ(system->HashState(), course.after) << scene.name;
        } else if (n % 3 != 0) {
            ExpectBroken(*system);
            ExpectGoodAgain(scene, course, *system);
        }
    }
    EXPECT_EQ(memory.Bytes(), 0) << scene.name << ", request " << n;
    return isDone;
}

TEST(OutOfMemorySteps, EachRequestOnOneThread) {
    const Reporting reporting;
    int64_t requests = 0;
    for (const Scene& scene : Scenes()) {
        const Course course = CourseOf(scene);
        int64_t n = 1;
        while (n < 2000 && !HasFailure() && !TryStep(scene, course, nullptr, n)) ++n;
        EXPECT_LT(n, 2000) << scene.name;
        requests += n - 1;
    }
    EXPECT_GT(requests, 300);
}

TEST(OutOfMemorySteps, SomeRequestsOnThreeThreads) {
    const Reporting reporting;
    ThreadPool jobs(3);
    for (const Scene& scene : Scenes()) {
        const Course course = CourseOf(scene);
        int64_t n = 1;
        while (!HasFailure() && !TryStep(scene, course, &jobs, n)) n += 1 + n / 4;
    }
}

// Threads of a game, which do not know what to do with an exception: std::terminate.
class NoExceptions final : public JobSystem {
public:
    uint32_t WorkerCount() const override { return 2; }
    void ParallelFor(uint32_t count, uint32_t, FunctionRef<void(JobRange)> job) override {
        if (count == 0) return;
        const uint32_t middle = count / 2;
        std::thread other([&]() noexcept {
            if (middle > 0) job({0, middle, 1});
        });
        RunNoexcept([&] { job({middle, count, 0}); });
        other.join();
    }
    void RunOnWorkers(FunctionRef<void(uint32_t)> job) override {
        std::thread other([&]() noexcept { job(1); });
        RunNoexcept([&] { job(0); });
        other.join();
    }

private:
    template <class Work>
    static void RunNoexcept(const Work& work) noexcept {
        work();
    }
};

TEST(OutOfMemorySteps, InJobsOfTheProgramsOwn) {
    const Reporting reporting;
    NoExceptions jobs;
    const Scene scene = Scenes()[1];
    const Course course = CourseOf(scene);
    for (int64_t n = 1; !HasFailure() && !TryStep(scene, course, &jobs, n); n += 1 + n / 2) {}
}

// A world that is good, too, is broken by a snapshot that it has no room for, and good again with the next.
TEST(OutOfMemorySteps, Restoring) {
    const Reporting reporting;
    for (const Scene& scene : Scenes()) {
        const Course course = CourseOf(scene);
        bool isDone = false;
        for (int64_t n = 1; !isDone && !HasFailure(); n += 1 + n / 8) {
            FailingMemory memory;
            {
                const auto system = Start(scene, nullptr, &memory);
                for (int i = 0; i < 3; ++i) ASSERT_TRUE(system->Update(kStep));
                AddPile(*system, 3);
                const uint64_t before = system->HashState();
                memory.FailAt(n);
                try {
                    isDone = bool(system->RestoreSnapshot(course.snapshot));
                } catch (const std::bad_alloc&) {}
                ASSERT_EQ(isDone, !memory.HasFailed());
                memory.FailAt(0);
                reports = 0;
                const uint64_t now = system->HashState();
                EXPECT_TRUE(reports == 1 || now == (isDone ? course.before : before)) << scene.name << ", " << n;
                ExpectGoodAgain(scene, course, *system);
            }
            EXPECT_EQ(memory.Bytes(), 0);
        }
    }
}

TEST(OutOfMemorySteps, Creating) {
    bool isDone = false;
    for (int64_t n = 1; !isDone && n < 100; ++n) {
        FailingMemory memory;
        memory.FailAt(n);
        try {
            isDone = bool(PhysicsSystem::Create(Everything(), nullptr, &memory));
        } catch (const std::bad_alloc&) {}
        EXPECT_EQ(memory.Bytes(), 0);
    }
    EXPECT_TRUE(isDone);
}

// What the program's own code throws in a step comes out of the step.
TEST(OutOfMemorySteps, AListenerThatThrows) {
    struct Throws final : ContactListener {
        bool ShouldCollide(BodyId, BodyId) const override { throw std::runtime_error("no"); }
    };
    const Reporting reporting;
    for (const uint32_t threads : {1u, 3u}) {
        const Throws listener;
        TestWorld world({}, threads);
        world.System().SetContactListener(&listener);
        AddFloor(world.System());
        AddPile(world.System(), 20);
        EXPECT_THROW((void)bool(world.System().Update(kStep)), std::runtime_error);
        ExpectBroken(world.System());
    }
}

}  // namespace
}  // namespace fulcrum::testing
