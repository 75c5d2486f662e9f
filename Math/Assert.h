// Checks of the engine's own invariants, compiled in if FULCRUM_ASSERTIONS is defined (debug and sanitizer presets).
// Arguments of callers are not checked with these: invalid ones are reported by a Result.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#ifdef FULCRUM_ASSERTIONS
#include <cstdio>
#include <cstdlib>
#define FULCRUM_ASSERT(condition) \
    ((condition)                  \
         ? void()                 \
         : (std::fprintf(stderr, "%s:%d: assertion failed: %s\n", __FILE__, __LINE__, #condition), std::abort()))
#define FULCRUM_VALIDATE(statement) statement
#else
#define FULCRUM_ASSERT(condition) void()
#define FULCRUM_VALIDATE(statement) void()
#endif
