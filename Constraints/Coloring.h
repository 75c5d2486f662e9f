// Colours contacts so that no two of a colour share a moving body: those of a colour are solved at the same time, in lanes
// and on any number of threads, and the result does not depend on their order. Kept from step to step: only contacts that
// begin or end to touch are coloured. Called by the Color stage. Serial; the same calls give the same colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fulcrum {

struct ColourSlot {
    uint8_t colour = 0xFF;  // index into ContactColouring::Colours(); kOverflow where none was free
    uint32_t slot = 0;      // index into the colour's list
};

class ContactColouring {
public:
    static constexpr int kColours = 64;
    static constexpr uint8_t kOverflow = kColours;  // contacts of bodies that touch more than 64: solved one after the other

    struct Entry {
        uint32_t contact, bodyA, bodyB;
    };
    struct Colour {
        std::vector<Entry> moving;  // both bodies are dynamic
        std::vector<Entry> fixed;   // only the first is
        bool Empty() const { return moving.empty() && fixed.empty(); }
    };

    // Adds a contact of the moving body a with b, which is moving too unless `fixedB`.
    ColourSlot Add(uint32_t contact, uint32_t bodyA, uint32_t bodyB, bool fixedB);

    // Removes a contact. Returns the contact that now has its place, or `contact` itself where it was the last.
    uint32_t Remove(uint32_t contact, ColourSlot place, uint32_t bodyA, uint32_t bodyB, bool fixedB);

    // Whether any coloured contact touches the body.
    bool IsTouched(uint32_t body) const { return body < used_.size() && (used_[body] != 0 || overflows_[body] != 0); }

    const Colour& At(int colour) const { return colours_[static_cast<size_t>(colour)]; }
    uint32_t Size() const { return size_; }
    // Grows with every change: what was derived from the colours holds as long as it stays.
    uint64_t Version() const { return version_; }
    void ReserveBodies(uint32_t count);
    size_t MemoryUsed() const;

private:
    std::vector<Entry>& List(uint8_t colour, bool fixedB) {
        return fixedB ? colours_[colour].fixed : colours_[colour].moving;
    }

    std::vector<Colour> colours_ = std::vector<Colour>(kColours + 1);
    std::vector<uint64_t> used_;       // by body: bit c is set where a contact of colour c moves it
    std::vector<uint16_t> overflows_;  // by body: its contacts without a colour
    uint32_t size_ = 0;
    uint64_t version_ = 1;
};

}  // namespace fulcrum
