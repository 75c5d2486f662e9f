// Disjoint sets over indices. The root of a set is its smallest member, so the result does not depend on the order of
// the unions. Used by the stages Sleep and Solve and the island query.
#pragma once

#include <cstdint>
#include <numeric>
#include <span>

namespace fulcrum {

class UnionFind {
public:
    // `parents` has one entry per element, and is owned by the caller.
    explicit UnionFind(std::span<uint32_t> parents) : parents_(parents) {
        std::iota(parents_.begin(), parents_.end(), 0u);
    }
    // Only of these members.
    UnionFind(std::span<uint32_t> parents, std::span<const uint32_t> members) : parents_(parents) {
        for (const uint32_t i : members) parents_[i] = i;
    }
    uint32_t Find(uint32_t i) {
        while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    void Unite(uint32_t i, uint32_t j) {
        i = Find(i);
        j = Find(j);
        if (i < j) parents_[j] = i;
        else parents_[i] = j;
    }

private:
    std::span<uint32_t> parents_;
};

}  // namespace fulcrum
