// Bodies are listed by index: a bit is set for each, and the bits are read in order.
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>
#include <bit>
#include <limits>

namespace fulcrum {

namespace {

ReportedBody ReportOf(const BodyStore& bodies, uint32_t body) {
    return {bodies.ExactCenterOf(body), bodies.RotationOf(body), bodies.cold[body].generation,
            bodies.dynamics[body].awake};
}

bool HasMoved(const ReportedBody& before, const ReportedBody& now) {
    const Quaternion &a = before.rotation, &b = now.rotation;
    return before.position != now.position || a.x != b.x || a.y != b.y || a.z != b.z || a.w != b.w;
}

void SetBit(Array<uint64_t>& words, uint32_t body) { words[body / 64] |= uint64_t{1} << body % 64; }

// Calls visit(body) for the bits of a word, ascending.
template <class Visit>
void VisitBits(uint64_t word, uint32_t firstBody, Visit&& visit) {
    for (; word != 0; word &= word - 1) visit(firstBody + static_cast<uint32_t>(std::countr_zero(word)));
}

void ListBits(const BodyStore& bodies, std::span<const uint64_t> words, Array<BodyId>& ids) {
    for (uint32_t w = 0; w < words.size(); ++w)
        VisitBits(words[w], 64 * w, [&](uint32_t body) { ids.push_back(bodies.IdOf(body)); });
}

// Lists the bodies that woke or fell asleep; all of them may have moved, and new awake bodies have.
void ListChanges(BodyStore& bodies, EventBuffers& buffers) {
    Array<uint32_t>& changes = bodies.sleepChanges;
    std::sort(changes.begin(), changes.end());
    changes.erase(std::unique(changes.begin(), changes.end()), changes.end());
    for (const uint32_t body : changes) {
        if (!bodies.cold[body].exists) continue;
        ReportedBody& reported = buffers.bodies[body];
        const ReportedBody now = ReportOf(bodies, body);
        if (reported.generation != now.generation) {
            reported = now;
            if (now.isAwake) reported.position.x() = std::numeric_limits<double>::quiet_NaN();
        } else if (reported.isAwake != now.isAwake) {
            (now.isAwake ? buffers.woke : buffers.fellAsleep).push_back(bodies.IdOf(body));
            reported.isAwake = now.isAwake;
        }
        SetBit(buffers.movedWords, body);
    }
}

}  // namespace

void BeginBodyEvents(const BodyStore& bodies, EventBuffers& buffers) {
    buffers.bodies.resize(bodies.Size());
    for (uint32_t body = 0; body < bodies.Size(); ++body)
        if (bodies.cold[body].exists) buffers.bodies[body] = ReportOf(bodies, body);
}

void ListBodyEvents(const StepContext& step, BodyStore& bodies, EventBuffers& buffers, const StepWorkers& workers) {
    if (step.settings.events.bodies) {
        buffers.bodies.resize(bodies.Size());
        const size_t wordCount = (bodies.Size() + 63) / 64;
        buffers.awakeWords.assign(wordCount, 0);
        for (const uint32_t body : bodies.awake) SetBit(buffers.awakeWords, body);
        buffers.movedWords = buffers.awakeWords;  // candidates
        ListChanges(bodies, buffers);
        workers.jobs.ParallelFor(static_cast<uint32_t>(wordCount), 4, [&](JobRange range) {
            for (uint32_t w = range.begin; w < range.end; ++w) {
                const uint64_t may = buffers.movedWords[w];
                buffers.movedWords[w] = 0;
                VisitBits(may, 64 * w, [&](uint32_t body) {
                    ReportedBody& reported = buffers.bodies[body];
                    const ReportedBody now = ReportOf(bodies, body);
                    if (!HasMoved(reported, now)) return;
                    SetBit(buffers.movedWords, body);
                    reported = now;
                });
            }
        });
        ListBits(bodies, buffers.awakeWords, buffers.awake);
        ListBits(bodies, buffers.movedWords, buffers.moved);
        buffers.events.awake = buffers.awake;
        buffers.events.moved = buffers.moved;
        buffers.events.woke = buffers.woke;
        buffers.events.fellAsleep = buffers.fellAsleep;
    }
    bodies.sleepChanges.clear();
}

}  // namespace fulcrum
