// Changes that are to be made between two steps, from threads that must not wait for a step to end, and from callbacks
// of a step, which must not change the world: a contact that makes a body burst, a loader that has finished.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace fulcrum::samples {

class EditQueue {
public:
    using Edit = std::function<void(PhysicsSystem&)>;

    // Any thread, at any time. Edits are made in ascending `order`, those of equal order as they were added. Callbacks
    // of a step run on several threads, in any order: for results that do not depend on it they pass a number of their
    // own, such as the index of a body.
    void Add(Edit edit, uint64_t order = 0) {
        const std::lock_guard guard(mutex_);
        edits_.push_back({order, std::move(edit)});
    }

    // Makes the edits so far; call between two steps. Other threads see all of them or none. Edits that an edit adds
    // are made the next time.
    void Apply(PhysicsSystem& system) {
        std::vector<Item> edits;
        {
            const std::lock_guard guard(mutex_);
            edits.swap(edits_);
        }
        if (edits.empty()) return;
        std::ranges::stable_sort(edits, {}, &Item::order);
        const auto held = system.HoldForChanges();
        for (const Item& item : edits) item.edit(system);
    }

private:
    struct Item {
        uint64_t order;
        Edit edit;
    };
    std::mutex mutex_;
    std::vector<Item> edits_;
};

}  // namespace fulcrum::samples
