// Writes a file atomically. Called by HtmlWriter, GlbWriter and others that write results. Any thread, as long as no
// two write the same path.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace fulcrum {

// Creates or replaces `path` with the concatenated parts, and its folders. They are written to `path` + ".part" first,
// which is then renamed. Error OutOfRange with the path and the system's reason; an existing file is then kept.
Status WriteWholeFile(const std::filesystem::path& path, std::initializer_list<std::string_view> parts);

}  // namespace fulcrum
