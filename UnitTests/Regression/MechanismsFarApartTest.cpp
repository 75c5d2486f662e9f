// Mechanisms of several joints of which one body alone is put far away: a car's chassis, a limb, a link of a chain, a
// door. All follow within seconds, none gets fast on the way, and those at rest are at rest again.
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr double kFastest = 60;      // m/s: three times jointPushSpeed
constexpr float kTogether = 0.065f;  // m, of joints that carry what still swings
// m/s, root of the mean square that five seconds leave at most of bodies at rest.
constexpr double kLeftBehind = 1.5;

// Moves a body elsewhere and runs five seconds, and twice as long as one joint needs to bring it back. speed: m/s, as
// kLeftBehind.
void ExpectToFollow(TestWorld& world, std::span<const BodyId> bodies, std::span<const JointId> joints, BodyId moved,
                    const Position& away, const Quaternion& turn, double speed) {
    SCOPED_TRACE(away);
    ASSERT_TRUE(
        world.Bodies().SetPose(moved, world.PositionOf(moved) + away, turn * world.Bodies().GetPose(moved).rotation));
    double fastest = 0;
    const double seconds = 5 + 2 * away.norm() / static_cast<double>(world.System().Settings().jointPushSpeed);
    for (int i = 0; i < static_cast<int>(seconds * 60); ++i) {
        world.Step();
        for (const BodyId id : bodies) fastest = std::max(fastest, static_cast<double>(Length(world.VelocityOf(id))));
    }
    double energy = 0, mass = 0;
    for (const BodyId id : bodies) {
        energy += world.Bodies().GetKineticEnergy(id);
        mass += static_cast<double>(world.Bodies().GetMass(id));
    }
    for (const JointId id : joints) EXPECT_LT(JointsOf(world).GetError(id).distance, kTogether);
    EXPECT_LT(fastest, kFastest);
    EXPECT_LT(std::sqrt(2 * energy / mass), speed);
    EXPECT_TRUE(world.AllFinite());
}

const Position kPlaces[] = {{100, 0, 0}, {0, 100, 0}, {-50, 20, 80}, {0.5, 0.5, 0}, {3, 0, -2}};

TEST(MechanismsFarApart, CarFollowsItsChassis) {
    for (const Position& away :
         {Position(100, 0, 0), Position(0, 100, 0), Position(-50, 20, 80), Position(0.5, 0.5, 0), Position(3, 0, -2)}) {
        TestWorld world;
        world.AddFloor();
        const BodyId chassis = world.Add({.shape = BoxOf(2, 0.3f, 0.8f), .position = {0, 0.9, 0}, .mass = 1500});
        std::vector<BodyId> bodies = {chassis};
        std::vector<JointId> joints;
        for (const double x : {-1.4, 1.4})
            for (const double z : {-0.8, 0.8}) {
                const BodyId wheel = world.Add({.shape = SphereOf(0.35f), .position = {x, 0.5, z}, .mass = 20});
                WheelJointSettings settings;
                static_cast<JointSettings&>(settings) = Between(chassis, wheel, {x, 0.5, z}, {0, 0, 1});
                settings.anchorA.normal = Vector3(0, 1, 0);
                settings.isSteered = x > 0;
                joints.push_back(Join(world, settings));
                bodies.push_back(wheel);
            }
        world.Run(1);
        ASSERT_TRUE(world.Bodies().SetPose(chassis, world.PositionOf(chassis) + away, Quaternion{}));
        float fastest = 0;
        for (int i = 0; i < 6 * 60; ++i) {
            world.Step();
            for (const BodyId id : bodies) fastest = std::max(fastest, Length(world.VelocityOf(id)));
            if (i != 5 * 60) continue;
            for (const JointId id : joints) EXPECT_LT(JointsOf(world).GetError(id).distance, 0.02f) << away;
        }
        EXPECT_LT(fastest, kFastest) << away;
        EXPECT_TRUE(world.AllFinite());
    }
}

// A chain of 16 links that hangs from a hook, or is free.
TEST(MechanismsFarApart, ChainFollowsItsMiddle) {
    for (const bool hangs : {false, true})
        for (const Position& away : kPlaces)
            for (const double angle : {0.0, 2.5}) {
                // A chain on its hook is longer than that for as long as it takes to come back, and falls meanwhile.
                if (hangs && away.norm() > 16) continue;
                SystemSettings settings;
                if (!hangs) settings = Weightless();
                TestWorld world(settings);
                BodyId last = hangs ? AddHook(world) : BodyId{};
                std::vector<BodyId> bodies;
                std::vector<JointId> joints;
                for (int i = 0; i < 16; ++i) {
                    const BodyId link = world.Add({.shape = BoxOf(0.1f, 0.5f, 0.1f),
                                                   .position = {0, -0.5 - i, 0},
                                                   .mass = 10,
                                                   .angularDamping = 0.5f});
                    if (last != BodyId{})
                        joints.push_back(Join(world, Of<PointJointSettings>(Between(last, link, {0, -1.0 * i, 0}))));
                    bodies.push_back(last = link);
                }
                // What hangs has fallen, and swings.
                ExpectToFollow(world, bodies, joints, bodies[8], away, RotationAbout(Vector3(0.6f, 0, 0.8f), angle),
                               hangs ? std::sqrt(2 * kGravity * 16) : kLeftBehind);
            }
}

TEST(MechanismsFarApart, RagdollFollowsAPart) {
    const RagdollSettings humanoid = Humanoid();
    for (const bool falls : {false, true})
        for (size_t part = 0; part < humanoid.parts.size(); ++part)
            for (const Position& away :
                 {Position(50, 0, 0), Position(0, 50, 0), Position(-30, 20, 40), Position(1, 0.5, 0)}) {
                TestWorld world(falls ? SystemSettings{} : Weightless());
                if (falls) world.AddFloor();
                const Result<Ragdoll> ragdoll =
                    Ragdoll::Create(world.System(), humanoid, {Position(0, 1.5, 0), Quaternion{}}, {});
                ASSERT_TRUE(ragdoll);
                std::vector<BodyId> bodies(ragdoll.Value().Bodies().begin(), ragdoll.Value().Bodies().end());
                std::vector<JointId> joints;
                JointsOf(world).Visit([&](JointId id) { joints.push_back(id); });
                ExpectToFollow(world, bodies, joints, bodies[part], away, RotationAbout(Vector3(0, 0.6f, 0.8f), 2),
                               kLeftBehind);
            }
}

// Ragdolls that fall on each other from 15 m: joints that the impact opens are pulled together while the pile keeps
// them centimeters apart. When limbs were moved without rotation to the end, as distant ones are, they spun by up to
// two revolutions a step, and joints were 0.25 to 0.5 m open. A single run is noisy: of 64 whose gravity differs by
// 1e-6 the widest gap is 0.07 m in the median, and more than 0.15 m in one or two.
double WidestGapOfRagdolls(float gravityFactor) {
    SceneInput input;
    input.solver.substeps = 64;
    ThreadPool pool(2);
    const Result<std::unique_ptr<SceneWorld>> world = SceneWorld::Create(*FindScene("ragdolls"), input, &pool);
    EXPECT_TRUE(world);
    SystemSettings settings = world.Value()->System().Settings();
    settings.gravity *= gravityFactor;
    EXPECT_TRUE(world.Value()->System().SetSettings(settings));
    double widest = 0;
    for (int i = 0; i < Cases(130); ++i) {
        EXPECT_TRUE(world.Value()->Step(kStep));
        widest = std::max(widest, LargestJointGap(*world.Value()));
    }
    return widest;
}

TEST(MechanismsFarApart, LimbsUnderAPileAreNotWhirled) {
    std::array<double, 5> widest;
    for (size_t run = 0; run < widest.size(); ++run)
        widest[run] = WidestGapOfRagdolls(1 + 1e-6f * static_cast<float>(run));
    std::sort(widest.begin(), widest.end());
    EXPECT_LT(widest[2], 0.15);
}

// One to three hinges or ball joints, at a fixed frame or at one that is free to move.
TEST(MechanismsFarApart, DoorFollowsItsHinges) {
    for (const Position& away : kPlaces)
        for (const int count : {1, 2, 3})
            for (const bool isFree : {false, true})
                for (const bool turns : {false, true}) {
                    // What hangs upside down, straight above two points that do not turn, is balanced, and stays so.
                    if (count > 1 && !turns && !isFree && away.y() == 100) continue;
                    SCOPED_TRACE(std::to_string(count) + (turns ? " hinges" : " ball joints") +
                                 (isFree ? ", free" : ""));
                    TestWorld world(Weightless());
                    const BodyId frame =
                        isFree ? world.Add({.shape = BoxOf(0.1f, 1, 0.1f), .mass = 60}) : AddHook(world);
                    const BodyId door =
                        world.Add({.shape = BoxOf(0.5f, 1, 0.05f), .position = {0.6, 0, 0}, .mass = 30});
                    std::vector<JointId> joints;
                    for (int i = 0; i < count; ++i) {
                        const Position place(0.1, count == 1 ? 0 : -0.8 + 1.6 * i / (count - 1), 0);
                        if (count > 1 && !turns) {
                            joints.push_back(Join(world, Of<PointJointSettings>(Between(frame, door, place))));
                            continue;
                        }
                        auto settings = Of<HingeJointSettings>(Between(frame, door, place, {0, 1, 0}));
                        settings.angle = Limited(-1.5, 1.5);
                        joints.push_back(Join(world, settings));
                    }
                    ExpectToFollow(world, std::vector{frame, door}, joints, door, away,
                                   RotationAbout(Vector3(0.6f, 0, 0.8f), 2.5), count == 1 || turns ? 0.01 : 2.5);
                }
}

}  // namespace
}  // namespace fulcrum::testing
