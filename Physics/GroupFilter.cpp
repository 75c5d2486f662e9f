#include <Fulcrum/Physics/GroupFilter.h>

#include <Fulcrum/Math/Hash.h>

#include <algorithm>

namespace fulcrum {

Result<std::shared_ptr<const GroupFilterTable>> GroupFilterTable::Create(std::span<const Pair> apart) {
    std::shared_ptr<GroupFilterTable> table(new GroupFilterTable);
    for (size_t i = 0; i < apart.size(); ++i) {
        const uint32_t largest = std::max(apart[i].first, apart[i].second);
        if (largest >= kMaxSubGroups)
            return Error{ErrorCode::OutOfRange, "apart[" + std::to_string(i) + "] names subgroup " +
                                                    std::to_string(largest) + "; it must be from 0 to " +
                                                    std::to_string(kMaxSubGroups - 1)};
        table->subGroups_ = std::max(table->subGroups_, largest + 1);
    }
    const size_t n = table->subGroups_;
    table->apart_.assign(n * n, false);
    for (const Pair& pair : apart)
        table->apart_[pair.first * n + pair.second] = table->apart_[pair.second * n + pair.first] = true;
    return std::shared_ptr<const GroupFilterTable>(std::move(table));
}

Result<std::shared_ptr<const GroupFilterTable>> GroupFilterTable::Create(std::initializer_list<Pair> apart) {
    return Create(std::span<const Pair>(apart.begin(), apart.size()));
}

bool GroupFilterTable::Collides(const Member& a, const Member& b) const {
    if (a.group != b.group || std::max(a.subGroup, b.subGroup) >= subGroups_) return true;
    return !apart_[size_t(a.subGroup) * subGroups_ + b.subGroup];
}

std::vector<GroupFilterTable::Pair> GroupFilterTable::Pairs() const {
    std::vector<Pair> pairs;
    for (uint32_t first = 0; first < subGroups_; ++first)
        for (uint32_t second = first; second < subGroups_; ++second)
            if (apart_[size_t(first) * subGroups_ + second]) pairs.push_back({first, second});
    return pairs;
}

uint64_t GroupFilterTable::ContentHash() const {
    uint64_t hash = HashWord(kHashSeed, subGroups_);
    for (size_t i = 0; i < apart_.size(); ++i)
        if (apart_[i]) hash = HashWord(hash, i);
    return hash;
}

}  // namespace fulcrum
