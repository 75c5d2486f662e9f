// One setting of the speed-accuracy trade-off: time step, solver effort, and the method compared. The grids of the lab
// are lists of these. Plain data and free functions, any thread.
#pragma once

#include <Fulcrum/Physics/Settings.h>

#include <string>
#include <vector>

namespace fulcrum {
struct Peer;
}

namespace fulcrum::accuracy {

// What a curve of the report shows; everything else varies along it.
enum class Family : uint8_t {
    Soft,       // the default: soft rows, relaxed
    Baumgarte,  // hard rows, position passes
    Libccd,     // soft rows, contacts by libccd
    NoTrees,    // soft rows, no joints are solved directly
    Fixed,      // soft rows, every island with the system's effort: no AccuracyTarget
    Target,     // soft rows, effort by an AccuracyTarget
    Peer,       // another engine
};
inline constexpr int kFamilies = 6;  // ours
const char* FamilyName(Family family);

struct Setting {
    int rate = 60;  // time steps per second
    SolverSettings solver{};
    Family family = Family::Soft;
    // Of the family Target: AccuracyTarget::penetration, and its jointError in m.
    float target = 0;
    const Peer* peer = nullptr;  // of the family Peer: its iterations are the velocity iterations

    double Dt() const { return 1.0 / rate; }
    SystemSettings System() const;
    // Passes over a constraint per simulated second.
    double PassesPerSecond() const;
    // "soft 1/60 4 1 1": family, dt, substeps, velocity iterations, position iterations; "target 1/60 1 1 1 0.002": the
    // target, too. Names the setting in files.
    std::string Key() const;
    std::string TargetText() const;  // "0.002"
    // "soft", or the name of the other engine.
    const char* FamilyText() const;
    // "fast", "balanced" (the default), "accurate", "reference"; of another engine "default"; empty for others.
    const char* Preset() const;
    // The lines that make a program run with it.
    std::string Code() const;
    friend bool operator==(const Setting&, const Setting&) = default;
};

// Which settings influence a scene: a grid skips the others.
struct Influences {
    bool timeStep = true, contacts = false, joints = false;
};

// The presets, then steps of 1/30 to 1/240 s at the default effort, ten iterations, and one or two of each other
// family: about 12.
std::vector<Setting> QuickGrid(const Influences& influences);
// The same, and targets of 10 % to 0.1 % that start from the presets Fast and Balanced: what `advise` chooses from.
std::vector<Setting> AdviceGrid(const Influences& influences);
// Fixed efforts of 1 to 181 substeps against targets of 40 % to 0.01 % that start from 1, 2 or 4 substeps, at steps of
// 1/30 and 1/60 s.
std::vector<Setting> TargetGrid(const Influences& influences);
// dt 1/30 .. 1/960 x substeps 1 .. 16 x velocity iterations 1 .. 32 x position iterations 0 .. 4 of Soft and Baumgarte,
// a part of it for the others, and the presets. Cheap ones first. A coarse one leaves out 1/480 and 1/960 s, and every
// other number of substeps and iterations: a twentieth of the work.
std::vector<Setting> FullGrid(const Influences& influences, bool isCoarse = false);
// Another engine at steps of 1/30 to 1/240 s with its default number of iterations, 4 and 50; in short grids the latter
// two at 1/60 s only.
std::vector<Setting> PeerGrid(const Influences& influences, const Peer& peer, bool isQuick);

}  // namespace fulcrum::accuracy
