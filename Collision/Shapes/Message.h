// Formatted error messages. Used by the Create functions of the shapes.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace fulcrum {

// printf into a string of at most 255 characters; the longest message of the shapes is shorter.
[[gnu::format(printf, 1, 2)]] inline std::string Message(const char* format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

}  // namespace fulcrum
