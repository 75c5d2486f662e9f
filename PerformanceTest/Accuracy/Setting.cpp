#include <Fulcrum/PerformanceTest/Accuracy/Setting.h>

#include <Fulcrum/PerformanceTest/Peers/Peer.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

namespace fulcrum::accuracy {
namespace {

constexpr std::pair<const char*, SolverSettings> kPresets[] = {
    {"fast", SolverSettings::Fast()},
    {"balanced", SolverSettings::Balanced()},
    {"accurate", SolverSettings::Accurate()},
    {"reference", SolverSettings::Reference()},
};

// Adds settings, each once, and only those that make a difference to the scene.
class Grid {
public:
    explicit Grid(const Influences& influences) : influences_(influences) {
        for (const auto& [name, solver] : kPresets) Add({.solver = solver});
    }
    void Add(Setting setting) {
        if (!influences_.timeStep && setting.rate != 60) return;
        const bool hasConstraints = influences_.contacts || influences_.joints;
        // Without contacts and joints nothing is solved: the time step alone matters, and the presets are one setting.
        if (!hasConstraints && (setting.solver != SolverSettings{} || setting.family != Family::Soft)) return;
        if (setting.family == Family::Libccd && !influences_.contacts) return;
        if (setting.family == Family::NoTrees && !influences_.joints) return;
        if (std::find(settings_.begin(), settings_.end(), setting) == settings_.end()) settings_.push_back(setting);
    }
    std::vector<Setting> Take() { return std::move(settings_); }

private:
    Influences influences_;
    std::vector<Setting> settings_;
};

SolverSettings Effort(int substeps, int velocityIterations, int positionIterations, Family family) {
    SolverSettings solver;
    solver.substeps = substeps;
    solver.velocityIterations = velocityIterations;
    solver.positionIterations = positionIterations;
    if (family == Family::Baumgarte) solver.positionCorrection = PositionCorrection::Baumgarte;
    return solver;
}

}  // namespace

const char* FamilyName(Family family) {
    constexpr const char* kNames[kFamilies] = {"soft", "baumgarte", "libccd", "no_trees", "fixed", "target"};
    return kNames[static_cast<int>(family)];
}

SystemSettings Setting::System() const {
    SystemSettings settings;
    settings.solver = solver;
    if (family == Family::Libccd) settings.narrowPhase = NarrowPhaseMethod::Libccd;
    if (family == Family::NoTrees) settings.exactJointLoad = std::numeric_limits<float>::infinity();
    if (family == Family::Fixed) settings.accuracy.penetration = std::numeric_limits<float>::infinity();
    if (family == Family::Target) settings.accuracy.penetration = settings.accuracy.jointError = target;
    return settings;
}

double Setting::PassesPerSecond() const {
    return static_cast<double>(rate) * solver.substeps * (solver.velocityIterations + solver.positionIterations);
}

std::string Setting::Key() const {
    return std::string(FamilyText()) + " 1/" + std::to_string(rate) + " " + std::to_string(solver.substeps) + " " +
           std::to_string(solver.velocityIterations) + " " + std::to_string(solver.positionIterations) +
           (family == Family::Target ? " " + TargetText() : "");
}

std::string Setting::TargetText() const {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", static_cast<double>(target));
    return text;
}

const char* Setting::FamilyText() const { return peer ? peer->name : FamilyName(family); }

const char* Setting::Preset() const {
    if (peer) return rate == 60 && solver.velocityIterations == peer->iterations ? "default" : "";
    if (rate == 60 && family == Family::Soft)
        for (const auto& [name, preset] : kPresets)
            if (solver == preset) return name;
    return "";
}

std::string Setting::Code() const {
    std::string code = "settings.solver = {.substeps = " + std::to_string(solver.substeps) +
                       ", .velocityIterations = " + std::to_string(solver.velocityIterations) +
                       ", .positionIterations = " + std::to_string(solver.positionIterations);
    if (family == Family::Baumgarte) code += ", .positionCorrection = PositionCorrection::Baumgarte";
    code += "};";
    if (family == Family::Libccd) code += " settings.narrowPhase = NarrowPhaseMethod::Libccd;";
    if (family == Family::NoTrees) code += " settings.exactJointLoad = std::numeric_limits<float>::infinity();";
    if (family == Family::Fixed) code += " settings.accuracy.penetration = std::numeric_limits<float>::infinity();";
    if (family == Family::Target)
        code += " settings.accuracy = {.penetration = " + TargetText() + "f, .jointError = " + TargetText() + "f};";
    return code + " system->Update(1.0 / " + std::to_string(rate) + ");";
}

std::vector<Setting> QuickGrid(const Influences& influences) {
    Grid grid(influences);
    for (const int rate : {30, 60, 120, 240}) grid.Add({.rate = rate});
    grid.Add({.solver = Effort(1, 10, 2, Family::Soft)});
    for (const int rate : {60, 240})
        grid.Add({.rate = rate, .solver = Effort(4, 1, 1, Family::Baumgarte), .family = Family::Baumgarte});
    grid.Add({.family = Family::Libccd});
    grid.Add({.family = Family::NoTrees});
    return grid.Take();
}

std::vector<Setting> AdviceGrid(const Influences& influences) {
    std::vector<Setting> settings = QuickGrid(influences);
    if (!influences.contacts && !influences.joints) return settings;
    for (const SolverSettings& solver : {SolverSettings::Fast(), SolverSettings::Balanced()})
        for (const float target : {0.1f, 0.03f, 0.01f, 0.003f, 0.001f})
            settings.push_back({.solver = solver, .family = Family::Target, .target = target});
    return settings;
}

std::vector<Setting> TargetGrid(const Influences& influences) {
    std::vector<Setting> settings;
    if (!influences.contacts && !influences.joints) return settings;
    for (const int rate : {30, 60}) {
        for (const int substeps : {1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 46, 64, 91, 128, 181})
            settings.push_back({rate, Effort(substeps, 1, 1, Family::Fixed), Family::Fixed});
        for (const int substeps : {1, 2, 3, 4, 5})
            // A substep of the square root of the half: half of the target.
            for (const float target :
                 {0.4f, 0.2f, 0.1f, 0.05f, 0.025f, 0.012f, 0.006f, 0.003f, 0.0015f, 0.0008f, 0.0004f, 0.0002f, 0.0001f})
                settings.push_back({rate, Effort(substeps, 1, 1, Family::Target), Family::Target, target});
    }
    return settings;
}

std::vector<Setting> FullGrid(const Influences& influences, bool isCoarse) {
    using List = std::vector<int>;
    const List rates = isCoarse ? List{30, 60, 120, 240} : List{30, 60, 120, 240, 480, 960};
    const List substeps = isCoarse ? List{1, 4, 16} : List{1, 2, 4, 8, 16};
    const List velocities = isCoarse ? List{1, 4, 16} : List{1, 2, 4, 8, 16, 32};
    const List positions = isCoarse ? List{0, 1, 2} : List{0, 1, 2, 4};
    Grid grid(influences);
    for (const Family family : {Family::Soft, Family::Baumgarte, Family::Libccd, Family::NoTrees})
        for (const int rate : rates)
            for (const int count : substeps)
                for (const int velocity : velocities)
                    for (const int position : positions) {
                        const bool isSide = family == Family::Libccd || family == Family::NoTrees;
                        if (isSide && (position != 1 || (velocity != 1 && velocity != 4))) continue;
                        grid.Add({rate, Effort(count, velocity, position, family), family});
                    }
    std::vector<Setting> settings = grid.Take();
    std::stable_sort(settings.begin(), settings.end(),
                     [](const Setting& a, const Setting& b) { return a.PassesPerSecond() < b.PassesPerSecond(); });
    return settings;
}

std::vector<Setting> PeerGrid(const Influences& influences, const Peer& peer, bool isQuick) {
    std::vector<Setting> settings;
    for (const int rate : {30, 60, 120, 240})
        for (const int iterations : {peer.iterations, 4, 50}) {
            const bool isUsual = iterations == peer.iterations;
            if (!influences.timeStep && rate != 60) continue;
            if (!isUsual && !influences.contacts && !influences.joints) continue;  // nothing is solved
            if (!isUsual && isQuick && rate != 60) continue;
            settings.push_back({.rate = rate,
                                .solver = {.substeps = 1, .velocityIterations = iterations, .positionIterations = 0},
                                .family = Family::Peer,
                                .peer = &peer});
        }
    return settings;
}

}  // namespace fulcrum::accuracy
