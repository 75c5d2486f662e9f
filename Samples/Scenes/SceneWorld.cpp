#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace fulcrum {

SceneWorld::SceneWorld(const Scene& scene, const SceneInput& input)
    : random(input.seed), scene_(scene), input_(input) {}

Result<std::unique_ptr<SceneWorld>> SceneWorld::Create(const Scene& scene, const SceneInput& input, JobSystem* jobs) {
    SystemSettings settings;
    if (input.description) settings = input.description->settings;
    else settings.sleep.enabled = scene.sleeping;
    if (!input.description || input.solver != SolverSettings()) settings.solver = input.solver;
    if (input.narrowPhase != NarrowPhaseMethod::Automatic) settings.narrowPhase = input.narrowPhase;
    if (input.measuresErrors) settings.measuresErrors = true;
    if (scene.adjust) scene.adjust(settings);
    if (input.sleeping) settings.sleep.enabled = *input.sleeping;
    settings.gravity = (settings.gravity.cast<double>() * input.gravityScale).cast<float>();
    Result<std::unique_ptr<PhysicsSystem>> system = PhysicsSystem::Create(settings, jobs);
    if (!system) return system.GetError();

    std::unique_ptr<SceneWorld> world(new SceneWorld(scene, input));
    world->system_ = std::move(system.Value());
    if (input.created) input.created(*world->system_);
    scene.build(*world);
    if (world->firstError_) return *world->firstError_;
    return world;
}

Status SceneWorld::Step(double dt) {
    if (scene_.beforeStep) scene_.beforeStep(*this, dt);
    const auto begin = std::chrono::steady_clock::now();
    Status status = system_->Update(dt);
    if (!status) return status;
    lastMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    if (stepCount_ > 0) longestMs_ = std::max(longestMs_, lastMs_);
    ++stepCount_;
    time_ += dt;
    drawing_.Clear();
    if (scene_.afterStep) scene_.afterStep(*this);
    return status;
}

int SceneWorld::NonFiniteBodies() const {
    int count = 0;
    system_->VisitBodies([&](BodyId id) {
        const Pose pose = Bodies().GetPose(id);
        const bool finite = IsFinite(pose.position) && IsFinite(pose.rotation) &&
                            IsFinite(Bodies().GetLinearVelocity(id)) && IsFinite(Bodies().GetAngularVelocity(id));
        if (!finite || Bodies().IsFrozen(id)) ++count;
    });
    return count;
}

template <class T>
ShapePtr SceneWorld::Checked(Result<T> shape) {
    if (shape) return shape.Value();
    if (!firstError_) firstError_ = shape.GetError();
    return nullptr;
}

ShapePtr SceneWorld::BoxOf(float halfX, float halfY, float halfZ) {
    return Checked(Box::Create(Vector3(halfX, halfY, halfZ)));
}
ShapePtr SceneWorld::SphereOf(float radius) { return Checked(Sphere::Create(radius)); }
ShapePtr SceneWorld::CapsuleOf(float halfHeight, float radius) { return Checked(Capsule::Create(halfHeight, radius)); }
ShapePtr SceneWorld::HullOf(std::span<const Vector3> points) { return Checked(ConvexHull::Create(points)); }
ShapePtr SceneWorld::MeshOf(std::span<const Vector3> vertices, std::span<const uint32_t> indices) {
    return Checked(TriangleMesh::Create({.vertices = vertices, .indices = indices}));
}
ShapePtr SceneWorld::CompoundOf(std::span<const Compound::ChildSettings> children) {
    return Checked(Compound::Create(children));
}
ShapePtr SceneWorld::MutableCompoundOf(std::span<const CompoundShape::ChildSettings> children) {
    return Checked(MutableCompound::Create(children));
}

BodyId SceneWorld::Add(const BodySettings& settings) {
    Result<BodyId> id = Bodies().Create(settings);
    if (id && input_.keepsSettings) added.emplace_back(id.Value(), settings);
    if (id) return id.Value();
    if (!firstError_) firstError_ = id.GetError();
    return {};
}

void SceneWorld::AddRagdoll(const RagdollSettings& settings, const Pose& origin, std::optional<MotionType> motion) {
    Result<Ragdoll> ragdoll = Ragdoll::Create(*system_, settings, origin, motion);
    if (ragdoll && input_.keepsSettings) addedRagdolls.push_back({{}, settings, origin, motion});
    if (ragdoll) ragdolls.push_back(std::move(ragdoll.Value()));
    else if (!firstError_) firstError_ = ragdoll.GetError();
}

void SceneWorld::Listen(std::unique_ptr<ContactListener> listener) {
    listener_ = std::move(listener);
    system_->SetContactListener(listener_.get());
}

BodyId SceneWorld::AddFloor(float halfX, float halfZ) {
    return Add({.shape = BoxOf(halfX, 1, halfZ), .motion = MotionType::Static, .position = {0, -1, 0}});
}

void SceneWorld::AddWalls(float halfX, float halfZ, float height) {
    constexpr float kHalfThickness = 0.1f;
    const ShapePtr alongZ = BoxOf(kHalfThickness, 0.5f * height, halfZ),
                   alongX = BoxOf(halfX, 0.5f * height, kHalfThickness);
    for (double side : {-1.0, 1.0}) {
        Add({.shape = alongZ, .motion = MotionType::Static, .position = {side * halfX, 0.5 * height, 0}});
        Add({.shape = alongX, .motion = MotionType::Static, .position = {0, 0.5 * height, side * halfZ}});
    }
}

std::string LabelOf(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

double LargestJointGap(const SceneWorld& world) {
    double largest = 0;
    world.Joints().Visit([&](JointId id) {
        const Position gap = world.Joints().GetFrameB(id).position - world.Joints().GetFrameA(id).position;
        largest = std::max(largest, gap.norm());
    });
    return largest;
}

double BodiesBelowTheFloor(const SceneWorld& world) {
    int count = 0;
    world.System().VisitBodies([&](BodyId id) {
        const bool dynamic = world.Bodies().GetMotionType(id) == MotionType::Dynamic;
        if (dynamic && !(world.Bodies().GetCenterOfMass(id).y() >= 0)) ++count;
    });
    return count;
}

}  // namespace fulcrum
