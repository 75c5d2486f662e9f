#include <Fulcrum/Samples/Scenes/Humanoid.h>

#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>

namespace fulcrum {

namespace {

enum class Along { X, Y, Z };

// Lengths in meters, angles in degrees. A swing of zero makes the joint a hinge about x.
struct Bone {
    const char* name;
    float halfHeight, radius;
    Position center;
    Along along;
    int parent;
    Position joint;
    double low, high, swing;
};

constexpr int kRoot = RagdollPart::kNoParent;

const Bone kBones[] = {
    {"pelvis", 0.08f, 0.12f, {0, 0, 0}, Along::X, kRoot, {0, 0, 0}, 0, 0, 0},
    {"torso", 0.14f, 0.14f, {0, 0.30, 0}, Along::Y, 0, {0, 0.10, 0}, -20, 20, 25},
    {"head", 0.05f, 0.10f, {0, 0.68, 0}, Along::Y, 1, {0, 0.54, 0}, -45, 45, 35},
    {"upper arm left", 0.11f, 0.05f, {0.24, 0.36, 0}, Along::Y, 1, {0.24, 0.50, 0}, -45, 45, 80},
    {"upper arm right", 0.11f, 0.05f, {-0.24, 0.36, 0}, Along::Y, 1, {-0.24, 0.50, 0}, -45, 45, 80},
    {"lower arm left", 0.11f, 0.045f, {0.24, 0.06, 0}, Along::Y, 3, {0.24, 0.21, 0}, -130, 0, 0},
    {"lower arm right", 0.11f, 0.045f, {-0.24, 0.06, 0}, Along::Y, 4, {-0.24, 0.21, 0}, -130, 0, 0},
    {"upper leg left", 0.16f, 0.075f, {0.10, -0.28, 0}, Along::Y, 0, {0.10, -0.06, 0}, -20, 20, 50},
    {"upper leg right", 0.16f, 0.075f, {-0.10, -0.28, 0}, Along::Y, 0, {-0.10, -0.06, 0}, -20, 20, 50},
    {"lower leg left", 0.16f, 0.06f, {0.10, -0.72, 0}, Along::Y, 7, {0.10, -0.50, 0}, 0, 130, 0},
    {"lower leg right", 0.16f, 0.06f, {-0.10, -0.72, 0}, Along::Y, 8, {-0.10, -0.50, 0}, 0, 130, 0},
    {"foot left", 0.06f, 0.05f, {0.10, -0.97, 0.05}, Along::Z, 9, {0.10, -0.94, 0}, -30, 30, 0},
};

AxisControl Range(double low, double high) {
    return {.limited = true,
            .limits = {.min = static_cast<float>(low * kDegree), .max = static_cast<float>(high * kDegree)}};
}

RagdollJoint JointOf(const Bone& bone) {
    if (bone.swing == 0) {
        HingeJointSettings joint;
        joint.anchorA = {.point = bone.joint, .axis = {1, 0, 0}, .normal = Vector3(0, 1, 0)};
        joint.angle = Range(bone.low, bone.high);
        return joint;
    }
    // The twist axis points from the joint along the part's capsule; all of these are along y.
    const float side = bone.center.y() > bone.joint.y() ? 1.0f : -1.0f;
    SwingTwistJointSettings joint;
    joint.anchorA = {.point = bone.joint, .axis = {0, side, 0}, .normal = Vector3(1, 0, 0)};
    joint.twist = Range(bone.low, bone.high);
    joint.swingY = joint.swingZ = Range(-bone.swing, bone.swing);
    return joint;
}

// Degrees: the twist about the joint's x axis, or the hinge's angle, and the swing about its y and z. A swing about y
// moves hanging limbs backwards and standing ones forwards, one about z moves both to the left.
struct Turned {
    double twist, swingY, swingZ;
};

// In the order of kBones.
const Turned kPoses[3][12] = {
    // A star.
    {{0, 0, 0},
     {0, 0, 0},
     {0, 0, 0},
     {0, 0, 70},
     {0, 0, -70},
     {0, 0, 0},
     {0, 0, 0},
     {0, 0, 35},
     {0, 0, -35},
     {0, 0, 0},
     {0, 0, 0},
     {0, 0, 0}},
    // A long stride.
    {{0, 0, 0},
     {10, 5, 0},
     {-30, 0, 0},
     {0, 35, 8},
     {0, -45, -8},
     {-70, 0, 0},
     {-80, 0, 0},
     {0, -42, 4},
     {0, 25, -4},
     {60, 0, 0},
     {30, 0, 0},
     {15, 0, 0}},
    // Seated, hands raised.
    {{0, 0, 0},
     {0, -10, 0},
     {0, 15, 10},
     {20, -50, 15},
     {-20, -50, -15},
     {-110, 0, 0},
     {-110, 0, 0},
     {0, -45, 8},
     {0, -45, -8},
     {90, 0, 0},
     {90, 0, 0},
     {-10, 0, 0}},
};

Quaternion RotationOf(const Turned& turned) {
    const auto vector = [](double x, double y, double z) {
        return Vector3((Position(x, y, z) * kDegree).cast<float>());
    };
    return RotationFromVector(vector(0, turned.swingY, turned.swingZ)) * RotationFromVector(vector(turned.twist, 0, 0));
}

}  // namespace

RagdollSettings Humanoid() {
    RagdollSettings settings;
    for (const Bone& bone : kBones) {
        RagdollPart part{.name = bone.name, .parent = bone.parent, .body = {}, .joint = JointOf(bone)};
        part.body.shape = Capsule::Create(bone.halfHeight, bone.radius).Value();
        part.body.position = bone.center;
        if (bone.along == Along::X) part.body.rotation = RotationAbout(Vector3(0, 0, 1), -0.5 * kPi);
        if (bone.along == Along::Z) part.body.rotation = RotationAbout(Vector3(1, 0, 0), 0.5 * kPi);
        settings.parts.push_back(std::move(part));
    }
    return settings;
}

RagdollSettings HumanoidWithMotors(float stiffness, float damping, float maxTorque) {
    const JointMotor motor{
        .mode = MotorMode::ToPosition,
        .spring = {.mode = SpringMode::StiffnessAndDamping, .stiffness = stiffness, .damping = damping},
        .minForce = -maxTorque,
        .maxForce = maxTorque};
    RagdollSettings settings = Humanoid();
    for (RagdollPart& part : settings.parts) {
        // Stiff motors couple the parts; with a single iteration they come to rest slowly.
        CommonOf(part.joint).velocityIterations = 4;
        if (auto* hinge = std::get_if<HingeJointSettings>(&part.joint)) hinge->angle.motor = motor;
        if (auto* ball = std::get_if<SwingTwistJointSettings>(&part.joint))
            ball->twist.motor = ball->swingY.motor = ball->swingZ.motor = motor;
    }
    return settings;
}

std::array<Quaternion, 12> HumanoidMotion(double time) {
    const int pose = std::clamp(static_cast<int>(time), 0, static_cast<int>(kHumanoidPoses) - 1);
    const double way = std::clamp((time - pose) / 0.4, 0.0, 1.0);
    const auto eased = static_cast<float>(way * way * (3 - 2 * way));
    std::array<Quaternion, 12> rotations;
    for (size_t part = 0; part < rotations.size(); ++part) {
        const Quaternion from = pose == 0 ? Quaternion{} : RotationOf(kPoses[pose - 1][part]),
                         to = RotationOf(kPoses[pose][part]);
        rotations[part] =
            Normalized(from * RotationFromVector(Vector3(RotationVectorOf(from.Conjugate() * to) * eased)));
    }
    return rotations;
}

}  // namespace fulcrum
