// Error handler for calls that are not allowed or have an invalid argument, and do not return a Result (queries): the
// handler is called, and the call has no effect.
#pragma once

#include <Fulcrum/Math/Result.h>

namespace fulcrum {

// Called by the offending thread, which may hold a lock of a world: it must neither query nor change a world. It may
// end the program, but not throw.
using MisuseHandler = void (*)(const Error& error);

// For all worlds of the program, from any thread. Null: the default, which logs the first 100 errors (Math/Log.h).
void SetMisuseHandler(MisuseHandler handler);

void ReportMisuse(const Error& error);

}  // namespace fulcrum
