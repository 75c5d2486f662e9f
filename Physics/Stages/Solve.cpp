// The solver loop is a sequence of verbs. For groups of small islands one worker runs the whole sequence. For large
// islands it is a sequence of short parallel phases: one per color, iteration and substep, and two over the bodies per
// substep. Colors are solved in ascending order, then the constraints without a color, serially. Within a color joints
// come before contacts, so non-penetration wins.
//
// Only bodies with constraints take part; the others are moved by Store.
//
// The warm start of every substep but the first costs nothing per constraint: the impulses of the last substep change
// each body's velocity by the same amount again, which is the difference of its solved and unconstrained velocities.
// Rows of contacts are constant within a step; joints add the change due to the rotation of their parts.
#include <Fulcrum/Jobs/Phases.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/EnergyLimit.h>
#include <Fulcrum/Physics/Stages/ErrorMeter.h>
#include <Fulcrum/Physics/Stages/Integrate.h>
#include <Fulcrum/Physics/Stages/LocalIterations.h>
#include <Fulcrum/Physics/Stages/PrefetchLines.h>
#include <Fulcrum/Physics/Stages/Recollide.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>
#include <atomic>
#include <optional>

namespace fulcrum {

namespace {

constexpr uint32_t kBatchesPerBlock = 4;
constexpr uint32_t kBodiesPerBlock = 128;

enum class Verb : uint8_t {
    IntegrateVelocities,
    WarmStart,
    FirstVelocities,
    Velocities,
    Impacts,  // velocity iterations in which contacts leave overlaps (Effort::impactIterations)
    // Serial, for contacts with large velocity errors, or overlaps that grow fast (LocalIterations.h):
    IterateVelocities,
    IterateRelax,
    LimitDepths,
    LimitEnergy,  // serial, of islands with joints that are pushed fast (EnergyLimit.h)
    ClearPulls,
    FirstPull,
    Pull,
    StopPulls,
    IntegratePoses,
    FirstRelax,
    Relax,
    FirstCorrection,
    Correction,
    Separations,
    NoteImpulses,  // for contact events
    NextSubstep,
    // For contacts whose bodies moved too far relative to each other (Recollide.h):
    StoreOutdated,
    Recollide,
    Refill
};

struct Phase {
    Verb verb;
    uint8_t substep;
    uint16_t color;  // of the large group, from 0; equal to the number of its colors: the overflow
};

// What a verb reads of a batch of contacts.
enum class Reads { Little, NormalRows, All };

// Prefetches the next batch while this one is solved.
FULCRUM_FORCE_INLINE void Prefetch(const ContactBatch<kLanes, false>& batch, Reads reads) {
    if (reads == Reads::Little) return;
    const auto normalRows = reinterpret_cast<const char*>(&batch.tangent1) - reinterpret_cast<const char*>(&batch);
    PrefetchLines(&batch, reads == Reads::All ? sizeof batch : static_cast<size_t>(normalRows));
}
template <class Batch>
FULCRUM_FORCE_INLINE void Prefetch(const Batch&, Reads) {}

bool IsOverBodies(Verb verb) {
    return verb == Verb::IntegrateVelocities || verb == Verb::ClearPulls || verb == Verb::IntegratePoses;
}

bool IsOfRecollision(Verb verb) {
    return verb == Verb::StoreOutdated || verb == Verb::Recollide || verb == Verb::Refill;
}

bool IsSerial(Verb verb) {
    return verb == Verb::IterateVelocities || verb == Verb::IterateRelax || verb == Verb::LimitDepths;
}

class StepSolver {
public:
    // pseudo: zeroed pseudo-velocities of all bodies; null if the group has no joints that are far apart.
    // pushes: by body; empty if not requested.
    StepSolver(const CollideStores& stores, const MovedBodies& moved, SolverLayout& layout, const SolverGroup& group,
               const Effort& effort, BodyState* pseudo, std::span<PushNote> pushes, const LocalMemory& local)
        : stores_(stores),
          moved_(moved),
          bodies_(moved.store),
          layout_(layout),
          group_(group),
          effort_(effort),
          pseudo_(pseudo),
          pushes_(pushes),
          notes_(layout.notes.empty() ? nullptr : layout.notes.data()),
          rare_{stores.pairs.records.data(), moved.store.poses.data(), stores.pairs.surfaceVelocities.data(),
                std::min(moved.settings.contactPushSpeed, moved.settings.depenetrationSpeed)},
          h_(effort.substepDt),
          local_(stores.bodies, stores.joints, layout, group, local) {}

    // A large group: all workers, phase by phase.
    void RunTogether(std::span<const Phase> phases, const StepWorkers& workers) {
        std::span<uint32_t> counts = workers.scratch.Allocate<uint32_t>(phases.size());
        for (size_t i = 0; i < phases.size(); ++i) counts[i] = BlockCount(phases[i]);
        RunPhases(workers.jobs, counts, [&](uint32_t phase, uint32_t block, uint32_t worker) {
            RunBlock(phases[phase], block, workers.findings[worker]);
        });
    }

    // Also limits the energy of islands with joints that are pushed fast.
    void LimitEnergyWith(std::span<uint32_t> parents, std::span<uint32_t> islandOf, std::span<uint32_t> members,
                         std::span<IslandEnergy> islands) {
        energyLimit_.emplace(bodies_, moved_.joints, moved_.pairs, layout_, group_, parents, islandOf, members,
                             islands);
    }

    // A group of small islands: one worker, from beginning to end.
    void RunAlone(std::span<const Verb> verbs, WorkerFindings& findings) {
        uint8_t substep = 0;
        for (const Verb verb : verbs) {
            if (IsOverBodies(verb)) {
                if (verb == Verb::IntegratePoses && energyLimit_) energyLimit_->NoteFree();
                RunBodies(verb, substep,
                          std::span(layout_.bodies).subspan(group_.bodiesBegin, group_.bodiesEnd - group_.bodiesBegin),
                          findings);
                continue;
            }
            if (verb == Verb::NextSubstep) {
                ++substep;
                continue;
            }
            if (IsSkipped(verb, substep)) continue;
            if (verb == Verb::LimitEnergy) {
                energyLimit_->Apply();
                continue;
            }
            if (IsSerial(verb)) {
                RunIterated(verb, substep);
                continue;
            }
            if (group_.HasTrees()) RunTrees(verb, substep);
            for (uint32_t c = group_.colorsBegin; c < group_.colorsEnd; ++c)
                RunBatches({verb, substep, 0}, layout_.colors[c], 0, layout_.colors[c].Count(), findings);
        }
    }

private:
    uint32_t BlockCount(const Phase& phase) const {
        if (IsOverBodies(phase.verb))
            return (group_.bodiesEnd - group_.bodiesBegin + kBodiesPerBlock - 1) / kBodiesPerBlock;
        if (IsSerial(phase.verb) || phase.color == group_.colorsEnd - group_.colorsBegin) return 1;
        return (layout_.colors[group_.colorsBegin + phase.color].Count() + kBatchesPerBlock - 1) / kBatchesPerBlock;
    }

    void RunBlock(const Phase& phase, uint32_t block, WorkerFindings& findings) {
        if (IsOverBodies(phase.verb)) {
            const uint32_t begin = group_.bodiesBegin + block * kBodiesPerBlock;
            const uint32_t count = std::min(kBodiesPerBlock, group_.bodiesEnd - begin);
            RunBodies(phase.verb, phase.substep, std::span(layout_.bodies).subspan(begin, count), findings);
        } else if (IsSkipped(phase.verb, phase.substep)) {
            return;
        } else if (IsSerial(phase.verb)) {
            RunIterated(phase.verb, phase.substep);
        } else if (phase.color == group_.colorsEnd - group_.colorsBegin) {
            ForEachOverflowList(layout_, [&](auto& batches) {
                for (auto& batch : batches) RunBatch(phase.verb, phase.substep, batch, findings);
            });
        } else {
            const ColorBatches& color = layout_.colors[group_.colorsBegin + phase.color];
            RunBatches(phase, color, block * kBatchesPerBlock, std::min((block + 1) * kBatchesPerBlock, color.Count()),
                       findings);
        }
    }

    void RunBodies(Verb verb, uint8_t substep, std::span<const uint32_t> bodies, WorkerFindings& findings) {
        if (verb == Verb::IntegratePoses) {
            IntegratePoses(moved_, bodies, h_, substep + 1 == effort_.solver.substeps, pseudo_, findings);
            if (!pushes_.empty()) NoteMoved(bodies_, bodies, pseudo_, pushes_);
        } else if (verb == Verb::IntegrateVelocities) {
            if (!pushes_.empty() && substep > 0) NotePushes(bodies_, bodies, h_, pushes_);
            IntegrateVelocities(bodies_, moved_.joints, bodies, h_, substep > 0, findings);
        } else {
            for (const uint32_t body : bodies) pseudo_[body] = {};
        }
    }

    // Runs the trees of a group, before its batches.
    void RunTrees(Verb verb, uint8_t substep) {
        JointBatch<kLanes>* batches = layout_.joints.batches.data();
        BodyState* states = bodies_.states.data();
        const std::span<JointBatch<kLanes>> own = JointBatchesOf(group_);
        const auto forTrees = [&](auto&& run) {
            for (uint32_t t = group_.treesBegin; t < group_.treesEnd; ++t)
                run(layout_.trees.At(layout_.trees.trees[layout_.treesByGroup[t]]));
        };
        const auto factorize = [&] {
            forTrees([&](const JointTree& tree) { FactorizeTree(tree, batches, bodies_.masses.data()); });
        };
        const auto solve = [&](bool relax) {
            forTrees([&](const JointTree& tree) { SolveTree(tree, batches, states, relax); });
        };
        switch (verb) {
            case Verb::WarmStart: factorize(); break;
            case Verb::FirstVelocities:
                if (substep > 0)
                    for (JointBatch<kLanes>& batch : own) RotateJointImpulses(batch, states);
                solve(false);
                break;
            case Verb::Velocities:
            case Verb::Impacts: solve(false); break;
            case Verb::FirstRelax:
            case Verb::Separations: {
                JointSolveSettings settings = effort_.joints;
                settings.elapsed = h_ * static_cast<float>(substep + 1);
                settings.firstPass = true;
                for (JointBatch<kLanes>& batch : own) UpdateJoints(batch, bodies_.ForSolver(), settings);
                factorize();
                if (verb == Verb::FirstRelax) solve(true);
                break;
            }
            case Verb::Relax: solve(true); break;
            case Verb::IntegrateVelocities:
            case Verb::IterateVelocities:
            case Verb::IterateRelax:
            case Verb::LimitDepths:
            case Verb::LimitEnergy:
            case Verb::NoteImpulses:
            case Verb::ClearPulls:
            case Verb::FirstPull:
            case Verb::Pull:
            case Verb::StopPulls:
            case Verb::IntegratePoses:
            case Verb::FirstCorrection:
            case Verb::Correction:
            case Verb::StoreOutdated:
            case Verb::Recollide:
            case Verb::Refill:
            case Verb::NextSubstep: break;
        }
    }

    // The batches of a group's colors are contiguous.
    std::span<JointBatch<kLanes>> JointBatchesOf(const SolverGroup& group) const {
        if (group.colorsBegin == group.colorsEnd) return {};
        const uint32_t begin = layout_.colors[group.colorsBegin].of[kJoints].begin,
                       end = layout_.colors[group.colorsEnd - 1].of[kJoints].end;
        return std::span(layout_.joints.batches).subspan(begin, end - begin);
    }

    Reads ReadsOf(Verb verb) const {
        if (IsOfRecollision(verb)) return Reads::Little;
        const bool isWithoutFriction =
            verb == Verb::Velocities || (verb == Verb::FirstVelocities && effort_.impactIterations == 0);
        return isWithoutFriction && effort_.contacts.relaxes ? Reads::NormalRows : Reads::All;
    }

    // Runs batches [begin, end) of a color, kind after kind.
    void RunBatches(const Phase& phase, const ColorBatches& color, uint32_t begin, uint32_t end,
                    WorkerFindings& findings) {
        uint32_t first = 0;  // index of the kind's first batch within the color
        const Reads reads = ReadsOf(phase.verb);
        ForEachBatchList(layout_, [&](auto& list, BatchKind kind) {
            const BatchRange& range = color.of[kind];
            const uint32_t last = first + range.Count();
            for (uint32_t i = std::max(begin, first); i < std::min(end, last); ++i) {
                const uint32_t batch = range.begin + i - first;
                if (i + 1 < last) Prefetch(list.batches[batch + 1], reads);
                RunBatch(phase.verb, phase.substep, list.batches[batch], findings);
            }
            first = last;
        });
    }

    // Additional iterations over single contacts.
    void RunIterated(Verb verb, uint8_t substep) {
        if (verb == Verb::LimitDepths) return local_.LimitDepths(bodies_.states.data(), ContactSettingsAt(substep, 1));
        const bool relax = verb == Verb::IterateRelax;
        ContactSolveSettings settings = ContactSettingsAt(substep, relax ? 1 : 0.5f);
        // Friction, too: what many iterations push would slip away.
        settings.relaxes = false;
        local_.Run(bodies_.states.data(), settings, substep, relax);
    }

    template <int N, bool kFixedB>
    void RunBatch(Verb verb, uint8_t substep, ContactBatch<N, kFixedB>& batch, WorkerFindings& findings) {
        BodyState* states = bodies_.states.data();
        switch (verb) {
            case Verb::WarmStart: WarmStartContacts(batch, states); break;
            // Poses are integrated with these velocities over the whole substep: they approximate those at its middle.
            case Verb::FirstVelocities:
            case Verb::Velocities:
            case Verb::Impacts:
                SolveContactVelocities(batch, states, VelocitySettingsAt(verb, substep));
                local_.Check(batch, substep);
                break;
            case Verb::FirstPull:
            case Verb::Pull:
            case Verb::StopPulls: PullContacts(batch, pseudo_, effort_.contacts); break;
            case Verb::FirstRelax:
            case Verb::Relax:
                RelaxContacts(batch, states, ContactSettingsAt(substep, 1));
                NoteOutdated(batch, substep);
                local_.CheckDepths(batch, substep);
                break;
            case Verb::FirstCorrection:
            case Verb::Correction: CorrectContacts(batch, states, ContactSettingsAt(substep, 1)); break;
            case Verb::Separations:
                UpdateSeparations(batch, states, ContactSettingsAt(substep, 1));
                NoteOutdated(batch, substep);
                local_.CheckDepths(batch, substep);
                break;
            case Verb::StoreOutdated:
                if (MayBeFoundAgain(batch)) StoreContacts(batch, stores_.pairs.records.data());
                break;
            case Verb::Recollide: {
                const uint32_t outdated = batch.rotated | batch.slid;
                if (outdated == 0) break;
                const CollideStores stores = StoresAt(substep);
                for (int lane = 0; lane < batch.count; ++lane)
                    if (outdated >> lane & 1u)
                        RecollidePair(stores, batch.contact[lane], batch.rotated >> lane & 1u, h_, findings);
                break;
            }
            case Verb::Refill: {
                if (!MayBeFoundAgain(batch)) break;
                RefillContacts(StoresAt(substep),
                               {.impulseScale = 1,
                                .restitutionSpeed = effort_.contacts.restitutionSpeed,
                                .dt = stores_.step.dt,
                                .massOverrides = stores_.pairs.massOverrides.data(),
                                .surfaceVelocities = stores_.pairs.surfaceVelocities.data()},
                               bodies_, batch);
                break;
            }
            case Verb::NoteImpulses:
                if (batch.hasNotes) AddRowImpulses(batch, notes_);
                break;
            case Verb::IntegrateVelocities:
            case Verb::IterateVelocities:
            case Verb::IterateRelax:
            case Verb::LimitDepths:
            case Verb::LimitEnergy:
            case Verb::ClearPulls:
            case Verb::IntegratePoses:
            case Verb::NextSubstep: break;
        }
    }

    // For joints, ball joints or others.
    template <class Batch>
    void RunBatch(Verb verb, uint8_t substep, Batch& batch, WorkerFindings&) {
        BodyState* states = bodies_.states.data();
        const JointSolveSettings settings = JointSettingsAt(verb, substep);
        switch (verb) {
            case Verb::WarmStart: WarmStartJoints(batch, states); break;
            case Verb::FirstVelocities:
            case Verb::Velocities:
            case Verb::Impacts: SolveJointVelocities(batch, states, settings); break;
            case Verb::FirstPull:
            case Verb::Pull: PullJoints(batch, pseudo_, settings); break;
            case Verb::FirstRelax:
            case Verb::Relax: RelaxJoints(batch, bodies_.ForSolver(), settings); break;
            case Verb::FirstCorrection:
            case Verb::Correction: CorrectJoints(batch, bodies_.ForSolver(), settings); break;
            case Verb::Separations: UpdateJoints(batch, bodies_.ForSolver(), settings); break;
            case Verb::IntegrateVelocities:
            case Verb::IterateVelocities:
            case Verb::IterateRelax:
            case Verb::LimitDepths:
            case Verb::LimitEnergy:
            case Verb::NoteImpulses:
            case Verb::ClearPulls:
            case Verb::StopPulls:
            case Verb::IntegratePoses:
            case Verb::StoreOutdated:
            case Verb::Recollide:
            case Verb::Refill:
            case Verb::NextSubstep: break;
        }
    }

    // Whether contacts of the batch may be found again. Surfaces, all of whose manifolds are if one is outdated, are
    // static or kinematic.
    template <int N, bool kFixedB>
    static bool MayBeFoundAgain(const ContactBatch<N, kFixedB>& batch) {
        return kFixedB || batch.rotated != 0;
    }
    template <class Batch>
    void NoteOutdated(const Batch& batch, uint8_t substep) {
        if ((batch.rotated | batch.slid) != 0) lastOutdated_.store(substep + 1, std::memory_order_relaxed);
    }
    // Whether no contact is outdated at the beginning of this substep, has a large velocity error in it, or is too
    // deep.
    bool IsSkipped(Verb verb, uint8_t substep) const {
        if (verb == Verb::LimitDepths) return !local_.IsAnyTooDeepIn(substep);
        if (IsSerial(verb)) return !local_.AreNeededIn(substep);
        return IsOfRecollision(verb) && lastOutdated_.load(std::memory_order_relaxed) != substep;
    }
    CollideStores StoresAt(uint8_t substep) const {
        CollideStores stores = stores_;
        stores.elapsed = h_ * static_cast<float>(substep);
        return stores;
    }

    JointSolveSettings JointSettingsAt(Verb verb, uint8_t substep) const {
        JointSolveSettings settings = effort_.joints;
        settings.elapsed = h_ * static_cast<float>(substep + 1);
        settings.continues = verb == Verb::FirstVelocities && substep > 0 && !effort_.hasTrees;
        settings.firstPass =
            verb == Verb::FirstPull || verb == Verb::FirstCorrection ||
            ((verb == Verb::FirstRelax || (verb == Verb::Separations && effort_.solver.positionIterations == 0)) &&
             !effort_.hasTrees);
        return settings;
    }

    ContactSolveSettings ContactSettingsAt(uint8_t substep, float part) const {
        ContactSolveSettings settings = effort_.contacts;
        settings.elapsed = h_ * (static_cast<float>(substep) + part);
        settings.unconstrained = bodies_.unconstrained.data()->row;
        settings.rare = &rare_;
        settings.notes = notes_;
        return settings;
    }

    ContactSolveSettings VelocitySettingsAt(Verb verb, uint8_t substep) const {
        ContactSolveSettings settings = ContactSettingsAt(substep, 0.5f);
        const bool isFirst = verb == Verb::FirstVelocities && effort_.impactIterations > 0;
        if (isFirst || verb == Verb::Impacts) settings.StopRecovery();
        return settings;
    }

    const CollideStores& stores_;  // of the start of the step
    const MovedBodies& moved_;
    BodyStore& bodies_;
    SolverLayout& layout_;
    const SolverGroup& group_;
    const Effort& effort_;
    BodyState* pseudo_;
    std::span<PushNote> pushes_;
    ContactNote* notes_;  // by record; null without contact events
    RareContactData rare_;
    float h_;                            // s, of a substep
    std::atomic<int> lastOutdated_ = 0;  // the substep, from 1, after which some contact was outdated last
    LocalIterations local_;
    std::optional<EnergyLimit> energyLimit_;  // if the group's loop has LimitEnergy
};

// Iterations over the pseudo-velocities per substep, for groups with joints that are far apart.
constexpr int kPullIterations = 4;
// Additional iterations over contacts only, so that non-penetration wins.
constexpr int kStopIterations = 2;

// Verbs that a group needs because of some of its joints.
struct JointVerbs {
    bool pulls = false;         // some are far apart
    bool limitsEnergy = false;  // some are pushed fast
    bool IsAny() const { return pulls || limitsEnergy; }
};

// The solver loop as the sequence of its verbs. notes: for contact events.
std::span<const Verb> LoopOf(const Effort& effort, const JointVerbs& joints, bool notes, ScratchArena& scratch) {
    const SolverSettings& settings = effort.solver;
    const size_t longest = static_cast<size_t>(settings.velocityIterations + settings.positionIterations +
                                               kPullIterations + kStopIterations + 16);
    std::span<Verb> verbs = scratch.Allocate<Verb>(longest * static_cast<size_t>(settings.substeps));
    size_t n = 0;
    for (int substep = 0; substep < settings.substeps; ++substep) {
        if (substep > 0)
            for (const Verb verb : {Verb::NextSubstep, Verb::StoreOutdated, Verb::Recollide, Verb::Refill})
                verbs[n++] = verb;
        verbs[n++] = Verb::IntegrateVelocities;
        if (substep == 0) verbs[n++] = Verb::WarmStart;
        for (int i = 0; i < settings.velocityIterations; ++i)
            verbs[n++] = i == 0                        ? Verb::FirstVelocities
                         : i < effort.impactIterations ? Verb::Impacts
                                                       : Verb::Velocities;
        verbs[n++] = Verb::IterateVelocities;
        if (joints.pulls) {
            verbs[n++] = Verb::ClearPulls;
            for (int i = 0; i < kPullIterations; ++i) verbs[n++] = i == 0 ? Verb::FirstPull : Verb::Pull;
            for (int i = 0; i < kStopIterations; ++i) verbs[n++] = Verb::StopPulls;
        }
        verbs[n++] = Verb::IntegratePoses;
        const bool corrects = settings.positionCorrection == PositionCorrection::Baumgarte;
        const Verb first = corrects ? Verb::FirstCorrection : Verb::FirstRelax,
                   next = corrects ? Verb::Correction : Verb::Relax;
        for (int i = 0; i < settings.positionIterations; ++i) verbs[n++] = i == 0 ? first : next;
        // The next substep needs current separations.
        if (corrects || settings.positionIterations == 0) verbs[n++] = Verb::Separations;
        else verbs[n++] = Verb::IterateRelax;
        verbs[n++] = Verb::LimitDepths;
        if (joints.limitsEnergy) verbs[n++] = Verb::LimitEnergy;
        if (notes) verbs[n++] = Verb::NoteImpulses;
    }
    return verbs.first(n);
}

// The same for a large group: a phase per color. Constraints without a color are solved with the first group.
std::span<const Phase> PhasesOf(std::span<const Verb> verbs, const SolverLayout& layout, const SolverGroup& group,
                                ScratchArena& scratch) {
    const bool overflows = &group == &layout.groups.front() && layout.OverflowCount() > 0;
    const size_t colors = group.colorsEnd - group.colorsBegin + (overflows ? 1u : 0u);
    if (group.bodiesBegin == group.bodiesEnd) return {};
    std::span<Phase> phases = scratch.Allocate<Phase>(verbs.size() * std::max<size_t>(colors, 1));
    size_t n = 0;
    uint8_t substep = 0;
    for (const Verb verb : verbs) {
        if (verb == Verb::NextSubstep) ++substep;
        else if (IsOverBodies(verb) || IsSerial(verb)) phases[n++] = {verb, substep, 0};
        else
            for (size_t c = 0; c < colors; ++c) phases[n++] = {verb, substep, static_cast<uint16_t>(c)};
    }
    return phases.first(n);
}

// Whether some joint of the group is far apart.
bool PullsJoints(const SolverLayout& layout, const SolverGroup& group) {
    bool far = false;
    const auto note = [&](const auto& batch) {
        if constexpr (requires { batch.far; }) far |= batch.far;
    };
    VisitBatches(layout, group, note);
    if (&group == &layout.groups.front())
        ForEachOverflowList(layout, [&](const auto& batches) {
            for (const auto& batch : batches) note(batch);
        });
    return far;
}

// Runs the verbs returned by loopOf(effort, JointVerbs) for every group. Of the step: some joints are far apart and are
// pulled, and some are pushed fast.
template <class LoopOfEffort>
void RunVerbs(const CollideStores& stores, const MovedBodies& moved, SolverLayout& layout, const JointVerbs& ofStep,
              std::span<PushNote> pushes, const StepWorkers& workers, LoopOfEffort&& loopOf) {
    const StepContext& step = stores.step;
    const std::span<const SolverGroup> groups = layout.groups;
    ScratchArena& scratch = workers.scratch;
    const size_t bodies = moved.store.states.size();
    const std::span<BodyState> pseudo = scratch.Allocate<BodyState>(ofStep.pulls ? bodies : 0);
    std::ranges::fill(pseudo, BodyState{});
    std::span<JointVerbs> verbsOf = scratch.Allocate<JointVerbs>(groups.size());
    bool limitsAny = false;
    for (size_t g = 0; g < groups.size(); ++g) {
        verbsOf[g] = {ofStep.pulls && PullsJoints(layout, groups[g]),
                      ofStep.limitsEnergy && PushesJoints(layout, groups[g])};
        limitsAny |= verbsOf[g].limitsEnergy;
    }
    const std::span<uint32_t> parents = scratch.Allocate<uint32_t>(limitsAny ? bodies : 0),
                              islandOf = scratch.Allocate<uint32_t>(limitsAny ? bodies : 0);
    std::span<std::span<IslandEnergy>> islands = scratch.Allocate<std::span<IslandEnergy>>(groups.size());
    std::span<std::span<uint32_t>> members = scratch.Allocate<std::span<uint32_t>>(groups.size());
    for (size_t g = 0; g < groups.size(); ++g) {
        const size_t count = verbsOf[g].limitsEnergy ? groups[g].bodiesEnd - groups[g].bodiesBegin : 0;
        islands[g] = scratch.Allocate<IslandEnergy>(count);
        members[g] = scratch.Allocate<uint32_t>(count);
    }
    const auto pseudoOf = [&](size_t g) { return verbsOf[g].pulls ? pseudo.data() : nullptr; };
    const std::span<const Verb> usual = loopOf(EffortOf(step, groups.front()), JointVerbs{});
    std::span<std::span<const Verb>> loops = scratch.Allocate<std::span<const Verb>>(groups.size());
    for (size_t g = 0; g < groups.size(); ++g)
        loops[g] = groups[g].IsOwn() || verbsOf[g].IsAny() ? loopOf(EffortOf(step, groups[g]), verbsOf[g]) : usual;
    const LocalMemory local(moved.store, layout, scratch);
    for (size_t g = 0; g < groups.size(); ++g) {
        if (!groups[g].isLarge) continue;
        const std::span<const Phase> phases = PhasesOf(loops[g], layout, groups[g], scratch);
        if (phases.empty()) continue;
        const Effort effort = EffortOf(step, groups[g]);
        StepSolver(stores, moved, layout, groups[g], effort, pseudoOf(g), pushes, local).RunTogether(phases, workers);
    }
    workers.jobs.ParallelFor(static_cast<uint32_t>(groups.size()), 1, [&](JobRange range) {
        for (uint32_t g = range.begin; g < range.end; ++g) {
            if (groups[g].isLarge) continue;
            const Effort effort = EffortOf(step, groups[g]);
            StepSolver solver(stores, moved, layout, groups[g], effort, pseudoOf(g), pushes, local);
            if (verbsOf[g].limitsEnergy) solver.LimitEnergyWith(parents, islandOf, members[g], islands[g]);
            solver.RunAlone(loops[g], workers.findings[range.worker]);
        }
    });
}

}  // namespace

void Solve(const StepContext& step, const ColliderStore& colliders, PairStore& pairs, const JointStore& joints,
           const ConstraintColoring& coloring, BodyStore& bodies, SolverLayout& layout, std::span<PushNote> pushes,
           const StepWorkers& workers) {
    if (coloring.Size() == 0) return;
    JointVerbs ofStep;
    for (const WorkerFindings& findings : workers.findings) {
        ofStep.pulls |= findings.joints.far;
        ofStep.limitsEnergy |= findings.joints.pushed;
    }
    RunVerbs({step, bodies, colliders, joints, coloring, pairs}, {step.settings, colliders, pairs, joints, bodies},
             layout, ofStep, pushes, workers, [&](const Effort& effort, const JointVerbs& verbs) {
                 return LoopOf(effort, verbs, !layout.notes.empty(), workers.scratch);
             });
    if (pushes.empty()) return;
    for (const SolverGroup& group : layout.groups)
        NotePushes(bodies, std::span(layout.bodies).subspan(group.bodiesBegin, group.bodiesEnd - group.bodiesBegin),
                   EffortOf(step, group).substepDt, pushes);
}

}  // namespace fulcrum
