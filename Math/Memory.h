// Where the memory of a world comes from. A program derives from MemoryResource and passes it to PhysicsSystem::Create;
// PmrMemory.h adapts a std::pmr::memory_resource. Inside the engine, an Array, or an object of a class with
// FULCRUM_WORLD_MEMORY, takes its memory from the resource that is current on its thread when it is constructed:
// whoever reads, changes or steps a world makes the world's resource current (WorldLock::Scope).
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#include <cstddef>
#include <limits>
#include <new>
#include <type_traits>
#include <vector>

namespace fulcrum {

class MemoryResource {
public:
    virtual ~MemoryResource() = default;
    // bytes > 0; alignment: a power of two. Several threads may call at the same time. Throws std::bad_alloc.
    virtual void* Allocate(size_t bytes, size_t alignment) = 0;
    // The same bytes and alignment as when it was allocated.
    virtual void Deallocate(void* memory, size_t bytes, size_t alignment) = 0;
};

// The current resource of this thread; null: operator new.
constinit inline thread_local MemoryResource* tCurrentMemory = nullptr;

// Makes a resource (null: operator new) the current one of this thread while the object lives.
class MemoryScope {
public:
    explicit MemoryScope(MemoryResource* memory) : before_(tCurrentMemory) { tCurrentMemory = memory; }
    ~MemoryScope() { tCurrentMemory = before_; }
    MemoryScope(const MemoryScope&) = delete;
    MemoryScope& operator=(const MemoryScope&) = delete;

private:
    MemoryResource* before_;
};

inline void* AllocateFrom(MemoryResource* memory, size_t bytes, size_t alignment) {
    if (memory) return memory->Allocate(bytes, alignment);
    if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return ::operator new(bytes);
    return ::operator new(bytes, std::align_val_t(alignment));
}
inline void DeallocateTo(MemoryResource* memory, void* address, size_t bytes, size_t alignment) {
    if (memory) return memory->Deallocate(address, bytes, alignment);
    if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return ::operator delete(address);
    ::operator delete(address, std::align_val_t(alignment));
}

// Keeps the resource with which it was constructed. A container that is moved or swapped takes its resource along, a
// copy has that of the original.
template <class T>
class Allocator {
public:
    using value_type = T;
    using propagate_on_container_move_assignment = std::true_type;
    using propagate_on_container_swap = std::true_type;

    Allocator() : memory_(tCurrentMemory) {}
    template <class U>
    Allocator(const Allocator<U>& other) : memory_(other.Memory()) {}

    T* allocate(size_t count) {
        if (count > std::numeric_limits<size_t>::max() / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(AllocateFrom(memory_, count * sizeof(T), alignof(T)));
    }
    void deallocate(T* address, size_t count) { DeallocateTo(memory_, address, count * sizeof(T), alignof(T)); }
    MemoryResource* Memory() const { return memory_; }
    template <class U>
    bool operator==(const Allocator<U>& other) const {
        return memory_ == other.Memory();
    }

private:
    MemoryResource* memory_;
};

// A std::vector in the current resource's memory.
template <class T>
using Array = std::vector<T, Allocator<T>>;

// Of single objects: the resource is kept in front of the object, so that it may be deleted anywhere.
inline void* AllocateObject(size_t bytes, size_t alignment = alignof(std::max_align_t)) {
    static_assert(sizeof(MemoryResource*) <= alignof(std::max_align_t));
    char* address = static_cast<char*>(AllocateFrom(tCurrentMemory, bytes + alignment, alignment));
    *reinterpret_cast<MemoryResource**>(address) = tCurrentMemory;
    return address + alignment;
}
inline void DeallocateObject(void* object, size_t bytes, size_t alignment = alignof(std::max_align_t)) {
    if (!object) return;
    char* address = static_cast<char*>(object) - alignment;
    DeallocateTo(*reinterpret_cast<MemoryResource**>(address), address, bytes + alignment, alignment);
}

// In a class: objects made by `new` are in the current resource's memory. Derived classes need a virtual destructor.
#define FULCRUM_WORLD_MEMORY                                                                                \
    static void* operator new(size_t bytes) { return ::fulcrum::AllocateObject(bytes); }                    \
    static void* operator new(size_t bytes, std::align_val_t alignment) {                                   \
        return ::fulcrum::AllocateObject(bytes, static_cast<size_t>(alignment));                            \
    }                                                                                                       \
    static void operator delete(void* object, size_t bytes) { ::fulcrum::DeallocateObject(object, bytes); } \
    static void operator delete(void* object, size_t bytes, std::align_val_t alignment) {                   \
        ::fulcrum::DeallocateObject(object, bytes, static_cast<size_t>(alignment));                         \
    }

}  // namespace fulcrum
