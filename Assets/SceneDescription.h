// A scene as plain data: settings of the system, bodies, joints and ragdolls, in the order in which they are created.
// Files of it: SceneFile.h. Plain data and free functions, any thread.
#pragma once

#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace fulcrum {

// All kinds of joints that data alone describes: not CustomJointSettings, which has code.
using AnyJointSettings =
    std::variant<PointJointSettings, FixedJointSettings, DistanceJointSettings, HingeJointSettings, SliderJointSettings,
                 ConeJointSettings, SwingTwistJointSettings, SixDofJointSettings, GearJointSettings,
                 RackAndPinionJointSettings, PulleyJointSettings, PathJointSettings, WheelJointSettings>;

struct SceneBody {
    std::string name;  // unique, or empty
    BodySettings settings;
};

struct SceneJoint {
    static constexpr int kWorld = -1;  // kWorldBody

    std::string name;           // unique, or empty
    int bodyA = kWorld;         // indices into SceneDescription::bodies
    int bodyB = kWorld;         // likewise
    AnyJointSettings settings;  // bodyA and bodyB in it are ignored
};

// Its bodies have no number in SceneDescription::bodies.
struct SceneRagdoll {
    std::string name;  // unique, or empty
    RagdollSettings settings;
    Pose origin;
    std::optional<MotionType> motion;  // see Ragdoll::Create
};

struct SceneDescription {
    std::string description;  // one line
    int steps = 300;          // that a run takes unless told otherwise, >= 1
    double dt = 1.0 / 60;     // s, of a step, > 0
    SystemSettings settings;
    std::vector<SceneBody> bodies;
    std::vector<SceneJoint> joints;
    std::vector<SceneRagdoll> ragdolls;
    // One line each: what the file has that no longer has an effect. Filled by reading, not written.
    std::vector<std::string> notes;
};

// What AddScene created: the ids in the order of the description.
struct SceneIds {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    std::vector<Ragdoll> ragdolls;
};

// Creates bodies, joints and ragdolls in a world, which may have others and whose settings stay its own. Errors: those
// of the calls that create them, named with the element, such as `joints[2]: ...`; OutOfRange (a number of a body).
// Then nothing is left of it.
Result<SceneIds> AddScene(PhysicsSystem& system, const SceneDescription& scene);

}  // namespace fulcrum
