// A fast hash, 64 bits, of bytes in memory: to compare states, and to notice damage. The same on every machine of the
// same byte order. Not for keys that somebody chooses on purpose.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace fulcrum {

inline constexpr uint64_t kHashSeed = 0x9E3779B97F4A7C15ull;

// The hash of what was hashed to `hash`, followed by a word. For either argument given, another other argument gives
// another result.
inline uint64_t HashWord(uint64_t hash, uint64_t word) {
    return std::rotl((hash ^ word) * 0xD6E8FEB86659FD93ull, 29) + 0x165667B19E3779F9ull;
}

// Words go round eight running hashes, so that the processor works on all at once, and these are hashed at last. A
// change of one word, be it of one bit, always changes the result: each step is a bijection.
inline uint64_t HashBytes(const void* bytes, size_t size, uint64_t seed = kHashSeed) {
    constexpr size_t kRunning = 8;
    const unsigned char* at = static_cast<const unsigned char*>(bytes);
    uint64_t running[kRunning];
    for (size_t i = 0; i < kRunning; ++i) running[i] = seed + i * kHashSeed;
    size_t left = size;
    for (; left >= 8 * kRunning; left -= 8 * kRunning, at += 8 * kRunning) {
        uint64_t words[kRunning];
        std::memcpy(words, at, sizeof words);
        for (size_t i = 0; i < kRunning; ++i) running[i] = HashWord(running[i], words[i]);
    }
    for (size_t i = 0; left > 0; ++i) {
        const size_t part = left < 8 ? left : 8;
        uint64_t word = 0;
        std::memcpy(&word, at, part);
        running[i] = HashWord(running[i], word);
        at += part;
        left -= part;
    }
    uint64_t hash = HashWord(seed, size);
    for (const uint64_t r : running) hash = HashWord(hash, r);
    return hash ^ hash >> 32;
}

}  // namespace fulcrum
