#include <Fulcrum/Constraints/Coloring.h>

#include <Fulcrum/Math/Assert.h>

#include <algorithm>
#include <bit>

namespace fulcrum {

void ConstraintColoring::ReserveBodies(uint32_t count) {
    if (count <= used_.size()) return;
    used_.resize(count, 0);
    overflows_.resize(count, 0);
}

size_t ConstraintColoring::PostponedOf(uint8_t color, Kind kind) const {
    const auto isOf = [&](const Postponed& p) { return p.color == color && p.kind == kind; };
    return static_cast<size_t>(std::ranges::count_if(postponed_, isOf));
}

void ConstraintColoring::Postpone(size_t entries) {
    Settle();
    if (entries > postponed_.capacity()) postponed_.reserve(std::max(entries, 2 * postponed_.capacity()));
    postpones_ = true;
}

void ConstraintColoring::Settle() {
    postpones_ = false;
    while (!postponed_.empty()) {
        const Postponed& first = postponed_.front();
        List(first.color, first.kind).push_back(first.entry);
        postponed_.erase(postponed_.begin());
    }
}

// Removes the last entry of a list, or of those that wait for it.
ConstraintColoring::Entry ConstraintColoring::TakeLast(uint8_t color, Kind kind) {
    const auto isOf = [&](const Postponed& p) { return p.color == color && p.kind == kind; };
    const auto last = std::find_if(postponed_.rbegin(), postponed_.rend(), isOf);
    if (last != postponed_.rend()) {
        const Entry entry = last->entry;
        postponed_.erase(std::next(last).base());
        return entry;
    }
    Array<Entry>& list = List(color, kind);
    const Entry entry = list.back();
    list.pop_back();
    return entry;
}

ConstraintColoring::Entry& ConstraintColoring::EntryAt(uint8_t color, Kind kind, uint32_t slot) {
    Array<Entry>& list = List(color, kind);
    if (slot < list.size()) return list[slot];
    size_t before = slot - list.size();
    const auto isIt = [&](const Postponed& p) { return p.color == color && p.kind == kind && before-- == 0; };
    return std::ranges::find_if(postponed_, isIt)->entry;
}

ColorSlot ConstraintColoring::Add(Kind kind, const Entry& entry, bool late) {
    uint64_t used = 0;
    VisitMoving(entry, [&](uint32_t body) { used |= used_[body]; });
    ColorSlot place;
    if (used == ~uint64_t(0)) place.color = kOverflow;
    else place.color = static_cast<uint8_t>(late ? 63 - std::countl_one(used) : std::countr_one(used));
    Array<Entry>& list = List(place.color, kind);
    place.slot = static_cast<uint32_t>(list.size());
    if (list.size() == list.capacity() || !postponed_.empty()) [[unlikely]]
        place.slot = AddToFull(place.color, kind, entry);
    else list.push_back(entry);
    VisitMoving(entry, [&](uint32_t body) {
        if (place.color == kOverflow) ++overflows_[body];
        else used_[body] |= uint64_t(1) << place.color;
    });
    ++size_;
    ++version_;
    jointVersion_ += kind == Kind::Joint;
    return place;
}

// Returns the slot.
uint32_t ConstraintColoring::AddToFull(uint8_t color, Kind kind, const Entry& entry) {
    Array<Entry>& list = List(color, kind);
    const size_t before = PostponedOf(color, kind);
    const auto slot = static_cast<uint32_t>(list.size() + before);
    if (before == 0) {
        try {
            // Grows by an eighth: doubling would leave up to half unused.
            if (list.size() == list.capacity()) list.reserve(list.size() + list.size() / 8 + 16);
            list.push_back(entry);
            return slot;
        } catch (...) {
            if (!postpones_ || postponed_.size() == postponed_.capacity()) throw;
        }
    }
    postponed_.push_back({entry, color, kind});
    return slot;
}

uint32_t ConstraintColoring::Remove(Kind kind, const Entry& entry, ColorSlot place) {
    VisitMoving(entry, [&](uint32_t body) {
        if (place.color == kOverflow) --overflows_[body];
        else used_[body] &= ~(uint64_t(1) << place.color);
    });
    FULCRUM_ASSERT(entry.constraint == EntryAt(place.color, kind, place.slot).constraint);
    const Entry moved = TakeLast(place.color, kind);
    if (moved.constraint != entry.constraint) EntryAt(place.color, kind, place.slot) = moved;
    --size_;
    ++version_;
    jointVersion_ += kind == Kind::Joint;
    return moved.constraint;
}

size_t ConstraintColoring::MemoryUsed() const {
    size_t bytes = used_.capacity() * sizeof(uint64_t) + overflows_.capacity() * sizeof(uint32_t) +
                   postponed_.capacity() * sizeof(Postponed);
    for (const Color& c : colors_)
        for (const Array<Entry>& list : c.lists) bytes += list.capacity() * sizeof(Entry);
    return bytes;
}

}  // namespace fulcrum
