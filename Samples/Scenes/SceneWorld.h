// A physics system filled by a scene, and the helpers with which scenes fill it. Owned by the runner, the benchmark and
// the tests; one thread at a time.
#pragma once

#include <Fulcrum/Assets/SceneDescription.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Samples/Scenes/Drawing.h>
#include <Fulcrum/Samples/Scenes/Random.h>
#include <Fulcrum/Samples/Scenes/Scene.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace fulcrum {

struct SceneInput {
    uint64_t seed = 1;
    SolverSettings solver;  // the default effort
    NarrowPhaseMethod narrowPhase = NarrowPhaseMethod::Automatic;
    bool measuresErrors = false;   // see SystemSettings
    ShapePtr shape;                // of the drop scenes: what falls
    ShapePtr ground;               // of drop_onto: what it falls onto
    int count = 50;                // bodies of the drop scenes, >= 1
    std::optional<bool> sleeping;  // null: as the scene has it
    double gravityScale = 1;       // times the scene's gravity
    bool keepsSettings = false;    // whether the world remembers what Add, Join and AddRagdoll were given
    const SceneDescription* description = nullptr;  // of a scene from a file
    Function<void(PhysicsSystem&)> created{};       // called when the system is created and still empty
};

class SceneWorld {
public:
    // `jobs` (not owned, may be null) must outlive the world. Errors: those of PhysicsSystem::Create, of the shapes and
    // of BodyInterface::Create, the first that was met.
    static Result<std::unique_ptr<SceneWorld>> Create(const Scene& scene, const SceneInput& input = {},
                                                      JobSystem* jobs = nullptr);

    // PhysicsSystem::Update with the scene's callbacks before and after it. Errors as there.
    Status Step(double dt);

    const Scene& Definition() const { return scene_; }
    const SceneInput& Input() const { return input_; }
    PhysicsSystem& System() { return *system_; }
    const PhysicsSystem& System() const { return *system_; }
    BodyInterface& Bodies() { return system_->Bodies(); }
    const BodyInterface& Bodies() const { return system_->Bodies(); }
    JointInterface& Joints() { return system_->Joints(); }
    const JointInterface& Joints() const { return system_->Joints(); }
    const QueryInterface& Queries() const { return system_->Queries(); }
    // Of the last step; empty unless it was turned on.
    Drawing& Draw() { return drawing_; }
    const Drawing& Draw() const { return drawing_; }
    int StepCount() const { return stepCount_; }
    double Time() const { return time_; }          // s
    double LastStepMs() const { return lastMs_; }  // wall clock of PhysicsSystem::Update alone
    bool Listens() const { return listener_ != nullptr; }
    double LongestStepMs() const { return longestMs_; }  // of all but the first step

    // Number of bodies with a pose or velocity that is not finite, or frozen for that reason.
    int NonFiniteBodies() const;

    // For scenes.
    // -------------------------------------------------------------------------------------------------------

    Random random;                  // seeded by the input
    std::vector<BodyId> watched;    // bodies that the figure uses, in an order that the scene chooses
    std::vector<JointId> joints;    // likewise
    std::vector<Ragdoll> ragdolls;  // all that AddRagdoll made
    // Where SceneInput::keepsSettings asks for them. Joints whose settings have code are missing.
    std::vector<std::pair<BodyId, BodySettings>> added;
    std::vector<std::pair<JointId, AnyJointSettings>> joined;
    std::vector<SceneRagdoll> addedRagdolls;
    double figure = 0;      // the figure, if the scene accumulates it over the steps
    std::vector<Ray> rays;  // of a scene that times a batch of them, and their hits
    std::vector<WorldRayHit> rayHits;
    std::vector<std::pair<BodyId, BodyLook>> looks;                  // what Show was given
    std::vector<std::pair<BodyId, std::vector<Look>>> surfaceLooks;  // likewise

    // Shapes; null, and an error of Create, where the sizes are wrong.
    ShapePtr BoxOf(float halfX, float halfY, float halfZ);
    ShapePtr SphereOf(float radius);
    ShapePtr CapsuleOf(float halfHeight, float radius);
    ShapePtr HullOf(std::span<const Vector3> points);
    ShapePtr MeshOf(std::span<const Vector3> vertices, std::span<const uint32_t> indices);
    ShapePtr CompoundOf(std::span<const Compound::ChildSettings> children);
    ShapePtr MutableCompoundOf(std::span<const CompoundShape::ChildSettings> children);

    // Makes Create fail, with the first such error.
    void Fail(const Error& error) {
        if (!firstError_) firstError_ = error;
    }
    // An error of Create where the settings are wrong.
    BodyId Add(const BodySettings& settings);
    // Settings of any kind of joint; likewise.
    template <class Settings>
    JointId Join(const Settings& settings) {
        Result<JointId> joint = Joints().Create(settings);
        if constexpr (std::is_constructible_v<AnyJointSettings, Settings>)
            if (joint && input_.keepsSettings) joined.emplace_back(joint.Value(), settings);
        if (joint) return joint.Value();
        if (!firstError_) firstError_ = joint.GetError();
        return {};
    }
    // Adds to `ragdolls`. An error of Create where the settings are wrong.
    void AddRagdoll(const RagdollSettings& settings, const Pose& origin, std::optional<MotionType> motion = {});
    // What a recording shows of the body.
    void Show(BodyId id, BodyLook look) { looks.emplace_back(id, std::move(look)); }
    // The looks of the materials of a body's surface, by their index.
    void ShowSurface(BodyId id, std::vector<Look> materials) { surfaceLooks.emplace_back(id, std::move(materials)); }
    // Sets the contact listener, which the world owns.
    void Listen(std::unique_ptr<ContactListener> listener);
    // Static box, its top at y = 0.
    BodyId AddFloor(float halfX, float halfZ);
    // Four static walls on the floor, their middles at x = -halfX, halfX and z = -halfZ, halfZ, `height` meters high.
    void AddWalls(float halfX, float halfZ, float height);

private:
    SceneWorld(const Scene& scene, const SceneInput& input);
    template <class T>
    ShapePtr Checked(Result<T> shape);

    const Scene& scene_;
    SceneInput input_;
    std::unique_ptr<ContactListener> listener_;
    std::unique_ptr<PhysicsSystem> system_;
    std::optional<Error> firstError_;
    Drawing drawing_;
    int stepCount_ = 0;
    double time_ = 0;
    double lastMs_ = 0;
    double longestMs_ = 0;
};

// A number for a label: three digits at most, no zeros behind it.
std::string LabelOf(double value);

// Returns `figure`, which the scene accumulates.
inline double FigureOf(const SceneWorld& world) { return world.figure; }

// A figure of several scenes: the number of dynamic bodies whose center is below y = 0, or not finite.
double BodiesBelowTheFloor(const SceneWorld& world);

// Likewise: the largest distance between the two anchors of a joint, m.
double LargestJointGap(const SceneWorld& world);

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegree = kPi / 180;

}  // namespace fulcrum
