// Worlds: create, set up, step, report, compare, save.
#include <Fulcrum/Assets/Json/JsonWriter.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Version.h>
#include <Fulcrum/Web/Bindings/Exchange.h>

#include <cstring>

namespace fulcrum::web {

namespace {

std::unique_ptr<World> WorldWith(int threads) {
    auto world = std::make_unique<World>();
    if (threads > 1) world->threads = std::make_unique<ThreadPool>(static_cast<uint32_t>(threads));
    return world;
}

void PutHash(uint64_t hash) {
    Shared().numbers[0] = static_cast<double>(hash >> 32);
    Shared().numbers[1] = static_cast<double>(hash & 0xFFFFFFFFu);
}

Json Written(const StepErrors& errors) {
    return {{"areMeasured", errors.areMeasured},     {"energyChange", errors.energyChange},
            {"energyGain", errors.energyGain},       {"mostGaining", IdOf(errors.mostGaining)},
            {"momentumError", errors.momentumError}, {"angularMomentumError", errors.angularMomentumError},
            {"pushEnergy", errors.pushEnergy},       {"largestPushEnergy", errors.largestPushEnergy},
            {"mostPushed", IdOf(errors.mostPushed)}};
}

}  // namespace

FULCRUM_FOR_JAVASCRIPT int fulcrum_version() {
    return Answer({{"version", FULCRUM_VERSION_STRING}, {"simd", kSimdName}, {"lanes", kLanes}});
}

// Input: settings. The world, or null after an error.
FULCRUM_FOR_JAVASCRIPT World* fulcrum_createWorld(int threads) {
    SystemSettings settings;
    if (!ReadInput("settings", [&](JsonReader& fields) { Describe(fields, settings); })) return nullptr;
    std::unique_ptr<World> world = WorldWith(threads);
    Result<std::unique_ptr<PhysicsSystem>> system = PhysicsSystem::Create(settings, world->threads.get());
    if (!system) return Fail(system.GetError()), nullptr;
    world->own = std::move(system.Value());
    return world.release();
}

// Input: scene, seed, solver, gravityScale, measuresErrors. Likewise.
FULCRUM_FOR_JAVASCRIPT World* fulcrum_createScene(int threads) {
    std::string name;
    SceneInput input;
    if (!ReadInput("options", [&](JsonReader& fields) {
            fields.Field("scene", name);
            fields.Field("seed", input.seed);
            fields.Field("solver", input.solver);
            fields.Field("gravityScale", input.gravityScale);
            fields.Field("measuresErrors", input.measuresErrors);
        }))
        return nullptr;
    const Scene* scene = FindScene(name);
    if (!scene) return Fail(WrongAt("scene", "there is no scene \"" + name + "\"")), nullptr;
    std::unique_ptr<World> world = WorldWith(threads);
    Result<std::unique_ptr<SceneWorld>> created = SceneWorld::Create(*scene, input, world->threads.get());
    if (!created) return Fail(created.GetError()), nullptr;
    world->scene = std::move(created.Value());
    return world.release();
}

FULCRUM_FOR_JAVASCRIPT void fulcrum_destroyWorld(World* world) { delete world; }

FULCRUM_FOR_JAVASCRIPT int fulcrum_scenes() {
    Json list = Json::array();
    for (const Scene* scene : AllScenes())
        list.push_back({{"name", scene->name},
                        {"description", scene->description},
                        {"kind", scene->kind == SceneKind::Performance ? "Performance" : "Sample"},
                        {"steps", scene->steps}});
    return Answer(list);
}

FULCRUM_FOR_JAVASCRIPT int fulcrum_getSettings(World* world) { return Answer(Written(world->System().Settings())); }
// Input: the settings to change; others stay.
FULCRUM_FOR_JAVASCRIPT int fulcrum_setSettings(World* world) {
    SystemSettings settings = world->System().Settings();
    if (!ReadInput("settings", [&](JsonReader& fields) { Describe(fields, settings); })) return 0;
    return Outcome(world->System().SetSettings(settings));
}

FULCRUM_FOR_JAVASCRIPT int fulcrum_step(World* world, double dt) {
    return Outcome(world->scene ? world->scene->Step(dt) : world->System().Update(dt));
}

FULCRUM_FOR_JAVASCRIPT int fulcrum_report(World* world) {
    const StepReport& report = world->System().Report();
    Json stages = Json::object();
    for (int stage = 0; stage < kStageCount; ++stage)
        stages[StageName(stage)] = report.stageMs[static_cast<size_t>(stage)];
    Json efforts = Json::array();
    for (const IslandEffortReport& effort : report.mostEffort)
        if (effort.substeps > 0)
            efforts.push_back({{"substeps", effort.substeps},
                               {"velocityIterations", effort.velocityIterations},
                               {"positionIterations", effort.positionIterations},
                               {"culprit", IdOf(effort.culprit)},
                               {"bodies", effort.bodies},
                               {"isDirect", effort.isDirect}});
    return Answer({{"step", report.step},
                   {"totalMs", report.totalMs},
                   {"stageMs", stages},
                   {"bodies", report.bodies},
                   {"awakeBodies", report.awakeBodies},
                   {"pairs", report.pairs},
                   {"contacts", report.contacts},
                   {"contactPoints", report.contactPoints},
                   {"joints", report.joints},
                   {"islands", report.islands},
                   {"islandsWithMoreEffort", report.islandsWithMoreEffort},
                   {"mostEffort", efforts},
                   {"largestPenetration", report.largestPenetration},
                   {"deepestA", IdOf(report.deepestA)},
                   {"deepestB", IdOf(report.deepestB)},
                   {"largestJointError", report.largestJointError},
                   {"largestJointAngle", report.largestJointAngle},
                   {"frozenBodies", report.frozenBodies},
                   {"sweptBodies", report.sweptBodies},
                   {"errors", Written(report.errors)}});
}

FULCRUM_FOR_JAVASCRIPT void fulcrum_hashPoses(World* world) { PutHash(world->System().HashPoses()); }
FULCRUM_FOR_JAVASCRIPT void fulcrum_hashState(World* world) { PutHash(world->System().HashState()); }
FULCRUM_FOR_JAVASCRIPT double fulcrum_energy(World* world) { return world->System().GetEnergy(); }
FULCRUM_FOR_JAVASCRIPT double fulcrum_memoryUsed(World* world) {
    return static_cast<double>(world->System().MemoryUsed());
}
// Threads that step the world; fewer than asked for where the browser starts no more.
FULCRUM_FOR_JAVASCRIPT int fulcrum_threads(World* world) {
    return world->threads ? static_cast<int>(world->threads->WorkerCount()) : 1;
}

// The answer is the snapshot's bytes.
FULCRUM_FOR_JAVASCRIPT int fulcrum_save(World* world) {
    std::vector<std::byte> bytes;
    if (!Outcome(world->System().SaveSnapshot(bytes))) return 0;
    Shared().answer.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return 1;
}
// Input: such bytes.
FULCRUM_FOR_JAVASCRIPT int fulcrum_restore(World* world) {
    const std::string& input = Shared().input;
    return Outcome(world->System().RestoreSnapshot({reinterpret_cast<const std::byte*>(input.data()), input.size()}));
}

}  // namespace fulcrum::web
