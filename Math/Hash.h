// A fast hash, 64 bits, of bytes in memory: to compare states, and to notice damage. The same on all machines of the
// same byte order. Not secure against chosen keys.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>

namespace fulcrum {

inline constexpr uint64_t kHashSeed = 0x9E3779B97F4A7C15ull;

// The hash of the data hashed so far followed by a word. For a fixed value of either argument the map is injective in
// the other.
inline uint64_t HashWord(uint64_t hash, uint64_t word) {
    return std::rotl((hash ^ word) * 0xD6E8FEB86659FD93ull, 29) + 0x165667B19E3779F9ull;
}

// Words are distributed round robin to eight running hashes, for instruction-level parallelism, which are combined at
// the end. A change of one word, be it of one bit, always changes the result: each step is a bijection.
inline uint64_t HashBytes(const void* bytes, size_t size, uint64_t seed = kHashSeed) {
    const unsigned char* at = static_cast<const unsigned char*>(bytes);
    const auto wordAt = [&](size_t i) {
        uint64_t word;
        std::memcpy(&word, at + 8 * i, sizeof word);
        return word;
    };
    // By name: compilers make slower vectors of an array.
    uint64_t a = seed, b = seed + 1, c = seed + 2, d = seed + 3, e = seed + 4, f = seed + 5, g = seed + 6, h = seed + 7;
    size_t left = size;
    for (; left >= 64; left -= 64, at += 64) {
        __builtin_prefetch(at + 4096);  // processors themselves prefetch to the end of a page only
        a = HashWord(a, wordAt(0));
        b = HashWord(b, wordAt(1));
        c = HashWord(c, wordAt(2));
        d = HashWord(d, wordAt(3));
        e = HashWord(e, wordAt(4));
        f = HashWord(f, wordAt(5));
        g = HashWord(g, wordAt(6));
        h = HashWord(h, wordAt(7));
    }
    uint64_t hash = HashWord(seed, size);
    for (const uint64_t running : {a, b, c, d, e, f, g, h}) hash = HashWord(hash, running);
    for (; left > 0; at += 8) {
        const size_t part = left < 8 ? left : 8;
        uint64_t word = 0;
        std::memcpy(&word, at, part);
        hash = HashWord(hash, word);
        left -= part;
    }
    return hash ^ hash >> 32;
}

}  // namespace fulcrum
