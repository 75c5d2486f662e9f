// Where a call is not allowed, or has an argument that it cannot work with, and has no Result to say so in (queries):
// the error goes to a handler, and the call does nothing.
#pragma once

#include <Fulcrum/Math/Result.h>

namespace fulcrum {

// Called by the thread that made the call, while that may hold a world: it must not query nor change one. It may end
// the program, but not throw.
using MisuseHandler = void (*)(const Error& error);

// For all worlds of the program, from any thread. Null: the default, which logs the first 100 errors (Math/Log.h).
void SetMisuseHandler(MisuseHandler handler);

void ReportMisuse(const Error& error);

}  // namespace fulcrum
