// Loads the plugin, calls it and lets go of it, twice, and on another thread.
#include <dlfcn.h>

#include <cstdio>
#include <thread>

static int UsePlugin() {
    void* plugin = dlopen(PLUGIN, RTLD_NOW | RTLD_LOCAL);
    if (!plugin) return std::printf("%s\n", dlerror()), 1;
    const auto version = reinterpret_cast<const char* (*)()>(dlsym(plugin, "EngineVersion"));
    const auto drop = reinterpret_cast<double (*)()>(dlsym(plugin, "TopOfDroppedBall"));
    if (!version || !drop) return std::printf("%s\n", dlerror()), 1;
    std::printf("plugin of version %s: %.2f m\n", version(), drop());
    return dlclose(plugin);
}

int main() {
    int failures = UsePlugin();
    std::thread other([&] { failures += UsePlugin(); });
    other.join();
    return failures + UsePlugin();
}
