// A world with something of everything, to which each bad call is made anew.
#pragma once

#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/UnitTests/Physics/BadInput/Spoiler.h>
#include <Fulcrum/UnitTests/Support/JointScene.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <functional>

namespace fulcrum::testing {

class Room {
public:
    Room();

    TestWorld world;
    PhysicsSystem& system = world.System();
    ShapePtr ball = SphereOf(0.4f);
    BodyId floor, body, other, driven, sensor, compound;
    ChildId child;
    JointId hinge, toWorld;
    BadIds bad;
    std::vector<std::byte> snapshot, some;  // of all, of two bodies

    uint64_t Hash() const { return hash_; }  // as it was built
    // Takes the present state for that to which Restore goes back.
    void Keep();
    // As it was built or kept, after calls that were made.
    void Restore();
    // Empty, or what a user reads that is not finite, after two steps.
    std::string WrongAfterSteps();

private:
    std::vector<ShapePtr> shapes_;
    uint64_t hash_ = 0;
};

template <class T>
MaybeError ErrorOf(const Result<T>& result) {
    if (result) return {};
    return result.GetError();
}

// Spoils `good` in every way; make(value) returns an error or nothing. `ignored`: the ends of the paths of what the
// function's comment says it ignores. Returns how many values were tried.
template <class T>
int TryAll(Room& room, const char* name, const T& good, const std::function<MaybeError(T&)>& make,
           const std::vector<std::string>& ignored = {}) {
    SCOPED_TRACE(name);
    T first = good;
    const MaybeError refused = make(first);
    EXPECT_FALSE(refused) << "with good arguments: " << refused->message;
    room.Restore();
    int values = 0;
    for (size_t which = 0;; ++which, ++values) {
        T bad = good;
        Spoiler spoiler(which, room.bad);
        spoiler.Argument(name, bad);
        if (!spoiler.Done()) break;
        const std::string what = spoiler.Done()->path + " = " + spoiler.Done()->value;
        if (const MaybeError error = make(bad)) {
            EXPECT_EQ(room.system.HashState(), room.Hash()) << what << ": " << error->message;
            continue;
        }
        const bool isIgnored =
            std::ranges::any_of(ignored, [&](const std::string& end) { return spoiler.Done()->path.ends_with(end); });
        EXPECT_TRUE(isIgnored || spoiler.Done()->verdict == Verdict::MayBeRefused) << what << " was not refused";
        const std::string wrong = room.WrongAfterSteps();
        EXPECT_TRUE(wrong.empty()) << "after " << what << " " << wrong;
        room.Restore();
    }
    return values;
}

}  // namespace fulcrum::testing
