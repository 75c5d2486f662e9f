// fulcrum-bench: what ./fulcrum bench starts.
#include <Fulcrum/PerformanceTest/Scenes/Bench.h>
#include <Fulcrum/Samples/Runner/StandardOutput.h>

#include <cstdio>

int main(int argc, char** argv) {
    const auto options = fulcrum::ParseBenchOptions(std::vector<std::string>(argv + 1, argv + argc));
    if (!options) {
        std::fprintf(stderr, "fulcrum: %s\n", options.GetError().message.c_str());
        return 2;
    }
    return fulcrum::WithStandardOutput([&] {
        if (options.Value().help.empty()) return fulcrum::RunBench(options.Value());
        std::printf("%s", options.Value().help.c_str());
        return 0;
    });
}
