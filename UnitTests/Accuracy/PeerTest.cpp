// Runs of the lab in another engine: a made-up one, which every build has, and Bullet where it is built in.
#include <Fulcrum/PerformanceTest/Accuracy/Baseline.h>
#include <Fulcrum/PerformanceTest/Accuracy/Lab.h>
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Options.h>
#include <Fulcrum/PerformanceTest/Accuracy/Output.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>
#include <Fulcrum/PerformanceTest/Peers/Peer.h>

#include <nlohmann/json.hpp>

#include <filesystem>

#include <unistd.h>

namespace fulcrum::accuracy {
namespace {

// Bodies fall by symplectic Euler, and are nowhere after `lostAfter` s. No joints.
class Falling final : public PeerWorld {
public:
    Falling(const PhysicsSystem& ours, double lostAfter) : ours_(ours), lostAfter_(lostAfter) {}

    Status AddBody(BodyId id, const BodySettings& settings) override {
        bodies_.push_back({id, settings.position, settings.linearVelocity.cast<double>()});
        return Done{};
    }
    Status AddJoint(JointId, const JointSettings&) override { return Error{ErrorCode::Unsupported, "joints"}; }
    void Step(double dt) override {
        time_ += dt;
        for (Body& body : bodies_) {
            body.velocity += ours_.Settings().gravity.cast<double>() * dt;
            body.position += body.velocity * dt;
            if (time_ > lostAfter_) body.position.x() = kNaN;
        }
    }
    Status CopyTo(PhysicsSystem& ours) override {
        for (const Body& body : bodies_) {
            (void)ours.Bodies().SetVelocity(body.id, body.velocity.cast<float>(), {0, 0, 0});
            if (const Status set = ours.Bodies().SetPose(body.id, body.position, {}); !set) return set;
        }
        return Done{};
    }

private:
    struct Body {
        BodyId id;
        Position position, velocity;
    };
    const PhysicsSystem& ours_;
    double lostAfter_, time_ = 0;
    std::vector<Body> bodies_;
};

std::string One() { return "1.0"; }
template <int kLostAfter>  // s
std::unique_ptr<PeerWorld> CreateFalling(const PhysicsSystem& ours, int) {
    return std::make_unique<Falling>(ours, kLostAfter);
}
const Peer kFalling{"falling", "Falling", One, 3, CreateFalling<1'000'000'000>, nullptr};
const Peer kLost{"lost", "Lost", One, 3, CreateFalling<5>, nullptr};

RunRecord MeasureIn(const Peer& peer, const char* scene, int rate = 60) {
    const Setting setting{.rate = rate,
                          .solver = {.substeps = 1, .velocityIterations = peer.iterations, .positionIterations = 0},
                          .family = Family::Peer,
                          .peer = &peer};
    return Measure(*FindLabScenes(scene).at(0), setting, true, true);
}
// Symplectic Euler is g t dt / 2 too low, of a chord of |v0 t + g t^2 / 2|.
double FallError(int rate) {
    const Position chord(-20, 20 - 0.5 * kGravity * 100, 80);
    return 0.5 * kGravity * 10 / rate / chord.norm();
}

TEST(PeerRun, ScenesMeasureThePeersMotion) {
    for (const int rate : {30, 60, 240}) {
        const RunRecord run = MeasureIn(kFalling, "projectile", rate);
        EXPECT_EQ(run.unsupported, "");
        EXPECT_NEAR(run.Error(), FallError(rate), 1e-7) << rate;  // 9.81 is a float
        EXPECT_TRUE(std::isnan(run.traversals));
        EXPECT_GT(run.microseconds, 0);
    }
}

TEST(PeerRun, SaysWhatThePeerLacks) {
    EXPECT_EQ(MeasureIn(kFalling, "pendulum").unsupported, "joints");
    EXPECT_EQ(MeasureIn(kFalling, "weight").unsupported, "the forces of contacts");
    EXPECT_EQ(MeasureIn(kFalling, "coincident.128").unsupported, "its pairs and the memory that it uses");
    EXPECT_EQ(MeasureIn(kFalling, "bad_input").unsupported, "refusals of input");
    EXPECT_EQ(MeasureIn(kFalling, "degenerate").unsupported, "checks of input without a step");
    EXPECT_TRUE(MeasureIn(kFalling, "pendulum").errors.empty());
}

TEST(PeerRun, WhatIsNotFiniteBlewUp) {
    const RunRecord run = MeasureIn(kLost, "projectile");
    EXPECT_EQ(run.unsupported, "");
    EXPECT_TRUE(run.blewUp);
    EXPECT_TRUE(std::isnan(run.Error())) << run.Error();
    EXPECT_EQ(run.failedConditions, std::vector<std::string>{"every pose is finite"});
}

TEST(PeerRun, IsInTheReportAndNowhereElse) {
    LabOptions options;
    for (const char* scene : {"projectile", "point_pendulum"}) options.scenes.push_back(FindLabScenes(scene)[0]);
    options.isQuick = options.isTimedOnce = true;
    options.showsProgress = false;
    options.peer = &kFalling;
    options.folder = std::filesystem::temp_directory_path() / ("fulcrum-peer-" + std::to_string(getpid()));
    const Result<std::vector<RunRecord>> runs = RunLab(options);
    std::filesystem::remove_all(options.folder);
    ASSERT_TRUE(runs);
    EXPECT_EQ(BaselineOf(runs.Value(), true).find("falling"), std::string::npos);
    EXPECT_NE(BaselineOf(runs.Value(), true).find("soft 1/60 4 1 1"), std::string::npos);

    const std::vector<SceneRuns> scenes = ByScene(runs.Value());
    ASSERT_EQ(scenes.size(), 2u);
    EXPECT_EQ(scenes[0].peerRuns.size(), 4u) << "nothing is solved: four time steps";
    for (const RunRecord& run : scenes[0].runs) EXPECT_EQ(run.setting.peer, nullptr);
    EXPECT_EQ(scenes[0].peerRuns[3].selfError, 0) << "its own finest";
    EXPECT_GT(scenes[0].peerRuns[0].selfError, 1e-4);
    EXPECT_TRUE(scenes[1].peerRuns.empty());
    EXPECT_EQ(scenes[1].peerLacks, "joints");

    const std::string csv = CsvOf(scenes);
    EXPECT_NE(csv.find("\nprojectile,falling,60,"), std::string::npos) << csv;
    EXPECT_EQ(csv.find("point_pendulum,falling"), std::string::npos) << csv;
    const nlohmann::ordered_json json = JsonOf(scenes, {.isQuick = true, .peer = &kFalling});
    EXPECT_EQ(json["peer"]["engine"], "Falling 1.0");
    EXPECT_EQ(json["scenes"][1]["peer_lacks"], "joints");
    const auto& all = json["scenes"][0]["runs"];
    EXPECT_EQ(all.size(), scenes[0].runs.size() + 4);
    EXPECT_EQ(all.back()["engine"], "Falling 1.0");
    for (const auto& place : json["scenes"][0]["summary"]["envelope"])
        EXPECT_LT(place.get<size_t>(), scenes[0].runs.size());
    const std::string table = PeerTable(scenes, kFalling);
    EXPECT_NE(table.find("| `projectile` |"), std::string::npos) << table;
    EXPECT_NE(table.find("`point_pendulum`: joints"), std::string::npos) << table;
}

TEST(PeerGrid, ShortAndWhole) {
    EXPECT_EQ(PeerGrid({.contacts = true}, kFalling, true).size(), 6u);
    EXPECT_EQ(PeerGrid({.contacts = true}, kFalling, false).size(), 12u);
    EXPECT_EQ(PeerGrid({}, kFalling, false).size(), 4u);
    const std::vector<Setting> fixedStep = PeerGrid({.timeStep = false, .contacts = true}, kFalling, true);
    ASSERT_EQ(fixedStep.size(), 3u);
    EXPECT_EQ(fixedStep[0].Key(), "falling 1/60 1 3 0");
    EXPECT_STREQ(fixedStep[0].Preset(), "default");
    EXPECT_STREQ(fixedStep[1].Preset(), "");
}

TEST(PeerOption, IsRefusedWhereItMeansNothing) {
    const auto unknown = ParseLabCommand({"--peer", "bulet"});
    ASSERT_FALSE(unknown);
    EXPECT_NE(unknown.GetError().message.find("the nearest is 'bullet'"), std::string::npos);
    const auto command = ParseLabCommand({"--quick", "--peer", "bullet"});
#ifdef FULCRUM_PEER_BULLET
    ASSERT_TRUE(command);
    ASSERT_NE(command.Value().lab.peer, nullptr);
    EXPECT_EQ(command.Value().lab.peer->Label().substr(0, 7), "Bullet ");
    EXPECT_FALSE(ParseLabCommand({"--peer", "bullet", "--soak"}));
    EXPECT_FALSE(ParseLabCommand({"--peer", "bullet", "--targets"}));
#else
    ASSERT_FALSE(command);
    EXPECT_NE(command.GetError().message.find("./fulcrum accuracy --peer bullet builds it in"), std::string::npos)
        << command.GetError().message;
#endif
}

#ifdef FULCRUM_PEER_BULLET
double ErrorNamed(const RunRecord& run, const char* name) {
    for (const NamedValue& error : run.errors)
        if (error.name == name) return error.value;
    return kNaN;
}
const Peer& Bullet() { return *FindPeer("bullet", "accuracy").Value(); }

TEST(Bullet, FallsAsSymplecticEulerDoes) {
    for (const int rate : {60, 240}) {
        const RunRecord run = MeasureIn(Bullet(), "projectile", rate);
        EXPECT_NEAR(run.Error(), FallError(rate), 0.01 * FallError(rate)) << rate;
    }
}

// Small steps: each joint is the counterpart of ours, in the right frame, with the right sign.
TEST(Bullet, JointsConvergeToTheClosedForms) {
    for (const char* scene : {"pendulum", "point_pendulum"}) {
        const RunRecord run = MeasureIn(Bullet(), scene, 960);
        EXPECT_LT(run.Error(), 0.01) << scene;
        EXPECT_LT(ErrorNamed(run, "gap"), 0.01) << scene;
    }
    const RunRecord spring = MeasureIn(Bullet(), "spring.near", 960);
    EXPECT_LT(ErrorNamed(spring, "frequency"), 0.01);
    EXPECT_LT(ErrorNamed(spring, "damping_ratio"), 0.1);
    EXPECT_LT(MeasureIn(Bullet(), "motor.drive", 960).Error(), 0.01);
    EXPECT_LT(MeasureIn(Bullet(), "motor.friction", 960).Error(), 0.01);
    EXPECT_LT(MeasureIn(Bullet(), "heavy_chain.100", 960).Error(), 0.1);
}

TEST(Bullet, ContactsConvergeToTheClosedForms) {
    for (const char* scene : {"incline.slide", "slide_to_roll", "rolling.sphere", "rolling.hoop", "rolling.cylinder",
                              "friction_isotropy"}) {
        const RunRecord run = MeasureIn(Bullet(), scene, 240);
        EXPECT_EQ(run.unsupported, "") << scene;
        EXPECT_LT(run.Error(), 0.05) << scene;
    }
}

// Masks, continuous collision, sleep.
TEST(Bullet, HasWhatBodiesAreCreatedWith) {
    EXPECT_EQ(MeasureIn(Bullet(), "bullet.wall_0.1").Error(), 0);
    const RunRecord stack = MeasureIn(Bullet(), "tall_stack.15", 240);
    EXPECT_LT(ErrorNamed(stack, "sink"), 0.05);
    EXPECT_GT(stack.figures.at(0).value, 0) << "it falls asleep";
}
#endif

}  // namespace
}  // namespace fulcrum::accuracy
