// Fills the rows of all batches.
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/PrefetchLines.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

template <int N, bool kFixedB>
void NoteDeepest(const PairStore& pairs, const ContactBatch<N, kFixedB>& batch, WorkerFindings& findings) {
    Wide<N> lowest(0.0f);
    for (int i = 0; i < batch.pointCount; ++i) lowest = Min(lowest, batch.rows[i].startSeparation);
    if (!(lowest <= Wide<N>(-findings.deepest)).Any()) return;
    for (int lane = 0; lane < batch.count; ++lane) {
        const float depth = -lowest[lane];
        if (depth < findings.deepest) continue;
        const uint32_t pair = pairs.contacts[batch.contact[lane]].pair;
        if (depth == findings.deepest && pair >= findings.deepestPair) continue;
        findings.deepest = depth;
        findings.deepestPair = pair;
    }
}

// Prefetches records and masses of the next contacts.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void Prefetch(const BodyStore& bodies, const PairStore& pairs,
                                   const ContactBatch<N, kFixedB>& batch) {
    for (int lane = 0; lane < batch.count; ++lane) {
        PrefetchLines(&pairs.records[batch.contact[lane]], sizeof(ContactRecord));
        for (uint32_t body : {batch.bodyA[lane], batch.bodyB[lane]}) {
            __builtin_prefetch(&bodies.poses[body]);
            __builtin_prefetch(&bodies.masses[body]);
        }
    }
}

// Discards the contacts of these lanes, whose numbers are not finite: the next step finds them anew.
template <int N, bool kFixedB>
[[gnu::cold]] void ForgetContacts(PairStore& pairs, const ContactBatch<N, kFixedB>& batch, uint32_t lanes) {
    for (int lane = 0; lane < batch.count; ++lane)
        if (lanes >> lane & 1u) {
            pairs.pairs[pairs.contacts[batch.contact[lane]].pair].pointCount = 0;
            pairs.records[batch.contact[lane]].pointCount = 0;
        }
}

// For bodies created inside each other: limits the recovery speed and disables the warm start, because their velocities
// are clamped to that speed.
template <int N, bool kFixedB>
[[gnu::cold]] void LimitPushes(const BodyStore& bodies, ContactBatch<N, kFixedB>& batch) {
    for (int lane = 0; lane < N; ++lane) {
        const auto isCrowded = [&](uint32_t body) {
            const BodyDynamics& d = bodies.dynamics[body];
            return d.crowded && !d.dispersing;
        };
        if (!isCrowded(batch.bodyA[lane]) && !isCrowded(batch.bodyB[lane])) continue;
        batch.gentle = static_cast<uint16_t>(batch.gentle | 1u << lane);
        batch.inverseSoftDepth.Set(lane, 0.0f);  // at any depth
    }
}

// Inputs of contact preparation. Pairs whose numbers are not finite lose their points.
struct ContactSource {
    const BodyStore& bodies;
    PairStore& pairs;
    ContactPrepareSettings settings;
    bool hasCrowds;      // some bodies are crowded
    ContactNote* notes;  // null without contact events
};

template <int N, bool kFixedB>
void Fill(const ContactSource& from, ContactBatch<N, kFixedB>& batch, WorkerFindings& findings) {
    const uint32_t unusable =
        PrepareContacts<N, kFixedB>(batch, from.pairs.records.data(), from.bodies.ForSolver(), from.settings);
    if (unusable != 0) ForgetContacts(from.pairs, batch, unusable);
    if (from.hasCrowds) [[unlikely]]
        LimitPushes(from.bodies, batch);
    NoteDeepest(from.pairs, batch, findings);
    if (batch.isGuided) [[unlikely]]
        LimitGuidedPushes(batch);
    batch.hasNotes = false;
    if (!from.notes) return;
    for (int lane = 0; lane < batch.count; ++lane)
        batch.hasNotes |= AreReported(from.bodies.reportsContacts, batch.bodyA[lane], batch.bodyB[lane]);
    if (batch.hasNotes) BeginNotes(batch, from.bodies.ForSolver(), from.notes);
}

// Batches per job for the large group, whose colors are split into several jobs.
constexpr uint32_t kPiece = 16;
BatchRange PieceOf(const BatchRange& range, uint32_t piece) {
    const uint32_t skipped = std::min(piece * kPiece, range.Count());
    BatchRange part;
    part.begin = range.begin + skipped;
    part.end = std::min(part.begin + kPiece, range.end);
    return part;
}

void FindDeepest(const BodyStore& bodies, const PairStore& pairs, std::span<const WorkerFindings> workers,
                 StepReport& report) {
    uint32_t pair = ~0u;
    for (const WorkerFindings& findings : workers) {
        const float depth = findings.deepest, worst = report.largestPenetration;
        if (depth < worst || (depth == worst && findings.deepestPair >= pair)) continue;
        report.largestPenetration = depth;
        pair = findings.deepestPair;
    }
    if (pair == ~0u) return;
    report.deepestA = bodies.IdOf(pairs.pairs[pair].bodyA);
    report.deepestB = bodies.IdOf(pairs.pairs[pair].bodyB);
}

class RowFiller {
public:
    RowFiller(const StepContext& step, const BodyStore& bodies, const CrowdState& crowd, const Effort& effort,
              PairStore& pairs, JointStore& joints, SolverLayout& layout)
        : contacts_{bodies,
                    pairs,
                    {.impulseScale = step.contactImpulseScale * effort.impulseScale,
                     .restitutionSpeed = step.settings.restitutionSpeed,
                     .dt = step.dt,
                     .massOverrides = pairs.massOverrides.data(),
                     .surfaceVelocities = pairs.surfaceVelocities.data()},
                    !crowd.crowded.empty(),
                    layout.notes.empty() ? nullptr : layout.notes.data()},
          joints_(joints),
          jointSettings_(effort.joints),
          layout_(layout) {}
    void FillGroup(const SolverGroup& group, WorkerFindings& findings) const {
        for (uint32_t c = group.colorsBegin; c < group.colorsEnd; ++c)
            ForEachBatchList(
                layout_, [&](auto& list, BatchKind kind) { FillBatches(list, layout_.colors[c].of[kind], findings); });
    }
    void FillPiece(const ColorBatches& color, uint32_t piece, WorkerFindings& findings) const {
        ForEachBatchList(
            layout_, [&](auto& list, BatchKind kind) { FillBatches(list, PieceOf(color.of[kind], piece), findings); });
    }
    void FillOverflow(WorkerFindings& findings) const {
        ForEachOverflowList(layout_, [&](auto& batches) {
            for (auto& batch : batches) FillRows(batch, findings);
        });
    }

private:
    template <int N, bool kFixedB>
    void FillBatches(BatchList<ContactBatch<N, kFixedB>>& list, const BatchRange& range,
                     WorkerFindings& findings) const {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            if (i + 1 < range.end) Prefetch(contacts_.bodies, contacts_.pairs, list.batches[i + 1]);
            FillRows(list.batches[i], findings);
        }
    }
    template <class Batch>
    void FillBatches(BatchList<Batch>& list, const BatchRange& range, WorkerFindings& findings) const {
        for (uint32_t i = range.begin; i < range.end; ++i) FillRows(list.batches[i], findings);
    }
    template <int N, bool kFixedB>
    void FillRows(ContactBatch<N, kFixedB>& batch, WorkerFindings& findings) const {
        Fill(contacts_, batch, findings);
    }
    template <int N>
    void FillRows(JointBatch<N>& batch, WorkerFindings& findings) const {
        PrepareJoints(batch, joints_.records.data(), joints_.types.data(), contacts_.bodies.ForSolver(), jointSettings_,
                      findings.joints);
    }
    template <int N>
    void FillRows(BallBatch<N>& batch, WorkerFindings& findings) const {
        PrepareJoints(batch, joints_.records.data(), contacts_.bodies.ForSolver(), jointSettings_, findings.joints);
    }

    ContactSource contacts_;
    JointStore& joints_;
    JointSolveSettings jointSettings_;
    SolverLayout& layout_;
};

// Fills the rows of a large group on all workers.
void FillTogether(const RowFiller& filler, const SolverLayout& layout, const SolverGroup& group,
                  const StepWorkers& workers) {
    const auto piecesOf = [&](uint32_t c) {
        uint32_t most = 0;
        for (const BatchRange& range : layout.colors[c].of) most = std::max(most, range.Count());
        return (most + kPiece - 1) / kPiece;
    };
    uint32_t count = 0;
    for (uint32_t c = group.colorsBegin; c < group.colorsEnd; ++c) count += piecesOf(c);
    std::span<std::pair<uint32_t, uint32_t>> pieces = workers.scratch.Allocate<std::pair<uint32_t, uint32_t>>(count);
    count = 0;
    for (uint32_t c = group.colorsBegin; c < group.colorsEnd; ++c)
        for (uint32_t i = 0; i < piecesOf(c); ++i) pieces[count++] = {c, i};
    workers.jobs.ParallelFor(count, 1, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const auto [c, piece] = pieces[i];
            filler.FillPiece(layout.colors[c], piece, workers.findings[range.worker]);
        }
    });
}

}  // namespace

void Prepare(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
             const CrowdState& crowd, PairStore& pairs, JointStore& joints, SolverLayout& layout,
             const StepWorkers& workers, StepReport& report) {
    // Includes contacts that are not solved in this step, e.g. of frozen bodies.
    layout.notes.assign(step.settings.events.contacts ? pairs.contacts.size() : 0, {});
    if (coloring.Size() == 0) return;
    const auto fillerOf = [&](const SolverGroup& group) {
        return RowFiller(step, bodies, crowd, EffortOf(step, group), pairs, joints, layout);
    };
    for (const SolverGroup& group : layout.groups)
        if (group.isLarge) FillTogether(fillerOf(group), layout, group, workers);
    workers.jobs.ParallelFor(static_cast<uint32_t>(layout.groups.size()), 1, [&](JobRange range) {
        for (uint32_t g = range.begin; g < range.end; ++g) {
            const SolverGroup& group = layout.groups[g];
            if (!group.isLarge) fillerOf(group).FillGroup(group, workers.findings[range.worker]);
        }
    });
    fillerOf(layout.groups.front()).FillOverflow(workers.findings.front());

    FindDeepest(bodies, pairs, workers.findings, report);
    report.colors = layout.colorCount;
    report.overflowConstraints = layout.uncolored;
}

}  // namespace fulcrum
