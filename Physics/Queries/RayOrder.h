// Orders the rays of a batch so that those next to each other lie close together. Called by the batches of ray casts.
// An object is used by one thread at a time and keeps its memory. Nothing but speed depends on the order.
#pragma once

#include <Fulcrum/Collision/Queries/RayCast.h>

#include <span>
#include <vector>

namespace fulcrum {

class RayOrder {
public:
    // `together`: how many in a row are to be close. Where there are too few rays for that, they keep their order.
    void Sort(std::span<const Ray> rays, uint32_t together);
    // The numbers of the rays, in order.
    std::span<const uint32_t> Numbers() const { return numbers_; }

private:
    // A number and the place of its ray.
    struct Item {
        uint32_t place, number;
    };
    std::vector<Item> items_, sorted_;
    std::vector<uint32_t> numbers_;
};

}  // namespace fulcrum
