// Lays the coloured contacts out as batches of lanes, colour after colour, and fills their rows.
#include <Fulcrum/Physics/Stages/Stages.h>

namespace fulcrum {

namespace {

uint32_t BatchCount(size_t contacts, int lanes) {
    return static_cast<uint32_t>((contacts + static_cast<size_t>(lanes) - 1) / static_cast<size_t>(lanes));
}

template <class Batch>
void GrowTo(std::vector<Batch>& batches, uint32_t count) {
    if (batches.size() < count) batches.resize(count + count / 4);
}

void LayOut(WorldState& world) {
    SolverGroup& group = world.group;
    group.colours.clear();
    group.movingCount = group.fixedCount = 0;
    for (int c = 0; c < ContactColouring::kColours; ++c) {
        const ContactColouring::Colour& colour = world.colouring.At(c);
        if (colour.Empty()) continue;
        SolverGroup::ColourRange range;
        range.colour = static_cast<uint32_t>(c);
        range.movingBegin = group.movingCount;
        range.movingEnd = group.movingCount += BatchCount(colour.moving.size(), kLanes);
        range.fixedBegin = group.fixedCount;
        range.fixedEnd = group.fixedCount += BatchCount(colour.fixed.size(), kLanes);
        group.colours.push_back(range);
    }
    GrowTo(group.moving, group.movingCount);
    GrowTo(group.fixed, group.fixedCount);
    const ContactColouring::Colour& overflow = world.colouring.At(ContactColouring::kOverflow);
    group.overflowMoving.resize(overflow.moving.size());
    group.overflowFixed.resize(overflow.fixed.size());
}

template <int N, bool kFixedB>
void NoteDeepest(const ContactBatch<N, kFixedB>& batch, WorkerFindings& findings) {
    Wide<N> lowest(0.0f);
    for (int i = 0; i < batch.pointCount; ++i) lowest = Min(lowest, batch.rows[i].startSeparation);
    if (!(lowest <= Wide<N>(-findings.deepest)).Any()) return;
    for (int lane = 0; lane < batch.count; ++lane) {
        const float depth = -lowest[lane];
        const uint32_t contact = batch.contact[lane];
        if (depth < findings.deepest || (depth == findings.deepest && contact >= findings.deepestPair)) continue;
        findings.deepest = depth;
        findings.deepestPair = contact;
    }
}

// Fills the batch with the contacts list[first ...]; lanes beyond the list repeat its last contact and are never written.
template <int N, bool kFixedB>
void Fill(WorldState& world, ContactBatch<N, kFixedB>& batch, const std::vector<uint32_t>& list, size_t first,
          const ContactPrepareSettings& settings, WorkerFindings& findings) {
    const size_t left = list.size() - first;
    batch.count = static_cast<int32_t>(left < N ? left : N);
    uint32_t bodyB[N];
    for (int lane = 0; lane < N; ++lane) {
        const int used = lane < batch.count ? lane : batch.count - 1;
        const uint32_t index = list[first + static_cast<size_t>(used)];
        const Pair& pair = world.pairs.pairs[index];
        batch.contact[lane] = index;
        batch.bodyA[lane] = pair.bodyA;
        bodyB[lane] = pair.bodyB;
    }
    PrepareContacts<N, kFixedB>(batch, world.pairs.records.data(), bodyB, world.bodies.ForSolver(), settings);
    findings.bounces |= batch.bounces;
    NoteDeepest(batch, findings);
}

}  // namespace

void Prepare(WorldState& world, const StepContext& step) {
    LayOut(world);
    SolverGroup& group = world.group;
    group.settings = world.settings.solver;
    ContactPrepareSettings settings;
    settings.impulseScale = world.lastSubstepDt > 0 ? step.substepDt / world.lastSubstepDt : 1.0f;
    settings.restitutionSpeed = world.settings.restitutionSpeed;

    for (const SolverGroup::ColourRange& range : group.colours) {
        const ContactColouring::Colour& colour = world.colouring.At(static_cast<int>(range.colour));
        const uint32_t moving = range.movingEnd - range.movingBegin, fixed = range.fixedEnd - range.fixedBegin;
        world.jobs->ParallelFor(moving + fixed, 8, [&](JobRange job) {
            WorkerFindings& findings = world.findings[job.worker];
            for (uint32_t i = job.begin; i < job.end; ++i) {
                if (i < moving) Fill(world, group.moving[range.movingBegin + i], colour.moving, size_t(i) * kLanes, settings, findings);
                else Fill(world, group.fixed[range.fixedBegin + i - moving], colour.fixed, size_t(i - moving) * kLanes, settings, findings);
            }
        });
    }
    const ContactColouring::Colour& overflow = world.colouring.At(ContactColouring::kOverflow);
    for (size_t i = 0; i < overflow.moving.size(); ++i)
        Fill(world, group.overflowMoving[i], overflow.moving, i, settings, world.findings[0]);
    for (size_t i = 0; i < overflow.fixed.size(); ++i)
        Fill(world, group.overflowFixed[i], overflow.fixed, i, settings, world.findings[0]);

    world.bounces = false;
    uint32_t deepestPair = ~0u;
    for (const WorkerFindings& findings : world.findings) {
        world.bounces |= findings.bounces;
        const float depth = findings.deepest, worst = world.report.largestPenetration;
        if (depth < worst || (depth == worst && findings.deepestPair >= deepestPair)) continue;
        world.report.largestPenetration = depth;
        deepestPair = findings.deepestPair;
    }
    if (deepestPair != ~0u) {
        world.report.deepestA = world.bodies.IdOf(world.pairs.pairs[deepestPair].bodyA);
        world.report.deepestB = world.bodies.IdOf(world.pairs.pairs[deepestPair].bodyB);
    }
    world.report.colours = static_cast<uint32_t>(group.colours.size());
    world.report.overflowContacts = static_cast<uint32_t>(overflow.moving.size() + overflow.fixed.size());
}

}  // namespace fulcrum
