#include <Fulcrum/Physics/Stages/IslandEfforts.h>

#include <Fulcrum/Physics/Stages/ContactLoads.h>
#include <Fulcrum/Physics/Stages/FindIslands.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;

void RaiseLeast(IslandEffort& effort, const LeastEffort& to, uint32_t culprit) {
    if (effort.least.Raise(to)) effort.culprit = culprit;
}

// Extent of an island: moments of its centers of mass relative to one of them, and masses.
struct Extent {
    float count = 0;
    float low = 0, high = 0;                                // m, along the direction opposite to gravity
    float x = 0, z = 0, xx = 0, xz = 0, zz = 0;             // sums over the horizontal coordinates
    float mass = 0;                                         // kg, total
    float target = std::numeric_limits<float>::infinity();  // the least of its bodies, see PenetrationTargetOf
    uint32_t lightest = ~0u;                                // body
    bool hasJoints = false;

    void Add(float up, float along, float across) {
        low = std::min(low, up);
        high = std::max(high, up);
        count += 1;
        x += along;
        z += across;
        xx += along * along;
        xz += along * across;
        zz += across * across;
    }
    float Height() const { return high - low; }
    // m^2: the squared half widths of the narrower and the wider side, if the centers were distributed uniformly.
    std::pair<float, float> SquaredHalfWidths() const {
        const float n = 1 / count, a = n * xx - n * n * x * x, b = n * xz - n * n * x * z, d = n * zz - n * n * z * z;
        const float mean = 0.5f * (a + d), half = 0.5f * (a - d), radius = std::sqrt(half * half + b * b);
        return {3 * std::max(mean - radius, 0.0f), 3 * (mean + radius)};
    }
};

// A column buckles under its own weight if the sink at its base times its height exceeds 0.22 a^2, with a half its
// width (measured; consistent with an elastic column, which buckles at a critical ratio of stiffness to weight). The
// allowed product is this constant times the target's penetration times a^2: a quarter of the critical one at the
// default 0.004.
constexpr float kBuckling = 12;
// Likewise for islands that are no columns: neighbors support each other.
constexpr float kBucklingOfWalls = 20;
// A column is at least this many times as high as half its width: its base carries all of it.
constexpr float kSlender = 8;
// Large islands, where more effort costs time for all bodies, get more only for walls: those so much higher than thick
// that they would soon buckle. A column of their height would need twice the stiffness; tapered walls come to rest
// without.
constexpr float kBucklingOfLarge = 110;
// Large islands get the effort at which a load of so many weights sinks a body by the allowed penetration.
constexpr float kWeights = 2;
// Islands for which so many passes over their rows in a step suffice get these, those of four substeps: a direct
// solution of one takes as long as 60, of many islands together in full lanes.
constexpr int kFewPasses = 8;
// Minimum number of constraints of an island that may buckle.
constexpr uint32_t kLeastHigh = 4;

struct Need {
    // Ratio of the sink of an island's contacts, or of the gap of its joints, to its target, with the system's
    // settings.
    float need = 0;
    uint32_t culprit = ~0u;  // the body with that contact or joint
    uint8_t stiffness = 0;   // minimum over the loaded contacts of the last step; 0: none
    bool isStiff = false;    // whether it needs the stiffest springs, as gaps of joints do
    bool isLoaded = false;   // whether a body lies on a much lighter one, see IsLoad

    void Raise(float to, uint32_t body) {
        if (!(need < to)) return;
        need = to;
        culprit = body;
    }
    void Load(uint32_t body) {
        isLoaded = true;
        if (culprit == ~0u) culprit = body;
    }
    void Soften(uint8_t to) { stiffness = stiffness == 0 ? to : std::min(stiffness, to); }
};

class LoadEfforts {
public:
    LoadEfforts(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                const JointStore& joints, const PairStore& pairs, std::span<const uint32_t> sizes, uint32_t mostLoaded,
                UnionFind& sets, std::span<Need> needs, ScratchArena& scratch)
        : step_(step),
          settings_(step.settings),
          softness_(LoadSoftnessOf(step)),
          bodies_(bodies),
          coloring_(coloring),
          joints_(joints),
          pairs_(pairs),
          sizes_(sizes),
          mostLoaded_(mostLoaded),
          sets_(sets),
          places_(scratch.Allocate<uint32_t>(bodies.awake.size())),
          needs_(needs) {
        uint32_t count = 0;
        for (uint32_t i = 0; i < places_.size(); ++i)
            places_[i] = sizes[i] >= kLeastHigh ? count++ : kNone;  // sizes: 0 but for roots
        extents_ = scratch.Allocate<Extent>(count);
        std::fill(extents_.begin(), extents_.end(), Extent{});
    }

    void Find() {
        FindExtents();
        for (Kind kind : {Kind::Moving, Kind::Fixed})
            VisitEntries(coloring_, kind, [&](uint32_t, const Entry& entry) { AddNeed(entry); });
        for (uint32_t i = 0; i < places_.size(); ++i)
            if (places_[i] != kNone) AddNeedOfColumn(i, extents_[places_[i]]);
        AddNeedsOfLarge();
        FindLoads();
    }

private:
    // How deep it may sink on what has no target of its own.
    float TargetOf(uint32_t body) const {
        return PenetrationTargetOf(bodies_, body, body, settings_.accuracy.penetration);
    }
    uint32_t RootOf(uint32_t body) { return sets_.Find(bodies_.cold[body].awakePlace); }

    void FindExtents() {
        const Vector3 g = settings_.gravity;
        const float length = Length(g);
        if (!(length > 0)) return;
        const Vector3 up = g * (-1 / length);
        const Vector3 along = Normalized(Cross(up, std::fabs(up.x()) < 0.5f ? Vector3(1, 0, 0) : Vector3(0, 1, 0)));
        const Vector3 across = Cross(up, along);
        for (uint32_t i = 0; i < bodies_.awake.size(); ++i) {
            const uint32_t root = sets_.Find(i);
            if (places_[root] == kNone) continue;
            const Position from = bodies_.CenterOf(bodies_.awake[i]) - bodies_.CenterOf(bodies_.awake[root]);
            const Vector3 p(static_cast<float>(from.x()), static_cast<float>(from.y()), static_cast<float>(from.z()));
            Extent& extent = extents_[places_[root]];
            extent.Add(Dot(p, up), Dot(p, along), Dot(p, across));
            const uint32_t body = bodies_.awake[i];
            const float inverseMass = bodies_.dynamics[body].inverseMass;
            if (!(inverseMass > 0)) continue;
            extent.mass += 1 / inverseMass;
            extent.target = std::min(extent.target, TargetOf(body));
            if (extent.lightest == ~0u || inverseMass > bodies_.dynamics[extent.lightest].inverseMass)
                extent.lightest = body;
        }
        VisitEntries(coloring_, Kind::Joint, [&](uint32_t, const Entry& entry) {
            const uint32_t place = places_[RootOf(MovingBodyOf(entry))];
            if (place != kNone) extents_[place].hasJoints = true;
        });
    }

    // By how much the allowed sink of bodies of this size, m, is below the target in an island of this extent.
    static float BucklingFactor(float size, const Extent& extent, float buckling) {
        if (!(extent.count > 0)) return 1;
        const float width = size * size + extent.SquaredHalfWidths().first;
        return std::max(1.0f, size * extent.Height() / (buckling * width));
    }

    // For large islands only the needs of small bodies by their own weight: more would cost too much.
    void AddNeedsOfLarge() {
        const float weights = kWeights * Length(settings_.gravity) * softness_;
        for (uint32_t i = 0; i < bodies_.awake.size(); ++i) {
            const BodyDynamics& body = bodies_.dynamics[bodies_.awake[i]];
            const float least = weights / TargetOf(bodies_.awake[i]), size = SquaredSizeOf(body);
            // Those that may be loaded (IsLoad), and the heaviest.
            constexpr float kSquared = (kCalm / kWeights) * (kCalm / kWeights);
            if (size >= kSquared * least * least) lightest_ = std::max(lightest_, body.inverseMass);
            if (body.inverseMass > 0) heaviest_ = std::min(heaviest_, body.inverseMass);
            if (!(size < least * least)) continue;
            const uint32_t root = sets_.Find(i);
            if (sizes_[root] > mostLoaded_) needs_[root].Raise(least / SizeOf(body), bodies_.awake[i]);
        }
    }

    // In a column the impulse at the foot reaches the load after as many steps as it has bodies; impulses of large
    // islands are not used. The load of a large island is carried by its whole foot: as many bodies as fit in its
    // widths.
    void AddNeedOfColumn(uint32_t root, const Extent& extent) {
        if (extent.hasJoints || extent.lightest == ~0u) return;
        const BodyDynamics& lightest = bodies_.dynamics[extent.lightest];
        const float size = SizeOf(lightest), height = extent.Height();
        const auto [narrow, wide] = extent.SquaredHalfWidths();
        const bool isLarge = sizes_[root] > mostLoaded_;
        if (!(height * height > kSlender * kSlender * (size * size + (isLarge ? narrow : wide)))) return;
        float sink = extent.mass * lightest.inverseMass * Length(settings_.gravity) * softness_ / size;
        if (isLarge) sink /= std::sqrt((1 + narrow / (size * size)) * (1 + wide / (size * size)));
        needs_[root].Raise(sink / extent.target * BucklingFactor(size, extent, isLarge ? kBucklingOfLarge : kBuckling),
                           extent.lightest);
    }

    // Marks the islands where a heavy body lies on a light one.
    void FindLoads() {
        if (!(lightest_ > kHeavy * heaviest_)) return;
        const Vector3 g = step_.settings.gravity;
        VisitEntries(coloring_, Kind::Moving, [&](uint32_t, const Entry& entry) {
            if (entry.fixedA || entry.fixedB) return;
            const BodyDynamics &a = bodies_.dynamics[entry.bodyA], &b = bodies_.dynamics[entry.bodyB];
            const bool isALighter = a.inverseMass > b.inverseMass;
            const BodyDynamics &lighter = isALighter ? a : b, &heavier = isALighter ? b : a;
            const uint32_t light = isALighter ? entry.bodyA : entry.bodyB,
                           heavy = isALighter ? entry.bodyB : entry.bodyA;
            if (!IsLoad(heavier, lighter, TargetOf(light), step_)) return;
            const uint32_t root = RootOf(light);
            if (sizes_[root] > mostLoaded_ || joints_.HasAny(light) || joints_.HasAny(heavy)) return;
            const Position rise = bodies_.CenterOf(heavy) - bodies_.CenterOf(light);
            if (rise.x() * double{g.x()} + rise.y() * double{g.y()} + rise.z() * double{g.z()} < 0)
                needs_[root].Load(light);
        });
    }

    // The lighter one of the dynamic bodies of a contact.
    uint32_t LighterOf(const Entry& entry) const {
        const auto inverseMassOf = [&](uint32_t body) { return bodies_.dynamics[body].inverseMass; };
        if (entry.fixedA || entry.fixedB) return MovingBodyOf(entry);
        return inverseMassOf(entry.bodyB) > inverseMassOf(entry.bodyA) ? entry.bodyB : entry.bodyA;
    }

    void AddNeed(const Entry& entry) {
        const LoadLevel& load = pairs_.loads[pairs_.contacts[entry.constraint].pair];
        if (load.level == 0 && load.recent == 0) return;
        const uint32_t root = RootOf(MovingBodyOf(entry));
        if (sizes_[root] > mostLoaded_) return;
        float size = std::numeric_limits<float>::infinity();
        if (!entry.fixedA) size = std::min(size, SizeOf(bodies_.dynamics[entry.bodyA]));
        if (!entry.fixedB) size = std::min(size, SizeOf(bodies_.dynamics[entry.bodyB]));
        const Extent& extent = places_[root] == kNone ? kLow : extents_[places_[root]];
        const float factor = BucklingFactor(size, extent, kBucklingOfWalls);
        const auto needOf = [&](uint32_t level) { return ExcessOfLevel(level) * factor; };
        Need& most = needs_[root];
        if (load.level > 0) most.Raise(needOf(load.level), LighterOf(entry));
        // A contact under high load in the last step, even by an impact, was solved with the last stiffness.
        if (load.stiffness > 0 && needOf(std::max(load.level, load.recent)) > 1) most.Soften(load.stiffness);
    }

    const StepContext& step_;
    const SystemSettings& settings_;
    float softness_;
    const BodyStore& bodies_;
    const ConstraintColoring& coloring_;
    const JointStore& joints_;
    const PairStore& pairs_;
    std::span<const uint32_t> sizes_;
    uint32_t mostLoaded_;
    UnionFind& sets_;
    static constexpr uint32_t kNone = ~0u;
    static constexpr Extent kLow{};
    std::span<uint32_t> places_;  // by root, index in extents_; kNone: only its loads count
    std::span<Extent> extents_;
    std::span<Need> needs_;                                                   // by root
    float lightest_ = 0, heaviest_ = std::numeric_limits<float>::infinity();  // 1/kg, see AddNeedsOfLarge
};

// The effort at which contacts sink `need` times less than with the system's settings: substeps, with whose square
// sinks fall. Not iterations: loads rattle on light legs with two relax iterations and more, and a step of N substeps
// of one iteration costs less than any other that is as stiff. Gaps of joints get iterations beyond 64 substeps. In
// powers of two, so that efforts seldom change. Leaves the part of the need that is not met: at most 1 if all of it is.
SolverSettings EffortFor(float& need, bool hasGaps, const SystemSettings& settings) {
    constexpr int kMostForGaps = 64, kMostIterations = 4;
    const int most = hasGaps ? std::min(settings.accuracy.mostSubsteps, kMostForGaps) : settings.accuracy.mostSubsteps;
    const int mostSubsteps = std::max(most, settings.solver.substeps);
    SolverSettings effort = settings.solver;
    for (float factor = 1; need > 1 && effort.substeps < mostSubsteps; need *= 0.5f) {
        factor *= 1.41421356f;
        const int substeps = static_cast<int>(std::ceil(factor * static_cast<float>(settings.solver.substeps) - 0.01f));
        effort.substeps = std::min(substeps, mostSubsteps);
    }
    for (; hasGaps && need > 1 && effort.velocityIterations < kMostIterations; need *= 0.5f) {
        effort.velocityIterations *= 2;
        effort.positionIterations = std::max(effort.positionIterations, effort.velocityIterations);
    }
    return effort;
}

int PassesOf(const SolverSettings& effort) {
    return effort.substeps * (effort.velocityIterations + effort.positionIterations);
}

}  // namespace

void Raise(IslandEffort& effort, const IslandEffort& to) {
    RaiseLeast(effort, to.least, to.culprit);
    if (!to.isLoaded) return;
    if (!effort.isLoaded || (to.stiffness > 0 && (effort.stiffness == 0 || to.stiffness < effort.stiffness)))
        effort.stiffness = to.stiffness;
    effort.longer = effort.isLoaded ? std::min(effort.longer, to.longer) : to.longer;
    effort.isLoaded = true;
}

std::span<const IslandEffort> FindEfforts(const StepContext& step, const BodyStore& bodies,
                                          const ConstraintColoring& coloring, const JointStore& joints,
                                          const PairStore& pairs, std::span<const uint32_t> sizes, uint32_t mostLoaded,
                                          UnionFind& sets, ScratchArena& scratch) {
    const size_t count = bodies.awake.size();
    std::span<IslandEffort> efforts = scratch.Allocate<IslandEffort>(count);
    std::fill(efforts.begin(), efforts.end(), IslandEffort{});
    std::span<Need> needs = scratch.Allocate<Need>(count);
    std::fill(needs.begin(), needs.end(), Need{});
    const bool adaptsToGaps = AdaptsToGaps(step.settings, joints);
    VisitEntries(coloring, Kind::Joint, [&](uint32_t, const Entry& entry) {
        const Joint& joint = joints.joints[entry.constraint];
        if (!joint.effort.IsAny() && !adaptsToGaps) return;
        const uint32_t body = MovingBodyOf(entry), root = sets.Find(bodies.cold[body].awakePlace);
        if (joint.effort.IsAny()) RaiseLeast(efforts[root], joint.effort, body);
        const LoadLevel& gap = joints.gaps[entry.constraint].load;
        if (!adaptsToGaps || gap.level == 0 || sizes[root] > mostLoaded) return;
        const float need = ExcessOfLevel(gap.level);
        needs[root].Raise(need, body);
        needs[root].isStiff = true;
        if (gap.stiffness > 0 && need > 1) needs[root].Soften(gap.stiffness);
    });
    if (AdaptsToLoads(step.settings, bodies))
        LoadEfforts(step, bodies, coloring, joints, pairs, sizes, mostLoaded, sets, needs, scratch).Find();
    else if (!adaptsToGaps) return efforts;
    // Of loads, with the settings' own substeps.
    const float ofSubsteps = step.softness / LoadSoftnessOf(step);
    for (size_t i = 0; i < count; ++i) {
        efforts[i].isHard = needs[i].need > 1 && !needs[i].isStiff;
        if (efforts[i].isHard && efforts[i].culprit == ~0u) efforts[i].culprit = needs[i].culprit;
        if (!needs[i].isStiff) needs[i].need *= ofSubsteps;
        if (!(needs[i].need > 1) && !needs[i].isLoaded) continue;
        // Islands under load get springs half as stiff as the stiffest, unless the maximum effort does not suffice
        // then. A need is up to twice what the island needs.
        const float softer = needs[i].isStiff || sizes[i] > mostLoaded ? 1 : kLoadedSubstep * kLoadedSubstep;
        float need = needs[i].need * softer;
        const SolverSettings effort = EffortFor(need, needs[i].isStiff, step.settings);
        if (effort.substeps > step.settings.solver.substeps && sizes[i] < kLeastHigh && PassesOf(effort) <= kFewPasses)
            efforts[i].isHard = false;
        efforts[i].longer = std::sqrt(softer / std::clamp(0.5f * need, 1.0f, softer));
        RaiseLeast(efforts[i], ToLeastEffort(effort), needs[i].culprit);
        efforts[i].isLoaded = true;
        efforts[i].stiffness = needs[i].stiffness;
    }
    return efforts;
}

}  // namespace fulcrum
