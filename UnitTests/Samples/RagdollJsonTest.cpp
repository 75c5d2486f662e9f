// Ragdolls as JSON: round trips, the file of the humanoid, and errors that name the path in the document.
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Assets/RagdollJson.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace fulcrum::testing {
namespace {

using Json = nlohmann::ordered_json;

uint64_t HashAfterAFall(const RagdollSettings& settings) {
    TestWorld world;
    world.AddFloor();
    EXPECT_TRUE(Ragdoll::Create(world.System(), settings, {Position(0, 1.5, 0), RotationAbout(Vector3(1, 0, 0), 0.3)}));
    world.Steps(60);
    return world.System().HashPoses();
}

Json WrittenOf(const RagdollSettings& settings) {
    const Result<Json> document = RagdollToJson(settings);
    EXPECT_TRUE(document) << document.GetError().message;
    return document.Value();
}

RagdollSettings ReadOf(const Json& document) {
    const Result<RagdollSettings> settings = RagdollFromJson(document);
    EXPECT_TRUE(settings) << settings.GetError().message;
    return settings.Value();
}

TEST(RagdollJson, TheFileOfTheHumanoidIsTheHumanoid) {
    const Result<RagdollSettings> read = ReadRagdoll(FULCRUM_SOURCE_DIR "/Samples/Ragdoll/humanoid.json");
    ASSERT_TRUE(read) << read.GetError().message;
    EXPECT_EQ(WrittenOf(read.Value()), WrittenOf(Humanoid()));
    EXPECT_EQ(HashAfterAFall(read.Value()), HashAfterAFall(Humanoid()));
}

// Every kind of joint and shape, every field another value than its default.
RagdollSettings Everything() {
    const SpringSettings soft{.mode = SpringMode::StiffnessAndDamping,
                              .frequency = 1.5f,
                              .dampingRatio = 0.3f,
                              .stiffness = 100,
                              .damping = 1.1f,
                              .form = SpringForm::Exact};
    const AxisControl axis{.limited = true,
                           .limits = {.min = -0.7f, .max = 0.7f, .spring = soft},
                           .motor = {.mode = MotorMode::ToVelocity,
                                     .targetSpeed = 0.1f,
                                     .targetPosition = 0.2f,
                                     .spring = soft,
                                     .minForce = -3,
                                     .maxForce = 1e7f},
                           .friction = 0.123456789f};
    HingeJointSettings hinge;
    hinge.angle = axis;
    hinge.angle.limits.min = -std::numeric_limits<float>::infinity();
    ConeJointSettings cone;
    cone.halfAngle = 0.1f;
    cone.spring = soft;
    SwingTwistJointSettings shoulder;
    shoulder.shape = SwingShape::Pyramid;
    shoulder.twist = shoulder.swingY = shoulder.swingZ = axis;
    SixDofJointSettings free;
    free.shape = SwingShape::Ellipse;
    for (AxisControl& control : free.axes) control = axis;
    const RagdollJoint joints[] = {{}, PointJointSettings{}, FixedJointSettings{}, hinge, cone, shoulder, free};
    RagdollSettings settings;
    for (int i = 0; i < 7; ++i) {
        RagdollPart part{
            .name = "part " + std::to_string(i), .parent = i == 6 ? 2 : i - 1, .body = {}, .joint = joints[i]};
        part.body.shape = BoxOf(0.1f, 0.2f, 0.3f);
        if (i == 1) part.body.shape = SphereOf(0.3f);
        if (i == 2) part.body.shape = CapsuleOf(0.2f, 0.1f);
        if (i == 3) part.body.shape = HullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
        part.body.position = Position(i, 0.1, -1e5);
        part.body.rotation = RotationAbout(Vector3(0, 1, 0), 0.3 * i);
        JointSettings& joint = CommonOf(part.joint);
        joint.anchorA = {.point = Position(0.1 * i, 1.0 / 3, 2), .axis = Vector3(0, 1, 0), .normal = Vector3(0, 0, 1)};
        if (i == 2 || i == 3)
            joint.anchorB = JointAnchor{.point = Position(1, 2, 3), .axis = Vector3(0, 0, 1), .normal = {}};
        joint.space = JointSpace::Body;
        joint.priority = JointPriority::High;
        joint.collideConnected = true;
        joint.enabled = false;
        joint.breakForce = 1000;
        joint.breakTorque = 10;
        joint.substeps = 8;
        joint.velocityIterations = 3;
        joint.positionIterations = 2;
        joint.massOverride = {0.5f, 0, 2, 0.25f};
        joint.userData = 0xFFFFFFFFFFFFFFFFull;
        settings.parts.push_back(part);
    }
    BodySettings& body = settings.parts[4].body;
    body.motion = MotionType::Kinematic;
    body.linearVelocity = Vector3(1, 2, 3);
    body.angularVelocity = Vector3(0.1f, 0.2f, 0.3f);
    body.density = 500;
    body.mass = 7;
    body.inertia = Vector3(1, 2, 2.5f);
    body.material = {.friction = 0.1f,
                     .restitution = 0.9f,
                     .frictionRule = CombineRule::Minimum,
                     .restitutionRule = CombineRule::Average};
    body.linearDamping = 0.1f;
    body.angularDamping = 0.2f;
    body.gravityFactor = -1;
    body.lockedAxes = LockedAxes::Plane2D;
    body.maxLinearSpeed = 10;
    body.maxAngularSpeed = 20;
    body.gyroscopicTorque = body.allowSleep = false;
    body.layer = 31;
    body.userData = 12345678901234567890ull;
    settings.parts[5].body.startAsleep = true;
    return settings;
}

TEST(RagdollJson, WhatIsWrittenReadsTheSame) {
    const RagdollSettings settings = Everything();
    const Json document = WrittenOf(settings);
    const RagdollSettings read = ReadOf(Json::parse(document.dump()));
    EXPECT_EQ(WrittenOf(read), document);
    ASSERT_EQ(read.parts.size(), settings.parts.size());
    for (size_t i = 0; i < read.parts.size(); ++i) {
        EXPECT_EQ(read.parts[i].name, settings.parts[i].name);
        EXPECT_EQ(read.parts[i].parent, settings.parts[i].parent);
        if (i > 0) {
            EXPECT_EQ(read.parts[i].joint.index(), settings.parts[i].joint.index());
        }
        EXPECT_EQ(read.parts[i].body.position, settings.parts[i].body.position);
        EXPECT_EQ(read.parts[i].body.shape->Type(), settings.parts[i].body.shape->Type());
        EXPECT_NEAR(read.parts[i].body.shape->Mass().volume, settings.parts[i].body.shape->Mass().volume, 1e-6);
    }
    const auto& hinge = std::get<HingeJointSettings>(read.parts[3].joint);
    EXPECT_EQ(hinge.angle.limits.min, -std::numeric_limits<float>::infinity());
    EXPECT_EQ(hinge.angle.friction, 0.123456789f);
    EXPECT_EQ(hinge.angle.motor.spring.form, SpringForm::Exact);
    EXPECT_EQ(hinge.userData, 0xFFFFFFFFFFFFFFFFull);
    ASSERT_TRUE(hinge.anchorB);
    EXPECT_FALSE(hinge.anchorB->normal);
    EXPECT_EQ(std::get<SixDofJointSettings>(read.parts[6].joint).axes[5].limits.max, 0.7f);
    EXPECT_EQ(read.parts[4].body.layer, 31);
    EXPECT_EQ(read.parts[4].body.lockedAxes, LockedAxes::Plane2D);
    EXPECT_EQ(read.parts[4].body.userData, 12345678901234567890ull);
}

TEST(RagdollJson, DefaultsAreLeftOut) {
    RagdollSettings settings;
    settings.parts.push_back({.name = "one", .body = {.shape = SphereOf(0.5f)}, .joint = {}});
    settings.parts.push_back(
        {.name = "two", .parent = 0, .body = {.shape = SphereOf(0.1f)}, .joint = FixedJointSettings{}});
    EXPECT_EQ(WrittenOf(settings), Json::parse(R"({"parts": [
        {"name": "one", "body": {"shape": {"kind": "Sphere", "radius": 0.5}}},
        {"name": "two", "parent": "one", "body": {"shape": {"kind": "Sphere", "radius": 0.1}}, "joint": {"kind": "Fixed"}}]})"));
}

// Changes the humanoid's document at a JSON pointer; null takes the field away.
void ExpectError(const std::string& pointer, const Json& value, const std::string& start) {
    Json document = WrittenOf(Humanoid());
    const Json::json_pointer at(pointer);
    if (value.is_null()) document[at.parent_pointer()].erase(at.back());
    else document[at] = value;
    const Result<RagdollSettings> settings = RagdollFromJson(document);
    ASSERT_FALSE(settings) << pointer;
    EXPECT_TRUE(settings.GetError().message.starts_with(start)) << settings.GetError().message;
}

TEST(RagdollJson, ErrorsNameThePath) {
    ExpectError("/parts", 3, "parts: it must be an array");
    ExpectError("/parts", Json::array(), "parts is empty");
    ExpectError("/part", 3, "part: an unknown name; known are parts");
    ExpectError("/parts/3", 3, "parts[3]: it must be an object");
    ExpectError("/parts/3/name", 3, "parts[3].name: of type number; it must be a string");
    ExpectError("/parts/2/name", nullptr, "parts[2].name is empty");
    ExpectError("/parts/3/color", "red", "parts[3].color: an unknown name");
    ExpectError("/parts/3/parent", "tail", "parts[3].parent: no part before has the name \"tail\"");
    ExpectError("/parts/0/parent", "head", "parts[0].parent: no part before");
    ExpectError("/parts/3/parent", nullptr, "parts[3].parent is -1");
    ExpectError("/parts/3/joint", nullptr, "parts[3].joint: missing");
    ExpectError("/parts/3/joint/kind", nullptr, "parts[3].joint: kind is missing; it must be one of Point, Fixed");
    ExpectError("/parts/3/joint/kind", "Ball", "parts[3].joint.kind: \"Ball\"; it must be one of Point, Fixed");
    ExpectError("/parts/3/joint/twst", 1, "parts[3].joint.twst: an unknown name");
    ExpectError("/parts/3/joint/twist/limits/min", "low",
                "parts[3].joint.twist.limits.min: of type string; it must be a number");
    ExpectError("/parts/3/joint/twist/limits/min", 1, "parts[3].joint: twist.limits.min is 1; it must not be larger");
    ExpectError("/parts/3/joint/twist/motor/mode", "On",
                "parts[3].joint.twist.motor.mode: \"On\"; it must be one of Off, ToVelocity, ToPosition");
    ExpectError("/parts/3/joint/anchorA/point", 1, "parts[3].joint.anchorA.point: it must be an array of 3 numbers");
    ExpectError("/parts/3/joint/anchorA/point/1", true,
                "parts[3].joint.anchorA.point[1]: of type boolean; it must be a number");
    ExpectError("/parts/3/joint/anchorA/axis", Json::array({0, 2, 0}), "parts[3].joint: anchorA.axis has length 2");
    ExpectError("/parts/3/joint/substeps", 1.5,
                "parts[3].joint.substeps: of type number; it must be a whole number from ");
    ExpectError("/parts/3/body/layer", 256,
                "parts[3].body.layer: of type number; it must be a whole number from 0 to 255");
    ExpectError("/parts/3/body/layer", -1,
                "parts[3].body.layer: of type number; it must be a whole number from 0 to 255");
    ExpectError("/parts/3/body/layer", 32, "parts[3].body: layer is 32");
    ExpectError("/parts/3/body/allowSleep", 1, "parts[3].body.allowSleep: it must be true or false");
    ExpectError("/parts/3/body/shape", nullptr, "parts[3].body: shape");
    ExpectError("/parts/3/body/shape/kind", nullptr, "parts[3].body.shape: kind is missing");
    ExpectError("/parts/3/body/shape/kind", "Sphere",
                "parts[3].body.shape.halfHeight: an unknown name; known are kind, radius");
    ExpectError("/parts/3/body/shape/radius", -1, "parts[3].body.shape: radius");
    ExpectError("/parts/3/body/rotation", Json::array({0, 0, 0}),
                "parts[3].body.rotation: it must be an array of 4 numbers");
    EXPECT_EQ(RagdollFromJson(Json(3)).GetError().message, "the document: it must be an object");
}

TEST(RagdollJson, ShapesThatCannotBeWrittenAreNamed) {
    RagdollSettings settings = Humanoid();
    settings.parts[2].body.shape = CompoundOf({{.shape = SphereOf(0.1f)}});
    EXPECT_TRUE(RagdollToJson(settings).GetError().message.starts_with("parts[2].body.shape: "));
    const std::array corners{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)};
    settings.parts[2].body.shape = ConvexHull::Create(corners, {.convexRadius = 0.01f}).Value();
    EXPECT_TRUE(RagdollToJson(settings).GetError().message.starts_with("parts[2].body.shape: "));
    settings.parts[2].body.mass = -1;
    EXPECT_EQ(RagdollToJson(settings).GetError().code, ErrorCode::Negative);
}

TEST(RagdollJson, FilesComeBackAndTheirErrorsNameThem) {
    const std::string file =
        (std::filesystem::temp_directory_path() / ("ragdoll" + std::to_string(getpid()) + ".json")).string();
    ASSERT_TRUE(WriteRagdoll(file, Humanoid()));
    const Result<RagdollSettings> read = ReadRagdoll(file);
    ASSERT_TRUE(read) << read.GetError().message;
    EXPECT_EQ(WrittenOf(read.Value()), WrittenOf(Humanoid()));
    std::filesystem::resize_file(file, 100);
    const Result<RagdollSettings> cut = ReadRagdoll(file);
    ASSERT_FALSE(cut);
    EXPECT_TRUE(cut.GetError().message.starts_with(file)) << cut.GetError().message;
    EXPECT_NE(cut.GetError().message.find("line 2"), std::string::npos) << cut.GetError().message;
    // A number beyond a double is no file of a ragdoll, but no reason to stop either.
    std::ofstream(file) << "{\"parts\": [1e2222222]}";
    const Result<RagdollSettings> huge = ReadRagdoll(file);
    ASSERT_FALSE(huge);
    EXPECT_NE(huge.GetError().message.find("1e2222222"), std::string::npos) << huge.GetError().message;
    // What is no UTF-8 cannot stand in JSON.
    RagdollSettings odd = Humanoid();
    odd.parts[0].name = "a\xff";
    ASSERT_TRUE(WriteRagdoll(file, odd));
    EXPECT_EQ(ReadRagdoll(file).Value().parts[0].name, "a\xEF\xBF\xBD");
    std::filesystem::remove(file);
    EXPECT_EQ(ReadRagdoll(file).GetError().message, file + ": it cannot be opened");
    EXPECT_FALSE(WriteRagdoll(file + "/no/such/folder", Humanoid()));
}

}  // namespace
}  // namespace fulcrum::testing
