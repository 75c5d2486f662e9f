// Room in a vector for more elements.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <algorithm>
#include <cstddef>

namespace fulcrum {

// As much as it would have grown by itself: many small reservations copy the elements as often as one large one.
template <class T>
void ReserveMore(Array<T>& elements, size_t more) {
    const size_t count = elements.size() + more;
    if (count > elements.capacity()) elements.reserve(std::max(count, 2 * elements.capacity()));
}

// For `count` elements in all, growing by an eighth: doubling the largest arrays of a world would leave up to half
// unused.
template <class T>
void ReserveAtLeast(Array<T>& elements, size_t count) {
    const size_t size = elements.size();
    if (count > elements.capacity()) elements.reserve(std::max(count, size + size / 8 + 64));
}

// For `count` elements in all, growing by an eighth of the room there is: for lists that are mostly shorter.
template <class T>
void ReserveRoom(Array<T>& elements, size_t count) {
    const size_t room = elements.capacity();
    if (count > room) elements.reserve(std::max(count, room + room / 8 + 16));
}

}  // namespace fulcrum
