// Each fuzz target for a moment, with seeds that are mutated at random, in every build of the tests. With coverage, and
// for as long as one likes: ./fulcrum fuzz. FULCRUM_FUZZ_FACTOR: how many times as long; FULCRUM_FUZZ_SEED: another
// beginning. Inputs that once broke a promise are tests of their own, in the folders of what they broke.
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace fulcrum::testing {
namespace {

double FromEnvironment(const char* name, double otherwise) {
    const char* const text = std::getenv(name);
    return text ? std::atof(text) : otherwise;
}

// One to some changes: bits, bytes, numbers, pieces copied, removed, or taken from another seed.
FuzzBytes Mutated(FuzzBytes bytes, const FuzzBytes& other, RandomPoses& random) {
    const auto at = [&](size_t size) { return size == 0 ? 0 : random.Below(static_cast<uint32_t>(size)); };
    for (uint32_t change = 1 + random.Below(6); change > 0; --change) {
        const size_t place = at(bytes.size()), length = std::min<size_t>(1 + at(16), bytes.size() - place);
        switch (random.Below(7)) {
            case 0:
                if (!bytes.empty()) bytes[place] = static_cast<uint8_t>(bytes[place] ^ 1u << random.Below(8));
                break;
            case 1:
                if (!bytes.empty()) bytes[place] = static_cast<uint8_t>(random.Below(256));
                break;
            case 2: {
                constexpr uint32_t kNumbers[] = {0,          1,          0x7F,       0xFF,       0x7FFFFFFF,
                                                 0xFFFFFFFF, 0x7F800000, 0x7FC00000, 0x7F7FFFFF, 0x80000000,
                                                 0x3F800000, 0x00800000, 1000000};
                const uint32_t number = kNumbers[random.Below(static_cast<uint32_t>(std::size(kNumbers)))];
                std::memcpy(bytes.data() + place, &number, std::min<size_t>(sizeof number, bytes.size() - place));
                break;
            }
            case 3:
                bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(place),
                            bytes.begin() + static_cast<std::ptrdiff_t>(place + length));
                break;
            case 4: {
                const FuzzBytes piece(bytes.begin() + static_cast<std::ptrdiff_t>(place),
                                      bytes.begin() + static_cast<std::ptrdiff_t>(place + length));
                bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at(bytes.size() + 1)), piece.begin(),
                             piece.end());
                break;
            }
            case 5: {
                const size_t from = at(other.size()), count = std::min<size_t>(1 + at(64), other.size() - from);
                bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(place),
                             other.begin() + static_cast<std::ptrdiff_t>(from),
                             other.begin() + static_cast<std::ptrdiff_t>(from + count));
                break;
            }
            default: bytes.resize(at(bytes.size() + 1)); break;
        }
    }
    return bytes;
}

class Fuzz : public ::testing::TestWithParam<FuzzTarget> {};

TEST_P(Fuzz, KeepsItsPromises) {
    const FuzzTarget& target = GetParam();
    const std::vector<FuzzBytes> seeds = target.seeds();
    for (const FuzzBytes& seed : seeds) target.run(seed);
    target.run({});
    RandomPoses random(static_cast<uint32_t>(FromEnvironment("FULCRUM_FUZZ_SEED", 1)));
    const double runs = Cases(target.quickRuns) * FromEnvironment("FULCRUM_FUZZ_FACTOR", 1);
    for (int run = 0; run < runs; ++run) {
        const FuzzBytes& seed = seeds[random.Below(static_cast<uint32_t>(seeds.size()))];
        const FuzzBytes& other = seeds[random.Below(static_cast<uint32_t>(seeds.size()))];
        target.run(Mutated(seed, other, random));
    }
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, ::testing::ValuesIn(FuzzTargets().begin(), FuzzTargets().end()),
                         [](const auto& test) {
                             std::string name = test.param.name;
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace fulcrum::testing
