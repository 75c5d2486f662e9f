#include <Fulcrum/UnitTests/Support/AllocationCounter.h>

#include <atomic>
#include <cstdlib>
#include <new>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

std::atomic<uint64_t> allocations{0}, mallocs{0}, bytes{0};

uint64_t SizeOf([[maybe_unused]] void* memory) {
#ifdef __GLIBC__
    return malloc_usable_size(memory);
#else
    return 0;
#endif
}

[[maybe_unused]] void Free(void* memory) {
    bytes.fetch_sub(SizeOf(memory), std::memory_order_relaxed);
    std::free(memory);
}

[[maybe_unused]] void* Allocate(std::size_t size, std::size_t alignment) {
    allocations.fetch_add(1, std::memory_order_relaxed);
    // aligned_alloc wants whole multiples of the alignment.
    const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, rounded > 0 ? rounded : alignment);
    if (!memory) throw std::bad_alloc();
    bytes.fetch_add(SizeOf(memory), std::memory_order_relaxed);
    return memory;
}

}  // namespace

namespace fulcrum::testing {

uint64_t AllocationCount() { return allocations.load(std::memory_order_relaxed); }
uint64_t AllocatedBytes() { return bytes.load(std::memory_order_relaxed); }
uint64_t MallocCount() { return mallocs.load(std::memory_order_relaxed); }

}  // namespace fulcrum::testing

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
// The C library's own, under the name by which it calls it.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) noexcept {
    mallocs.fetch_add(1, std::memory_order_relaxed);
    return __libc_malloc(size);
}
#endif

// Clang's ThreadSanitizer has its own, which cannot be replaced: nothing is counted there.
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define FULCRUM_KEEPS_OPERATOR_NEW
#endif
#endif
#ifndef FULCRUM_KEEPS_OPERATOR_NEW
// The array forms call these; so do the non-throwing ones, but those of AddressSanitizer do not.
void* operator new(std::size_t size) { return Allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return Allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return Allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { Free(memory); }
void operator delete(void* memory, std::size_t) noexcept { Free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { Free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { Free(memory); }
#endif
