#include <Fulcrum/Constraints/Coloring.h>

#include <Fulcrum/Math/Assert.h>

#include <bit>

namespace fulcrum {

void ConstraintColoring::ReserveBodies(uint32_t count) {
    if (count <= used_.size()) return;
    used_.resize(count, 0);
    overflows_.resize(count, 0);
}

ColorSlot ConstraintColoring::Add(Kind kind, const Entry& entry, bool late) {
    uint64_t used = 0;
    VisitMoving(entry, [&](uint32_t body) { used |= used_[body]; });
    ColorSlot place;
    if (used == ~uint64_t(0)) {
        place.color = kOverflow;
        VisitMoving(entry, [&](uint32_t body) { ++overflows_[body]; });
    } else {
        place.color = static_cast<uint8_t>(late ? 63 - std::countl_one(used) : std::countr_one(used));
        VisitMoving(entry, [&](uint32_t body) { used_[body] |= uint64_t(1) << place.color; });
    }
    Array<Entry>& list = List(place.color, kind);
    place.slot = static_cast<uint32_t>(list.size());
    // Grows by an eighth: doubling would leave up to half unused.
    if (list.size() == list.capacity()) list.reserve(list.size() + list.size() / 8 + 16);
    list.push_back(entry);
    ++size_;
    ++version_;
    jointVersion_ += kind == Kind::Joint;
    return place;
}

uint32_t ConstraintColoring::Remove(Kind kind, const Entry& entry, ColorSlot place) {
    VisitMoving(entry, [&](uint32_t body) {
        if (place.color == kOverflow) --overflows_[body];
        else used_[body] &= ~(uint64_t(1) << place.color);
    });
    Array<Entry>& list = List(place.color, kind);
    FULCRUM_ASSERT(entry.constraint == list[place.slot].constraint);
    const Entry moved = list.back();
    list[place.slot] = moved;
    list.pop_back();
    --size_;
    ++version_;
    jointVersion_ += kind == Kind::Joint;
    return moved.constraint;
}

size_t ConstraintColoring::MemoryUsed() const {
    size_t bytes = used_.capacity() * sizeof(uint64_t) + overflows_.capacity() * sizeof(uint32_t);
    for (const Color& c : colors_)
        for (const Array<Entry>& list : c.lists) bytes += list.capacity() * sizeof(Entry);
    return bytes;
}

}  // namespace fulcrum
