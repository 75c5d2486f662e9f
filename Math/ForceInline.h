// For the kernels alone: code that is only fast where the compiler inlines all of it, which by itself it does not.
// Builds with assertions, which are for finding errors, do without: they compile several times faster.
#pragma once

#if defined(FULCRUM_ASSERTIONS)
#define FULCRUM_FORCE_INLINE inline
#define FULCRUM_FORCE_INLINE_LAMBDA
#else
#define FULCRUM_FORCE_INLINE [[gnu::always_inline]] inline
#define FULCRUM_FORCE_INLINE_LAMBDA __attribute__((always_inline))
#endif
