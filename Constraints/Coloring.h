// Graph coloring of contacts and joints: no two constraints of a color share a dynamic body, so they can be solved in
// parallel, in lanes and on any number of threads, and the result does not depend on their order. Persistent and
// incremental: only constraints that begin or end are colored. Called by the Color stage and where joints are created
// or destroyed. Serial and deterministic: the same calls give the same colors.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace fulcrum {

struct ColorSlot {
    uint8_t color = 0xFF;  // index into ConstraintColoring::Colors(); kOverflow if none was free
    uint32_t slot = 0;     // index into the color's list
};

class ConstraintColoring {
public:
    static constexpr int kColors = 64;
    static constexpr uint8_t kOverflow =
        kColors;  // for constraints that fit no color (a body with more than 64 of them): solved serially

    struct Entry {
        uint32_t constraint = 0;
        // Below 2^31. fixed: the body is not dynamic, constraints may share it.
        uint32_t bodyA : 31 = 0, fixedA : 1 = false;
        uint32_t bodyB : 31 = 0, fixedB : 1 = false;
        Entry() = default;
        Entry(uint32_t itsConstraint, uint32_t itsBodyA, uint32_t itsBodyB, bool isFixedA, bool isFixedB)
            : constraint(itsConstraint),
              bodyA(itsBodyA & kBodies),
              fixedA(isFixedA),
              bodyB(itsBodyB & kBodies),
              fixedB(isFixedB) {}

    private:
        static constexpr uint32_t kBodies = ~0u >> 1;
    };
    enum class Kind : uint8_t {
        Moving,  // contacts of two dynamic bodies
        Fixed,   // contacts between a dynamic body A and a static or kinematic one
        Joint,   // either body may be static or kinematic
    };
    static constexpr size_t kKinds = 3;
    struct Color {
        std::array<Array<Entry>, kKinds> lists;
        const Array<Entry>& Of(Kind kind) const { return lists[static_cast<size_t>(kind)]; }
        bool Empty() const { return lists[0].empty() && lists[1].empty() && lists[2].empty(); }
    };

    // Colors are solved in ascending order, and the last one solved wins where constraints conflict: such constraints
    // ask for a `late` color.
    ColorSlot Add(Kind kind, const Entry& entry, bool late);

    // Takes the entry that was added. Returns the constraint of its kind that was moved into its slot, or itself if its
    // slot was the last.
    uint32_t Remove(Kind kind, const Entry& entry, ColorSlot place);

    // Invalidates everything derived from the colors (Version changes).
    void Invalidate() {
        ++version_;
        ++jointVersion_;
    }

    // Whether any colored constraint touches the body.
    bool IsTouched(uint32_t body) const { return body < used_.size() && (used_[body] != 0 || overflows_[body] != 0); }

    const Color& At(int color) const { return colors_[static_cast<size_t>(color)]; }
    uint32_t Size() const { return size_; }
    bool HasOverflow() const { return !colors_[kOverflow].Empty(); }
    // Incremented by every change: data derived from the colors is valid while it stays the same.
    uint64_t Version() const { return version_; }
    uint64_t JointVersion() const { return jointVersion_; }  // the same, of joints alone
    void ReserveBodies(uint32_t count);
    // Which list an entry needs is known when it is added, too late to ask for memory that may be refused. After
    // Postpone, up to `entries` of them wait for Settle where their list has no room, which is to be called before the
    // lists are read, or anything is postponed anew: colors and slots are the same.
    void Postpone(size_t entries);
    void Settle();
    size_t MemoryUsed() const;

private:
    friend struct SnapshotAccess;
    template <class Visit>
    static void VisitMoving(const Entry& entry, Visit&& visit) {
        if (!entry.fixedA) visit(entry.bodyA);
        if (!entry.fixedB) visit(entry.bodyB);
    }
    Array<Entry>& List(uint8_t color, Kind kind) { return colors_[color].lists[static_cast<size_t>(kind)]; }
    // An entry that belongs to the end of its list, behind those of it that are postponed before.
    struct Postponed {
        Entry entry;
        uint8_t color;
        Kind kind;
    };
    size_t PostponedOf(uint8_t color, Kind kind) const;
    uint32_t AddToFull(uint8_t color, Kind kind, const Entry& entry);
    Entry TakeLast(uint8_t color, Kind kind);
    Entry& EntryAt(uint8_t color, Kind kind, uint32_t slot);

    Array<Color> colors_ = Array<Color>(kColors + 1);
    Array<uint64_t> used_;       // by body: bit c is set if a constraint of color c moves it
    Array<uint32_t> overflows_;  // by body: number of its constraints without a color
    uint32_t size_ = 0;
    uint64_t version_ = 1, jointVersion_ = 1;
    Array<Postponed> postponed_;
    bool postpones_ = false;
};

}  // namespace fulcrum
