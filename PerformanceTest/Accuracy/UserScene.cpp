#include <Fulcrum/PerformanceTest/Accuracy/UserScene.h>

#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/Samples/Runner/FileScene.h>
#include <Fulcrum/Samples/Runner/CommandLine.h>
#include <Fulcrum/Samples/Runner/Options.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <algorithm>
#include <limits>

namespace fulcrum::accuracy {

namespace {

// The scene that was loaded: runs, which are functions without arguments of their own, read it.
struct UserScene {
    SceneDescription description;
    std::string name;
    LabScene scene;
};
UserScene theScene;

double SizeOf(const BodyInterface& bodies, BodyId id, bool inner) {
    const ShapePtr shape = bodies.Exists(id) ? bodies.GetShape(id) : nullptr;
    if (!shape || bodies.GetMotionType(id) == MotionType::Static) return std::numeric_limits<double>::infinity();
    return double{inner ? shape->InnerRadius() : shape->OuterRadius()};
}

// The larger of the step's largest overlap and largest gap, relative to the sizes of the bodies.
double ErrorOf(LabWorld& world) {
    const BodyInterface& bodies = world.Bodies();
    const StepReport& report = world.System().Report();
    double error = 0;
    if (report.largestPenetration > 0)
        error = double{report.largestPenetration} /
                std::min(SizeOf(bodies, report.deepestA, true), SizeOf(bodies, report.deepestB, true));
    world.Joints().Visit([&](JointId id) {
        const double size = std::min(SizeOf(bodies, world.Joints().GetBodyA(id), false),
                                     SizeOf(bodies, world.Joints().GetBodyB(id), false));
        error = std::max(error, static_cast<double>(world.Joints().GetError(id).distance) / size);
    });
    return error;
}

void Run(LabRun& run) {
    const SceneDescription& description = theScene.description;
    LabWorld world(run, description.settings);
    const Result<SceneIds> ids = AddScene(world.System(), description);
    run.Require(bool(ids), "the scene can be created");
    if (!ids) return;
    world.domain = 1e9;
    const double duration = std::min(description.steps * description.dt, run.Seconds(60, 10)),
                 settles = std::min(0.5, 0.5 * duration);
    std::vector<double> errors;
    for (int i = run.Steps(duration); i > 0; --i) {
        world.Step();
        if (world.Time() >= settles) errors.push_back(ErrorOf(world));
    }
    const auto rank = errors.begin() + static_cast<ptrdiff_t>(errors.size() * 19 / 20);
    std::nth_element(errors.begin(), rank, errors.end());
    run.Error("overlap_or_gap", *rank);
    run.Figure("energy", world.System().GetEnergy());
}

}  // namespace

Result<const LabScene*> LoadUserScene(const std::string& name) {
    SceneDescription description;
    if (IsSceneFile(name)) {
        Result<SceneDescription> read = ReadScene(name);
        if (!read) return read.GetError();
        description = std::move(read.Value());
    } else {
        const Scene* scene = FindScene(name);
        if (!scene) return UnknownName("scene", name, SceneNames());
        Result<ExportedScene> exported = ExportScene(*scene, {});
        if (!exported) return Error{exported.GetError().code, name + ": " + exported.GetError().message};
        description = std::move(exported.Value().description);
    }
    theScene.description = std::move(description);
    theScene.name = std::filesystem::path(name).filename().string();
    theScene.scene = {
        .name = theScene.name.c_str(),
        .what = theScene.description.description.c_str(),
        .error =
            "the largest overlap or gap of a step over the size of its smaller body, exceeded in one "
            "of twenty steps",
        .influences = {.timeStep = true,
                       .contacts = true,
                       .joints = !theScene.description.joints.empty() || !theScene.description.ragdolls.empty()},
        .run = Run};
    return &theScene.scene;
}

const LabScene* FindUserScene(const std::string& name) {
    return theScene.scene.run && theScene.name == name ? &theScene.scene : nullptr;
}

}  // namespace fulcrum::accuracy
