// Executes the commands of the command line. Called by Main.cpp; one thread.
#pragma once

#include <Fulcrum/Samples/Runner/Options.h>

namespace fulcrum {

// Prints to stdout, errors to stderr; writes recordings to out/ below the current folder. Returns the exit status:
// 0, or 1 where something could not be read, simulated or written.
int Execute(const Command& command);

}  // namespace fulcrum
