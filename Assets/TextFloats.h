// The floating-point environment of functions that read and write files: that of the engine, and the rounding mode by
// which the C library converts numbers to text and back, which on x86-64 is another register's.
#pragma once

#include <Fulcrum/Math/FloatEnvironment.h>

#include <cfenv>

namespace fulcrum {

class TextFloats {
public:
    TextFloats() : rounding_(std::fegetround()) {
        if (rounding_ != FE_TONEAREST) std::fesetround(FE_TONEAREST);
    }
    ~TextFloats() {
        if (rounding_ != FE_TONEAREST) std::fesetround(rounding_);
    }
    TextFloats(const TextFloats&) = delete;
    TextFloats& operator=(const TextFloats&) = delete;

private:
    const DefaultFloats floats_;  // ends last: with what a program set in this register alone
    const int rounding_;
};

}  // namespace fulcrum
