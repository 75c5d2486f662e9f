// ./fulcrum replay and shrink: recorded calls (Docs/Replay.md). Called by Commands.cpp; one thread.
#pragma once

#include <Fulcrum/Samples/Runner/Options.h>

namespace fulcrum {

// Print to stdout, errors to stderr; return the exit status: 1 if the file cannot be read or played, if a step differs,
// or if nothing fails that could be shrunk.
int ReplayFile(const Command& command);
int ShrinkFile(const Command& command);

}  // namespace fulcrum
