// The floating-point environment in which the engine computes, whatever a program has set for its threads: round to
// nearest, subnormal numbers kept, no traps. Entered by every public function that computes and by every job, so that
// results are the same bits everywhere. Per thread; allocates nothing.
//
// WebAssembly has no other environment. What is specific to processors stands here, since Math/Wide.h is slow to
// compile and public headers need this.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#include <cstdint>

namespace fulcrum {

#if defined(__x86_64__)

// MXCSR. The x87 unit is not used.
class FloatRegisters {
public:
    static FloatRegisters Read() { return FloatRegisters(__builtin_ia32_stmxcsr()); }
    static FloatRegisters Default() { return FloatRegisters(kDefault); }
    void Write() const { __builtin_ia32_ldmxcsr(word_); }
    bool AreDefault() const { return (word_ & ~kFlags) == kDefault; }
    bool operator==(const FloatRegisters&) const = default;

private:
    static constexpr uint32_t kDefault = 0x1F80;  // the six exceptions are masked
    static constexpr uint32_t kFlags = 0x3F;      // of those that occurred
    explicit FloatRegisters(uint32_t word) : word_(word) {}
    uint32_t word_;
};

#elif defined(__aarch64__)

// FPCR and the flags of FPSR.
class FloatRegisters {
public:
    static FloatRegisters Read() {
        FloatRegisters now;
        asm volatile("mrs %0, fpcr" : "=r"(now.control_));
        asm volatile("mrs %0, fpsr" : "=r"(now.flags_));
        return now;
    }
    static FloatRegisters Default() { return {}; }
    void Write() const {
        asm volatile("msr fpcr, %0" : : "r"(control_) : "memory");
        asm volatile("msr fpsr, %0" : : "r"(flags_) : "memory");
    }
    bool AreDefault() const { return control_ == 0; }
    bool operator==(const FloatRegisters&) const = default;

private:
    uint64_t control_ = 0, flags_ = 0;
};

#else

struct FloatRegisters {
    static FloatRegisters Read() { return {}; }
    static FloatRegisters Default() { return {}; }
    void Write() const {}
    bool AreDefault() const { return true; }
    bool operator==(const FloatRegisters&) const = default;
};

#endif

// The default environment as long as the object lives; then the caller's again, with the flags of exceptions that were
// raised before. Within itself, and wherever a program has changed nothing, it only reads the register: a few cycles.
class DefaultFloats {
public:
    DefaultFloats() : before_(FloatRegisters::Read()) {
        if (!before_.AreDefault()) [[unlikely]]
            FloatRegisters::Default().Write();
    }
    ~DefaultFloats() {
        if (FloatRegisters::Read() != before_) before_.Write();
    }
    DefaultFloats(const DefaultFloats&) = delete;
    DefaultFloats& operator=(const DefaultFloats&) = delete;

private:
    const FloatRegisters before_;
};

}  // namespace fulcrum
