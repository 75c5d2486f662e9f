// Calls that would deadlock, and arguments that crashed: each is refused with an error that says why, and nothing
// changes.
#include <Fulcrum/UnitTests/Support/Deadline.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace fulcrum::testing {
namespace {

// A hit of some body, to be overwritten.
template <class Hit>
Hit Touching() {
    Hit hit;
    hit.body = {7, 7};
    return hit;
}

constexpr double kDeadline = 60;  // s

// Collects the reported errors while it exists.
class Reports {
public:
    Reports() {
        Take();
        SetMisuseHandler([](const Error& error) {
            const std::lock_guard<std::mutex> guard(theMutex);
            theErrors.push_back(error);
        });
    }
    ~Reports() { SetMisuseHandler(nullptr); }
    std::vector<Error> Take() {
        const std::lock_guard<std::mutex> guard(theMutex);
        return std::exchange(theErrors, {});
    }

private:
    static inline std::mutex theMutex;
    static inline std::vector<Error> theErrors;
};

// Runs a function whenever it is called.
class Listener final : public ContactListener {
public:
    explicit Listener(std::function<void()> act) : act_(std::move(act)) {}
    bool ShouldCollide(BodyId, BodyId) const override { return act_(), true; }
    void ModifyContact(const ContactView&, ContactChange&) const override {
        act_();
        ++contacts;
    }
    mutable std::atomic<int> contacts{0};

private:
    std::function<void()> act_;
};

class Filter final : public GroupFilter {
public:
    explicit Filter(std::function<void()> act) : act_(std::move(act)) {}
    bool Collides(const Member&, const Member&) const override { return act_(), true; }

private:
    std::function<void()> act_;
};

BodySettings Ball(const Position& position) { return {.shape = SphereOf(0.5f), .position = position}; }

// Enough contacts for all threads.
std::vector<BodyId> AddRow(TestWorld& world) {
    std::vector<BodyId> ids;
    world.AddFloor();
    for (int i = 0; i < 400; ++i) ids.push_back(world.Add(Ball({i * 0.99 - 90, 0.5, 0})));
    return ids;
}

bool IsRefused(const Status& status) {
    return !status && status.GetError().code == ErrorCode::NotAllowedHere && !status.GetError().message.empty();
}

// All that changes a world.
std::vector<std::function<Status()>> Changes(TestWorld& world, BodyId body, BodyId other) {
    BodyInterface& bodies = world.Bodies();
    const auto status = [](const auto& result) -> Status {
        if (!result) return result.GetError();
        return Done{};
    };
    return {[&, status] {
                return status(bodies.Create(Ball({0, 50, 0})));
            },
            [&bodies, body] { return bodies.Remove(body); },
            [&bodies, body] {
                return bodies.SetPose(body, {0, 9, 0}, {});
            },
            [&bodies, body] {
                return bodies.SetVelocity(body, {1, 0, 0}, {0, 0, 0});
            },
            [&bodies, body] {
                return bodies.AddForce(body, {1, 0, 0});
            },
            [&bodies, body] {
                return bodies.AddImpulse(body, {1, 0, 0});
            },
            [&bodies, body] { return bodies.SetMaterial(body, {}); },
            [&bodies, body] { return bodies.SetCategoryAndMask(body, 2, 2); },
            [&bodies, body] { return bodies.SetShape(body, SphereOf(0.4f)); },
            [&bodies, body] { return bodies.Wake(body); },
            [&bodies, body] { return bodies.Sleep(body); },
            [&bodies, body] { return bodies.SetSensor(body, true); },
            [&world, status, body, other] {
                PointJointSettings joint;
                joint.bodyA = body;
                joint.bodyB = other;
                return status(world.System().Joints().Create(joint));
            },
            [&world] { return world.System().SetSettings({}); },
            [&world] { return world.System().Update(kStep); }};
}

TEST(Misuse, QueriesInAListenerAreRefusedAndReported) {
    Within(kDeadline, [] {
        for (uint32_t threads : {1u, 3u}) {
            TestWorld world({}, threads);
            AddRow(world);
            Reports reports;
            std::atomic<int> asked{0}, hits{0};
            const Listener listener([&] {
                WorldRayHit hit;
                ++asked;
                hits += world.System().Queries().CastRay({{0, 10, 0}, {0, -20, 0}}, hit);
            });
            world.System().SetContactListener(&listener);
            world.Steps(2);
            EXPECT_GT(listener.contacts, 400);
            EXPECT_EQ(hits, 0);
            const std::vector<Error> errors = reports.Take();
            EXPECT_EQ(errors.size(), static_cast<size_t>(asked));
            ASSERT_FALSE(errors.empty());
            EXPECT_EQ(errors.front().code, ErrorCode::NotAllowedHere);
            EXPECT_NE(errors.front().message.find("listener"), std::string::npos);
            // Outside they work as usual.
            WorldRayHit hit;
            EXPECT_TRUE(world.System().Queries().CastRay({{0, 10, 0}, {0, -20, 0}}, hit));
            world.System().SetContactListener(nullptr);
        }
    });
}

TEST(Misuse, BatchesInAListenerFindNothing) {
    Within(kDeadline, [] {
        TestWorld world({}, 2);
        AddRow(world);
        Reports reports;
        std::atomic<int> found{0};
        const Listener listener([&] {
            const std::vector<Ray> rays(100, Ray{{0, 10, 0}, {0, -20, 0}});
            std::vector<WorldRayHit> hits(rays.size(), Touching<WorldRayHit>());
            std::vector<uint8_t> isHit(rays.size(), 1);
            world.System().Queries().CastRays(rays, hits);
            world.System().Queries().AreHit(rays, isHit);
            for (const WorldRayHit& hit : hits) found += hit.body != BodyId{};
            for (uint8_t hit : isHit) found += hit;
        });
        world.System().SetContactListener(&listener);
        world.Step();
        EXPECT_EQ(found, 0);
        EXPECT_FALSE(reports.Take().empty());
        world.System().SetContactListener(nullptr);
    });
}

TEST(Misuse, EventsInAListenerAreNone) {
    Within(kDeadline, [] {
        SystemSettings settings;
        settings.events.contacts = true;
        TestWorld world(settings, 2);
        AddRow(world);
        world.Step();
        EXPECT_GT(world.System().Events().contacts.size(), 400u);
        Reports reports;
        std::atomic<size_t> seen{0};
        const Listener listener([&] { seen += world.System().Events().contacts.size(); });
        world.System().SetContactListener(&listener);
        world.Step();
        EXPECT_EQ(seen, 0u);
        const std::vector<Error> errors = reports.Take();
        ASSERT_FALSE(errors.empty());
        EXPECT_EQ(errors.front().code, ErrorCode::NotAllowedHere);
        world.System().SetContactListener(nullptr);
        world.Step();
        EXPECT_GT(world.System().Events().contacts.size(), 400u);
    });
}

TEST(Misuse, ChangesInAListenerAreRefused) {
    Within(kDeadline, [] {
        TestWorld world({}, 3), twin({}, 3);
        const std::vector<BodyId> row = AddRow(world);
        AddRow(twin);
        const auto changes = Changes(world, row[0], row[1]);
        std::atomic<int> refused{0}, accepted{0};
        const Listener listener([&] {
            for (const auto& change : changes) ++(IsRefused(change()) ? refused : accepted);
        });
        const Listener idle([] {});
        world.System().SetContactListener(&listener);
        twin.System().SetContactListener(&idle);
        world.Steps(3);
        twin.Steps(3);
        EXPECT_EQ(accepted, 0);
        EXPECT_GE(refused, static_cast<int>(changes.size()) * 400);
        EXPECT_EQ(world.System().HashPoses(), twin.System().HashPoses());
        Reports reports;
        const Listener replaces([&] { world.System().SetContactListener(nullptr); });
        world.System().SetContactListener(&replaces);
        world.Step();
        EXPECT_GT(replaces.contacts, 0);
        EXPECT_FALSE(reports.Take().empty());
        world.System().SetContactListener(nullptr);
    });
}

TEST(Misuse, QueriesAndChangesInAGroupFilterAreRefused) {
    Within(kDeadline, [] {
        TestWorld world;
        Reports reports;
        int refused = 0, asked = 0;
        std::vector<BodyId> ids;
        const auto filter = std::make_shared<Filter>([&] {
            ++asked;
            refused += IsRefused(world.Bodies().Remove(ids[0]));
            static_cast<void>(world.System().Queries().IsHit(Ray{{0, 10, 0}, {0, -20, 0}}));
        });
        for (double x : {0.0, 0.9})
            ids.push_back(world.Add({.shape = SphereOf(0.5f), .position = {x, 0, 0}, .group = {.filter = filter}}));
        world.Step();
        ASSERT_TRUE(world.Bodies().SetCategoryAndMask(ids[0], 1, ~uint64_t(0)));  // asks about the pair again
        EXPECT_GE(asked, 2);
        EXPECT_EQ(refused, asked);
        EXPECT_EQ(reports.Take().size(), static_cast<size_t>(asked));
    });
}

TEST(Misuse, ChangesUnderHoldAreRefused) {
    Within(kDeadline, [] {
        TestWorld world;
        const std::vector<BodyId> row = AddRow(world);
        world.Step();
        const uint64_t before = world.System().HashPoses();
        {
            const auto held = world.System().Queries().Hold();
            for (const auto& change : Changes(world, row[0], row[1])) EXPECT_TRUE(IsRefused(change()));
        }
        EXPECT_EQ(world.System().HashPoses(), before);
        EXPECT_TRUE(world.Bodies().Remove(row[0]));
        world.Step();
    });
}

TEST(Misuse, ChangesInWhatAQueryCallsBackAreRefused) {
    Within(kDeadline, [] {
        TestWorld world({}, 2);
        const std::vector<BodyId> row = AddRow(world);
        world.Step();
        const auto changes = Changes(world, row[0], row[1]);
        std::atomic<int> refused{0}, accepted{0};
        const auto change = [&] {
            for (const auto& each : changes) ++(IsRefused(each()) ? refused : accepted);
        };
        const QueryInterface& queries = world.System().Queries();
        queries.VisitRay({{0, 10, 0}, {0, -20, 0}}, [&](const WorldRayHit&) { return change(), 1.0f; });
        EXPECT_GT(refused, 0);
        // A predicate, asked by several threads.
        refused = 0;
        const std::vector<Ray> rays(500, Ray{{0, 10, 0}, {0, -20, 0}});
        std::vector<WorldRayHit> hits(rays.size());
        const auto accepts = [&](BodyId) { return change(), true; };
        queries.CastRays(rays, hits, {}, {.accepts = accepts});
        EXPECT_GT(refused, 0);
        EXPECT_EQ(accepted, 0);
        EXPECT_NE(hits[0].body, BodyId{});
    });
}

TEST(Misuse, AnotherThreadMayStillWait) {
    Within(kDeadline, [] {
        TestWorld world;
        const std::vector<BodyId> row = AddRow(world);
        std::atomic<bool> isDone{false};
        std::thread changer;
        {
            const auto held = world.System().Queries().Hold();
            changer = std::thread([&] {
                EXPECT_TRUE(world.Bodies().SetPose(row[0], {0, 9, 0}, {}));
                isDone = true;
            });
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            EXPECT_FALSE(isDone);
        }
        changer.join();
        EXPECT_TRUE(isDone);
    });
}

TEST(Misuse, NullShapesInQueriesFindNothingAndAreReported) {
    TestWorld world;
    AddRow(world);
    world.Step();
    const QueryInterface& queries = world.System().Queries();
    Reports reports;
    WorldShapeHit hit;
    WorldClosest closest;
    std::vector<WorldShapeHit> hits(1);
    std::vector<OverlapHit> overlaps(1);
    MovingShape moving;
    moving.displacement = {0, -1, 0};
    const PlacedShape placed;
    EXPECT_FALSE(queries.CastShape(moving, hit));
    EXPECT_FALSE(queries.IsHit(moving));
    queries.CastShapeAll(moving, hits);
    EXPECT_TRUE(hits.empty());
    queries.VisitShape(moving, [](const WorldShapeHit&) { return ADD_FAILURE(), 1.0f; });
    EXPECT_FALSE(queries.IsOverlapping(placed));
    queries.FindOverlaps(placed, overlaps);
    EXPECT_TRUE(overlaps.empty());
    queries.VisitOverlaps(placed, [](const OverlapHit&) { return ADD_FAILURE(), true; });
    EXPECT_FALSE(queries.FindClosest(placed, 10, closest));
    EXPECT_EQ(reports.Take().size(), 8u);

    std::vector<uint8_t> flags(1, 1);
    std::vector<WorldShapeHit> shapeHits(1, Touching<WorldShapeHit>());
    std::vector<WorldClosest> nearest(1, Touching<WorldClosest>());
    std::vector<std::vector<OverlapHit>> lists;
    std::vector<std::vector<WorldShapeHit>> shapeLists;
    queries.CastShapes({&moving, 1}, shapeHits);
    EXPECT_EQ(shapeHits[0].body, BodyId{});
    queries.AreHit(std::span<const MovingShape>(&moving, 1), flags);
    EXPECT_EQ(flags[0], 0);
    queries.CastShapesAll({&moving, 1}, shapeLists);
    EXPECT_TRUE(shapeLists.at(0).empty());
    flags[0] = 1;
    queries.AreOverlapping({&placed, 1}, flags);
    EXPECT_EQ(flags[0], 0);
    queries.FindOverlaps(std::span<const PlacedShape>(&placed, 1), lists);
    EXPECT_TRUE(lists.at(0).empty());
    queries.FindClosest(std::span<const PlacedShape>(&placed, 1), 10, nearest);
    EXPECT_EQ(nearest[0].body, BodyId{});
    EXPECT_EQ(reports.Take().size(), 6u);
}

TEST(MisuseDeathTest, TheValueOfAnErrorEndsTheProgramWithItsMessage) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    SystemSettings settings;
    settings.boundsMargin = -1;
    EXPECT_DEATH(static_cast<void>(PhysicsSystem::Create(settings).Value()),
                 "Value\\(\\) of an error: boundsMargin is -1");
    const Status done = Done{};
    EXPECT_DEATH(static_cast<void>(done.GetError()), "GetError\\(\\) of a result without an error");
}

}  // namespace
}  // namespace fulcrum::testing
