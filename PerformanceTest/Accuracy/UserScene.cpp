#include <Fulcrum/PerformanceTest/Accuracy/UserScene.h>

#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/Samples/Runner/FileScene.h>
#include <Fulcrum/Samples/Runner/CommandLine.h>
#include <Fulcrum/Samples/Runner/Options.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <algorithm>
#include <cstdio>
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

// An error, and the bodies or the joint that have it.
struct StepError {
    double value = 0;  // relative to the size of the smaller body
    BodyId bodyA, bodyB;
    JointId joint;
    bool isOfJoint = false;
    double time = 0;  // s
};

// The largest of the step's overlaps and errors of joints. That of an angle is its arc at the outer radius.
StepError ErrorOf(LabWorld& world) {
    const BodyInterface& bodies = world.Bodies();
    const StepReport& report = world.Ours("reports of steps").Report();
    StepError error{.bodyA = report.deepestA, .bodyB = report.deepestB, .joint = {}, .time = world.Time()};
    if (report.largestPenetration > 0)
        error.value = double{report.largestPenetration} /
                      std::min(SizeOf(bodies, report.deepestA, true), SizeOf(bodies, report.deepestB, true));
    world.Joints().Visit([&](JointId id) {
        const BodyId a = world.Joints().GetBodyA(id), b = world.Joints().GetBodyB(id);
        const JointError apart = world.Joints().GetError(id);
        const double gap = double{apart.distance} / std::min(SizeOf(bodies, a, false), SizeOf(bodies, b, false)),
                     value = std::max(gap, double{apart.angle});
        if (value <= error.value) return;
        error = {.value = value, .bodyA = a, .bodyB = b, .joint = id, .isOfJoint = true, .time = world.Time()};
    });
    return error;
}

// `name`, or "body 3" by the place in its list.
template <class Id, class Elements>
std::string NameOf(const char* kind, Id id, const std::vector<Id>& ids, const Elements& elements) {
    const auto at = static_cast<size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
    if (at == ids.size()) return std::string("a ") + kind + " of a ragdoll";
    return elements[at].name.empty() ? kind + (" " + std::to_string(at)) : "`" + elements[at].name + "`";
}

// "4.2 % at 3.1 s, joint 3 between `pier` and body 7".
std::string TextOf(const StepError& error, const SceneIds& ids) {
    char number[64];
    std::snprintf(number, sizeof number, "%.3g %% at %.3g s, ", 100 * error.value, error.time);
    const auto body = [&](BodyId id) {
        return id == kWorldBody ? "the world" : NameOf("body", id, ids.bodies, theScene.description.bodies);
    };
    const std::string between = body(error.bodyA) + " and " + body(error.bodyB);
    if (!error.isOfJoint) return number + between;
    return number + NameOf("joint", error.joint, ids.joints, theScene.description.joints) + " between " + between;
}

void Run(LabRun& run) {
    const SceneDescription& description = theScene.description;
    LabWorld world(run, description.settings);
    const Result<SceneIds> ids = AddScene(world.Ours("scenes from files"), description);
    run.Require(bool(ids), "the scene can be created");
    if (!ids) return;
    world.domain = 1e9;
    const double duration = std::min(description.steps * description.dt, run.Seconds(60, 10)),
                 settles = std::min(0.5, 0.5 * duration);
    std::vector<double> errors;
    StepError worst;
    run.isMeasured = false;
    for (int i = run.Steps(duration); i > 0; --i) {
        world.Step();
        if (world.Time() < settles) continue;
        const StepError error = ErrorOf(world);
        errors.push_back(error.value);
        run.isMeasured |= error.value > 0 || world.Ours("reports of steps").Report().contacts > 0;
        if (error.value > worst.value) worst = error;
    }
    const auto rank = errors.begin() + static_cast<ptrdiff_t>(errors.size() * 19 / 20);
    std::nth_element(errors.begin(), rank, errors.end());
    run.Error("overlap_or_gap", *rank);
    run.Figure("energy", world.Energy());
    if (worst.value > 0) run.worst = TextOf(worst, ids.Value());
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
            "the largest overlap or gap of a step over the size of its smaller body, or angle in rad that a joint is "
            "off, "
            "exceeded in one of twenty steps",
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
