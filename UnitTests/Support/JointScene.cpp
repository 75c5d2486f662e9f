#include <Fulcrum/UnitTests/Support/JointScene.h>

#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cstring>

namespace fulcrum::testing {

namespace {

constexpr int kHit = 140;  // step in which a ball appears over the sleepers

class Hasher {
public:
    void Add(double number) {
        unsigned char bytes[sizeof number];
        std::memcpy(bytes, &number, sizeof number);
        for (unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 0x100000001B3ull;  // FNV-1a
    }
    void Add(const Vector3& v) {
        for (int k = 0; k < 3; ++k) Add(double(v[k]));
    }
    void Add(uint64_t number) { hash_ = (hash_ ^ number) * 0x100000001B3ull; }
    uint64_t Value() const { return hash_; }

private:
    uint64_t hash_ = 0xCBF29CE484222325ull;
};

}  // namespace

SystemSettings JointScene::Settings() {
    SystemSettings settings;
    settings.layerCollides[1] &= ~2u;
    return settings;
}

JointScene::JointScene(TestWorld& world) : world_(world) {
    world.AddFloor({.friction = 0.7f});
    AddChains();
    AddPlane();
    AddSprings();
    AddShoulders();
    AddGears();
    AddPathsAndRopes();
    AddCar();
    AddCurtain();
    AddHub();
    AddSleepers();
    AddWhatBreaks();
    AddRagdolls();
}

void JointScene::BeforeStep(int step) {
    JointInterface& joints = JointsOf(world_);
    EXPECT_TRUE(world_.Bodies().MoveKinematic(swing_, {0.8 * Sin(0.05 * step), 8, 0},
                                              RotationAbout({0, 0, 1}, 0.01 * step), static_cast<float>(kStep)));
    JointLimits rope;
    rope.max = static_cast<float>(6.2 - 0.004 * step);
    EXPECT_TRUE(joints.SetLimits(winch_, JointAxis::LinearX, rope));
    EXPECT_TRUE(step != 30 || joints.SetEnabled(switched_, false));
    EXPECT_TRUE(step != 45 || joints.Remove(removed_));
    EXPECT_TRUE(step != 50 || joints.SetMotor(driven_, JointAxis::AngularX, {}));
    EXPECT_TRUE(step != 60 || joints.SetEnabled(switched_, true));
    EXPECT_TRUE(step != 80 || joints.SetMotor(wheel_, JointAxis::AngularX, SpeedMotor(-5, 2000)));
    EXPECT_TRUE(step != 90 || joints.SetMotor(gate_, JointAxis::LinearX, SpeedMotor(1.5, 4000)));
    EXPECT_TRUE(step != 100 || world_.Bodies().Remove(removedBody_));
    EXPECT_TRUE(step != 110 || joints.SetMotor(driven_, JointAxis::AngularX, SpeedMotor(-4, 200)));
    EXPECT_TRUE(step != 120 || joints.SetTargetOrientation(shoulder_, RotationAbout({0.6f, 0, 0.8f}, 0.4)));
    EXPECT_TRUE(step != 150 || joints.SetFriction(gate_, JointAxis::LinearX, 100));
    if (step == kHit) {
        slept_ = !world_.Bodies().IsAwake(sleeper_);
        world_.Add({.shape = SphereOf(0.3f), .position = {1.8, 2, 20.1}});
    }
    woke_ |= step > kHit && world_.Bodies().IsAwake(sleeper_);
    for (const BrokenJoint& joint : world_.System().Events().brokenJoints) broke_ |= joint.id == breaking_;
    overflowed_ |= world_.Report().overflowConstraints > 0;
}

void JointScene::ExpectAllHappened() const {
    EXPECT_TRUE(slept_);
    EXPECT_TRUE(woke_);
    EXPECT_TRUE(broke_);
    EXPECT_TRUE(overflowed_);
    EXPECT_TRUE(world_.AllFinite());
}

uint64_t JointScene::Hash() const {
    Hasher hasher;
    hasher.Add(world_.System().HashPoses());
    world_.System().VisitBodies([&](BodyId id) {
        hasher.Add(world_.Bodies().GetLinearVelocity(id));
        hasher.Add(world_.Bodies().GetAngularVelocity(id));
    });
    const JointInterface& joints = world_.System().Joints();
    joints.Visit([&](JointId id) {
        hasher.Add(joints.GetForce(id));
        hasher.Add(joints.GetTorque(id));
        for (int axis = 0; axis < 6; ++axis) hasher.Add(joints.GetCoordinate(id, static_cast<JointAxis>(axis)));
    });
    return hasher.Value();
}

uint64_t HashOfJointScene(uint32_t threads) {
    TestWorld world(JointScene::Settings(), threads);
    JointScene scene(world);
    for (int step = 0; step < kJointSceneSteps; ++step) {
        scene.BeforeStep(step);
        world.Step();
    }
    scene.ExpectAllHappened();
    return scene.Hash();
}

}  // namespace fulcrum::testing
