// Sorts the rays of a batch so that neighbors in the order are close together. Called by batches of ray casts. An
// object is used by one thread at a time and reuses its memory. Only performance depends on the order.
#pragma once

#include <Fulcrum/Collision/Queries/RayCast.h>

#include <span>
#include <vector>

namespace fulcrum {

class RayOrder {
public:
    // `together`: packet size for which neighbors should be close. If there are too few rays, the order is unchanged.
    void Sort(std::span<const Ray> rays, uint32_t together);
    // The indices of the rays, in the sorted order.
    std::span<const uint32_t> Numbers() const { return numbers_; }

private:
    // A ray's index and its code.
    struct Item {
        uint32_t place, number;
    };
    std::vector<Item> items_, sorted_;
    std::vector<uint32_t> numbers_;
};

}  // namespace fulcrum
