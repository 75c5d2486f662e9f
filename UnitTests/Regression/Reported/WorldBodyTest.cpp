// Joints to the world are held by a body that nobody sees. After a snapshot was restored, it may have the index and the
// generation of an id that was given out before: no call with that id, nor with a guessed one, may reach it.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/Physics/Recording/PublicCalls.h>

#include <algorithm>
#include <functional>

namespace fulcrum::testing {
namespace {

// Two bobs that hang from the world, as after a rollback: `stale` was created and is no more, and the joints have been
// made since.
class HangingBobs {
public:
    HangingBobs() : world(Settings()) {
        for (const double x : {0.0, 5.0}) bobs.push_back(Add({x, 2, 0}));
        std::vector<std::byte> before;
        EXPECT_TRUE(world.System().SaveSnapshot(before));
        stale = Add({0, 8, 0});
        EXPECT_TRUE(world.System().SaveBodies({&stale, 1}, savedStale));
        EXPECT_TRUE(world.System().RestoreSnapshot(before));
        EXPECT_FALSE(world.Bodies().Exists(stale));
        for (const BodyId bob : bobs) joints.push_back(HangFromWorld(bob));
    }

    JointId HangFromWorld(BodyId bob) {
        PointJointSettings joint;
        joint.bodyA = kWorldBody;
        joint.bodyB = bob;
        joint.anchorA.point = world.PositionOf(bob) + Position(1, 0, 0);
        return world.System().Joints().Create(joint).Value();
    }
    // Of the first indices and of generations that a count, a fresh body or a sentinel may have; and the stale one.
    std::vector<BodyId> Guesses() const {
        std::vector<BodyId> ids{stale};
        for (uint32_t index = 0; index < 6; ++index)
            for (const uint32_t generation : {0u, 1u, 2u, 3u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFEu, 0xFFFFFFFFu})
                ids.push_back({index, generation});
        std::erase_if(ids, [&](BodyId id) { return std::ranges::find(bobs, id) != bobs.end(); });
        return ids;
    }
    uint64_t Hash() { return world.System().HashState(); }

    TestWorld world;
    std::vector<BodyId> bobs;
    std::vector<JointId> joints;
    BodyId stale;
    std::vector<std::byte> savedStale;

private:
    static SystemSettings Settings() {
        SystemSettings settings;
        settings.events = {.contacts = true, .bodies = true};
        return settings;
    }
    BodyId Add(const Position& position) { return world.Add({.shape = CubeOf(0.25f), .position = position}); }
};

// Arguments with which a call is made on a body: defaults, except what has no valid one.
template <class Arguments>
Arguments ArgumentsOn(BodyId id) {
    Arguments arguments{};
    std::get<0>(arguments) = id;
    const auto fill = [](auto& argument) {
        using T = std::remove_reference_t<decltype(argument)>;
        if constexpr (std::is_same_v<T, float> || std::is_same_v<T, double>) argument = 1;
        if constexpr (std::is_same_v<T, Vector3>) argument = Vector3(1, 2, 3);
        if constexpr (std::is_same_v<T, SymmetricMatrix3>) argument.xx = argument.yy = argument.zz = 1;
        if constexpr (std::is_same_v<T, bool>) argument = true;
        if constexpr (std::is_same_v<T, ShapePtr>) argument = CubeOf(1);
        if constexpr (std::is_same_v<T, MotionType>) argument = MotionType::Dynamic;
        if constexpr (std::is_same_v<T, CompoundShape::ChildSettings>) argument.shape = CubeOf(1);
    };
    std::apply([&](BodyId&, auto&... others) { (fill(others), ...); }, arguments);
    return arguments;
}

template <class Class>
Class& InterfaceOf(PhysicsSystem& system) {
    if constexpr (std::is_same_v<Class, BodyInterface>) return system.Bodies();
    else if constexpr (std::is_same_v<Class, JointInterface>) return system.Joints();
    else return system;
}
template <class Result, class Class, class... Parameters>
Class& OwnerOf(PhysicsSystem& system, Result (Class::*)(Parameters...)) {
    return InterfaceOf<Class>(system);
}

// Calls each public function whose first argument is a body, and creates each kind of joint, with this body; returns
// how many calls there were.
template <auto kFunction>
int CallOn(HangingBobs& bobs, BodyId id, const char* name) {
    using Arguments = CallArguments<kFunction>;
    if constexpr (std::tuple_size_v < Arguments >> 0) {
        using First = std::tuple_element_t<0, Arguments>;
        auto& owner = OwnerOf(bobs.world.System(), kFunction);
        if constexpr (std::is_same_v<First, BodyId>) {
            const auto result = std::apply([&](const auto&... arguments) { return (owner.*kFunction)(arguments...); },
                                           ArgumentsOn<Arguments>(id));
            EXPECT_FALSE(result) << name;
            EXPECT_TRUE(result || result.GetError().code == ErrorCode::UnknownId) << name;
            return 1;
        } else if constexpr (std::is_base_of_v<JointSettings, First>) {
            First settings;
            settings.bodyA = id;
            settings.bodyB = bobs.bobs[0];
            EXPECT_FALSE((owner.*kFunction)(settings)) << name;
            return 1;
        }
    }
    return 0;
}

TEST(WorldBody, IsReachedByNoCallThatChangesTheWorld) {
    HangingBobs bobs;
    const uint64_t before = bobs.Hash();
    int calls = 0;
    for (const BodyId id : bobs.Guesses()) {
        std::apply(
            [&]<class... Calls>(const Calls&... call) {
                ((calls += [&]<auto f>(const PublicCall<f>& c) { return CallOn<f>(bobs, id, c.name); }(call)), ...);
            },
            kPublicCalls);
        const Pose pose{};
        EXPECT_FALSE(bobs.world.Bodies().SetPoses({&id, 1}, {&pose, 1}));
        EXPECT_FALSE(bobs.world.System().Joints().CreateTarget({.body = id}));
        PointJointSettings joint;
        joint.bodyA = id;
        joint.bodyB = BodyBatch::Body(0);
        const auto batch = BodyBatch::Prepare({{.shape = CubeOf(1)}}, {joint});
        ASSERT_TRUE(batch);
        EXPECT_FALSE(bobs.world.Bodies().Commit(batch.Value()));
        std::vector<std::byte> bytes;
        EXPECT_FALSE(bobs.world.System().SaveBodies({&id, 1}, bytes));
    }
    EXPECT_GT(calls, 40 * static_cast<int>(bobs.Guesses().size()));
    EXPECT_FALSE(bobs.world.System().RestoreBodies(bobs.savedStale));
    EXPECT_EQ(bobs.Hash(), before);
    for (const JointId joint : bobs.joints) EXPECT_TRUE(bobs.world.System().Joints().Exists(joint));
}

// A getter of the body that nobody sees returns what it does for an id that there never was.
TEST(WorldBody, IsSeenByNoGetter) {
    HangingBobs bobs;
    const BodyInterface& b = bobs.world.Bodies();
    const BodyId none{};
    const auto seen = [&](BodyId id) {
        int differences = 0;
        const auto compare = [&](auto get) { differences += !(get(id) == get(none)); };
        for (const BodyInterface* bodies : {&b, &std::as_const(bobs.world.System()).LockingBodies()}) {
            compare([&](BodyId i) { return bodies->Exists(i); });
            compare([&](BodyId i) { return bodies->GetPose(i).position; });
            compare([&](BodyId i) { return bodies->GetCenterOfMass(i); });
            compare([&](BodyId i) { return bodies->GetBounds(i).lower; });
            compare([&](BodyId i) { return bodies->GetShape(i); });
            compare([&](BodyId i) { return bodies->GetChildren(i); });
            compare([&](BodyId i) { return bodies->GetMaterial(i).friction; });
            compare([&](BodyId i) { return bodies->GetGravity(i); });
            compare([&](BodyId i) { return bodies->GetGravityFactor(i); });
            compare([&](BodyId i) { return bodies->GetCategory(i); });
            compare([&](BodyId i) { return bodies->GetMask(i); });
            compare([&](BodyId i) { return bodies->GetMaxLinearSpeed(i); });
            compare([&](BodyId i) { return bodies->GetMaxAngularSpeed(i); });
            compare([&](BodyId i) { return bodies->AllowsSleep(i); });
            compare([&](BodyId i) { return bodies->HasGyroscopicTorque(i); });
            compare([&](BodyId i) { return bodies->ReportsContacts(i); });
        }
        bobs.world.System().Joints().VisitOf(id, [&](JointId) { ++differences; });
        bobs.world.System().VisitContactsOf(id, [&](const ContactView&) { ++differences; });
        differences += bobs.world.System().Queries().MayCollide(id, bobs.bobs[0]);
        differences += static_cast<int>(bobs.world.System().BodiesInside(id).size());
        return differences;
    };
    for (const BodyId id : bobs.Guesses()) EXPECT_EQ(seen(id), 0) << id.index << ", " << id.generation;
}

TEST(WorldBody, IsListedNowhere) {
    HangingBobs bobs;
    PhysicsSystem& system = bobs.world.System();
    const auto isBob = [&](BodyId id) { return std::ranges::find(bobs.bobs, id) != bobs.bobs.end(); };
    for (int step = 0; step < 3; ++step) {
        bobs.world.Step();
        system.VisitBodies([&](BodyId id) { EXPECT_TRUE(isBob(id)); });
        system.VisitIslands([&](BodyId id, uint32_t) { EXPECT_TRUE(isBob(id)); });
        const StepEvents& events = system.Events();
        for (const std::span<const BodyId> list : {events.awake, events.moved, events.woke, events.fellAsleep})
            for (const BodyId id : list) EXPECT_TRUE(isBob(id));
        EXPECT_EQ(bobs.world.Report().bodies, 2u);
    }
    for (const JointId joint : bobs.joints) EXPECT_EQ(system.Joints().GetBodyA(joint), kWorldBody);
}

// The bobs fall a quarter turn about their anchors, 1 m away, and pass below them: what is removed does not let go.
TEST(WorldBody, HoldsItsJointsWhenStaleIdsAreRemoved) {
    HangingBobs bobs;
    for (const BodyId id : bobs.Guesses()) EXPECT_FALSE(bobs.world.Bodies().Remove(id));
    bobs.world.Run(2);
    constexpr double kMost = 0.02;  // m, what a joint may be off with the default effort
    for (size_t i = 0; i < bobs.bobs.size(); ++i) {
        const Position anchor(i == 0 ? 1.0 : 6.0, 2, 0), arm = bobs.world.PositionOf(bobs.bobs[i]) - anchor;
        EXPECT_NEAR(arm.norm(), 1, kMost);
    }
    // And a joint to the world made now is held by the same body.
    const BodyId late = bobs.world.Add({.shape = CubeOf(0.25f), .position = {0, 8, 0}});
    (void)bobs.HangFromWorld(late);
    bobs.world.Run(1);
    EXPECT_NEAR((bobs.world.PositionOf(late) - Position(1, 8, 0)).norm(), 1, kMost);
}

}  // namespace
}  // namespace fulcrum::testing
