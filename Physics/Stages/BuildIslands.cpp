// Sorts the coloured contacts into groups of islands. Small islands are packed into groups that fit a worker's cache and
// are solved there whole; that saves them all barriers and most of the memory traffic. Done only in steps in which a
// contact began or ended. Serial; the islands follow from the contacts alone.
#include <Fulcrum/Physics/Islands/UnionFind.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

constexpr uint32_t kLargeIsland = 768;  // contacts: from here on all workers solve it together
constexpr uint32_t kSmallGroup = 192;   // contacts that a group of small islands has at least, about 60 KB of rows
constexpr uint32_t kColours = ContactColouring::kColours;
constexpr uint32_t kLargeGroup = 0;

using Entry = ContactColouring::Entry;

struct Islands {
    std::span<uint32_t> groupOf;  // by place in bodies.awake: the group, or kNone where no contact touches
    uint32_t groups = 0;
    uint32_t islands = 0;
    static constexpr uint32_t kNone = ~0u;
};

template <class Visit>
void VisitEntries(const WorldState& world, Visit&& visit) {
    for (uint32_t c = 0; c <= kColours; ++c) {
        const ContactColouring::Colour& colour = world.colouring.At(static_cast<int>(c));
        for (const Entry& entry : colour.moving) visit(c, false, entry);
        for (const Entry& entry : colour.fixed) visit(c, true, entry);
    }
}

Islands FindIslands(WorldState& world) {
    const auto placeOf = [&](uint32_t body) { return world.bodies.cold[body].awakePlace; };
    const size_t count = world.bodies.awake.size();
    UnionFind sets(world.scratch.Allocate<uint32_t>(count));
    std::span<uint32_t> contacts = world.scratch.Allocate<uint32_t>(count);
    std::fill(contacts.begin(), contacts.end(), 0u);
    for (uint32_t c = 0; c <= kColours; ++c)
        for (const Entry& entry : world.colouring.At(static_cast<int>(c)).moving)
            sets.Unite(placeOf(entry.bodyA), placeOf(entry.bodyB));
    // A body beyond all colours makes its island a large one.
    VisitEntries(world, [&](uint32_t c, bool, const Entry& entry) {
        contacts[sets.Find(placeOf(entry.bodyA))] += c == kColours ? kLargeIsland : 1;
    });

    Islands result;
    result.groupOf = world.scratch.Allocate<uint32_t>(count);
    result.groups = 1;
    uint32_t inGroup = kSmallGroup;  // so that the first small island opens a group
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t root = sets.Find(i);
        if (root != i) {
            result.groupOf[i] = result.groupOf[root];  // the root is the smallest, so it has its group
            continue;
        }
        result.groupOf[i] = Islands::kNone;
        if (contacts[i] == 0) continue;
        ++result.islands;
        if (contacts[i] >= kLargeIsland) {
            result.groupOf[i] = kLargeGroup;
            continue;
        }
        if (inGroup >= kSmallGroup) {
            ++result.groups;
            inGroup = 0;
        }
        result.groupOf[i] = result.groups - 1;
        inGroup += contacts[i];
    }
    return result;
}

// Turns counts into the index of the first of each, in order; returns the sum.
uint32_t FirstOfEach(std::span<uint32_t> counts) {
    uint32_t sum = 0;
    for (uint32_t& count : counts) {
        const uint32_t n = count;
        count = sum;
        sum += n;
    }
    return sum;
}

void SortBodies(WorldState& world, const Islands& islands) {
    SolverLayout& layout = world.solver;
    std::span<uint32_t> next = world.scratch.Allocate<uint32_t>(islands.groups);
    std::fill(next.begin(), next.end(), 0u);
    for (uint32_t group : islands.groupOf)
        if (group != Islands::kNone) ++next[group];
    layout.bodies.resize(FirstOfEach(next));
    for (uint32_t g = 0; g < islands.groups; ++g) layout.groups[g].bodiesBegin = next[g];
    for (size_t i = 0; i < islands.groupOf.size(); ++i)
        if (islands.groupOf[i] != Islands::kNone) layout.bodies[next[islands.groupOf[i]]++] = world.bodies.awake[i];
    for (uint32_t g = 0; g < islands.groups; ++g) layout.groups[g].bodiesEnd = next[g];
}

BatchRange MakeRange(uint32_t first, uint32_t contacts, uint32_t& batches) {
    BatchRange range{first, contacts, batches, 0};
    batches += (contacts + kLanes - 1) / kLanes;
    range.end = batches;
    return range;
}

template <class Batch>
void GrowTo(std::vector<Batch>& batches, uint32_t count) {
    if (batches.size() < count) batches.resize(count + count / 4);
}

void SortContacts(WorldState& world, const Islands& islands) {
    SolverLayout& layout = world.solver;
    const auto keyOf = [&](uint32_t colour, const Entry& entry) {
        return islands.groupOf[world.bodies.cold[entry.bodyA].awakePlace] * kColours + colour;
    };
    const size_t keys = size_t(islands.groups) * kColours;
    std::span<uint32_t> moving = world.scratch.Allocate<uint32_t>(keys), fixed = world.scratch.Allocate<uint32_t>(keys);
    std::fill(moving.begin(), moving.end(), 0u);
    std::fill(fixed.begin(), fixed.end(), 0u);
    VisitEntries(world, [&](uint32_t c, bool fixedB, const Entry& entry) {
        if (c < kColours) ++(fixedB ? fixed : moving)[keyOf(c, entry)];
    });
    layout.colours.clear();
    uint32_t movingFirst = 0, fixedFirst = 0;
    uint64_t used = 0;
    for (uint32_t g = 0; g < islands.groups; ++g) {
        layout.groups[g].coloursBegin = static_cast<uint32_t>(layout.colours.size());
        for (uint32_t c = 0; c < kColours; ++c) {
            const uint32_t m = moving[g * kColours + c], f = fixed[g * kColours + c];
            if (m + f == 0) continue;
            used |= uint64_t(1) << c;
            ColourBatches colour;
            colour.moving = MakeRange(movingFirst, m, layout.movingCount);
            colour.fixed = MakeRange(fixedFirst, f, layout.fixedCount);
            layout.colours.push_back(colour);
            movingFirst += m;
            fixedFirst += f;
        }
        layout.groups[g].coloursEnd = static_cast<uint32_t>(layout.colours.size());
    }
    layout.colourCount = static_cast<uint32_t>(std::popcount(used));
    layout.movingContacts.resize(FirstOfEach(moving));
    layout.fixedContacts.resize(FirstOfEach(fixed));
    VisitEntries(world, [&](uint32_t c, bool fixedB, const Entry& entry) {
        if (c == kColours) return;
        if (fixedB) layout.fixedContacts[fixed[keyOf(c, entry)]++] = entry;
        else layout.movingContacts[moving[keyOf(c, entry)]++] = entry;
    });
}

}  // namespace

void BuildIslands(WorldState& world) {
    SolverLayout& layout = world.solver;
    if (layout.version == world.colouring.Version()) return;
    layout.version = world.colouring.Version();
    layout.movingCount = layout.fixedCount = 0;
    const Islands islands = FindIslands(world);
    layout.islands = islands.islands;
    layout.groups.resize(islands.groups);
    SortBodies(world, islands);
    SortContacts(world, islands);
    GrowTo(layout.moving, layout.movingCount);
    GrowTo(layout.fixed, layout.fixedCount);
    const ContactColouring::Colour& overflow = world.colouring.At(ContactColouring::kOverflow);
    layout.overflowMoving.resize(overflow.moving.size());
    layout.overflowFixed.resize(overflow.fixed.size());
}

}  // namespace fulcrum
