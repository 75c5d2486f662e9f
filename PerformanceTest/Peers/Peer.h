// Another engine that runs our scenes for comparison. It builds the same world from a scene's bodies and joints. Used
// by the benchmark; one thread.
#pragma once

#include <Fulcrum/Samples/Runner/Simulation.h>

#include <string>
#include <vector>

namespace fulcrum {

struct PeerFigures {
    Statistics ms;  // as ComparedMs: of a step, or of the scene's batch of queries
    double accuracy = 0;
};

struct Peer {
    const char* name;
    std::string (*version)();
    // `untimed` steps, then `steps` timed ones of dt seconds, with one thread and the engine's default settings. Error
    // Unsupported where the scene has something that has no counterpart.
    Result<PeerFigures> (*run)(const Scene& scene, SceneInput input, int untimed, int steps, double dt);
};

// The peers in this build; ./fulcrum bench --peer NAME builds one.
std::vector<const Peer*> BuiltPeers();
// All known peers.
std::vector<std::string> PeerNames();

}  // namespace fulcrum
