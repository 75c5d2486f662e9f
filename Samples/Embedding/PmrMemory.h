// A world in memory of a std::pmr::memory_resource: a pool, a buffer with a limit, or one that counts.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <memory_resource>

namespace fulcrum::samples {

// `resource` (not owned) must be safe for several threads, as std::pmr::synchronized_pool_resource is, unless the world
// has a single one. It may throw std::bad_alloc, which ends in whoever called the engine; the world is not usable then.
class PmrMemory final : public MemoryResource {
public:
    explicit PmrMemory(std::pmr::memory_resource& resource) : resource_(resource) {}
    void* Allocate(size_t bytes, size_t alignment) override { return resource_.allocate(bytes, alignment); }
    void Deallocate(void* memory, size_t bytes, size_t alignment) override {
        resource_.deallocate(memory, bytes, alignment);
    }

private:
    std::pmr::memory_resource& resource_;
};

}  // namespace fulcrum::samples
