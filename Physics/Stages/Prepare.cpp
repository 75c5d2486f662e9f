// Fills the rows of all batches.
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

using Entry = ContactColouring::Entry;

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

// Records and masses of the contacts that come next are on their way while these are worked on.
void Prefetch(const WorldState& world, std::span<const Entry> entries) {
    for (const Entry& entry : entries) {
        const char* record = reinterpret_cast<const char*>(&world.pairs.records[entry.contact]);
        for (size_t line = 0; line < sizeof(ContactRecord); line += 64) __builtin_prefetch(record + line);
        for (uint32_t body : {entry.bodyA, entry.bodyB}) {
            __builtin_prefetch(&world.bodies.poses[body]);
            __builtin_prefetch(&world.bodies.masses[body]);
        }
    }
}

// Fills the batch with at most N contacts; lanes beyond them repeat the last one and are never written.
template <int N, bool kFixedB>
void Fill(WorldState& world, ContactBatch<N, kFixedB>& batch, std::span<const Entry> entries,
          const ContactPrepareSettings& settings, WorkerFindings& findings) {
    batch.count = static_cast<int32_t>(entries.size());
    uint32_t bodyB[N];
    for (size_t lane = 0; lane < N; ++lane) {
        const Entry& entry = entries[lane < entries.size() ? lane : entries.size() - 1];
        batch.contact[lane] = entry.contact;
        batch.bodyA[lane] = entry.bodyA;
        bodyB[lane] = entry.bodyB;
    }
    PrepareContacts<N, kFixedB>(batch, world.pairs.records.data(), bodyB, world.bodies.ForSolver(), settings);
    findings.bounces |= batch.bounces;
    NoteDeepest(batch, findings);
}

template <class Batch>
void FillRange(WorldState& world, std::vector<Batch>& batches, const BatchRange& range,
               std::span<const Entry> contacts, const ContactPrepareSettings& settings, WorkerFindings& findings) {
    contacts = contacts.subspan(range.first, range.contacts);
    for (uint32_t i = range.begin; i < range.end; ++i) {
        const size_t n = std::min(contacts.size(), size_t(kLanes));
        const std::span<const Entry> now = contacts.first(n);
        contacts = contacts.subspan(n);
        Prefetch(world, contacts.first(std::min(contacts.size(), size_t(kLanes))));
        Fill(world, batches[i], now, settings, findings);
    }
}

// A part of a colour, for the large group, whose colours are cut into pieces of so many batches.
constexpr uint32_t kPiece = 16;
BatchRange Piece(const BatchRange& range, uint32_t piece) {
    const uint32_t skipped = std::min(piece * kPiece, range.Count());
    BatchRange part;
    part.begin = range.begin + skipped;
    part.end = std::min(part.begin + kPiece, range.end);
    part.first = range.first + std::min(skipped * kLanes, range.contacts);
    part.contacts = std::min(part.Count() * kLanes, range.contacts - std::min(skipped * kLanes, range.contacts));
    return part;
}

void FindDeepest(WorldState& world) {
    StepReport& report = world.report;
    uint32_t pair = ~0u;
    for (const WorkerFindings& findings : world.findings) {
        const float depth = findings.deepest, worst = report.largestPenetration;
        if (depth < worst || (depth == worst && findings.deepestPair >= pair)) continue;
        report.largestPenetration = depth;
        pair = findings.deepestPair;
    }
    if (pair == ~0u) return;
    report.deepestA = world.bodies.IdOf(world.pairs.pairs[pair].bodyA);
    report.deepestB = world.bodies.IdOf(world.pairs.pairs[pair].bodyB);
}

}  // namespace

// Impulses of a short step, scaled up to a long one, are mostly its noise: steps that alternate between 1/240 and 1/30 s
// threw a stack of six boxes over with no limit, and leave one of ten standing with this one.
constexpr float kMostScale = 2;

void Prepare(WorldState& world, const StepContext& step) {
    SolverLayout& layout = world.solver;
    world.bounces = false;
    if (world.colouring.Size() == 0) return;
    ContactPrepareSettings settings;
    settings.impulseScale = world.lastSubstepDt > 0 ? std::min(step.substepDt / world.lastSubstepDt, kMostScale) : 1.0f;
    settings.restitutionSpeed = world.settings.restitutionSpeed;

    const auto fill = [&](const BatchRange& moving, const BatchRange& fixed, WorkerFindings& findings) {
        FillRange(world, layout.moving, moving, layout.movingContacts, settings, findings);
        FillRange(world, layout.fixed, fixed, layout.fixedContacts, settings, findings);
    };
    const SolverGroup& large = layout.groups.front();
    const auto piecesOf = [&](uint32_t c) {
        const ColourBatches& colour = layout.colours[c];
        return (std::max(colour.moving.Count(), colour.fixed.Count()) + kPiece - 1) / kPiece;
    };
    uint32_t count = 0;
    for (uint32_t c = large.coloursBegin; c < large.coloursEnd; ++c) count += piecesOf(c);
    std::span<std::pair<uint32_t, uint32_t>> pieces = world.scratch.Allocate<std::pair<uint32_t, uint32_t>>(count);
    count = 0;
    for (uint32_t c = large.coloursBegin; c < large.coloursEnd; ++c)
        for (uint32_t i = 0; i < piecesOf(c); ++i) pieces[count++] = {c, i};
    world.jobs->ParallelFor(count, 1, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const auto [c, piece] = pieces[i];
            fill(Piece(layout.colours[c].moving, piece), Piece(layout.colours[c].fixed, piece), world.findings[range.worker]);
        }
    });
    world.jobs->ParallelFor(static_cast<uint32_t>(layout.groups.size()) - 1, 1, [&](JobRange range) {
        for (uint32_t g = range.begin + 1; g < range.end + 1; ++g)
            for (uint32_t c = layout.groups[g].coloursBegin; c < layout.groups[g].coloursEnd; ++c)
                fill(layout.colours[c].moving, layout.colours[c].fixed, world.findings[range.worker]);
    });
    const ContactColouring::Colour& overflow = world.colouring.At(ContactColouring::kOverflow);
    for (size_t i = 0; i < overflow.moving.size(); ++i)
        Fill(world, layout.overflowMoving[i], std::span(&overflow.moving[i], 1), settings, world.findings[0]);
    for (size_t i = 0; i < overflow.fixed.size(); ++i)
        Fill(world, layout.overflowFixed[i], std::span(&overflow.fixed[i], 1), settings, world.findings[0]);

    for (const WorkerFindings& findings : world.findings) world.bounces |= findings.bounces;
    FindDeepest(world);
    world.report.colours = layout.colourCount;
    world.report.overflowContacts = static_cast<uint32_t>(overflow.moving.size() + overflow.fixed.size());
}

}  // namespace fulcrum
