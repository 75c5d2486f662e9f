// A world that goes back to a snapshot repeats every bit, whatever is in it: by the hash of the whole state after each
// step, in the world that was saved and in an empty one.
#include <Fulcrum/Samples/Scenes/SceneWorld.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/FastScene.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/SurfaceScene.h>
#include <Fulcrum/UnitTests/Support/WorldAccess.h>

#include <algorithm>
#include <functional>

namespace fulcrum::testing {
namespace {

// What is to be done before a step, by its number.
using BeforeStep = std::function<void(int)>;

struct Run {
    PhysicsSystem& system;
    BeforeStep beforeStep;
    std::function<void()> step;

    uint64_t Step(int number) const {
        if (beforeStep) beforeStep(number);
        step();
        return system.HashState();
    }
};

// Runs `steps`, saves at some of them, goes back to each, the last first, and repeats what followed.
void ExpectRepeats(const Run& run, int steps, int every, int repeated) {
    std::vector<uint64_t> hashes;
    std::vector<std::pair<int, Bytes>> saved;
    for (int step = 0; step < steps; ++step) {
        if (step % every == every / 2) {
            saved.emplace_back(step, SnapshotOf(run.system));
        }
        hashes.push_back(run.Step(step));
    }
    const Assets assets(run.system);
    while (!saved.empty()) {
        const auto& [from, bytes] = saved.back();
        const Status restored = run.system.RestoreSnapshot(bytes, assets.All());
        ASSERT_TRUE(restored) << restored.GetError().message;
        ASSERT_TRUE(SnapshotOf(run.system) == bytes) << "what was restored is not what was saved, of step " << from;
        const ColliderStore& colliders = WorldOf(run.system).colliders;
        for (const BoundsTree* tree : {&colliders.staticTree, &colliders.movingTree, &colliders.sensorTree})
            tree->Validate();
        for (int step = from; step < std::min(from + repeated, steps); ++step)
            ASSERT_EQ(run.Step(step), hashes[static_cast<size_t>(step)]) << "step " << step << ", from " << from;
        saved.pop_back();
    }
}

Run RunOf(TestWorld& world, BeforeStep beforeStep) {
    return {world.System(), std::move(beforeStep), [&world] { world.Step(); }};
}

TEST(SnapshotResume, OfTheMixedScene) {
    for (uint32_t threads : SomeOf({4u, 1u, 2u})) {
        TestWorld world({}, threads);
        MixedScene scene(world);
        ExpectRepeats(RunOf(world, [&](int step) { scene.BeforeStep(step); }), 220, 40, 100);
    }
}

// Longer steps look at the impulses of shorter ones.
TEST(SnapshotResume, OfStepsOfOtherLengths) {
    for (uint32_t threads : SomeOf({4u, 1u})) {
        TestWorld world({}, threads);
        MixedScene scene(world);
        double dt = 0;
        const auto beforeStep = [&](int step) {
            scene.BeforeStep(step);
            dt = step % 7 < 4 ? 1.0 / 240 : 1.0 / 30;
        };
        ExpectRepeats({world.System(), beforeStep, [&] { ASSERT_TRUE(world.System().Update(dt)); }}, 400, 20, 40);
    }
}

TEST(SnapshotResume, OfTheJointScene) {
    for (uint32_t threads : SomeOf({4u, 1u, 2u})) {
        TestWorld world(JointScene::Settings(), threads);
        JointScene scene(world);
        ExpectRepeats(RunOf(world, [&](int step) { scene.BeforeStep(step); }), 240, 40, 100);
    }
}

TEST(SnapshotResume, OfTheSurfaceScene) {
    for (uint32_t threads : SomeOf({4u, 1u, 2u})) {
        TestWorld world({}, threads);
        BuildSurfaceScene(world);
        ExpectRepeats(RunOf(world, {}), 220, 40, 100);
    }
}

TEST(SnapshotResume, OfTheFastScene) {
    for (uint32_t threads : SomeOf({4u, 1u, 2u})) {
        TestWorld world({}, threads);
        BuildFastScene(world);
        ExpectRepeats(RunOf(world, {}), 120, 20, 100);
    }
}

// Under the sanitizers this is where every scene runs: a third of a second each.
TEST(SnapshotResume, OfSampleScenes) {
    const int steps = kIsSanitized ? 20 : 120;
    for (const Scene* scene : AllScenes()) {
        if (scene->beforeStep || scene->query) continue;
        SCOPED_TRACE(scene->name);
        ThreadPool jobs(2);
        const auto world = SceneWorld::Create(*scene, {}, &jobs);
        ASSERT_TRUE(world);
        PhysicsSystem& system = world.Value()->System();
        int bodies = 0;
        system.VisitBodies([&](BodyId) { ++bodies; });
        if (bodies > (kIsSanitized ? 500 : 3000)) continue;
        ExpectRepeats({system, {}, [&] { ASSERT_TRUE(system.Update(kStep)); }}, steps, steps / 3, steps / 2);
    }
}

}  // namespace
}  // namespace fulcrum::testing
