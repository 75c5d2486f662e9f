// Room in a vector for more elements, as much as it would have grown by itself: many small reservations copy the
// elements as often as one large one.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <algorithm>
#include <cstddef>

namespace fulcrum {

template <class T>
void ReserveMore(Array<T>& elements, size_t more) {
    const size_t count = elements.size() + more;
    if (count > elements.capacity()) elements.reserve(std::max(count, 2 * elements.capacity()));
}

}  // namespace fulcrum
