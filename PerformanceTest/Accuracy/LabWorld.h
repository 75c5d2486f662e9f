// The physics system of a run: times its steps, counts their work, and checks general conditions. Also helpers to build
// scenes. Made by the scenes; one thread.
//
// In a run of another engine (Setting::peer) the world of that engine gets the bodies and joints, too, steps in place
// of ours, and puts its poses and velocities into ours after each step, so that scenes measure both alike. What cannot
// be had that way ends the run with NotInPeer.
#pragma once

#include <Fulcrum/Fulcrum.h>
#include <Fulcrum/PerformanceTest/Accuracy/EffortReturns.h>
#include <Fulcrum/PerformanceTest/Accuracy/LabScene.h>

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

namespace fulcrum {
class PeerWorld;
}

namespace fulcrum::accuracy {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kGravity = 9.81;  // m/s2
inline const Vector3 kDown(0, -9.81f, 0), kNoGravity(0, 0, 0);

class LabWorld {
public:
    // With the run's setting; `change` may change the rest of the settings.
    explicit LabWorld(LabRun& run, const Vector3& gravity = kDown, void (*change)(SystemSettings&) = Nothing);
    // The same with a scene's own settings, but for the effort, which is the run's, its accuracy target if it has one,
    // and sleep, which is off.
    LabWorld(LabRun& run, SystemSettings settings);
    // Requires that all poses are finite and no body has gone farther than `domain`; adds the work to the run's.
    ~LabWorld();
    LabWorld(const LabWorld&) = delete;
    LabWorld& operator=(const LabWorld&) = delete;

    static void Nothing(SystemSettings&) {}
    static void Sleeps(SystemSettings& settings) { settings.sleep.enabled = true; }

    BodyId Add(const BodySettings& settings);
    // Static, its top at y = 0.
    BodyId AddFloor(float friction = 0.5f, float restitution = 0, double halfWidth = 100,
                    const Position& origin = {0, 0, 0});
    template <class Settings>
    JointId Join(const Settings& settings) {
        const JointId id = system_->Joints().Create(settings).Value();
        Joined(id, settings);
        return id;
    }

    void Step() { Step(run_.Dt()); }
    void Step(double dt);
    void Steps(double seconds) {
        for (int i = run_.Steps(seconds); i > 0; --i) Step();
    }
    double Time() const { return time_; }  // s

    // Our engine, for what only it has, which is named: reports, contacts, forces, changes of bodies and joints. Throws
    // NotInPeer where another engine runs.
    PhysicsSystem& Ours(const char* what);
    bool IsPeer() const { return peer_ != nullptr; }
    const BodyInterface& Bodies() const { return system_->Bodies(); }
    const JointInterface& Joints() const { return system_->Joints(); }  // forces: through Ours
    double Energy() const { return system_->GetEnergy(); }              // J
    int AwakeBodies() const;                                            // dynamic ones
    Position At(BodyId id) const { return Bodies().GetPose(id).position; }
    Position Speed(BodyId id) const { return Bodies().GetLinearVelocity(id).cast<double>(); }
    Position Turn(BodyId id) const { return Bodies().GetAngularVelocity(id).cast<double>(); }
    double FastestBody();
    // All gaps of the joints together, m.
    double SumOfGaps();

    double domain = 1e4;  // m

private:
    struct Built {
        BodyId id;
        Position position;
    };
    void Create(const SystemSettings& settings);
    void Joined(JointId id, const JointSettings& settings);

    LabRun& run_;
    std::unique_ptr<PhysicsSystem> system_;
    std::unique_ptr<PeerWorld> peer_;  // null: ours steps
    std::vector<Built> dynamic_;
    double time_ = 0;
    Work work_;
    EffortReturns efforts_;
    std::vector<double> returns_;  // s, when an island's effort rose after it had fallen
    bool isFinite_ = true;
};

inline ShapePtr BoxOf(double x, double y, double z) { return Box::Create(Position(x, y, z).cast<float>()).Value(); }
inline ShapePtr SphereOf(double radius) { return Sphere::Create(static_cast<float>(radius)).Value(); }

template <class Settings>
Settings Of(const JointSettings& between) {
    Settings settings;
    static_cast<JointSettings&>(settings) = between;
    return settings;
}
// A static body without contacts, to attach joints to.
BodyId AddHook(LabWorld& world, const Position& position = {0, 0, 0});

// A stack of cubes, the lowest on y = 0 above `origin`, each up to `offset` out of line.
std::vector<BodyId> AddStack(LabWorld& world, int count, double edge, double offset, Random& random,
                             const Position& origin = {0, 0, 0});
// A flat pyramid of cubes whose lowest row has `base`; neighbors in a row stand `spacing` edges apart. Row by row.
// Layers are `rise` edges apart. The top one, the last, weighs `topMass` kg, or as the others.
std::vector<BodyId> AddPyramid(LabWorld& world, int base, double edge, double spacing = 1.05, double rise = 1,
                               double topMass = 0);

// A chain along x of links of 1 kg and 1 m, which touch nothing, from a hook at the origin; ends in a ball of
// `endMass` kg, or none. Created `stretch` times as long as its rest length.
struct Chain {
    std::vector<BodyId> bodies;
    double length = 0;  // m, from the hook to the middle of the last body
};
Chain AddChain(LabWorld& world, int links, double endMass, double stretch = 1, const Position& origin = {0, 0, 0});

// Times at which a sampled quantity changes its sign, interpolated.
class Crossings {
public:
    void Sample(double time, double value);
    const std::vector<double>& Times() const { return times_; }
    // Of an oscillation, which has two crossings a period; empty with less than three crossings.
    std::optional<double> Period() const;

private:
    std::vector<double> times_;
    std::optional<std::pair<double, double>> last_;
};

inline double Relative(double value, double reference) { return std::abs(value - reference) / std::abs(reference); }

}  // namespace fulcrum::accuracy
