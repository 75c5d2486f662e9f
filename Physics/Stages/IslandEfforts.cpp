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
// A column is at least this many times as high as half its width: its base carries all of it.
constexpr float kSlender = 8;
// Large islands, where more effort costs time for all bodies, get more only for walls: those so much higher than thick
// that they would soon buckle. A column of their height would need twice the stiffness; tapered walls come to rest
// without.
constexpr float kBucklingOfLarge = 110;
// Large islands get the effort at which a load of so many weights sinks a body by the allowed penetration.
constexpr float kWeights = 2;
// Single contacts for which so many passes over their rows in a step suffice get these, those of four substeps: a
// direct solution of one takes as long as 60, of many islands together in full lanes.
constexpr int kFewPasses = 8;
// Minimum number of constraints of an island that may buckle.
constexpr uint32_t kLeastHigh = 4;
constexpr int kMostSubsteps = std::numeric_limits<uint8_t>::max();  // LeastEffort has no more

struct Need {
    // Ratio of the sink of an island's contacts to its target, in the substeps of LoadSoftnessOf.
    float need = 0;
    uint32_t culprit = ~0u;  // the body with that contact

    void Raise(float to, uint32_t body) {
        if (!(need < to)) return;
        need = to;
        culprit = body;
    }
};

class LoadEfforts {
public:
    LoadEfforts(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                const PairStore& pairs, std::span<const uint32_t> sizes, uint32_t mostLoaded, UnionFind& sets,
                std::span<Need> needs, ScratchArena& scratch)
        : settings_(step.settings),
          softness_(LoadSoftnessOf(step)),
          bodies_(bodies),
          coloring_(coloring),
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

    // The lighter one of the dynamic bodies of a contact.
    uint32_t LighterOf(const Entry& entry) const {
        const auto inverseMassOf = [&](uint32_t body) { return bodies_.dynamics[body].inverseMass; };
        if (entry.fixedA || entry.fixedB) return MovingBodyOf(entry);
        return inverseMassOf(entry.bodyB) > inverseMassOf(entry.bodyA) ? entry.bodyB : entry.bodyA;
    }

    void AddNeed(const Entry& entry) {
        const LoadLevel& load = pairs_.loads[pairs_.contacts[entry.constraint].pair];
        if (load.level == 0) return;
        const uint32_t root = RootOf(MovingBodyOf(entry));
        if (sizes_[root] > mostLoaded_) return;
        float size = std::numeric_limits<float>::infinity();
        if (!entry.fixedA) size = std::min(size, SizeOf(bodies_.dynamics[entry.bodyA]));
        if (!entry.fixedB) size = std::min(size, SizeOf(bodies_.dynamics[entry.bodyB]));
        const Extent& extent = places_[root] == kNone ? kLow : extents_[places_[root]];
        const float factor = BucklingFactor(size, extent, kBuckling);
        needs_[root].Raise(ExcessOfLevel(load.level) * factor, LighterOf(entry));
    }

    const SystemSettings& settings_;
    float softness_;
    const BodyStore& bodies_;
    const ConstraintColoring& coloring_;
    const PairStore& pairs_;
    std::span<const uint32_t> sizes_;
    uint32_t mostLoaded_;
    UnionFind& sets_;
    static constexpr uint32_t kNone = ~0u;
    static constexpr Extent kLow{};
    std::span<uint32_t> places_;  // by root, index in extents_; kNone: only its loads count
    std::span<Extent> extents_;
    std::span<Need> needs_;  // by root
};

// The effort at which contacts sink `need` times less than with the system's settings: substeps, with whose square
// sinks fall, in steps of the root of two, so that efforts seldom change.
LeastEffort EffortFor(float need, const SolverSettings& solver) {
    int substeps = solver.substeps;
    for (float factor = 1; need > 1 && substeps < kMostSubsteps; need *= 0.5f) {
        factor *= 1.41421356f;
        substeps = static_cast<int>(std::ceil(factor * static_cast<float>(solver.substeps) - 0.01f));
    }
    LeastEffort effort = ToLeastEffort(solver);
    effort.substeps = static_cast<uint8_t>(std::min(substeps, kMostSubsteps));
    return effort;
}

int PassesOf(const LeastEffort& effort) {
    return effort.substeps * (effort.velocityIterations + effort.positionIterations);
}

}  // namespace

void Raise(IslandEffort& effort, const IslandEffort& to) { RaiseLeast(effort, to.least, to.culprit); }

std::span<const IslandEffort> FindEfforts(const StepContext& step, const BodyStore& bodies,
                                          const ConstraintColoring& coloring, const JointStore& joints,
                                          const PairStore& pairs, std::span<const uint32_t> sizes, uint32_t mostLoaded,
                                          UnionFind& sets, ScratchArena& scratch) {
    const size_t count = bodies.awake.size();
    std::span<IslandEffort> efforts = scratch.Allocate<IslandEffort>(count);
    std::fill(efforts.begin(), efforts.end(), IslandEffort{});
    VisitEntries(coloring, Kind::Joint, [&](uint32_t, const Entry& entry) {
        const LeastEffort& asked = joints.joints[entry.constraint].effort;
        if (!asked.IsAny()) return;
        const uint32_t body = MovingBodyOf(entry);
        RaiseLeast(efforts[sets.Find(bodies.cold[body].awakePlace)], asked, body);
    });
    if (!AdaptsToLoads(step.settings, bodies)) return efforts;
    std::span<Need> needs = scratch.Allocate<Need>(count);
    std::fill(needs.begin(), needs.end(), Need{});
    LoadEfforts(step, bodies, coloring, pairs, sizes, mostLoaded, sets, needs, scratch).Find();
    const float ofSubsteps = step.softness / LoadSoftnessOf(step);  // of a need: with the settings' own
    for (size_t i = 0; i < count; ++i) {
        const auto [need, culprit] = needs[i];
        if (!(need > 1)) continue;
        const LeastEffort effort = EffortFor(need * ofSubsteps, step.settings.solver);
        const bool isFew = effort.Exceeds(step.settings.solver) && PassesOf(effort) <= kFewPasses;
        if (sizes[i] > mostLoaded || (sizes[i] == 1 && isFew)) {
            RaiseLeast(efforts[i], effort, culprit);
            continue;
        }
        efforts[i].isHard = true;
        if (efforts[i].culprit == ~0u) efforts[i].culprit = culprit;
    }
    return efforts;
}

}  // namespace fulcrum
