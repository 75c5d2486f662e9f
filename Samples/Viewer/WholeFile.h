// Writes a file whole or not at all. Called by HtmlWriter, GlbWriter and whoever else leaves results in a folder.
// Any thread, as long as no two write the same path.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace fulcrum {

// Creates or replaces `path` with the parts one after another, and the folders that lead to it. They go to `path` +
// ".part" first, which is then renamed. Error OutOfRange with the path and the system's reason; a file that was there
// is still there.
Status WriteWholeFile(const std::filesystem::path& path, std::initializer_list<std::string_view> parts);

}  // namespace fulcrum
