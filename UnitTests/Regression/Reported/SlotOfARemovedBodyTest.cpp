// A body that was removed keeps its contacts until the next step. What a program changes in between, and what would
// wake a body that lost a contact by it, must not wake one that is gone: the next body at its index would be moved by
// each step, although it was created asleep.
#include <Fulcrum/Physics/GroupFilter.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <functional>
#include <string>

namespace fulcrum::testing {
namespace {

struct Refuser : ContactListener {
    bool ShouldCollide(BodyId, BodyId) const override { return false; }
};
const Refuser kRefuser;

struct Place {
    TestWorld world;
    BodyId floor, neighbor, removed;
};
struct Change {
    const char* name;
    std::function<void(Place&)> make;
};

const std::vector<Change> kChanges = {
    {"none", [](Place&) {}},
    {"a listener that refuses", [](Place& p) { p.world.System().SetContactListener(&kRefuser); }},
    {"layers that do not collide",
     [](Place& p) {
         SystemSettings settings = p.world.System().Settings();
         settings.layerCollides.fill(0);
         EXPECT_TRUE(p.world.System().SetSettings(settings));
     }},
    {"another layer of the floor", [](Place& p) { EXPECT_TRUE(p.world.Bodies().SetLayer(p.floor, 3)); }},
    {"another mask of the floor", [](Place& p) { EXPECT_TRUE(p.world.Bodies().SetCategoryAndMask(p.floor, 2, 0)); }},
    {"another group of the neighbor",
     [](Place& p) {
         const auto filter = GroupFilterTable::Create({{0, 0}}).Value();
         EXPECT_TRUE(p.world.Bodies().SetGroup(p.neighbor, {filter, 0, 0}));
     }},
    {"the floor moves",
     [](Place& p) {
         EXPECT_TRUE(p.world.Bodies().SetPose(p.floor, {0, -9, 0}, {}));
     }},
    {"the neighbor is kinematic",
     [](Place& p) { EXPECT_TRUE(p.world.Bodies().SetMotionType(p.neighbor, MotionType::Kinematic)); }},
    {"the neighbor moves",
     [](Place& p) {
         EXPECT_TRUE(p.world.Bodies().SetPose(p.neighbor, {0, 9, 0}, {}));
     }},
    {"the neighbor wakes", [](Place& p) { EXPECT_TRUE(p.world.Bodies().Wake(p.neighbor)); }},
    {"the neighbor is removed", [](Place& p) { EXPECT_TRUE(p.world.Bodies().Remove(p.neighbor)); }},
    {"the floor is removed", [](Place& p) { EXPECT_TRUE(p.world.Bodies().Remove(p.floor)); }},
    {"the floor has another shape",
     [](Place& p) { EXPECT_TRUE(p.world.Bodies().SetShape(p.floor, BoxOf(1, 1, 1), MassUpdate::Keep)); }},
    {"a joint is removed",
     [](Place& p) {
         p.world.System().Joints().Visit([&](JointId id) { EXPECT_TRUE(p.world.System().Joints().Remove(id)); });
     }},
};

// The next body at the index of a removed one, in the air, asleep.
void ExpectThatItStays(const Change& change, const ShapePtr& shape, bool isJointed, bool wasAsleep, bool early) {
    SCOPED_TRACE(std::string(change.name) + (isJointed ? ", jointed" : "") + (wasAsleep ? ", asleep" : ", awake") +
                 (early ? ", before" : ", after"));
    Place place;
    BodyInterface& bodies = place.world.Bodies();
    place.floor = place.world.AddFloor();
    place.neighbor = place.world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}});
    place.removed = place.world.Add({.shape = shape, .position = {0, 0.5, 0}});
    if (isJointed) {
        FixedJointSettings joint;
        joint.bodyA = place.removed;
        joint.bodyB = place.neighbor;
        joint.anchorA = {.point = {0, 1, 0}};
        (void)place.world.System().Joints().Create(joint).Value();
    }
    place.world.Steps(3);
    ASSERT_TRUE(!wasAsleep || bodies.Sleep(place.removed));
    if (early) change.make(place);
    ASSERT_TRUE(bodies.Remove(place.removed));
    if (!early) change.make(place);
    place.world.Step();

    // One at each index that is free.
    std::vector<BodyId> next;
    std::vector<BodyBits> before;
    do {
        const double x = 50.0 + 5.0 * static_cast<double>(next.size());
        next.push_back(place.world.Add({.shape = shape, .position = {x, 5, 0}, .startAsleep = true}));
        before.push_back(BitsOf(place.world, next.back()));
    } while (next.back().index != place.removed.index && next.size() < 3);
    ASSERT_EQ(next.back().index, place.removed.index);
    place.world.Steps(5);
    for (size_t i = 0; i < next.size(); ++i) {
        EXPECT_FALSE(bodies.IsAwake(next[i]));
        EXPECT_EQ(BitsOf(place.world, next[i]), before[i]);
    }
    // It wakes like any other, and falls once.
    ASSERT_TRUE(bodies.Wake(next.back()));
    place.world.Step();
    EXPECT_NEAR(place.world.VelocityOf(next.back()).y(), -kGravity * kStep, 1e-5);
}

TEST(SlotOfARemovedBody, IsAsleepAgain) {
    const ShapePtr shapes[] = {
        CubeOf(0.5f), CompoundOf({{.shape = CubeOf(0.5f)}, {.shape = SphereOf(0.4f), .position = {0.5f, 0, 0}}})};
    for (const Change& change : kChanges)
        for (const ShapePtr& shape : shapes)
            for (const bool isJointed : {false, true})
                for (const bool wasAsleep : {false, true})
                    for (const bool early : {false, true})
                        ExpectThatItStays(change, shape, isJointed, wasAsleep, early);
}

}  // namespace
}  // namespace fulcrum::testing
