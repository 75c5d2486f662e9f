#include <Fulcrum/Assets/SceneDescription.h>

#include <Fulcrum/Assets/TextFloats.h>
#include <Fulcrum/Physics/Files/ErrorBoundary.h>

namespace fulcrum {

namespace {

Error Named(const char* list, size_t index, const Error& error) {
    return {error.code, std::string(list) + "[" + std::to_string(index) + "]: " + error.message};
}

class SceneBuilder {
public:
    SceneBuilder(PhysicsSystem& system, const SceneDescription& scene) : system_(system), scene_(scene) {}

    MaybeError Run() {
        for (size_t i = 0; i < scene_.bodies.size(); ++i) {
            const Result<BodyId> id = system_.Bodies().Create(scene_.bodies[i].settings);
            if (!id) return Named("bodies", i, id.GetError());
            ids.bodies.push_back(id.Value());
        }
        for (size_t i = 0; i < scene_.joints.size(); ++i) {
            const SceneJoint& joint = scene_.joints[i];
            if (!IsBody(joint.bodyA) || !IsBody(joint.bodyB))
                return Named("joints", i, {ErrorCode::OutOfRange, "there is no body of that number"});
            const Result<JointId> id = std::visit([&](auto settings) { return Join(joint, settings); }, joint.settings);
            if (!id) return Named("joints", i, id.GetError());
            ids.joints.push_back(id.Value());
        }
        for (size_t i = 0; i < scene_.ragdolls.size(); ++i) {
            const SceneRagdoll& one = scene_.ragdolls[i];
            Result<Ragdoll> ragdoll = Ragdoll::Create(system_, one.settings, one.origin, one.motion);
            if (!ragdoll) return Named("ragdolls", i, ragdoll.GetError());
            ids.ragdolls.push_back(std::move(ragdoll.Value()));
        }
        return {};
    }

    void Undo() {
        for (Ragdoll& ragdoll : ids.ragdolls) ragdoll.Remove();
        // They exist: it has just created them.
        for (const JointId id : ids.joints) (void)system_.Joints().Remove(id);
        for (const BodyId id : ids.bodies) (void)system_.Bodies().Remove(id);
    }

    SceneIds ids;

private:
    bool IsBody(int number) const { return number >= SceneJoint::kWorld && number < std::ssize(ids.bodies); }
    BodyId IdOf(int number) const {
        return number == SceneJoint::kWorld ? kWorldBody : ids.bodies[static_cast<size_t>(number)];
    }
    template <class Settings>
    Result<JointId> Join(const SceneJoint& joint, Settings& settings) {
        settings.bodyA = IdOf(joint.bodyA);
        settings.bodyB = IdOf(joint.bodyB);
        return system_.Joints().Create(settings);
    }

    PhysicsSystem& system_;
    const SceneDescription& scene_;
};

}  // namespace

Result<SceneIds> AddScene(PhysicsSystem& system, const SceneDescription& scene) {
    const TextFloats floats;
    SceneBuilder builder(system, scene);
    const Status run = WithErrors("", [&]() -> Status {
        if (MaybeError e = builder.Run()) return *e;
        return Done{};
    });
    if (run) return std::move(builder.ids);
    builder.Undo();
    return run.GetError();
}

}  // namespace fulcrum
