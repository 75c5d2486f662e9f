#include <Fulcrum/Constraints/Direct/DirectPattern.h>

#include <algorithm>
#include <bit>

namespace fulcrum {

namespace {

// The smallest of the keys of all bodies, in a tree of pairwise comparisons.
class SmallestKey {
public:
    SmallestKey(uint32_t count, ScratchArena& scratch)
        : leaves_(std::bit_ceil(std::max(count, 1u))), keys_(scratch.Allocate<uint64_t>(2 * size_t{leaves_})) {
        std::fill(keys_.begin(), keys_.end(), kDone);
    }
    void Set(uint32_t body, uint32_t degree) { Set(body, uint64_t{degree} << 32 | body); }
    void Remove(uint32_t body) { Set(body, kDone); }
    uint32_t Body() const { return static_cast<uint32_t>(keys_[1]); }

private:
    static constexpr uint64_t kDone = ~uint64_t{0};

    void Set(uint32_t body, uint64_t key) {
        size_t i = leaves_ + size_t{body};
        keys_[i] = key;
        for (i /= 2; i > 0; i /= 2) keys_[i] = std::min(keys_[2 * i], keys_[2 * i + 1]);
    }

    uint32_t leaves_;
    std::span<uint64_t> keys_;  // node i has the children 2 i and 2 i + 1
};

// Neighbors of a body, ascending. Eliminated ones are removed when the list is merged.
struct NeighborList {
    uint32_t* items = nullptr;
    uint32_t count = 0, capacity = 0;
};

class Elimination {
public:
    Elimination(uint32_t bodies, std::span<const DirectEdge> edges, ScratchArena& scratch)
        : scratch_(scratch),
          lists_(scratch.Allocate<NeighborList>(bodies)),
          degrees_(scratch.Allocate<uint32_t>(bodies)),
          isDone_(scratch.Allocate<bool>(bodies)),
          smallest_(bodies, scratch) {
        std::fill(lists_.begin(), lists_.end(), NeighborList{});
        std::fill(isDone_.begin(), isDone_.end(), false);
        for (const DirectEdge& edge : edges) {
            ++lists_[edge.a].capacity;
            ++lists_[edge.b].capacity;
        }
        uint32_t* next = scratch.Allocate<uint32_t>(2 * edges.size()).data();
        for (NeighborList& list : lists_) {
            list.items = next;
            next += list.capacity;
        }
        const auto add = [](NeighborList& list, uint32_t body) { list.items[list.count++] = body; };
        for (const DirectEdge& edge : edges) {
            add(lists_[edge.a], edge.b);
            add(lists_[edge.b], edge.a);
        }
        for (uint32_t i = 0; i < bodies; ++i) {
            NeighborList& list = lists_[i];
            std::sort(list.items, list.items + list.count);
            list.count = static_cast<uint32_t>(std::unique(list.items, list.items + list.count) - list.items);
            SetDegree(i, list.count);
        }
        merged_ = scratch.Allocate<uint32_t>(bodies);
    }

    uint32_t Next() const { return smallest_.Body(); }

    // Returns the body's neighbors, which are connected to each other from now on.
    std::span<uint32_t> Eliminate(uint32_t body) {
        NeighborList& list = lists_[body];
        isDone_[body] = true;
        smallest_.Remove(body);
        list.count = static_cast<uint32_t>(
            std::remove_if(list.items, list.items + list.count, [&](uint32_t other) { return isDone_[other]; }) -
            list.items);
        const std::span<uint32_t> neighbors(list.items, list.count);
        if (neighbors.size() == 1) SetDegree(neighbors[0], degrees_[neighbors[0]] - 1);
        else
            for (const uint32_t neighbor : neighbors) Merge(neighbor, neighbors);
        return neighbors;
    }

private:
    void SetDegree(uint32_t body, uint32_t degree) {
        degrees_[body] = degree;
        smallest_.Set(body, degree);
    }

    void Merge(uint32_t body, std::span<const uint32_t> others) {
        NeighborList& list = lists_[body];
        uint32_t count = 0;
        auto other = others.begin();
        const auto addOthersBelow = [&](uint32_t end) {
            for (; other != others.end() && *other < end; ++other)
                if (*other != body) merged_[count++] = *other;
        };
        for (uint32_t i = 0; i < list.count; ++i) {
            const uint32_t own = list.items[i];
            if (isDone_[own]) continue;
            addOthersBelow(own);
            if (other != others.end() && *other == own) ++other;
            merged_[count++] = own;
        }
        addOthersBelow(~0u);
        if (count > list.capacity) {
            list.capacity = std::bit_ceil(count);
            list.items = scratch_.Allocate<uint32_t>(list.capacity).data();
        }
        std::copy_n(merged_.data(), count, list.items);
        list.count = count;
        SetDegree(body, count);
    }

    ScratchArena& scratch_;
    std::span<NeighborList> lists_;
    std::span<uint32_t> degrees_;  // neighbors that are not eliminated
    std::span<bool> isDone_;
    std::span<uint32_t> merged_;
    SmallestKey smallest_;
};

// Of the column of a body with so many neighbors: its factorization, its blocks, and their products with each other.
double FlopsOf(double neighbors) { return 72 + 216 * neighbors + 432 * (neighbors * (neighbors + 1) / 2); }

}  // namespace

uint32_t DirectPattern::BlockAt(uint32_t placeA, uint32_t placeB) const {
    const uint32_t column = std::min(placeA, placeB), row = std::max(placeA, placeB);
    const uint32_t *begin = RowOf() + Columns()[column], *end = RowOf() + Columns()[column + 1];
    const uint32_t* found = std::lower_bound(begin, end, row);
    return found != end && *found == row ? static_cast<uint32_t>(found - RowOf()) : kNone;
}

std::optional<DirectPattern> FindDirectPattern(uint32_t bodies, std::span<const DirectEdge> edges,
                                               ScratchArena& scratch, const DirectCost& mostPerBody) {
    Elimination elimination(bodies, edges, scratch);
    const DirectCost most{mostPerBody.flops * bodies, mostPerBody.blocks * bodies};
    DirectCost cost;
    std::span<std::span<uint32_t>> columns = scratch.Allocate<std::span<uint32_t>>(bodies);
    std::span<uint32_t> places = scratch.Allocate<uint32_t>(bodies);
    uint32_t blocks = 0;
    for (uint32_t place = 0; place < bodies; ++place) {
        const uint32_t body = elimination.Next();
        places[body] = place;
        columns[place] = elimination.Eliminate(body);
        const uint32_t neighbors = static_cast<uint32_t>(columns[place].size());
        blocks += neighbors;
        cost.flops += FlopsOf(neighbors);
        cost.blocks += 1 + neighbors;
        if (cost.flops > most.flops || cost.blocks > most.blocks) return {};
    }

    const std::span<uint32_t> words = scratch.Allocate<uint32_t>(DirectPattern::WordsOf(bodies, blocks));
    std::copy(places.begin(), places.end(), words.begin());
    uint32_t *columnBegin = words.data() + bodies, *rowBegin = columnBegin + bodies + 1, *rowOf = rowBegin + bodies + 1,
             *blockOf = rowOf + blocks, *columnOf = blockOf + blocks;
    std::fill_n(rowBegin, bodies + 1, 0u);
    uint32_t block = 0;
    for (uint32_t place = 0; place < bodies; ++place) {
        columnBegin[place] = block;
        for (uint32_t& neighbor : columns[place]) neighbor = places[neighbor];
        std::sort(columns[place].begin(), columns[place].end());
        for (const uint32_t row : columns[place]) {
            rowOf[block++] = row;
            ++rowBegin[row];
        }
    }
    columnBegin[bodies] = block;
    uint32_t items = 0;
    for (uint32_t place = 0; place <= bodies; ++place) {
        items += rowBegin[place];
        rowBegin[place] = items;  // the end, for now
    }
    for (uint32_t column = bodies; column-- > 0;)
        for (uint32_t i = columnBegin[column + 1]; i-- > columnBegin[column];) {
            const uint32_t item = --rowBegin[rowOf[i]];
            blockOf[item] = i;
            columnOf[item] = column;
        }
    return DirectPattern(bodies, blocks, cost, words);
}

}  // namespace fulcrum
