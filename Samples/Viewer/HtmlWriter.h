// Writes a recording as one self-contained web page that plays it. Called by the runner, one thread at a time. The page
// is the bundle that the build makes of Page/, with the recording in it (PageData.h).
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Samples/Viewer/Recording.h>

#include <filesystem>

namespace fulcrum {

// Creates or replaces `path`: whole or not at all, since the page is written beside it first and then renamed.
// Error OutOfRange, with the path and the system's reason: the page cannot be written there, or the page's template,
// which the build left at a place of its own, cannot be read. Error UnknownId: the recording names a body or shape that
// it lacks.
Status WriteHtml(const Recording& recording, const std::filesystem::path& path);

}  // namespace fulcrum
