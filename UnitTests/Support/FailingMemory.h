// Memory of a world that runs out when a test says so, and knows how much of it is not given back.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace fulcrum::testing {

class FailingMemory final : public MemoryResource {
public:
    // The n-th request from now on fails, n > 0, and no other; 0: none.
    void FailAt(int64_t n) {
        left_ = n;
        hasFailed_ = false;
    }
    bool HasFailed() const { return hasFailed_; }  // since FailAt
    int64_t Bytes() const { return bytes_; }

    void* Allocate(size_t bytes, size_t alignment) override {
        if (left_.fetch_sub(1) == 1) {
            hasFailed_ = true;
            throw std::bad_alloc();
        }
        void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
        if (!memory) throw std::bad_alloc();
        bytes_ += static_cast<int64_t>(bytes);
        return memory;
    }
    void Deallocate(void* memory, size_t bytes, size_t) override {
        bytes_ -= static_cast<int64_t>(bytes);
        std::free(memory);
    }

private:
    std::atomic<int64_t> left_{0}, bytes_{0};
    std::atomic<bool> hasFailed_{false};
};

}  // namespace fulcrum::testing
