// Events after a snapshot was restored are those of the first time: contacts that had begun go on and do not begin
// again, and what slept, moved or was removed since is told likewise.
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>
#include <Fulcrum/UnitTests/Support/ContactEvents.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <string>

namespace fulcrum::testing {
namespace {

std::string Text(BodyId id) { return std::to_string(id.index) + "." + std::to_string(id.generation); }

// The events of the last step, a line each.
std::string EventsOf(const PhysicsSystem& system) {
    const StepEvents& events = system.Events();
    std::string text;
    for (const ContactEvent& event : events.contacts) {
        text += "contact " + Text(event.bodyA) + " " + Text(event.bodyB) + " kind " +
                std::to_string(static_cast<int>(event.kind)) + " impulse " + std::to_string(event.NormalImpulse()) +
                " approach " + std::to_string(event.approachSpeed) + "\n";
    }
    const auto list = [&](const char* what, std::span<const BodyId> ids) {
        text += what;
        for (const BodyId id : ids) text += " " + Text(id);
        text += "\n";
    };
    list("awake", events.awake);
    list("moved", events.moved);
    list("woke", events.woke);
    list("fell asleep", events.fellAsleep);
    return text;
}

// Boxes on a floor, of which one falls onto another, one sleeps and one is to be removed.
struct Heap {
    TestWorld world{WithAllEvents()};
    BodyId floor = world.AddFloor();
    BodyId lower = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    BodyId other = world.Add({.shape = CubeOf(0.5f), .position = {4, 0.5, 0}});
    BodyId falling = world.Add({.shape = CubeOf(0.5f), .position = {0.2, 9, 0}});
};

// What happens in the second that follows: the calls of a user among it.
std::vector<std::string> PlayOn(PhysicsSystem& system, BodyId other) {
    std::vector<std::string> steps;
    for (int i = 0; i < 90; ++i) {
        if (i == 5) {
            EXPECT_TRUE(system.Bodies().Remove(other));
        }
        EXPECT_TRUE(system.Update(kStep));
        steps.push_back(EventsOf(system));
    }
    return steps;
}

TEST(SnapshotEvents, AreThoseOfTheFirstTime) {
    Heap heap;
    heap.world.Run(1.0);  // the lower boxes sleep, the other one falls
    const Bytes bytes = SnapshotOf(heap.world.System());
    const Assets assets(heap.world.System());
    const std::vector<std::string> first = PlayOn(heap.world.System(), heap.other);
    // The box that falls hits, wakes what it hits, and comes to rest; what is removed ends its contact.
    std::string all;
    for (const std::string& step : first) all += step;
    for (const char* kind : {"kind 0", "kind 1", "kind 2"}) EXPECT_NE(all.find(kind), std::string::npos) << kind;
    EXPECT_NE(all.find("woke " + Text(heap.lower)), std::string::npos);

    ASSERT_TRUE(heap.world.System().RestoreSnapshot(bytes));
    EXPECT_TRUE(heap.world.System().Events().contacts.empty());
    EXPECT_EQ(PlayOn(heap.world.System(), heap.other), first);

    // In another world, whose settings asked for no events.
    TestWorld another;
    ASSERT_TRUE(another.System().RestoreSnapshot(bytes, assets.All()));
    EXPECT_EQ(PlayOn(another.System(), heap.other), first);
}

TEST(SnapshotEvents, AContactThatHasBegunIsPartOfTheState) {
    Heap heap;
    heap.world.Run(0.2);
    const uint64_t hash = heap.world.System().HashState();
    const Bytes bytes = SnapshotOf(heap.world.System());
    heap.world.Run(0.1);
    EXPECT_NE(heap.world.System().HashState(), hash);
    ASSERT_TRUE(heap.world.System().RestoreSnapshot(bytes));
    EXPECT_EQ(heap.world.System().HashState(), hash);
    // The same without events is another state.
    SystemSettings settings = heap.world.System().Settings();
    settings.events = {};
    ASSERT_TRUE(heap.world.System().SetSettings(settings));
    EXPECT_NE(heap.world.System().HashState(), hash);
}

}  // namespace
}  // namespace fulcrum::testing
