#include <Fulcrum/Physics/Stages/LocalIterations.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace fulcrum {

namespace {

// Where masses are similar the usual iterations suffice.
constexpr float kLeastMassRatio = 2;
constexpr int kMostRounds = 256;
// Of the contacts of a cluster in a substep, before and after it moves each. Enough for the chains of contacts between
// a few bodies, little compared with the usual iterations of many.
constexpr uint32_t kMostIterations = 512;
// Chains of contacts under heavy bodies converge slowly without it.
constexpr float kOverRelaxation = 1.3f;

uint32_t OverflowingContacts(const SolverLayout& layout) {
    return static_cast<uint32_t>(layout.overflowMoving.size() + layout.overflowFixed.size());
}
uint32_t CountContacts(const SolverLayout& layout) {
    return (layout.moving.count + layout.fixed.count) * kLanes + OverflowingContacts(layout);
}

template <int N, bool kFixedB>
constexpr uint32_t WidthOf(std::span<ContactBatch<N, kFixedB>>) {
    return N;
}

// The index of the first true value from `begin` on; the size if there is none. Few of many are true.
uint32_t NextTrue(std::span<const bool> values, uint32_t begin) {
    const void* found = begin < values.size() ? std::memchr(&values[begin], 1, values.size() - begin) : nullptr;
    return static_cast<uint32_t>(found ? static_cast<const bool*>(found) - values.data() : values.size());
}

bool AreUneven(const BodyStore& bodies, uint32_t a, uint32_t b) {
    const float massA = bodies.masses[a].inverseMass, massB = bodies.masses[b].inverseMass;
    return std::max(massA, massB) >= kLeastMassRatio * std::min(massA, massB);
}

}  // namespace

LocalMemory::LocalMemory(const BodyStore& bodies, const SolverLayout& layout, ScratchArena& scratch) {
    if (CountContacts(layout) == 0) return;
    float least = std::numeric_limits<float>::infinity(), most = 0;
    for (const uint32_t body : layout.bodies) {
        least = std::min(least, bodies.masses[body].inverseMass);
        most = std::max(most, bodies.masses[body].inverseMass);
    }
    wrongIn = scratch.Allocate<uint8_t>(bodies.Size());
    contactsBegin = scratch.Allocate<uint32_t>(bodies.Size());
    contactsEnd = scratch.Allocate<uint32_t>(bodies.Size());
    contactsOfBodies = scratch.Allocate<uint32_t>(2 * CountContacts(layout));
    iterates = scratch.Allocate<bool>(CountContacts(layout));
    clusters = scratch.Allocate<uint32_t>(bodies.Size());
    iterations = scratch.Allocate<uint32_t>(bodies.Size());
    for (const uint32_t body : layout.bodies) wrongIn[body] = 0;
    if (most < kLeastMassRatio * least) return;
    isUneven = scratch.Allocate<bool>(bodies.Size());
    for (const uint32_t body : layout.bodies) isUneven[body] = false;
    const auto note = [&](const auto& batches) {
        for (const auto& batch : batches)
            for (int lane = 0; lane < batch.count; ++lane) {
                const uint32_t a = batch.bodyA[lane], b = batch.bodyB[lane];
                if (AreUneven(bodies, a, b)) isUneven[a] = isUneven[b] = true;
            }
    };
    note(std::span(layout.moving.batches).first(layout.moving.count));
    note(layout.overflowMoving);
}

LocalIterations::LocalIterations(const BodyStore& bodies, const JointStore& joints, SolverLayout& layout,
                                 const SolverGroup& group, const LocalMemory& memory)
    : bodies_(bodies), joints_(joints), layout_(layout), group_(group), memory_(memory) {}

template <int N, bool kFixedB>
void LocalIterations::MarkBodies(const ContactBatch<N, kFixedB>& batch, uint8_t substep) {
    if (memory_.isUneven.empty()) return;
    const uint16_t wrong = kFixedB ? batch.hits : batch.unsolved;
    for (int lane = 0; lane < batch.count; ++lane) {
        if (!(wrong >> lane & 1)) continue;
        const uint32_t a = batch.bodyA[lane], b = SecondBody(batch, lane);
        if (kFixedB ? !memory_.isUneven[a] : !AreUneven(bodies_, a, b)) continue;
        if (IsJointed(a, b)) continue;
        memory_.wrongIn[a] = memory_.wrongIn[b] = static_cast<uint8_t>(substep + 1);
        lastWrong_.store(substep + 1, std::memory_order_relaxed);
    }
}

// Of bodies without joints.
template <int N, bool kFixedB>
bool LocalIterations::IsTooDeep(const ContactBatch<N, kFixedB>& batch, int lane) const {
    return batch.deepened >> lane & 1 && !IsJointed(batch.bodyA[lane], SecondBody(batch, lane));
}

template <int N, bool kFixedB>
void LocalIterations::NoteDeepened(const ContactBatch<N, kFixedB>& batch, uint8_t substep) {
    for (int lane = 0; lane < batch.count; ++lane)
        if (IsTooDeep(batch, lane)) lastDeepened_.store(substep + 1, std::memory_order_relaxed);
}
#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                  \
    template void LocalIterations::MarkBodies(const ContactBatch<lanes, fixedB>&, uint8_t); \
    template void LocalIterations::NoteDeepened(const ContactBatch<lanes, fixedB>&, uint8_t);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

// Calls visit(batches, number of lanes, index of the first contact) for the batches of each color and kind, in the
// order of solving.
template <class Visit>
void LocalIterations::VisitRanges(Visit&& visit) {
    uint32_t first = OverflowingContacts(layout_);
    const auto visitRange = [&](auto& list, const BatchRange& range) {
        const uint32_t lanes = range.Count() * kLanes;
        visit(std::span(list.batches).subspan(range.begin, range.Count()), lanes, first);
        first += lanes;
    };
    if (group_.colorsBegin < group_.colorsEnd) {
        const ColorBatches& color = layout_.colors[group_.colorsBegin];
        first += (color.of[kMovingContacts].begin + color.of[kFixedContacts].begin) * kLanes;
    }
    for (uint32_t c = group_.colorsBegin; c < group_.colorsEnd; ++c) {
        visitRange(layout_.moving, layout_.colors[c].of[kMovingContacts]);
        visitRange(layout_.fixed, layout_.colors[c].of[kFixedContacts]);
    }
    if (&group_ != &layout_.groups.front()) return;
    first = 0;
    const auto visitOverflow = [&](auto& batches) {
        visit(std::span(batches), static_cast<uint32_t>(batches.size()), first);
        first += static_cast<uint32_t>(batches.size());
    };
    visitOverflow(layout_.overflowMoving);
    visitOverflow(layout_.overflowFixed);
}

void LocalIterations::ListContacts() {
    if (std::exchange(areListed_, true)) return;
    const auto visitContacts = [&](auto&& visit) {
        VisitRanges([&](auto batches, uint32_t count, uint32_t first) {
            for (uint32_t i = 0; i < count; ++i) {
                const auto& batch = batches[i / WidthOf(batches)];
                const int lane = static_cast<int>(i % WidthOf(batches));
                if (lane >= batch.count) continue;
                const uint32_t a = batch.bodyA[lane], b = SecondBody(batch, lane);
                if (!IsJointed(a, b)) visit(first + i, a, b);
            }
        });
    };
    const std::span<const uint32_t> bodies = Bodies();
    std::span<uint32_t> begin = memory_.contactsBegin, end = memory_.contactsEnd;
    for (const uint32_t body : bodies) end[body] = 0;
    uint32_t next = 2 * CountContacts(layout_);
    visitContacts([&](uint32_t contact, uint32_t a, uint32_t b) {
        next = std::min(next, 2 * contact);
        ++end[a];
        if (b != a) ++end[b];
    });
    for (const uint32_t body : bodies) {
        begin[body] = next;
        next += end[body];
        end[body] = begin[body];
    }
    VisitRanges([&](const auto&, uint32_t count, uint32_t first) {
        std::ranges::fill(memory_.iterates.subspan(first, count), false);
    });
    visitContacts([&](uint32_t contact, uint32_t a, uint32_t b) {
        memory_.contactsOfBodies[end[a]++] = contact;
        if (b != a) memory_.contactsOfBodies[end[b]++] = contact;
    });
}

std::span<const uint32_t> LocalIterations::ContactsOf(uint32_t body) const {
    return memory_.contactsOfBodies.subspan(memory_.contactsBegin[body],
                                            memory_.contactsEnd[body] - memory_.contactsBegin[body]);
}

// Returns the root of their set.
uint32_t LocalIterations::JoinClusters(UnionFind& clusters, uint32_t a, uint32_t b) {
    const uint32_t ofA = clusters.Find(a), ofB = clusters.Find(b);
    if (ofA == ofB) return ofA;
    clusters.Unite(ofA, ofB);
    const uint32_t root = clusters.Find(ofA);
    memory_.iterations[root] += memory_.iterations[root == ofA ? ofB : ofA];
    return root;
}

void LocalIterations::MarkContactsOf(uint32_t body) {
    for (const uint32_t contact : ContactsOf(body)) memory_.iterates[contact] = true;
}

// Calls iterate(batch, lane, body A, body B) for the marked contacts, in the order of solving, round after round. It
// marks others and returns whether it did.
template <class Iterate>
void LocalIterations::IterateMarked(Iterate&& iterate) {
    UnionFind clusters(memory_.clusters, Bodies());
    for (const uint32_t body : Bodies()) memory_.iterations[body] = 0;
    bool isAnyMarked = true;
    for (int round = 0; round < kMostRounds && isAnyMarked; ++round) {
        isAnyMarked = false;
        VisitRanges([&](auto batches, uint32_t count, uint32_t first) {
            const std::span<bool> iterates = memory_.iterates.subspan(first, count);
            for (uint32_t i = NextTrue(iterates, 0); i < count; i = NextTrue(iterates, i + 1)) {
                iterates[i] = false;
                auto& batch = batches[i / WidthOf(batches)];
                const int lane = static_cast<int>(i % WidthOf(batches));
                const uint32_t a = batch.bodyA[lane], b = SecondBody(batch, lane);
                uint32_t& iterations = memory_.iterations[JoinClusters(clusters, a, b)];
                if (iterations >= kMostIterations) continue;
                ++iterations;
                isAnyMarked |= iterate(batch, lane, a, b);
            }
        });
    }
    // What the last round left.
    if (isAnyMarked)
        VisitRanges([&](const auto&, uint32_t count, uint32_t first) {
            std::ranges::fill(memory_.iterates.subspan(first, count), false);
        });
}

void LocalIterations::Run(BodyState* states, const ContactSolveSettings& settings, uint8_t substep, bool relax) {
    ListContacts();
    const uint8_t mark = static_cast<uint8_t>(substep + 1);
    for (const uint32_t body : Bodies())
        if (memory_.wrongIn[body] == mark) MarkContactsOf(body);
    IterateMarked([&](auto& batch, int lane, uint32_t a, uint32_t b) {
        if (!IterateContact(batch, lane, kOverRelaxation, states, settings, relax)) return false;
        for (const uint32_t body : {a, b}) {
            memory_.wrongIn[body] = mark;
            MarkContactsOf(body);
        }
        return true;
    });
}

void LocalIterations::LimitDepths(BodyState* states, const ContactSolveSettings& settings) {
    ListContacts();
    VisitRanges([&](auto batches, uint32_t, uint32_t first) {
        for (const auto& batch : batches) {
            for (int lane = 0; batch.deepened >> lane != 0; ++lane)
                if (IsTooDeep(batch, lane)) memory_.iterates[first + static_cast<uint32_t>(lane)] = true;
            first += WidthOf(batches);
        }
    });
    IterateMarked([&](auto& batch, int lane, uint32_t a, uint32_t b) {
        if (!LimitDepth(batch, lane, states, settings)) return false;
        for (const uint32_t body : {a, b}) MarkContactsOf(body);
        return true;
    });
}

}  // namespace fulcrum
