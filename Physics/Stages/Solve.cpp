// The solver loop is a sequence of verbs. For groups of small islands one worker runs the whole sequence. For large
// islands it is a sequence of short parallel phases: one per color, iteration and substep, and two over the bodies per
// substep. Colors are solved in ascending order, then the constraints without a color, serially. Within a color joints
// come before contacts, so non-penetration wins.
//
// Only bodies with constraints take part; the others are moved by Store.
//
// In islands without joints the warm start of every substep but the first costs nothing per constraint: the impulses of
// the last substep change each body's velocity by the same amount again, which is the difference of its solved and
// unconstrained velocities. Rows of contacts are constant within a step. Those of joints are not, and iterations leave
// more of a mechanism unsolved: there the impulses of every substep are applied anew, scaled by island (WarmStart.h).
// So are those of contacts where substeps are short (Effort::startsAnew).
// Velocity iterations and relax iterations are the same for joints, whose errors position iterations correct.
#include <Fulcrum/Jobs/Phases.h>
#include <Fulcrum/Physics/Stages/DirectIsland.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/ErrorMeter.h>
#include <Fulcrum/Physics/Stages/Integrate.h>
#include <Fulcrum/Physics/Stages/LocalIterations.h>
#include <Fulcrum/Physics/Stages/PrefetchLines.h>
#include <Fulcrum/Physics/Stages/Recollide.h>
#include <Fulcrum/Physics/Stages/ScaleWarmStarts.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>
#include <atomic>

namespace fulcrum {

namespace {

constexpr uint32_t kBatchesPerBlock = 4;
constexpr uint32_t kBodiesPerBlock = 128;

enum class Verb : uint8_t {
    IntegrateVelocities,
    WarmStart,
    // In groups with joints instead, in every substep:
    AddWarmStart,
    ApplyWarmStart,  // serial
    ScaleImpulses,
    Gyroscopic,      // of the end of the last substep and of the start of this one (GyroscopicHalves)
    LastGyroscopic,  // of the end of the step
    FirstVelocities,
    Velocities,
    Impacts,  // velocity iterations in which contacts leave overlaps (Effort::impactIterations)
    // Serial, for contacts with large velocity errors, or overlaps that grow fast (LocalIterations.h):
    IterateVelocities,
    IterateRelax,
    LimitDepths,
    IntegratePoses,
    Relax,
    Correction,
    Separations,
    CorrectPoses,  // of groups with joints
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

bool IsGyroscopic(Verb verb) { return verb == Verb::Gyroscopic || verb == Verb::LastGyroscopic; }

bool IsOverBodies(Verb verb) {
    return verb == Verb::IntegrateVelocities || verb == Verb::IntegratePoses || IsGyroscopic(verb);
}

bool IsOfRecollision(Verb verb) {
    return verb == Verb::StoreOutdated || verb == Verb::Recollide || verb == Verb::Refill;
}

bool IsSerial(Verb verb) {
    return verb == Verb::ApplyWarmStart || verb == Verb::IterateVelocities || verb == Verb::IterateRelax ||
           verb == Verb::LimitDepths;
}

bool IsCorrection(Verb verb) { return verb == Verb::Correction || verb == Verb::CorrectPoses; }

// Passes over the velocities of joints.
bool SolvesJoints(Verb verb) {
    return verb == Verb::FirstVelocities || verb == Verb::Velocities || verb == Verb::Impacts || verb == Verb::Relax;
}

class StepSolver {
public:
    // starts: of all bodies; null if the group has no joints. islands: as many as the group has bodies, then. pushes:
    // by body; empty if not requested.
    StepSolver(const CollideStores& stores, const MovedBodies& moved, SolverLayout& layout, const SolverGroup& group,
               const Effort& effort, WarmStart* starts, std::span<IslandWarmStart> islands, std::span<PushNote> pushes,
               const LocalMemory& local)
        : stores_(stores),
          moved_(moved),
          bodies_(moved.store),
          layout_(layout),
          group_(group),
          effort_(effort),
          starts_(starts),
          islands_(islands),
          addsAtEnd_(!group.isDirect && (effort.solver.positionCorrection == PositionCorrection::SoftRelax ||
                                         effort.solver.positionIterations == 0)),
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

    // Of a group that is solved directly. scratch: of the worker that runs it.
    void SolveDirectlyWith(DirectIsland& island, ScratchArena& scratch) {
        direct_ = &island;
        directScratch_ = &scratch;
        maySolveContacts_ = group_.isLoaded && island.MaySolveContacts(stores_.pairs);
    }

    // A group of small islands: one worker, from beginning to end.
    void RunAlone(std::span<const Verb> verbs, WorkerFindings& findings) {
        uint8_t substep = 0;
        for (const Verb verb : verbs) {
            if (IsOverBodies(verb)) {
                RunBodies(verb, substep, layout_.BodiesOf(group_), findings);
                continue;
            }
            if (verb == Verb::NextSubstep) {
                ++substep;
                continue;
            }
            if (IsSkipped(verb, substep)) continue;
            if (IsSerial(verb)) {
                RunIterated(verb, substep);
                continue;
            }
            if (direct_) SolveDirectly(verb, substep);
            const bool corrects = isSolved_ && IsCorrection(verb);
            if (corrects) direct_->NotePlaces(ContactSettingsAt(substep, 1));
            for (uint32_t c = group_.colorsBegin; c < group_.colorsEnd; ++c)
                RunBatches({verb, substep, 0}, layout_.colors[c], 0, layout_.colors[c].Count(), findings);
            if (corrects) {
                directScratch_->Reset();
                direct_->CorrectPoses(ContactSettingsAt(substep, 1), *directScratch_);
                if (HasSolvedContacts()) NoteOutdatedOfGroup(substep);
            }
        }
        if (maySolveContacts_) findings.loadsChanged |= direct_->NoteMisses();
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
            const JointSolveSettings joints = JointSettingsAt(phase.substep);
            ForEachOverflowList(layout_, [&](auto& batches) {
                for (auto& batch : batches) RunBatch(phase.verb, phase.substep, joints, batch, findings);
            });
        } else {
            const ColorBatches& color = layout_.colors[group_.colorsBegin + phase.color];
            RunBatches(phase, color, block * kBatchesPerBlock, std::min((block + 1) * kBatchesPerBlock, color.Count()),
                       findings);
        }
    }

    void RunBodies(Verb verb, uint8_t substep, std::span<const uint32_t> bodies, WorkerFindings& findings) {
        if (verb == Verb::IntegratePoses) {
            IntegratePoses(moved_, bodies, h_, substep + 1 == effort_.solver.substeps, findings);
            if (!pushes_.empty()) NoteMoved(bodies_, bodies, pushes_);
            if (starts_ && addsAtEnd_) ClearStarts(bodies);
        } else if (verb == Verb::IntegrateVelocities) {
            if (!pushes_.empty() && substep > 0) NotePushes(bodies_, bodies, h_, pushes_);
            const SubstepStart start = substep == 0         ? SubstepStart::First
                                       : effort_.startsAnew ? SubstepStart::Anew
                                                            : SubstepStart::Carries;
            IntegrateVelocities(bodies_, moved_.joints, bodies, h_, start, findings);
            if (starts_ && (substep == 0 || !addsAtEnd_)) ClearStarts(bodies);
        } else if (IsGyroscopic(verb)) {
            const GyroscopicHalves halves = verb == Verb::LastGyroscopic ? GyroscopicHalves::Second
                                            : substep == 0               ? GyroscopicHalves::First
                                                                         : GyroscopicHalves::Both;
            AddGyroscopicTorque(bodies_, moved_.joints, bodies, h_, halves, starts_);
        }
    }

    void ClearStarts(std::span<const uint32_t> bodies) {
        for (const uint32_t body : bodies) starts_[body] = {};
    }

    // Before the batches of a group that is solved directly. The contacts once a substep, unless one bounces or that
    // takes too long; or the joints, before contacts are iterated: once a substep is enough without contacts.
    void SolveDirectly(Verb verb, uint8_t substep) {
        if (!SolvesJoints(verb)) return;
        const bool isFirst = verb == Verb::FirstVelocities;
        if (group_.isLoaded) {
            if (!isFirst) return;
            directScratch_->Reset();
            isSolved_ = maySolveContacts_ && direct_->SolveContacts(ContactSettingsAt(substep, 0.5f), *directScratch_);
            return;
        }
        const bool hasContacts = direct_->HasContacts();
        if (isSolved_ && !isFirst && !hasContacts) return;
        const auto solve = [&] {
            directScratch_->Reset();
            return direct_->SolveJoints(hasContacts ? DirectIsland::From::Current : DirectIsland::From::Unconstrained,
                                        *directScratch_);
        };
        isSolved_ = solve();
        if (!isSolved_ || !isFirst) return;
        // Joints have aimed by the velocities of the last substep: once more by those found.
        VisitBatches(layout_, group_, [&](auto& batch) {
            if constexpr (requires { batch.rowCount; })
                AimJoints(batch, bodies_.states.data(), JointSettingsAt(substep));
        });
        solve();
    }

    bool HasSolvedContacts() const { return isSolved_ && group_.isLoaded; }

    void NoteOutdatedOfGroup(uint8_t substep) {
        VisitBatches(layout_, group_, [&](const auto& batch) {
            if constexpr (requires { batch.frictionImpulse; }) NoteOutdated(batch, substep);
        });
    }

    // Adds the warm start to the velocities, scaled by island.
    void ApplyWarmStart() {
        const uint32_t* islandOf = layout_.islandOf.data() + group_.bodiesBegin;
        scales_ = ScaleWarmStarts(bodies_, layout_.BodiesOf(group_), islandOf, starts_, islands_);
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
        const JointSolveSettings joints = JointSettingsAt(phase.substep);
        ForEachBatchList(layout_, [&](auto& list, BatchKind kind) {
            const BatchRange& range = color.of[kind];
            const uint32_t last = first + range.Count();
            for (uint32_t i = std::max(begin, first); i < std::min(end, last); ++i) {
                const uint32_t batch = range.begin + i - first;
                if (i + 1 < last) Prefetch(list.batches[batch + 1], reads);
                RunBatch(phase.verb, phase.substep, joints, list.batches[batch], findings);
            }
            first = last;
        });
    }

    // Additional iterations over single contacts.
    void RunIterated(Verb verb, uint8_t substep) {
        if (verb == Verb::ApplyWarmStart) return ApplyWarmStart();
        if (verb == Verb::LimitDepths) return local_.LimitDepths(bodies_.states.data(), ContactSettingsAt(substep, 1));
        const bool relax = verb == Verb::IterateRelax;
        ContactSolveSettings settings = ContactSettingsAt(substep, relax ? 1 : 0.5f);
        // Friction, too: what many iterations push would slip away.
        settings.relaxes = false;
        local_.Run(bodies_.states.data(), settings, substep, relax);
    }

    template <int N, bool kFixedB>
    void RunBatch(Verb verb, uint8_t substep, const JointSolveSettings&, ContactBatch<N, kFixedB>& batch,
                  WorkerFindings& findings) {
        BodyState* states = bodies_.states.data();
        if (HasSolvedContacts() && (SolvesJoints(verb) || IsCorrection(verb))) return;
        switch (verb) {
            case Verb::WarmStart: WarmStartContacts(batch, states); break;
            case Verb::AddWarmStart: AddWarmStart(batch, starts_, ContactSettingsAt(substep, 0.5f)); break;
            case Verb::ScaleImpulses: ScaleImpulses(batch, starts_); break;
            // Poses are integrated with these velocities over the whole substep: they approximate those at its middle.
            case Verb::FirstVelocities:
            case Verb::Velocities:
            case Verb::Impacts:
                SolveContactVelocities(batch, states, VelocitySettingsAt(verb, substep));
                local_.Check(batch, substep);
                break;
            case Verb::Relax:
                RelaxContacts(batch, states, ContactSettingsAt(substep, 1));
                NoteOutdated(batch, substep);
                local_.CheckDepths(batch, substep);
                break;
            case Verb::Correction:
            case Verb::CorrectPoses: CorrectContacts(batch, states, ContactSettingsAt(substep, 1)); break;
            case Verb::Separations:
                UpdateSeparations(batch, states, ContactSettingsAt(substep, 1));
                NoteOutdated(batch, substep);
                if (!HasSolvedContacts()) local_.CheckDepths(batch, substep);
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
            default: break;
        }
    }

    // For joints, ball joints or others.
    template <class Batch>
    void RunBatch(Verb verb, uint8_t substep, const JointSolveSettings& settings, Batch& batch, WorkerFindings&) {
        BodyState* states = bodies_.states.data();
        switch (verb) {
            case Verb::AddWarmStart:
                if (substep == 0 || !addsAtEnd_) AddWarmStart(batch, states, starts_, settings);
                break;
            case Verb::ScaleImpulses: ScaleImpulses(batch, starts_); break;
            case Verb::FirstVelocities:
            case Verb::Velocities:
            case Verb::Impacts:
            case Verb::Relax:
                if (!isSolved_) SolveJointVelocities(batch, states, settings);
                break;
            case Verb::CorrectPoses:
                CorrectJoints(batch, bodies_.ForSolver(), NextStarts(substep), AtEnd(settings));
                break;
            case Verb::Correction: CorrectJoints(batch, bodies_.ForSolver(), nullptr, AtEnd(settings)); break;
            default: break;
        }
    }

    // At the end of a substep; the warm start of the next one, where joints add it then.
    static JointSolveSettings AtEnd(JointSolveSettings settings) {
        settings.continues = true;
        return settings;
    }
    WarmStart* NextStarts(uint8_t substep) const {
        return addsAtEnd_ && substep + 1 < effort_.solver.substeps ? starts_ : nullptr;
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
        if (verb == Verb::ApplyWarmStart) return false;
        if (verb == Verb::ScaleImpulses) return !scales_;
        if (verb == Verb::LimitDepths) return !local_.IsAnyTooDeepIn(substep);
        if (IsSerial(verb)) return !local_.AreNeededIn(substep);
        return IsOfRecollision(verb) && lastOutdated_.load(std::memory_order_relaxed) != substep;
    }
    CollideStores StoresAt(uint8_t substep) const {
        CollideStores stores = stores_;
        stores.elapsed = h_ * static_cast<float>(substep);
        return stores;
    }

    JointSolveSettings JointSettingsAt(uint8_t substep) const {
        JointSolveSettings settings = effort_.joints;
        settings.elapsed = h_ * static_cast<float>(substep + 1);
        settings.continues = substep > 0;
        settings.leavesLocks = isSolved_;
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
    WarmStart* starts_;
    std::span<IslandWarmStart> islands_;
    // Joints add the warm start of the next substep as their poses are corrected; not where trees correct more after
    // that.
    bool addsAtEnd_;
    bool scales_ = false;  // some warm start of this substep is scaled
    std::span<PushNote> pushes_;
    ContactNote* notes_;  // by record; null without contact events
    RareContactData rare_;
    float h_;                            // s, of a substep
    std::atomic<int> lastOutdated_ = 0;  // the substep, from 1, after which some contact was outdated last
    LocalIterations local_;
    DirectIsland* direct_ = nullptr;  // if the group is solved directly
    ScratchArena* directScratch_ = nullptr;
    bool maySolveContacts_ = false;  // then: in this step, see DirectIsland
    bool isSolved_ = false;  // directly, in the last pass: the contacts of an island under load, else the joints
};

// Verbs that a group needs because of its joints.
struct JointVerbs {
    bool any = false;         // it has joints
    bool gyroscopic = false;  // some jointed body of the step may feel gyroscopic torque
};

// The solver loop as the sequence of its verbs. notes: for contact events.
std::span<const Verb> LoopOf(const Effort& effort, const JointVerbs& joints, bool notes, ScratchArena& scratch) {
    const SolverSettings& settings = effort.solver;
    const size_t longest = static_cast<size_t>(settings.velocityIterations + 2 * settings.positionIterations + 22);
    std::span<Verb> verbs = scratch.Allocate<Verb>(longest * static_cast<size_t>(settings.substeps) + 1);
    size_t n = 0;
    for (int substep = 0; substep < settings.substeps; ++substep) {
        if (substep > 0)
            for (const Verb verb : {Verb::NextSubstep, Verb::StoreOutdated, Verb::Recollide, Verb::Refill})
                verbs[n++] = verb;
        verbs[n++] = Verb::IntegrateVelocities;
        if (joints.any) {
            verbs[n++] = Verb::AddWarmStart;
            if (joints.gyroscopic) verbs[n++] = Verb::Gyroscopic;
            verbs[n++] = Verb::ApplyWarmStart;
            verbs[n++] = Verb::ScaleImpulses;
        } else if (substep == 0 || effort.startsAnew) {
            verbs[n++] = Verb::WarmStart;
        }
        for (int i = 0; i < settings.velocityIterations; ++i)
            verbs[n++] = i == 0                        ? Verb::FirstVelocities
                         : i < effort.impactIterations ? Verb::Impacts
                                                       : Verb::Velocities;
        verbs[n++] = Verb::IterateVelocities;
        verbs[n++] = Verb::IntegratePoses;
        const bool corrects = settings.positionCorrection == PositionCorrection::Baumgarte;
        for (int i = 0; i < settings.positionIterations; ++i) {
            verbs[n++] = corrects ? Verb::Correction : Verb::Relax;
        }
        // The next substep needs current separations.
        if (corrects || settings.positionIterations == 0) verbs[n++] = Verb::Separations;
        else verbs[n++] = Verb::IterateRelax;
        verbs[n++] = Verb::LimitDepths;
        if (joints.any && (!corrects || settings.positionIterations == 0)) {
            verbs[n++] = Verb::CorrectPoses;
        }
        if (notes) verbs[n++] = Verb::NoteImpulses;
    }
    if (joints.gyroscopic) verbs[n++] = Verb::LastGyroscopic;
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

// Runs the verbs returned by loopOf(effort, JointVerbs) for every group. isGyroscopic: JointVerbs::gyroscopic.
template <class LoopOfEffort>
void RunVerbs(const CollideStores& stores, const MovedBodies& moved, SolverLayout& layout, bool isGyroscopic,
              std::span<PushNote> pushes, const StepWorkers& workers, LoopOfEffort&& loopOf) {
    const StepContext& step = stores.step;
    const std::span<const SolverGroup> groups = layout.groups;
    ScratchArena& scratch = workers.scratch;
    const size_t bodies = moved.store.states.size();
    const bool hasJoints = std::ranges::any_of(groups, &SolverGroup::hasJoints);
    const std::span<WarmStart> starts = scratch.Allocate<WarmStart>(hasJoints ? bodies : 0);
    const std::span<IslandWarmStart> islandStarts =
        scratch.Allocate<IslandWarmStart>(hasJoints ? layout.bodies.size() : 0);
    const auto solverOf = [&](size_t g, const Effort& effort, const LocalMemory& local) {
        const SolverGroup& group = groups[g];
        const uint32_t count = group.hasJoints ? group.bodiesEnd - group.bodiesBegin : 0;
        return StepSolver(stores, moved, layout, group, effort, group.hasJoints ? starts.data() : nullptr,
                          islandStarts.subspan(group.hasJoints ? group.bodiesBegin : 0, count), pushes, local);
    };
    // Most groups are one of two.
    const std::span<const Verb> usual[2] = {
        loopOf(EffortOf(step, {}), JointVerbs{}),
        loopOf(EffortOf(step, {.hasJoints = true}), JointVerbs{.any = true, .gyroscopic = isGyroscopic})};
    std::span<std::span<const Verb>> loops = scratch.Allocate<std::span<const Verb>>(groups.size());
    for (size_t g = 0; g < groups.size(); ++g) {
        const bool any = groups[g].hasJoints;
        loops[g] =
            groups[g].IsOwn() ? loopOf(EffortOf(step, groups[g]), JointVerbs{any, any && isGyroscopic}) : usual[any];
    }
    const LocalMemory local(moved.store, layout, scratch);
    // Memory of those that are solved directly.
    const auto isDirect = [](const SolverGroup& group) { return group.isDirect; };
    const std::span<uint32_t> localOf = scratch.Allocate<uint32_t>(std::ranges::any_of(groups, isDirect) ? bodies : 0);
    const std::span<DirectIsland*> direct = scratch.Allocate<DirectIsland*>(groups.size());
    for (size_t g = 0; g < groups.size(); ++g)
        if (groups[g].isDirect)
            direct[g] =
                std::construct_at(scratch.Allocate<DirectIsland>(1).data(), moved.store, layout, groups[g],
                                  EffortOf(step, groups[g]).substepDt, Length(step.settings.gravity), localOf, scratch);
    for (size_t g = 0; g < groups.size(); ++g) {
        if (!groups[g].isLarge) continue;
        const std::span<const Phase> phases = PhasesOf(loops[g], layout, groups[g], scratch);
        if (phases.empty()) continue;
        const Effort effort = EffortOf(step, groups[g]);
        solverOf(g, effort, local).RunTogether(phases, workers);
    }
    workers.jobs.ParallelFor(static_cast<uint32_t>(groups.size()), 1, [&](JobRange range) {
        for (uint32_t g = range.begin; g < range.end; ++g) {
            if (groups[g].isLarge) continue;
            const Effort effort = EffortOf(step, groups[g]);
            StepSolver solver = solverOf(g, effort, local);
            if (groups[g].isDirect) solver.SolveDirectlyWith(*direct[g], workers.ofWorkers[range.worker]);
            solver.RunAlone(loops[g], workers.findings[range.worker]);
        }
    });
}

}  // namespace

void Solve(const StepContext& step, const ColliderStore& colliders, PairStore& pairs, const JointStore& joints,
           const ConstraintColoring& coloring, BodyStore& bodies, SolverLayout& layout, std::span<PushNote> pushes,
           const StepWorkers& workers) {
    if (coloring.Size() == 0) return;
    bool isGyroscopic = false;
    for (const WorkerFindings& findings : workers.findings) isGyroscopic |= findings.joints.turning;
    RunVerbs({step, bodies, colliders, joints, coloring, pairs}, {step.settings, colliders, pairs, joints, bodies},
             layout, isGyroscopic, pushes, workers, [&](const Effort& effort, const JointVerbs& verbs) {
                 return LoopOf(effort, verbs, !layout.notes.empty(), workers.scratch);
             });
    if (pushes.empty()) return;
    for (const SolverGroup& group : layout.groups)
        NotePushes(bodies, layout.BodiesOf(group), EffortOf(step, group).substepDt, pushes);
}

}  // namespace fulcrum
