// Many readers or one writer: queries share the world, changes and steps have it alone. A reader that arrives while a writer
// waits lets it go first, once, so that neither starves the other. A thread that holds the lock for reading may take it again;
// one that holds it in either way must not take it for writing.
#pragma once

#include <atomic>
#include <shared_mutex>

namespace fulcrum {

class WorldLock {
public:
    // For the life of the object, which is that of a scope of one thread.
    class Shared {
    public:
        enum class Kind : uint8_t { Own, Borrowed };
        // Borrowed: another thread holds it on behalf of this one, which only may not wait for it.
        explicit Shared(WorldLock& lock, Kind kind = Kind::Own);
        ~Shared();
        Shared(const Shared&) = delete;
        Shared& operator=(const Shared&) = delete;

        static bool IsHeldByThisThread(const WorldLock& lock);

    private:
        WorldLock& lock_;
        Shared* outer_;
        bool isHolder_;
    };

    class Exclusive {
    public:
        explicit Exclusive(WorldLock& lock);
        ~Exclusive();
        Exclusive(const Exclusive&) = delete;
        Exclusive& operator=(const Exclusive&) = delete;

    private:
        WorldLock& lock_;
    };

private:
    std::shared_mutex mutex_;
    std::atomic<uint32_t> writers_{0};  // that wait or hold
};

}  // namespace fulcrum
