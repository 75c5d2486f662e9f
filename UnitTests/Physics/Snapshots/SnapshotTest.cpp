// Snapshots: what goes back and what does not, whom they refuse, what they cost.
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/UnitTests/Physics/SensorTest.h>
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/WorldAccess.h>

#include <algorithm>
#include <functional>

namespace fulcrum::testing {
namespace {

void Restore(PhysicsSystem& system, const Bytes& bytes, const SnapshotSources& sources = {}) {
    const Status restored = system.RestoreSnapshot(bytes, sources);
    if (!restored) ADD_FAILURE() << restored.GetError().message;
}

void ExpectRefused(PhysicsSystem& system, std::span<const std::byte> bytes, ErrorCode code,
                   const SnapshotSources& sources = {}) {
    const uint64_t before = system.HashState();
    const Status restored = system.RestoreSnapshot(bytes, sources);
    ASSERT_FALSE(restored);
    EXPECT_EQ(restored.GetError().code, code) << restored.GetError().message;
    EXPECT_EQ(system.HashState(), before);
}

// ---- Rollback

// A player's calls in ten frames: pushes, a teleport, a body made, one removed, a joint made and one removed, motors.
struct Calls {
    TestWorld& world;
    std::vector<BodyId> made;
    std::vector<JointId> joints;

    void Before(int frame, BodyId first, BodyId second, BodyId third) {
        BodyInterface& bodies = world.Bodies();
        EXPECT_TRUE(bodies.AddImpulse(first, {200, 300, 0}));
        EXPECT_TRUE(frame != 1 || bodies.SetPose(second, {0, 8, 0}, {}));
        if (frame == 2) made.push_back(world.Add({.shape = SphereOf(0.3f), .position = {0.2, 5, 0}}));
        if (frame == 3) {
            PointJointSettings joint;
            joint.bodyA = made.front();
            joint.bodyB = first;
            joint.anchorA.point = {0.2, 4.5, 0};
            joints.push_back(world.System().Joints().Create(joint).Value());
        }
        EXPECT_TRUE(frame != 4 || bodies.Remove(third));
        EXPECT_TRUE(frame != 5 || bodies.AddForce(made.front(), {0, 100, 0}));
        if (frame == 6) made.push_back(world.Add({.shape = CubeOf(0.2f), .position = {0.3, 6, 0.1}}));
        EXPECT_TRUE(frame != 7 || world.System().Joints().Remove(joints.front()));
        EXPECT_TRUE(frame != 8 || bodies.SetVelocity(made.back(), {0, -5, 0}, {1, 2, 3}));
    }
};

std::vector<BodyId> AddHeap(TestWorld& world) {
    world.AddFloor();
    const ShapePtr shapes[] = {CubeOf(0.4f), SphereOf(0.4f), CapsuleOf(0.3f, 0.3f)};
    std::vector<BodyId> bodies;
    for (int i = 0; i < 60; ++i)
        bodies.push_back(world.Add({.shape = shapes[i % 3],
                                    .position = {0.9 * (i % 4) + 0.05 * i, 0.5 + 0.95 * (i / 16), 0.9 * (i / 4 % 4)}}));
    return bodies;
}

TEST(Snapshot, TenFramesBackAndAgainAreTheSameFrames) {
    TestWorld world;
    const std::vector<BodyId> heap = AddHeap(world);
    world.Steps(50);
    const Bytes start = SnapshotOf(world.System());
    std::vector<uint64_t> hashes[2];
    Calls calls[2] = {{world, {}, {}}, {world, {}, {}}};
    for (int turn = 0; turn < 2; ++turn) {
        if (turn == 1) Restore(world.System(), start);
        hashes[turn].push_back(world.System().HashState());
        for (int frame = 0; frame < 10; ++frame) {
            calls[turn].Before(frame, heap[10], heap[20], heap[30]);
            hashes[turn].push_back(world.System().HashState());
            world.Step();
            hashes[turn].push_back(world.System().HashState());
        }
    }
    EXPECT_EQ(hashes[1], hashes[0]);
    EXPECT_EQ(calls[1].made, calls[0].made);
    EXPECT_EQ(calls[1].joints, calls[0].joints);
    EXPECT_EQ(hashes[0].size(), 21u);
    std::sort(hashes[0].begin(), hashes[0].end());
    EXPECT_EQ(std::unique(hashes[0].begin(), hashes[0].end()), hashes[0].end()) << "frames have no hash of their own";
}

// Sensors and continuous collision note in which step something happened: what happened in steps that were taken back
// must not count in those that follow, though they have the same numbers.
TEST(Snapshot, NothingIsLeftOfStepsThatWereTakenBack) {
    const auto build = [](TestWorld& world) {
        const std::vector<BodyId> heap = AddHeap(world);
        world.Add(SensorOf(BoxOf(3, 1, 3), {1, 1, 1}));
        // Beside a sensor that moves, something sleeps that was above it in the steps that are taken back.
        BodySettings passing = SensorOf(CubeOf(0.5f), {8, 0.5, 8}, MotionType::Kinematic);
        passing.linearVelocity = Vector3(0.05f, 0, 0);
        world.Add(passing);
        world.Add({.shape = SphereOf(0.1f), .position = {8, 0.1, 8.62}, .startAsleep = true});
        // In another one something sleeps.
        world.Add(SensorOf(CubeOf(0.5f), {12, 0.5, 12}));
        world.Add({.shape = SphereOf(0.1f), .position = {12, 0.3, 12}, .startAsleep = true});
        world.Add({.shape = SphereOf(0.1f),
                   .position = {-20, 1, 0.3},
                   .linearVelocity = {150, 0, 0},
                   .gravityFactor = 0,
                   .continuous = ContinuousCollision::LinearAndAngular});
        world.Steps(3);
        return heap;
    };
    TestWorld straight, back;
    const std::vector<BodyId> heap = build(straight);
    build(back);
    const Bytes start = SnapshotOf(back.System());
    // The future that is given up: all move, some are removed, one that sleeps wakes.
    for (int step = 0; step < 12; ++step) {
        for (const BodyId id : heap)
            EXPECT_TRUE(!back.Bodies().Exists(id) || back.Bodies().AddImpulse(id, {100, 50, 0}));
        EXPECT_TRUE(step != 4 || back.Bodies().Remove(heap[3]));
        EXPECT_TRUE(step != 2 || back.Bodies().SetPose({heap.back().index + 3, 0}, {8, 3, 8}, {}));
        EXPECT_TRUE(step != 2 || back.Bodies().SetPose({heap.back().index + 5, 0}, {12, 3, 12}, {}));
        if (step == 5)
            for (int i = 0; i < 80; ++i) back.Add({.shape = CubeOf(0.2f), .position = {5 + i * 0.5, 1, 0}});
        back.Step();
    }
    Restore(back.System(), start);
    for (int step = 0; step < 60; ++step) {
        ASSERT_EQ(back.System().HashState(), straight.System().HashState()) << "step " << step;
        ASSERT_EQ(EventsOf(back), EventsOf(straight)) << "step " << step;
        back.Step();
        straight.Step();
    }
}

TEST(Snapshot, IdsOfThenAreValidAgainAndLaterOnesAreNot) {
    TestWorld world;
    world.AddFloor();
    const BodyId kept = world.Add({.shape = CubeOf(0.5f), .position = {0, 2, 0}, .userData = 7});
    const BodyId removed = world.Add({.shape = CubeOf(0.5f), .position = {3, 2, 0}, .userData = 8});
    HingeJointSettings hinge;
    hinge.bodyA = kept;
    hinge.bodyB = removed;
    hinge.userData = 9;
    const JointId joint = world.System().Joints().Create(hinge).Value();
    const ShapePtr shape = world.Bodies().GetShape(removed);
    world.Step();
    const Bytes bytes = SnapshotOf(world.System());

    EXPECT_TRUE(world.Bodies().Remove(removed));
    world.Step();
    const BodyId later = world.Add({.shape = SphereOf(0.5f), .position = {3, 2, 0}});
    const BodyId another = world.Add({.shape = SphereOf(0.5f), .position = {6, 2, 0}});
    EXPECT_EQ(later.index, removed.index);
    world.Step();
    Restore(world.System(), bytes);

    EXPECT_TRUE(world.Bodies().Exists(kept));
    EXPECT_TRUE(world.Bodies().Exists(removed));
    EXPECT_FALSE(world.Bodies().Exists(later));
    EXPECT_FALSE(world.Bodies().Exists(another));
    EXPECT_TRUE(world.System().Joints().Exists(joint));
    EXPECT_EQ(world.Bodies().GetUserData(kept), 7u);
    EXPECT_EQ(world.Bodies().GetUserData(removed), 8u);
    EXPECT_EQ(world.System().Joints().GetUserData(joint), 9u);
    EXPECT_EQ(world.Bodies().GetShape(removed)->Type(), ShapeType::Box);
    EXPECT_EQ(ContentHash(*world.Bodies().GetShape(removed)), ContentHash(*shape));
    // The same calls give the same ids as before.
    EXPECT_TRUE(world.Bodies().Remove(removed));
    world.Step();
    EXPECT_EQ(world.Add({.shape = SphereOf(0.5f), .position = {3, 2, 0}}), later);
}

// The same two colliders have a pair in both worlds, but the body that moves is the other one; or the bodies are the
// same, and one has another shape.
TEST(Snapshot, GoesToAWorldWhosePairsAreOfOtherBodiesOrShapes) {
    const ShapePtr cube = CubeOf(0.5f), ball = SphereOf(0.5f);
    const auto fill = [](TestWorld& world, const ShapePtr& lower, const ShapePtr& upper, bool firstIsUpper) {
        const auto add = [&](bool isUpper) {
            world.Add({.shape = isUpper ? upper : lower,
                       .motion = isUpper ? MotionType::Dynamic : MotionType::Static,
                       .position = {0.1, isUpper ? 1.05 : 0, 0}});
        };
        add(firstIsUpper);
        add(!firstIsUpper);
        world.Steps(5);
    };
    TestWorld world;
    fill(world, cube, cube, true);
    const Bytes saved = SnapshotOf(world.System());
    world.Steps(20);
    struct Other {
        ShapePtr lower, upper;
        bool firstIsUpper;
    };
    for (const auto& [lower, upper, firstIsUpper] :
         {Other{cube, cube, false}, {ball, cube, true}, {cube, ball, true}}) {
        TestWorld other;
        fill(other, lower, upper, firstIsUpper);
        Restore(other.System(), saved, {.shapes = {&cube, 1}});
        EXPECT_EQ(SnapshotOf(other.System()), saved);
        other.Steps(20);
        EXPECT_EQ(other.System().HashState(), world.System().HashState());
    }
}

TEST(Snapshot, GoesBackBeforeSettingsWereChanged) {
    TestWorld world;
    const BodyId body = world.Add({.shape = CubeOf(0.5f)});
    const Bytes bytes = SnapshotOf(world.System());
    SystemSettings settings = world.System().Settings();
    settings.gravity = Vector3(0, 3, 0);
    EXPECT_TRUE(world.System().SetSettings(settings));
    world.Step();
    EXPECT_GT(world.VelocityOf(body).y(), 0);
    Restore(world.System(), bytes);
    world.Step();
    EXPECT_FLOAT_EQ(world.VelocityOf(body).y(), static_cast<float>(-kGravity * kStep));
}

TEST(Snapshot, HasWhatTheLastStepReported) {
    TestWorld world;
    const BodyId sensor = world.Add(SensorOf(CubeOf(1)));
    const BodyId falls = world.Add({.shape = CubeOf(0.2f), .position = {0, 1.25, 0}});
    const BodyId hook = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Static, .position = {5, 5, 0}});
    const BodyId heavy = world.Add({.shape = CubeOf(0.5f), .position = {5, 4, 0}});
    PointJointSettings weak;
    weak.bodyA = hook;
    weak.bodyB = heavy;
    weak.anchorA.point = {5, 5, 0};
    weak.breakForce = 10;
    const JointId joint = world.System().Joints().Create(weak).Value();
    int steps = 0;
    while (InsideOf(world, sensor).empty() && ++steps < 60) world.Step();
    EXPECT_TRUE(world.System().Joints().SetEnabled(joint, true));
    world.Step();
    const std::vector<SensorEvent> events = EventsOf(world);
    const auto broken = [&] {
        std::vector<JointId> ids;
        for (const BrokenJoint& each : world.System().Events().brokenJoints) ids.push_back(each.id);
        return ids;
    };
    ASSERT_EQ(InsideOf(world, sensor), std::vector{falls});
    ASSERT_EQ(broken(), std::vector{joint});
    ASSERT_EQ(events.size(), 1u);
    const Bytes bytes = SnapshotOf(world.System());
    EXPECT_TRUE(world.Bodies().SetPose(falls, {0, 9, 0}, {}));
    world.Step();
    EXPECT_TRUE(InsideOf(world, sensor).empty());
    EXPECT_TRUE(broken().empty());
    Restore(world.System(), bytes);
    EXPECT_EQ(InsideOf(world, sensor), std::vector{falls});
    EXPECT_EQ(broken(), std::vector{joint});
    EXPECT_EQ(EventsOf(world), events);
}

TEST(Snapshot, TakesEditsOfCompoundsBack) {
    TestWorld world;
    world.AddFloor();
    const CompoundShape::ChildSettings children[] = {{.shape = CubeOf(0.3f)},
                                                     {.shape = SphereOf(0.3f), .position = {0.8f, 0, 0}}};
    const BodyId body = world.Add({.shape = MutableCompound::Create(children).Value(), .position = {0, 1, 0}});
    world.Steps(20);
    const Bytes bytes = SnapshotOf(world.System());
    const uint64_t before = world.System().HashState();
    std::vector<uint64_t> hashes;
    for (int turn = 0; turn < 2; ++turn) {
        ASSERT_EQ(world.System().HashState(), before);
        const ChildId added =
            world.Bodies()
                .AddChild(body, {.shape = CubeOf(0.2f), .position = {-0.7f, 0, 0}}, MassUpdate::Update)
                .Value();
        EXPECT_EQ(added.index, 2u);
        EXPECT_TRUE(world.Bodies().RemoveChild(body, {0, 0}, MassUpdate::Update));
        const Bytes edited = SnapshotOf(world.System());
        Restore(world.System(), edited);
        EXPECT_TRUE(SnapshotOf(world.System()) == edited);
        for (int step = 0; step < 30; ++step) {
            world.Step();
            const uint64_t hash = world.System().HashState();
            if (turn == 0) hashes.push_back(hash);
            else ASSERT_EQ(hash, hashes[static_cast<size_t>(step)]) << step;
        }
        EXPECT_TRUE(world.Bodies().SetShape(body, SphereOf(0.4f), MassUpdate::Update));
        world.Step();
        Restore(world.System(), bytes);
        EXPECT_TRUE(world.Bodies().GetChildren(body)->Exists({0, 0}));
    }
}

// ---- Other worlds

TEST(Snapshot, OfJointsOfEveryKindGoesOnInAnEmptyWorld) {
    TestWorld world(JointScene::Settings());
    JointScene scene(world);
    for (int step = 0; step < 130; ++step) {
        scene.BeforeStep(step);
        world.Step();
    }
    const Bytes bytes = SnapshotOf(world.System());
    const Assets assets(world.System());
    for (uint32_t threads : {1u, 2u}) {
        TestWorld other({}, threads);
        other.Add({.shape = SphereOf(1), .position = {0, 50, 0}});
        other.Steps(5);
        Restore(other.System(), bytes, assets.All());
        Restore(world.System(), bytes);
        EXPECT_EQ(SnapshotOf(other.System()), bytes);
        for (int step = 0; step < 100; ++step) {
            ASSERT_EQ(other.System().HashState(), world.System().HashState()) << "step " << step;
            other.Step();
            world.Step();
        }
    }
}

TEST(Snapshot, SaysWhichShapeIsMissing) {
    TestWorld world, other;
    world.Add({.shape = CubeOf(0.5f)});
    world.Add({.shape = SphereOf(0.25f), .position = {3, 0, 0}});
    other.Add({.shape = CubeOf(0.5f)});
    const Bytes bytes = SnapshotOf(world.System());
    ExpectRefused(other.System(), bytes, ErrorCode::UnknownId);
    const ShapePtr others[] = {SphereOf(0.2500001f), CapsuleOf(0.1f, 0.25f), nullptr};
    ExpectRefused(other.System(), bytes, ErrorCode::UnknownId, {.shapes = others});
    const ShapePtr right[] = {CapsuleOf(0.1f, 0.25f), SphereOf(0.25f)};
    Restore(other.System(), bytes, {.shapes = right});
    EXPECT_EQ(other.System().HashState(), world.System().HashState());
}

TEST(Snapshot, KeepsGroupFiltersApartThatDecideAlike) {
    // Two pairs of bodies that overlap: of each pair both are in one filter's group, so that they do not collide;
    // bodies of different pairs do, since their filters are two objects.
    const auto filter = [] { return GroupFilterTable::Create({{0, 1}}).Value(); };
    const std::shared_ptr<const GroupFilter> filters[] = {filter(), filter()};
    EXPECT_EQ(filters[0]->ContentHash(), filters[1]->ContentHash());
    TestWorld world(NoGravity()), other(NoGravity());
    for (uint32_t i = 0; i < 4; ++i)
        world.Add({.shape = CubeOf(0.5f), .position = {0.6 * i, 0, 0}, .group = {filters[i / 2], 0, i % 2}});
    const Bytes bytes = SnapshotOf(world.System());
    const ShapePtr shapes[] = {CubeOf(0.5f)};
    const std::shared_ptr<const GroupFilter> one[] = {filter()}, two[] = {filter(), filter()};
    ExpectRefused(other.System(), bytes, ErrorCode::UnknownId, {.shapes = shapes, .groupFilters = one});
    Restore(other.System(), bytes, {.shapes = shapes, .groupFilters = two});
    for (int step = 0; step < 20; ++step) {
        world.Step();
        other.Step();
    }
    EXPECT_EQ(other.System().HashState(), world.System().HashState());
    EXPECT_EQ(world.Report().contacts, 1u);
}

TEST(Snapshot, WantsTheTypesOfJointsThatAreNotTheEngines) {
    TestWorld world, other;
    for (int i = 0; i < 2; ++i) world.Add({.shape = CubeOf(0.5f), .position = {2.0 * i, 0, 0}});
    CustomJointSettings screw;
    screw.bodyA = {0, 0};
    screw.bodyB = {1, 0};
    screw.make = MakeScrew;
    const JointId joint = world.System().Joints().Create(screw).Value();
    const Bytes bytes = SnapshotOf(world.System());
    const ShapePtr shapes[] = {CubeOf(0.5f)};
    ExpectRefused(other.System(), bytes, ErrorCode::UnknownId, {.shapes = shapes});
    std::vector<JointId> asked;
    Restore(other.System(), bytes, {.shapes = shapes, .makeJoint = [&](JointId id) {
                                        asked.push_back(id);
                                        return MakeScrew();
                                    }});
    EXPECT_EQ(asked, std::vector{joint});
    // What is there is kept.
    Restore(other.System(), bytes);
    EXPECT_EQ(asked.size(), 1u);
}

class Egg final : public CustomConvex {
public:
    explicit Egg(float length) : length_(length) {}
    Vector3 FarthestPoint(const Vector3& d) const override {
        return Vector3(d.x() > 0 ? length_ : -length_, d.y() > 0 ? 0.3f : -0.3f, d.z() > 0 ? 0.2f : -0.2f);
    }

private:
    float length_;
};

TEST(Snapshot, KnowsCustomShapesByWhatTheyAre) {
    const auto egg = [](float length) { return ShapePtr(CreateCustom<Egg>(length).Value()); };
    EXPECT_EQ(ContentHash(*egg(0.4f)), ContentHash(*egg(0.4f)));
    EXPECT_NE(ContentHash(*egg(0.4f)), ContentHash(*egg(0.41f)));
    TestWorld world, other;
    const BodyId body = world.Add({.shape = egg(0.4f)});
    const ShapePtr wrong[] = {egg(0.41f)}, right[] = {egg(0.41f), egg(0.4f)};
    const Bytes bytes = SnapshotOf(world.System());
    ExpectRefused(other.System(), bytes, ErrorCode::UnknownId, {.shapes = wrong});
    Restore(other.System(), bytes, {.shapes = right});
    // As children of compounds that are edited, which are contained whole, they cannot be written; the hash has them.
    const CompoundShape::ChildSettings children[] = {{.shape = egg(0.4f)}};
    EXPECT_TRUE(world.Bodies().SetShape(body, MutableCompound::Create(children).Value(), MassUpdate::Update));
    Bytes none = bytes;
    const Status saved = world.System().SaveSnapshot(none);
    ASSERT_FALSE(saved);
    EXPECT_EQ(saved.GetError().code, ErrorCode::Unsupported);
    EXPECT_TRUE(none.empty());
    const uint64_t before = world.System().HashState();
    EXPECT_TRUE(world.Bodies().MoveChild(body, {0, 0}, {0, 0.1f, 0}, {}, MassUpdate::Keep));
    EXPECT_NE(world.System().HashState(), before);
}

// ---- What is refused

TEST(Snapshot, OfWhichAnyByteIsWrongIsRefused) {
    TestWorld world(JointScene::Settings());
    JointScene scene(world);
    world.Add(SensorOf(CubeOf(1)));
    world.Steps(20);
    Bytes bytes = SnapshotOf(world.System());
    world.Step();
    const uint64_t state = world.System().HashState();
    const size_t every = kIsSanitized ? 997 : 97;
    for (size_t at = 0; at < bytes.size(); at += at < 200 ? 1 : every) {
        const std::byte was = bytes[at];
        bytes[at] ^= static_cast<std::byte>(1u << at % 8);
        EXPECT_FALSE(world.System().RestoreSnapshot(bytes)) << "byte " << at;
        bytes[at] = was;
    }
    for (size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : every)
        EXPECT_FALSE(world.System().RestoreSnapshot(std::span(bytes).first(size))) << "size " << size;
    bytes.push_back(std::byte{0});
    EXPECT_FALSE(world.System().RestoreSnapshot(bytes));
    bytes.pop_back();
    EXPECT_EQ(world.System().HashState(), state);
    world.Step();
    Restore(world.System(), bytes);
}

TEST(Snapshot, SaysWhatIsWrong) {
    TestWorld world;
    world.Add({.shape = CubeOf(0.5f)});
    const Bytes good = SnapshotOf(world.System());
    Bytes bad = good;
    bad[0] ^= std::byte{1};
    ExpectRefused(world.System(), bad, ErrorCode::Unsupported);  // no snapshot
    bad = good;
    bad[8] ^= std::byte{1};
    ExpectRefused(world.System(), bad, ErrorCode::Unsupported);  // another format
    bad = good;
    bad[bad.size() / 2] ^= std::byte{1};
    ExpectRefused(world.System(), bad, ErrorCode::Degenerate);
    ExpectRefused(world.System(), std::span(good).first(40), ErrorCode::Degenerate);
    ExpectRefused(world.System(), {}, ErrorCode::Unsupported);
}

class Listens final : public ContactListener {};

TEST(Snapshot, WantsAContactListenerWhereThereWasOne) {
    const Listens listener;
    TestWorld world;
    world.Add({.shape = CubeOf(0.5f)});
    const Bytes without = SnapshotOf(world.System());
    world.System().SetContactListener(&listener);
    const Bytes with = SnapshotOf(world.System());
    ExpectRefused(world.System(), without, ErrorCode::Unsupported);
    Restore(world.System(), with);
    world.System().SetContactListener(nullptr);
    ExpectRefused(world.System(), with, ErrorCode::Unsupported);
}

TEST(Snapshot, IsNotMadeInsideAStep) {
    struct Curious final : ContactListener {
        bool ShouldCollide(BodyId, BodyId) const override {
            Bytes bytes;
            saved = system->SaveSnapshot(bytes);
            restored = system->RestoreSnapshot(bytes);
            hash = system->HashState();
            return true;
        }
        PhysicsSystem* system = nullptr;
        mutable Status saved = Done{}, restored = Done{};
        mutable uint64_t hash = 1;
    };
    static int theReports = 0;
    SetMisuseHandler([](const Error&) { ++theReports; });
    TestWorld world;
    Curious listener;
    listener.system = &world.System();
    world.System().SetContactListener(&listener);
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Step();
    SetMisuseHandler(nullptr);
    ASSERT_FALSE(listener.saved);
    ASSERT_FALSE(listener.restored);
    EXPECT_EQ(listener.saved.GetError().code, ErrorCode::NotAllowedHere);
    EXPECT_EQ(listener.restored.GetError().code, ErrorCode::NotAllowedHere);
    EXPECT_EQ(listener.hash, 0u);
    EXPECT_GE(theReports, 1);
}

// ---- The hash

TEST(HashState, ChangesWithAllThatMatters) {
    TestWorld world;
    world.AddFloor();
    const BodyId a = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const BodyId b = world.Add({.shape = CubeOf(0.5f), .position = {3, 0.5, 0}});
    HingeJointSettings hinge;
    hinge.bodyA = a;
    hinge.bodyB = b;
    const JointId joint = world.System().Joints().Create(hinge).Value();
    world.Steps(3);
    const Bytes bytes = SnapshotOf(world.System());
    const uint64_t before = world.System().HashState();
    BodyInterface& bodies = world.Bodies();
    JointInterface& joints = world.System().Joints();
    const WorldState& state = WorldOf(world.System());
    WorldState& inside = WorldOf(world.System());
    const auto recordOfA = [&]() -> ContactRecord& {
        return inside.pairs.RecordOf(state.pairs.pairs[state.pairs.Find(0, a.index)]);
    };
    const std::pair<const char*, std::function<void()>> changes[] = {
        {"velocity",
         [&] {
             EXPECT_TRUE(bodies.SetVelocity(a, {0, 0, 1e-6f}, {0, 0, 0}));
         }},
        {"force",
         [&] {
             EXPECT_TRUE(bodies.AddForce(a, {0, 0, 1}));
         }},
        {"mask", [&] { EXPECT_TRUE(bodies.SetCategoryAndMask(a, 2, 3)); }},
        {"friction", [&] { EXPECT_TRUE(bodies.SetMaterial(a, {.friction = 0.51f})); }},
        {"motor", [&] { EXPECT_TRUE(joints.SetMotor(joint, JointAxis::AngularX, {.targetSpeed = 1})); }},
        {"effort", [&] { EXPECT_TRUE(joints.SetEffort(joint, {.substeps = 5})); }},
        {"sleep", [&] { EXPECT_TRUE(bodies.Sleep(a)); }},
        {"new body",
         [&] {
             world.Add({.shape = CubeOf(0.5f), .position = {9, 9, 9}});
         }},
        {"removed body", [&] { EXPECT_TRUE(bodies.Remove(a)); }},
        {"new body removed again",
         [&] {
             EXPECT_TRUE(bodies.Remove(world.Add({.shape = CubeOf(0.5f), .position = {99, 9, 9}})));
             world.Step(0);
         }},
        {"settings",
         [&] {
             SystemSettings settings = world.System().Settings();
             settings.sleep.seconds += 0.1f;
             EXPECT_TRUE(world.System().SetSettings(settings));
         }},
        {"slowness", [&] { inside.bodies.dynamics[a.index].slowSeconds += 0.01f; }},
        {"slow motion", [&] { inside.bodies.slowMotions[a.index].lately.linear[0] += 1e-3f; }},
        {"impulse", [&] { recordOfA().impulse[0] *= 1.001f; }},
        {"friction impulse", [&] { recordOfA().frictionImpulse[0] += 1; }},
        {"load", [&] { inside.pairs.loads[state.pairs.Find(0, a.index)].steps += 1; }},
        {"fat bounds", [&] { inside.colliders.colliders[a.index].fat.upper[0] += 1; }},
        {"remainder", [&] { inside.bodies.remainders[a.index].value[0] += 1e-12; }},
        {"joint impulse", [&] { inside.joints.records[joint.index].ownImpulse[1] += 1; }},
        {"turns", [&] { inside.joints.types[joint.index]->State()[0] += 6.28; }},
        {"turned", [&] { inside.joints.types[joint.index]->turnedA[0] += 1; }},
        {"generation", [&] { inside.bodies.cold[a.index].generation += 1; }},
    };
    for (const auto& [what, change] : changes) {
        change();
        EXPECT_NE(world.System().HashState(), before) << what;
        Restore(world.System(), bytes);
        EXPECT_EQ(world.System().HashState(), before) << what;
    }
}

TEST(HashState, IsTheSameForWorldsThatDifferInUserDataAlone) {
    TestWorld one, other;
    one.Add({.shape = CubeOf(0.5f), .userData = 1});
    other.Add({.shape = CubeOf(0.5f), .userData = 2});
    EXPECT_EQ(one.System().HashState(), other.System().HashState());
    EXPECT_NE(SnapshotOf(one.System()), SnapshotOf(other.System()));
}

TEST(HashState, OfPrefabsFollowsTheirContent) {
    const CompoundShape::ChildSettings children[] = {{.shape = CubeOf(0.3f)},
                                                     {.shape = SphereOf(0.3f), .position = {0.8f, 0, 0}}};
    EXPECT_EQ(ContentHash(*Compound::Create(children).Value()), ContentHash(*Compound::Create(children).Value()));
    EXPECT_EQ(ContentHash(*CubeOf(0.5f)), ContentHash(*CubeOf(0.5f)));
    EXPECT_NE(ContentHash(*CubeOf(0.5f)), ContentHash(*CubeOf(0.5000001f)));
    EXPECT_NE(ContentHash(*BoxOf(1, 2, 3)), ContentHash(*BoxOf(1, 3, 2)));
    EXPECT_NE(ContentHash(*SphereOf(0.5f)), ContentHash(*CubeOf(0.5f)));
}

// ---- Costs

TEST(Snapshot, SavedToBytesThatSufficeAllocatesNothing) {
    TestWorld world(JointScene::Settings());
    JointScene scene(world);
    world.Steps(30);
    Bytes bytes;
    EXPECT_TRUE(world.System().SaveSnapshot(bytes));
    EXPECT_NE(world.System().HashState(), 0u);
    world.Step();
    bytes.reserve(bytes.size() + 100000);
    const uint64_t before = AllocationCount();
    EXPECT_TRUE(world.System().SaveSnapshot(bytes));
    EXPECT_NE(world.System().HashState(), 0u);
    EXPECT_EQ(AllocationCount(), before);
}

TEST(Snapshot, StepsOfASettledWorldThatWentBackAllocateNothing) {
    TestWorld world(NoSleep());
    AddHeap(world);
    world.Steps(300);
    const Bytes bytes = SnapshotOf(world.System());
    for (int turn = 0; turn < 3; ++turn) {
        Restore(world.System(), bytes);
        const uint64_t before = AllocationCount();
        for (int step = 0; step < 20; ++step) {
            const Status status = world.System().Update(kStep);
            if (!status) ADD_FAILURE();
        }
        EXPECT_EQ(AllocationCount(), before);
    }
}

}  // namespace
}  // namespace fulcrum::testing
