// Contacts of one color never share a moving body, whatever came and went before.
#include <Fulcrum/Constraints/Coloring.h>

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

namespace fulcrum {
namespace {

ConstraintColoring::Kind KindOf(bool fixed) {
    return fixed ? ConstraintColoring::Kind::Fixed : ConstraintColoring::Kind::Moving;
}
size_t MovingOf(const ConstraintColoring& coloring, int color) {
    return coloring.At(color).Of(ConstraintColoring::Kind::Moving).size();
}

struct Contact {
    uint32_t a, b;
    bool fixedB;
    ColorSlot place;
};

// Contacts by their numbers, kept as the engine keeps them.
class Colored {
public:
    explicit Colored(uint32_t bodies) { coloring.ReserveBodies(bodies); }

    void Add(uint32_t contact, uint32_t a, uint32_t b, bool fixedB) {
        contacts[contact] = {a, b, fixedB, coloring.Add(KindOf(fixedB), {contact, a, b, false, fixedB}, fixedB)};
    }
    void Remove(uint32_t contact) {
        const Contact c = contacts.at(contact);
        const uint32_t moved = coloring.Remove(KindOf(c.fixedB), {contact, c.a, c.b, false, c.fixedB}, c.place);
        contacts.at(moved).place.slot = c.place.slot;
        contacts.erase(contact);
    }
    void Check() const {
        ASSERT_EQ(coloring.Size(), contacts.size());
        size_t listed = 0;
        std::set<uint32_t> touched;
        for (int color = 0; color <= ConstraintColoring::kColors; ++color) {
            std::set<uint32_t> moved;
            const ConstraintColoring::Color& lists = coloring.At(color);
            for (bool fixed : {false, true}) {
                const auto& list = lists.Of(KindOf(fixed));
                listed += list.size();
                for (size_t slot = 0; slot < list.size(); ++slot) {
                    const auto found = contacts.find(list[slot].constraint);
                    ASSERT_NE(found, contacts.end());
                    const Contact& c = found->second;
                    ASSERT_EQ(c.place.color, color);
                    ASSERT_EQ(c.place.slot, slot);
                    ASSERT_EQ(c.fixedB, fixed);
                    ASSERT_EQ(list[slot].bodyA, c.a);
                    ASSERT_EQ(list[slot].bodyB, c.b);
                    touched.insert(c.a);
                    if (!fixed) touched.insert(c.b);
                    if (color == ConstraintColoring::kOverflow) continue;
                    ASSERT_TRUE(moved.insert(c.a).second) << "body " << c.a << " twice in color " << color;
                    if (fixed) continue;
                    ASSERT_TRUE(moved.insert(c.b).second) << "body " << c.b << " twice in color " << color;
                }
            }
        }
        ASSERT_EQ(listed, contacts.size());
        for (uint32_t body = 0; body < 400; ++body)
            ASSERT_EQ(coloring.IsTouched(body), touched.count(body) > 0) << body;
    }

    ConstraintColoring coloring;
    std::map<uint32_t, Contact> contacts;
};

TEST(Coloring, NeverSharesAMovingBodyWithinAColor) {
    std::mt19937 engine(3);
    const auto random = [&] { return static_cast<uint32_t>(engine()); };
    Colored world(200);
    uint32_t next = 0;
    for (int round = 0; round < 60; ++round) {
        for (int i = 0; i < 50; ++i) {
            const uint32_t a = random() % 200, b = random() % 200;
            // Body 199 is one that half the others rest on.
            const uint32_t other = random() % 2 ? 199 : b;
            if (a != other) world.Add(next++, a, other, random() % 3 == 0);
        }
        for (int i = 0; i < 30 && !world.contacts.empty(); ++i) {
            auto victim = world.contacts.begin();
            std::advance(victim, static_cast<long>(random() % world.contacts.size()));
            world.Remove(victim->first);
        }
        world.Check();
        if (::testing::Test::HasFatalFailure()) return;
    }
    while (!world.contacts.empty()) world.Remove(world.contacts.begin()->first);
    world.Check();
}

TEST(Coloring, OverflowsWhereABodyTouchesMoreThanThereAreColors) {
    Colored world(200);
    for (uint32_t i = 0; i < 100; ++i) world.Add(i, 0, i + 1, false);
    world.Check();
    EXPECT_EQ(MovingOf(world.coloring, ConstraintColoring::kOverflow), 36u);
    for (int color = 0; color < ConstraintColoring::kColors; ++color) EXPECT_EQ(MovingOf(world.coloring, color), 1u);
    // What becomes free is used again.
    world.Remove(10);
    world.Add(200, 0, 150, false);
    world.Check();
    EXPECT_EQ(MovingOf(world.coloring, ConstraintColoring::kOverflow), 36u);
}

TEST(Coloring, TheFixedSideMayBeSharedByAll) {
    Colored world(200);
    // A hundred bodies on one floor need one color.
    for (uint32_t i = 0; i < 100; ++i) world.Add(i, i, 150, true);
    world.Check();
    int colors = 0;
    for (int color = 0; color < ConstraintColoring::kColors; ++color) colors += !world.coloring.At(color).Empty();
    EXPECT_EQ(colors, 1);
    EXPECT_FALSE(world.coloring.IsTouched(150));
}

TEST(Coloring, FixedContactsAreSolvedAfterMovingOnes) {
    Colored world(10);
    world.Add(0, 1, 9, true);
    world.Add(1, 1, 2, false);
    EXPECT_GT(world.contacts.at(0).place.color, world.contacts.at(1).place.color);
}

TEST(Coloring, TheSameCallsGiveTheSameColors) {
    Colored a(50), b(50);
    for (uint32_t i = 0; i < 300; ++i) {
        a.Add(i, i % 50, (i * 7 + 1) % 50, i % 5 == 0);
        b.Add(i, i % 50, (i * 7 + 1) % 50, i % 5 == 0);
        EXPECT_EQ(a.contacts.at(i).place.color, b.contacts.at(i).place.color);
        EXPECT_EQ(a.contacts.at(i).place.slot, b.contacts.at(i).place.slot);
    }
}

}  // namespace
}  // namespace fulcrum
