#include <Fulcrum/Constraints/Coloring.h>

#include <Fulcrum/Math/Assert.h>

#include <bit>

namespace fulcrum {

void ContactColouring::ReserveBodies(uint32_t count) {
    if (count <= used_.size()) return;
    used_.resize(count, 0);
    overflows_.resize(count, 0);
}

ColourSlot ContactColouring::Add(uint32_t contact, uint32_t bodyA, uint32_t bodyB, bool fixedB) {
    const uint64_t used = used_[bodyA] | (fixedB ? 0 : used_[bodyB]);
    ColourSlot place;
    if (used == ~uint64_t(0)) {
        place.colour = kOverflow;
        ++overflows_[bodyA];
        if (!fixedB) ++overflows_[bodyB];
    } else {
        // Colours are solved in ascending order. Contacts with what does not move come last: they must win.
        place.colour = static_cast<uint8_t>(fixedB ? 63 - std::countl_one(used) : std::countr_one(used));
        const uint64_t bit = uint64_t(1) << place.colour;
        used_[bodyA] |= bit;
        if (!fixedB) used_[bodyB] |= bit;
    }
    std::vector<Entry>& list = List(place.colour, fixedB);
    place.slot = static_cast<uint32_t>(list.size());
    list.push_back({contact, bodyA, bodyB});
    ++size_;
    ++version_;
    return place;
}

uint32_t ContactColouring::Remove(uint32_t contact, ColourSlot place, uint32_t bodyA, uint32_t bodyB, bool fixedB) {
    if (place.colour == kOverflow) {
        --overflows_[bodyA];
        if (!fixedB) --overflows_[bodyB];
    } else {
        const uint64_t bit = uint64_t(1) << place.colour;
        used_[bodyA] &= ~bit;
        if (!fixedB) used_[bodyB] &= ~bit;
    }
    std::vector<Entry>& list = List(place.colour, fixedB);
    FULCRUM_ASSERT(contact == list[place.slot].contact);
    (void)contact;
    const Entry moved = list.back();
    list[place.slot] = moved;
    list.pop_back();
    --size_;
    ++version_;
    return moved.contact;
}

size_t ContactColouring::MemoryUsed() const {
    size_t bytes = used_.capacity() * sizeof(uint64_t) + overflows_.capacity() * sizeof(uint16_t);
    for (const Colour& c : colours_) bytes += (c.moving.capacity() + c.fixed.capacity()) * sizeof(Entry);
    return bytes;
}

}  // namespace fulcrum
