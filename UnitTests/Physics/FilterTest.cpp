// Which bodies collide: categories and masks, groups, and what happens when they change.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

struct Ball {
    MotionType motion = MotionType::Dynamic;
    uint64_t category = 1, mask = ~uint64_t(0);
    CollisionGroup group{};
};

// Contacts after a step of two balls that overlap, with nothing else about.
uint32_t ContactsOf(const Ball& a, const Ball& b) {
    TestWorld world(NoGravity());
    const ShapePtr shape = SphereOf(0.5f);
    world.Add({.shape = shape, .motion = a.motion, .category = a.category, .mask = a.mask, .group = a.group});
    world.Add({.shape = shape,
               .motion = b.motion,
               .position = {0.9, 0, 0},
               .category = b.category,
               .mask = b.mask,
               .group = b.group});
    world.Step();
    return world.Report().contacts;
}

CollisionGroup Member(std::shared_ptr<const GroupFilter> filter, uint32_t group, uint32_t subGroup) {
    return {std::move(filter), group, subGroup};
}

std::shared_ptr<const GroupFilterTable> Table(std::initializer_list<GroupFilterTable::Pair> apart) {
    const auto table = GroupFilterTable::Create(apart);
    EXPECT_TRUE(table);
    return table ? table.Value() : nullptr;
}

TEST(CategoryAndMask, EachMustHaveABitOfItsCategoryInTheOthersMask) {
    constexpr uint64_t kHigh = uint64_t(1) << 63;
    for (uint64_t categoryA : {uint64_t(0), uint64_t(1), kHigh, kHigh | 1})
        for (uint64_t maskA : {uint64_t(0), uint64_t(1), kHigh, ~uint64_t(0)})
            for (uint64_t categoryB : {uint64_t(1), uint64_t(2), kHigh})
                for (uint64_t maskB : {uint64_t(1), uint64_t(3), kHigh}) {
                    const bool expected = (categoryA & maskB) != 0 && (categoryB & maskA) != 0;
                    EXPECT_EQ(
                        ContactsOf({.category = categoryA, .mask = maskA}, {.category = categoryB, .mask = maskB}),
                        expected ? 1u : 0u)
                        << categoryA << " " << maskA << " " << categoryB << " " << maskB;
                }
}

TEST(CategoryAndMask, OfOneBodyAloneCountAgainstTheDefaultsOfTheOther) {
    EXPECT_EQ(ContactsOf({}, {}), 1u);
    EXPECT_EQ(ContactsOf({.category = 2}, {}), 1u);
    EXPECT_EQ(ContactsOf({.mask = 2}, {}), 0u);
    EXPECT_EQ(ContactsOf({}, {.mask = 2}), 0u);
    EXPECT_EQ(ContactsOf({.mask = 3}, {}), 1u);
    EXPECT_EQ(ContactsOf({.category = 0}, {}), 0u);
}

TEST(CategoryAndMask, AreTheSameForFixedBodies) {
    for (MotionType motion : {MotionType::Static, MotionType::Kinematic}) {
        EXPECT_EQ(ContactsOf({.mask = 6}, {.motion = motion, .category = 4}), 1u);
        EXPECT_EQ(ContactsOf({.mask = 6}, {.motion = motion, .category = 8}), 0u);
    }
}

TEST(GroupFilterTable, KeepsThePairsApartThatItNames) {
    const auto table = Table({{0, 1}, {2, 2}, {3, 1}});
    for (uint32_t i = 0; i < 6; ++i)
        for (uint32_t j = 0; j < 6; ++j) {
            const bool apart = (i == 0 && j == 1) || (i == 1 && j == 0) || (i == 2 && j == 2) || (i == 1 && j == 3) ||
                               (i == 3 && j == 1);
            EXPECT_EQ(table->Collides({7, i}, {7, j}), !apart) << i << " " << j;
            EXPECT_TRUE(table->Collides({7, i}, {8, j})) << i << " " << j;
        }
    EXPECT_TRUE(Table({})->Collides({0, 0}, {0, 0}));
}

TEST(GroupFilterTable, HasAtMost1024SubGroups) {
    EXPECT_TRUE(GroupFilterTable::Create({{1023, 0}}));
    const auto tooLarge = GroupFilterTable::Create({{0, 1}, {5, 1024}});
    ASSERT_FALSE(tooLarge);
    EXPECT_EQ(tooLarge.GetError().code, ErrorCode::OutOfRange);
    EXPECT_NE(tooLarge.GetError().message.find("apart[1]"), std::string::npos);
}

TEST(Groups, AreAskedAboutBodiesOfTheSameFilterOnly) {
    const auto table = Table({{0, 1}}), other = Table({{0, 1}});
    EXPECT_EQ(ContactsOf({.group = Member(table, 1, 0)}, {.group = Member(table, 1, 1)}), 0u);
    EXPECT_EQ(ContactsOf({.group = Member(table, 1, 1)}, {.group = Member(table, 1, 0)}), 0u);
    EXPECT_EQ(ContactsOf({.group = Member(table, 1, 0)}, {.group = Member(table, 1, 0)}), 1u);
    EXPECT_EQ(ContactsOf({.group = Member(table, 1, 0)}, {.group = Member(table, 2, 1)}), 1u);
    EXPECT_EQ(ContactsOf({.group = Member(table, 1, 0)}, {.group = Member(other, 1, 1)}), 1u);
    EXPECT_EQ(ContactsOf({.group = Member(table, 0, 1)}, {}), 1u);
    // Masks forbid what a group allows.
    EXPECT_EQ(ContactsOf({.mask = 2, .group = Member(table, 1, 0)}, {.group = Member(table, 1, 0)}), 0u);
}

// Even numbers meet even ones, whatever their groups.
class SameParity final : public GroupFilter {
public:
    bool Collides(const Member& a, const Member& b) const override { return (a.subGroup + b.subGroup) % 2 == 0; }
};

TEST(Groups, TakeFiltersOfTheUsersOwn) {
    const auto filter = std::make_shared<const SameParity>();
    for (uint32_t i = 0; i < 3; ++i)
        for (uint32_t j = 0; j < 3; ++j)
            EXPECT_EQ(ContactsOf({.group = Member(filter, i, i)}, {.group = Member(filter, 0, j)}),
                      (i + j) % 2 == 0 ? 1u : 0u);
}

// A chain whose balls overlap their neighbors, held together by joints that forbid nothing.
std::vector<BodyId> AddChain(TestWorld& world, const Position& top, std::shared_ptr<const GroupFilter> filter,
                             uint32_t group) {
    std::vector<BodyId> balls;
    for (uint32_t i = 0; i < 5; ++i) {
        const Position at = top - Position(0, 0.3 * i, 0);
        balls.push_back(world.Add({.shape = SphereOf(0.2f),
                                   .motion = i == 0 ? MotionType::Static : MotionType::Dynamic,
                                   .position = at,
                                   .group = Member(filter, group, i)}));
        if (i == 0) continue;
        PointJointSettings joint;
        joint.bodyA = balls[i - 1];
        joint.bodyB = balls[i];
        joint.space = JointSpace::World;
        joint.anchorA.point = at + Position(0, 0.15, 0);
        joint.collideConnected = true;
        EXPECT_TRUE(world.System().Joints().Create(joint));
    }
    return balls;
}

TEST(Groups, LetThePartsOfARagdollOverlapAndMeetOthers) {
    const auto neighbors = Table({{0, 1}, {1, 2}, {2, 3}, {3, 4}});
    TestWorld world;
    const std::vector<BodyId> one = AddChain(world, {0, 5, 0}, neighbors, 1);
    world.Run(1);
    EXPECT_EQ(world.Report().contacts, 0u);
    // Joints carry like springs of w = 2 pi 60/s on the reduced mass m / 2: four of them, below each at most four
    // balls.
    const double sag = 4 * 4 * 2 * kGravity / (120 * kPi * 120 * kPi);
    for (size_t i = 0; i < one.size(); ++i)
        EXPECT_NEAR(world.PositionOf(one[i]).y(), 5 - 0.3 * static_cast<double>(i), sag);
    // Another of the same kind beside it: each ball overlaps that at its side, and those above and below it not quite.
    AddChain(world, {0.35, 5, 0}, neighbors, 2);
    world.Step();
    EXPECT_EQ(world.Report().contacts, 4u);  // the uppermost are static
}

// A box at rest on a floor, asleep.
struct Sleeper {
    TestWorld world;
    BodyId floor, box;
    Sleeper() {
        floor = world.AddFloor();
        box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
        world.Run(2);
        EXPECT_FALSE(world.Bodies().IsAwake(box));
    }
    // m, after so many steps from rest: v += g h, then x += v h in each, or exact flight.
    void ExpectFall(int steps) {
        const double from = world.PositionOf(box).y(), t = steps * kStep;
        world.Steps(steps);
        EXPECT_NEAR(world.PositionOf(box).y(), from - 0.5 * kGravity * t * t, 1e-3);
        EXPECT_EQ(world.Report().contacts, 0u);
        EXPECT_EQ(world.Report().pairs, 0u);
    }
};

TEST(FilterChanges, LetASleeperFallAndCatchItAgain) {
    Sleeper s;
    ASSERT_TRUE(s.world.Bodies().SetCategoryAndMask(s.box, 1, 0));
    EXPECT_TRUE(s.world.Bodies().IsAwake(s.box));
    EXPECT_EQ(s.world.Bodies().GetCategory(s.box), 1u);
    EXPECT_EQ(s.world.Bodies().GetMask(s.box), 0u);
    s.ExpectFall(6);
    ASSERT_TRUE(s.world.Bodies().SetCategoryAndMask(s.box, 1, ~uint64_t(0)));
    s.world.Run(2);
    EXPECT_EQ(s.world.Report().frozenBodies, 0u);
    // Pushed out again: the boxes overlap by 0.05 m.
    EXPECT_NEAR(s.world.PositionOf(s.box).y(), 0.5, 2e-3);
}

TEST(FilterChanges, OfAFloorWakeWhatRestsOnIt) {
    Sleeper s;
    ASSERT_TRUE(s.world.Bodies().SetCategoryAndMask(s.floor, 2, 2));
    EXPECT_TRUE(s.world.Bodies().IsAwake(s.box));
    s.ExpectFall(6);
}

TEST(FilterChanges, OfGroupsToo) {
    Sleeper s;
    const auto table = Table({{0, 1}});
    ASSERT_TRUE(s.world.Bodies().SetGroup(s.floor, Member(table, 3, 0)));
    s.world.Step();
    EXPECT_EQ(s.world.Report().contacts, 1u);
    ASSERT_TRUE(s.world.Bodies().SetGroup(s.box, Member(table, 3, 1)));
    EXPECT_EQ(s.world.Bodies().GetGroup(s.box).filter, table);
    EXPECT_EQ(s.world.Bodies().GetGroup(s.box).subGroup, 1u);
    s.ExpectFall(6);
    ASSERT_TRUE(s.world.Bodies().SetGroup(s.box, {}));
    s.world.Run(2);
    EXPECT_NEAR(s.world.PositionOf(s.box).y(), 0.5, 2e-3);
}

TEST(FilterChanges, ThatAllowWhatWasAllowedChangeNoBit) {
    Sleeper changed, left;
    for (Sleeper* s : {&changed, &left}) {
        ASSERT_TRUE(s->world.Bodies().SetVelocity(s->box, {1, 0, 0}, {0, 2, 0}));
        s->world.Step();
    }
    ASSERT_TRUE(changed.world.Bodies().SetCategoryAndMask(changed.box, 5, 3));
    for (Sleeper* s : {&changed, &left}) s->world.Steps(60);
    EXPECT_EQ(changed.world.System().HashPoses(), left.world.System().HashPoses());
}

TEST(FilterChanges, NeedABodyThatExists) {
    TestWorld world;
    const BodyId id = world.Add({.shape = SphereOf(1)});
    ASSERT_TRUE(world.Bodies().Remove(id));
    EXPECT_EQ(world.Bodies().SetCategoryAndMask(id, 1, 1).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(world.Bodies().SetGroup(id, {}).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(world.Bodies().GetCategory(id), 0u);
}

TEST(FilterChanges, ReleaseTheFilterOfARemovedBody) {
    TestWorld world;
    auto table = Table({{0, 1}});
    const BodyId id = world.Add({.shape = SphereOf(1), .group = Member(table, 0, 0)});
    EXPECT_EQ(table.use_count(), 2);
    ASSERT_TRUE(world.Bodies().Remove(id));
    world.Step();
    EXPECT_EQ(table.use_count(), 1);
}

TEST(QueryFilter, FindsWhatABodyOfItsCategoryAndMaskWouldCollideWith) {
    TestWorld world(NoGravity());
    const BodyId first = world.Add({.shape = SphereOf(0.5f), .position = {1, 0, 0}, .category = 2, .mask = 4});
    const BodyId second = world.Add({.shape = SphereOf(0.5f), .position = {3, 0, 0}, .category = 4, .mask = 0});
    const BodyId third = world.Add({.shape = SphereOf(0.5f), .position = {5, 0, 0}, .category = 0});
    const auto seen = [&](const QueryFilter& filter) {
        WorldRayHit hit;
        (void)world.System().Queries().CastRay({Position(-1, 0, 0), Vector3(10, 0, 0)}, hit, {}, filter);
        return hit.body;
    };
    EXPECT_EQ(seen({}), first);
    EXPECT_EQ(seen({.mask = 6}), first);
    EXPECT_EQ(seen({.mask = 4}), second);
    EXPECT_EQ(seen({.mask = 1}), BodyId{});
    EXPECT_EQ(seen({.category = 4}), first);
    EXPECT_EQ(seen({.category = 8}), third);
    EXPECT_EQ(seen({.category = 8, .mask = 6}), BodyId{});
    EXPECT_EQ(seen({.category = 12, .mask = 2}), first);
}

}  // namespace
}  // namespace fulcrum::testing
