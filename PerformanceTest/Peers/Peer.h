// Another engine that runs our scenes for comparison. It builds the same world from bodies and joints of ours. Used by
// the benchmark and the accuracy lab; one thread at a time.
#pragma once

#include <Fulcrum/Samples/Runner/Simulation.h>

#include <memory>
#include <string>
#include <vector>

namespace fulcrum {

struct PeerFigures {
    Statistics ms;  // as ComparedMs: of a step, or of the scene's batch of queries
    double accuracy = 0;
};

// A world of another engine that steps in place of one of ours.
class PeerWorld {
public:
    virtual ~PeerWorld() = default;
    // A body or joint of ours that has just been created with these settings. Error Unsupported: what has no
    // counterpart. Not checked: settings that only matter to our solver, and limits of speed.
    virtual Status AddBody(BodyId id, const BodySettings& settings) = 0;
    virtual Status AddJoint(JointId id, const JointSettings& settings) = 0;
    virtual void Step(double dt) = 0;  // s, >= 0
    // Our bodies get its poses and velocities, and sleep where its bodies do. Errors: a number is not finite, or too
    // large for ours.
    virtual Status CopyTo(PhysicsSystem& ours) = 0;
};

struct Peer {
    const char* name;   // of options and files
    const char* title;  // of reports
    std::string (*version)();
    int iterations;  // its default
    // With the settings of `ours` that all engines have (gravity, whether bodies sleep, the speed below which nothing
    // bounces, if it is not our default), its own default settings otherwise, and so many iterations. `ours` must
    // outlive it.
    std::unique_ptr<PeerWorld> (*create)(const PhysicsSystem& ours, int iterations);
    // `untimed` steps, then `steps` timed ones of dt seconds, with one thread and the engine's default settings. Error
    // Unsupported where the scene has something that has no counterpart.
    Result<PeerFigures> (*run)(const Scene& scene, SceneInput input, int untimed, int steps, double dt);

    std::string Label() const { return std::string(title) + " " + version(); }  // "Bullet 3.24"
};

// Errors, a line each: OutOfRange (there is no such engine), Unsupported (this program was built without it; names the
// command of ./fulcrum that builds it in).
Result<const Peer*> FindPeer(const std::string& name, const std::string& command);

}  // namespace fulcrum
