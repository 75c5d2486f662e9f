// The fuzz targets under libFuzzer. FULCRUM_FUZZ_TARGET names one; FULCRUM_FUZZ_SEEDS=FOLDER writes its seeds there and
// ends.
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace {

const fulcrum::testing::FuzzTarget* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* const name = std::getenv("FULCRUM_FUZZ_TARGET");
    for (const fulcrum::testing::FuzzTarget& target : fulcrum::testing::FuzzTargets())
        if (name && std::string(name) == target.name) chosen = &target;
    if (!chosen) {
        std::fprintf(stderr, "FULCRUM_FUZZ_TARGET must be one of:");
        for (const fulcrum::testing::FuzzTarget& target : fulcrum::testing::FuzzTargets())
            std::fprintf(stderr, " %s", target.name);
        std::fprintf(stderr, "\n");
        std::exit(1);
    }
    if (const char* const folder = std::getenv("FULCRUM_FUZZ_SEEDS")) {
        int number = 0;
        for (const fulcrum::testing::FuzzBytes& seed : chosen->seeds())
            std::ofstream(std::string(folder) + "/seed" + std::to_string(number++), std::ios::binary)
                .write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
        std::exit(0);
    }
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    chosen->run({data, size});
    return 0;
}
