// For kernels that are only fast if fully inlined, which compilers do not do by themselves. Off in builds with
// assertions, which compile several times faster without it.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#if defined(FULCRUM_ASSERTIONS)
#define FULCRUM_FORCE_INLINE inline
#define FULCRUM_FORCE_INLINE_LAMBDA
#else
#define FULCRUM_FORCE_INLINE [[gnu::always_inline]] inline
#define FULCRUM_FORCE_INLINE_LAMBDA __attribute__((always_inline))
#endif
