// ./fulcrum replay and shrink: recorded calls (Docs/Replay.md). Called by Commands.cpp; one thread.
#pragma once

#include <Fulcrum/Physics/Recording/Shrink.h>
#include <Fulcrum/Samples/Runner/Options.h>

namespace fulcrum {

// Print to stdout, errors to stderr; return the exit status: 1 if the file cannot be read or played, if a step differs,
// or if nothing fails that could be shrunk.
int ReplayFile(const Command& command);
int ShrinkFile(const Command& command);

// For ShrinkSettings::isolation: a forked process without output.
IsolatedRun RunInAProcess(const Function<void(const CallRecorder::Sink& send)>& play);

}  // namespace fulcrum
