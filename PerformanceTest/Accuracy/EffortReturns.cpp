#include <Fulcrum/PerformanceTest/Accuracy/EffortReturns.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

// splitmix64: sums of such numbers are hashes of sets.
uint64_t Scrambled(uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
uint64_t HashOf(uint64_t a, uint64_t b, uint64_t kind) { return Scrambled(a + Scrambled(b + Scrambled(kind))); }

}  // namespace

uint32_t EffortReturns::Sample(const PhysicsSystem& system) {
    constexpr uint32_t kNone = ~0u;
    constexpr int kDirect = 256;  // more than any number of substeps
    std::fill(islandOf_.begin(), islandOf_.end(), kNone);
    keys_.clear();
    system.VisitIslands([&](BodyId body, uint32_t island) {
        if (body.index >= islandOf_.size()) islandOf_.resize(body.index + 1, kNone);
        islandOf_[body.index] = island;
        if (island >= keys_.size()) keys_.resize(island + 1, 0);
    });
    const auto add = [&](BodyId body, uint64_t hash) {
        if (body.index >= islandOf_.size() || islandOf_[body.index] == kNone) return false;
        keys_[islandOf_[body.index]] += hash;
        return true;
    };
    system.VisitContacts(
        [&](const ContactView& contact) { add(contact.bodyA, HashOf(contact.bodyA.index, contact.bodyB.index, 0)); });
    const JointInterface& joints = system.Joints();
    joints.Visit([&](JointId joint) {
        const uint64_t hash = HashOf(joint.index, joint.generation, 1);
        if (!add(joints.GetBodyA(joint), hash)) add(joints.GetBodyB(joint), hash);
    });
    substeps_.assign(keys_.size(), system.Settings().solver.substeps);
    system.VisitEfforts([&](const IslandEffortReport& effort) {
        const uint32_t body = effort.culprit.index;
        if (body >= islandOf_.size() || islandOf_[body] == kNone) return;
        substeps_[islandOf_[body]] = effort.isDirect ? kDirect : effort.substeps;
    });
    uint32_t returns = 0;
    now_.clear();
    for (size_t i = 0; i < keys_.size(); ++i) {
        if (keys_[i] == 0) continue;  // a free body
        Island island{substeps_[i]};
        if (const auto found = before_.find(keys_[i]); found != before_.end()) {
            const Island& last = found->second;
            returns += last.hasFallen && island.substeps > last.substeps;
            island.hasFallen = island.substeps < last.substeps || (last.hasFallen && island.substeps == last.substeps);
        }
        now_[keys_[i]] = island;
    }
    std::swap(before_, now_);
    return returns;
}

}  // namespace fulcrum::accuracy
