// Bodies whose children come, go and move in the world: what is felt of it, by the body itself, by what touches it, by
// queries.
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

using ChildSettings = CompoundShape::ChildSettings;

ShapePtr MutableOf(const std::vector<ChildSettings>& children) { return MutableCompound::Create(children).Value(); }

// A row of cubes of 1 m along x, the first at the origin.
ShapePtr RowOf(int count, float spacing = 1) {
    std::vector<ChildSettings> children;
    for (int i = 0; i < count; ++i)
        children.push_back({.shape = CubeOf(0.5f), .position = {spacing * static_cast<float>(i), 0, 0}});
    return MutableOf(children);
}

TEST(MutableCompoundBody, MassInertiaAndCenterAreThoseOfTheChildren) {
    TestWorld world(NoGravity());
    const ShapePtr cube = CubeOf(0.5f);
    const BodyId id = world.Add({.shape = RowOf(1),
                                 .position = {10, 20, 30},
                                 .rotation = RotationAbout({0, 0, 1}, 90 * kDegree),
                                 .density = 100});
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(id), 100);
    const ChildId second = world.Bodies().AddChild(id, {.shape = cube, .position = {3, 0, 0}, .density = 2}).Value();
    // 100 kg at 0 and 200 kg at 3 m: the center at 2 m, which the body's rotation turns upwards.
    EXPECT_NEAR(world.Bodies().GetMass(id), 300, 1e-3);
    EXPECT_LT(Position(world.Bodies().GetCenterOfMass(id) - Position(10, 22, 30)).norm(), 1e-5);
    EXPECT_LT(Position(world.PositionOf(id) - Position(10, 20, 30)).norm(), 1e-6);
    // About the vertical axis, along the row: m (1 + 1) / 12; about the others also 100 2^2 + 200 1^2.
    ASSERT_TRUE(world.Bodies().SetVelocity(id, Vector3::Zero(), {0, 1, 0}));
    EXPECT_NEAR(world.Bodies().GetAngularMomentum(id).y(), 50, 1e-3);
    ASSERT_TRUE(world.Bodies().SetVelocity(id, Vector3::Zero(), {0, 0, 1}));
    EXPECT_NEAR(world.Bodies().GetAngularMomentum(id).z(), 650, 1e-3);
    // Without the first the second keeps its 200 kg.
    ASSERT_TRUE(world.Bodies().RemoveChild(id, {0, 0}));
    EXPECT_NEAR(world.Bodies().GetMass(id), 200, 1e-3);
    EXPECT_LT(Position(world.Bodies().GetCenterOfMass(id) - Position(10, 23, 30)).norm(), 1e-5);
    // Mass and center may stay.
    ASSERT_TRUE(world.Bodies().MoveChild(id, second, {7, 0, 0}, {}, MassUpdate::Keep));
    EXPECT_NEAR(world.Bodies().GetMass(id), 200, 1e-3);
    EXPECT_LT(Position(world.Bodies().GetCenterOfMass(id) - Position(10, 23, 30)).norm(), 1e-5);
}

TEST(MutableCompoundBody, MaterialPointsKeepTheirVelocities) {
    TestWorld world(NoGravity());
    const BodyId id = world.Add({.shape = RowOf(4), .linearVelocity = {1, 2, 3}, .angularVelocity = {0.5f, -1, 2}});
    const Position points[] = {{0, 0, 0}, {3, 0, 0}, {1, 2, -1}};
    std::vector<Vector3> before;
    for (const Position& point : points) before.push_back(world.Bodies().GetVelocityAt(id, point));
    ASSERT_TRUE(world.Bodies().RemoveChild(id, {3, 0}));
    ASSERT_TRUE(world.Bodies().AddChild(id, {.shape = SphereOf(1), .position = {-5, 3, 0}}));
    ASSERT_TRUE(world.Bodies().MoveChild(id, {1, 0}, {0, 4, 0}, {}));
    // Velocities and arms of some 10, with float's rounding.
    for (size_t i = 0; i < 3; ++i)
        EXPECT_LT(Length(Vector3(world.Bodies().GetVelocityAt(id, points[i]) - before[i])), 1e-5f);
}

TEST(MutableCompoundBody, ForcesKeepTheirLines) {
    // A force through what becomes the center of mass turns nothing.
    TestWorld world(NoGravity());
    const BodyId id = world.Add({.shape = RowOf(3)});
    ASSERT_TRUE(world.Bodies().AddForceAt(id, {0, 3000, 0}, {0.5, 0, 0}));
    ASSERT_TRUE(world.Bodies().RemoveChild(id, {2, 0}));
    world.Step();
    EXPECT_LT(Length(world.Bodies().GetAngularVelocity(id)), 1e-6f);
    EXPECT_NEAR(world.VelocityOf(id).y(), 3000.0 / 2000 * kStep, 1e-6);
}

TEST(MutableCompoundBody, WhatRestedOnAChildWakesAndFalls) {
    TestWorld world;
    const BodyId table = world.Add({.shape = RowOf(9), .motion = MotionType::Static});
    std::vector<BodyId> boxes;
    for (int i = 0; i < 9; ++i) boxes.push_back(world.Add({.shape = CubeOf(0.3f), .position = {double(i), 0.8, 0}}));
    world.Run(2);
    ASSERT_EQ(world.Report().awakeBodies, 0u);
    ASSERT_TRUE(world.Bodies().RemoveChild(table, {2, 0}));
    ASSERT_TRUE(world.Bodies().MoveChild(table, {6, 0}, {6, -50, 0}, {}));
    EXPECT_TRUE(world.Bodies().IsAwake(boxes[2]) && world.Bodies().IsAwake(boxes[6]));
    EXPECT_FALSE(world.Bodies().IsAwake(boxes[0]) || world.Bodies().IsAwake(boxes[4]) ||
                 world.Bodies().IsAwake(boxes[8]));
    world.Run(2);
    // 2 s of fall are 19.6 m, but for what the edges of the neighbors, 0.2 m away, hold up: nothing.
    for (int i : {2, 6}) EXPECT_NEAR(world.PositionOf(boxes[static_cast<size_t>(i)]).y(), 0.8 - 19.62, 0.4) << i;
    for (int i : {0, 1, 3, 4, 5, 7, 8})
        EXPECT_NEAR(world.PositionOf(boxes[static_cast<size_t>(i)]).y(), 0.8, 0.01) << i;
}

TEST(MutableCompoundBody, WhatComesUnderAFallingBoxHoldsIt) {
    TestWorld world;
    const BodyId table = world.Add({.shape = RowOf(1), .motion = MotionType::Static});
    const BodyId box = world.Add({.shape = CubeOf(0.3f), .position = {20, 3, 0}});
    world.Steps(10);
    // More children than the table began with: its colliders are in several runs.
    for (int i = 1; i < 40; ++i)
        ASSERT_TRUE(world.Bodies().AddChild(table, {.shape = CubeOf(0.5f), .position = {static_cast<float>(i), 0, 0}}));
    world.Run(3);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.8, 0.01);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    // Another shape of the same child: the top is 0.3 m lower.
    ASSERT_TRUE(world.Bodies().SetChild(table, {20, 0}, {.shape = CubeOf(0.2f), .position = {20, 0, 0}}));
    ASSERT_TRUE(world.Bodies().RemoveChild(table, {19, 0}));
    ASSERT_TRUE(world.Bodies().RemoveChild(table, {21, 0}));
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.01);
}

TEST(MutableCompoundBody, AChildOfAKinematicBodyPushes) {
    TestWorld world;
    world.AddFloor();
    const BodyId piston = world.Add({.shape = RowOf(2, 10), .motion = MotionType::Kinematic, .position = {0, 0.5, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {2, 0.5, 0}, .material = {.friction = 0.2f}});
    world.Run(1);
    for (int i = 1; i <= 120; ++i) {
        const float x = static_cast<float>(i) / 60.0f;  // 1 m/s
        ASSERT_TRUE(world.Bodies().MoveChild(piston, {0, 0}, {x, 0, 0}, {}));
        world.Step();
    }
    // Its face ended at 2.5 m. What overlaps is pushed out at 3 m/s, and slides on at less than that: v^2 / (2 mu g)
    // = 2.3 m.
    EXPECT_GT(world.PositionOf(box).x(), 2.98);
    EXPECT_LT(world.PositionOf(box).x(), 5.3);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.02);
}

TEST(MutableCompoundBody, JointsStayWhereTheyAre) {
    TestWorld world;
    const BodyId base = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static});
    const BodyId arm = world.Add({.shape = RowOf(4), .position = {1.5, 0, 0}});
    HingeJointSettings hinge;
    hinge.bodyA = base;
    hinge.bodyB = arm;
    hinge.anchorA.point = {0.75, 0, 0};
    hinge.anchorA.axis = {0, 0, 1};
    const JointId joint = world.System().Joints().Create(hinge).Value();
    world.Steps(20);
    const Position at = world.System().Joints().GetFrameB(joint).position;
    for (uint32_t child : {3u, 2u}) ASSERT_TRUE(world.Bodies().RemoveChild(arm, {child, 0}));
    EXPECT_LT(Position(world.System().Joints().GetFrameB(joint).position - at).norm(), 1e-5);
    for (int i = 0; i < 120; ++i) {
        world.Step();
        const Position gap =
            world.System().Joints().GetFrameB(joint).position - world.System().Joints().GetFrameA(joint).position;
        ASSERT_LT(gap.norm(), 0.005) << i;
    }
}

// A heap of boxes in a bowl of mutable children, on its side a mutable body; edited as the steps go.
struct EditedScene {
    TestWorld world;
    BodyId bowl, raft;
    std::vector<ChildId> ofBowl, ofRaft;
    RandomPoses random{5};

    explicit EditedScene(uint32_t threads) : world({}, threads) {
        world.AddFloor({}, {0, -3, 0});
        std::vector<ChildSettings> slabs, bars;
        for (int i = 0; i < 36; ++i)
            slabs.push_back({.shape = BoxOf(0.5f, 0.2f, 0.5f),
                             .position = {static_cast<float>(i % 6) - 2.5f, 0, static_cast<float>(i / 6) - 2.5f}});
        for (int i = 0; i < 5; ++i)
            bars.push_back({.shape = BoxOf(0.2f, 0.2f, 0.8f), .position = {0.45f * static_cast<float>(i), 0, 0}});
        bowl = world.Add({.shape = MutableOf(slabs), .motion = MotionType::Static});
        raft = world.Add({.shape = MutableOf(bars), .position = {-1, 1, 0}});
        for (uint32_t i = 0; i < 36; ++i) ofBowl.push_back({i, 0});
        for (uint32_t i = 0; i < 5; ++i) ofRaft.push_back({i, 0});
        for (int i = 0; i < 60; ++i) {
            const Position at(i % 4 * 1.1 - 1.6, 2 + 0.7 * (i / 16), i / 4 % 4 * 1.1 - 1.6);
            world.Add({.shape = i % 3 ? CubeOf(0.25f) : SphereOf(0.3f), .position = at});
        }
    }
    uint32_t Below(size_t count) {
        return std::min(static_cast<uint32_t>(random.Between(0, static_cast<float>(count))),
                        static_cast<uint32_t>(count - 1));
    }
    ChildSettings Next(float reach) {
        ChildSettings child{.shape = BoxOf(0.3f, 0.15f, 0.3f)};
        child.position = random.InCube().cwiseProduct(Vector3(reach, 0.2f, reach));
        child.rotation = random.Rotation();
        child.density = random.Between(0.5f, 2);
        return child;
    }
    void Edit(BodyId body, std::vector<ChildId>& ids, float reach) {
        const uint32_t any = Below(ids.size());
        const float what = random.Between(0, 4);
        if (what < 1 || ids.size() < 3) {
            ids.push_back(world.Bodies().AddChild(body, Next(reach)).Value());
        } else if (what < 2) {
            EXPECT_TRUE(world.Bodies().RemoveChild(body, ids[any]));
            ids.erase(ids.begin() + any);
        } else if (what < 3) {
            EXPECT_TRUE(world.Bodies().SetChild(body, ids[any], Next(reach)));
        } else {
            const ChildSettings place = Next(reach);
            EXPECT_TRUE(world.Bodies().MoveChild(body, ids[any], place.position, place.rotation));
        }
    }
    void EditAndStep() {
        Edit(bowl, ofBowl, 2.5f);
        Edit(raft, ofRaft, 1);
        world.Step();
    }
};

TEST(MutableCompoundBody, EditsGiveTheSameBitsOnAnyNumberOfThreads) {
    std::vector<uint64_t> hashes;
    for (uint32_t threads : {1u, 2u, 3u, 4u}) {
        EditedScene scene(threads);
        for (int i = 0; i < 120; ++i) scene.EditAndStep();
        EXPECT_TRUE(scene.world.AllFinite());
        hashes.push_back(scene.world.System().HashPoses());
    }
    for (uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

// Bodies made of what the edits came to stand where the edited ones do, before the first step: from there on they are
// the same.
TEST(MutableCompoundBody, AnEditedWorldIsOneMadeInItsFinalState) {
    EditedScene edited(1);
    for (int i = 0; i < 100; ++i) {
        edited.Edit(edited.bowl, edited.ofBowl, 2.5f);
        edited.Edit(edited.raft, edited.ofRaft, 1);
    }
    TestWorld fresh;
    edited.world.System().VisitBodies([&](BodyId id) {
        BodyInterface& bodies = edited.world.Bodies();
        BodySettings s{
            .shape = bodies.GetShape(id), .motion = bodies.GetMotionType(id), .position = bodies.GetPose(id).position};
        // Children that came later weigh what they do beside the first: density 1000 on average was true of those
        // alone.
        s.mass = bodies.GetMass(id);
        EXPECT_EQ(fresh.Add(s), id);
    });
    for (int i = 0; i < 100; ++i) {
        edited.world.Step();
        fresh.Step();
        // The same to the rounding of the raft's mass and place, until collisions have made much of that.
        if (i != 10) continue;
        const Pose a = edited.world.Bodies().GetPose(edited.raft), b = fresh.Bodies().GetPose(edited.raft);
        EXPECT_LT(Position(a.position - b.position).norm(), 1e-5);
    }
    // Queries name the same children in the same places of the bowl, which does not move.
    RandomPoses random(9);
    int hits = 0;
    for (int i = 0; i < 500; ++i) {
        const Vector3 from = random.InCube() * 4;
        const Ray ray{Position(from.x(), -1.5, from.z()), Vector3(0.1f, 3, 0.2f)};
        WorldRayHit a, b;
        const bool hitA = edited.world.System().Queries().CastRay(ray, a),
                   hitB = fresh.System().Queries().CastRay(ray, b);
        if (!hitA || a.body != edited.bowl || !hitB || b.body != edited.bowl) continue;
        ++hits;
        EXPECT_EQ(a.subShape.child, b.subShape.child);
        EXPECT_EQ(a.fraction, b.fraction);
    }
    EXPECT_GT(hits, 80);
}

TEST(MutableCompoundBody, EditsThatAreTakenBackLeaveNoBitBehind) {
    const auto build = [](TestWorld& world) {
        world.AddFloor();
        return world.Add({.shape = RowOf(5, 0.9f),
                          .position = {0, 3, 0},
                          .rotation = RotationAbout({0.6f, 0, 0.8f}, 0.5),
                          .angularVelocity = {1, 2, 3}});
    };
    TestWorld never, edited;
    build(never);
    const BodyId id = build(edited);
    // Kept mass properties: not even the center of mass goes there and back.
    for (int i = 0; i < 20; ++i) {
        const ChildId child =
            edited.Bodies().AddChild(id, {.shape = SphereOf(0.5f), .position = {0, 2, 0}}, MassUpdate::Keep).Value();
        ASSERT_TRUE(edited.Bodies().MoveChild(id, {2, 0}, {9, 9, 9}, {}, MassUpdate::Keep));
        ASSERT_TRUE(edited.Bodies().MoveChild(id, {2, 0}, {2 * 0.9f, 0, 0}, {}, MassUpdate::Keep));
        ASSERT_TRUE(edited.Bodies().RemoveChild(id, child, MassUpdate::Keep));
    }
    for (int i = 0; i < 200; ++i) {
        never.Step();
        edited.Step();
        ASSERT_EQ(never.System().HashPoses(), edited.System().HashPoses()) << i;
    }
}

// Queries of an edited body, awake and after steps, against queries of its shape alone.
TEST(MutableCompoundBody, QueriesSeeTheEditsAndNameTheChild) {
    EditedScene scene(1);
    RandomPoses random(3);
    int hits = 0;
    for (int i = 0; i < 150; ++i) {
        scene.EditAndStep();
        scene.Edit(scene.raft, scene.ofRaft, 1);
        const Pose pose = scene.world.Bodies().GetPose(scene.raft);
        const Position center = scene.world.Bodies().GetCenterOfMass(scene.raft);
        const Vector3 from = random.Direction() * 5;
        const Ray ray{center + from.cast<double>(), from * -1.5f + random.InCube() * 1.5f};
        std::vector<WorldRayHit> all;
        scene.world.System().Queries().CastRayAll(ray, all);
        const auto mine =
            std::find_if(all.begin(), all.end(), [&](const WorldRayHit& hit) { return hit.body == scene.raft; });
        RayHit expected;
        const bool isHit = RayCaster(ray).CastClosest(*scene.world.Bodies().GetShape(scene.raft),
                                                      {center, pose.rotation}, {}, expected);
        ASSERT_EQ(mine != all.end(), isHit) << i;
        if (!isHit) continue;
        ++hits;
        EXPECT_NEAR(mine->fraction, expected.fraction, 1e-5f);
        const ChildId child = scene.world.Bodies().GetChildren(scene.raft)->IdOf(mine->subShape.child);
        EXPECT_NE(std::find(scene.ofRaft.begin(), scene.ofRaft.end(), child), scene.ofRaft.end());
    }
    EXPECT_GT(hits, 50);
}

TEST(MutableCompoundBody, ASettledStepAllocatesNothing) {
    EditedScene scene(1);
    for (int i = 0; i < 30; ++i) scene.EditAndStep();
    SystemSettings settings = scene.world.System().Settings();
    settings.sleep.enabled = false;
    ASSERT_TRUE(scene.world.System().SetSettings(settings));
    scene.world.Steps(1000);  // the last contacts to settle may be the first of their color
    const uint64_t before = AllocationCount();
    for (int i = 0; i < 50; ++i) {
        const Status status = scene.world.System().Update(kStep);
        if (!status) ADD_FAILURE();
    }
    EXPECT_EQ(AllocationCount() - before, 0u);
}

TEST(MutableCompoundBody, BodiesOfOneShapeAreEditedByThemselves) {
    TestWorld world(NoGravity());
    const ShapePtr row = RowOf(3);
    const BodyId a = world.Add({.shape = row}), b = world.Add({.shape = row, .position = {0, 5, 0}});
    ASSERT_TRUE(world.Bodies().RemoveChild(a, {1, 0}));
    EXPECT_EQ(world.Bodies().GetChildren(a)->Count(), 2u);
    EXPECT_EQ(world.Bodies().GetChildren(b)->Count(), 3u);
    EXPECT_EQ(static_cast<const MutableCompound&>(*row).Count(), 3u);
    // Removed and made again: nothing of the first is left.
    ASSERT_TRUE(world.Bodies().Remove(a));
    world.Step();
    const BodyId c = world.Add({.shape = row, .position = {0, -5, 0}});
    world.Step();
    EXPECT_EQ(world.Bodies().GetChildren(c)->Count(), 3u);
    EXPECT_EQ(world.Bodies().GetChildren(a), nullptr);
}

TEST(MutableCompoundBody, BadEditsAreRefusedAndChangeNothing) {
    TestWorld world;
    const BodyId cube = world.Add({.shape = CubeOf(1)}),
                 row = world.Add({.shape = RowOf(2), .position = {0, 5, 0}, .mass = 1});
    const ShapePtr tiny = CubeOf(1e-3f), cubeShape = CubeOf(1);
    const auto code = [](const auto& result) { return result ? ErrorCode(-1) : result.GetError().code; };
    EXPECT_EQ(code(world.Bodies().AddChild({99, 0}, {.shape = tiny})), ErrorCode::UnknownId);
    EXPECT_EQ(code(world.Bodies().AddChild(cube, {.shape = tiny})), ErrorCode::Unsupported);
    EXPECT_EQ(code(world.Bodies().AddChild(row, {.shape = nullptr})), ErrorCode::Unsupported);
    EXPECT_EQ(code(world.Bodies().MoveChild(row, {2, 0}, {0, 0, 0}, {})), ErrorCode::UnknownId);
    EXPECT_EQ(code(world.Bodies().MoveChild(row, {1, 0}, {0, INFINITY, 0}, {})), ErrorCode::NonFinite);
    EXPECT_EQ(code(world.Bodies().MoveChild(row, {1, 0}, {0, 0, 0}, {0, 0, 0, 3})), ErrorCode::Unnormalized);
    EXPECT_EQ(code(world.Bodies().AddChild(row, {.shape = cubeShape, .density = 3e38f})), ErrorCode::OutOfRange);
    EXPECT_EQ(world.Bodies().GetMass(row), 1);
    EXPECT_EQ(world.Bodies().GetChildren(row)->Count(), 2u);
    EXPECT_EQ(world.Bodies().GetChildren(cube), nullptr);
}

TEST(SetShape, TheBodyGoesOnAsTheNewShape) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .density = 500});
    const BodyId above = world.Add({.shape = CubeOf(0.3f), .position = {0, 1.3, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(above));
    ASSERT_TRUE(world.Bodies().SetShape(box, CubeOf(0.25f)));
    EXPECT_TRUE(world.Bodies().IsAwake(box) && world.Bodies().IsAwake(above));
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(box), 500 * 0.125f);
    world.Run(3);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.25, 0.01);
    EXPECT_NEAR(world.PositionOf(above).y(), 0.8, 0.02);
    // To a mutable compound and on; the mass stays.
    ASSERT_TRUE(world.Bodies().SetShape(box, RowOf(3, 0.9f), MassUpdate::Keep));
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(box), 500 * 0.125f);
    ASSERT_TRUE(world.Bodies().RemoveChild(box, {2, 0}));
    EXPECT_NEAR(world.Bodies().GetMass(box), 500 * 0.125 * 2 / 3, 1e-3);
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.02);
    EXPECT_TRUE(world.AllFinite());
    EXPECT_EQ(world.Bodies().SetShape(box, nullptr).GetError().code, ErrorCode::Unsupported);
    EXPECT_EQ(world.Bodies().SetShape({77, 0}, CubeOf(1)).GetError().code, ErrorCode::UnknownId);
}

}  // namespace
}  // namespace fulcrum::testing
