// Programs whose standard output gets lost, on a full disk for one, fail. Called by their main functions. One thread.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace fulcrum {

// Calls a program and returns its exit status, or 1 where what it printed has not arrived. What can be seen to be full
// before is an error before anything is simulated; no output at all, closed on purpose, is one only where something was
// printed.
template <class Program>
int WithStandardOutput(const Program& program) {
    const auto fail = [](int error) {
        std::fprintf(stderr, "fulcrum: cannot write to standard output: %s\n", std::strerror(error));
        return 1;
    };
    // Devices that take nothing refuse no bytes, too.
    if (write(STDOUT_FILENO, "", 0) < 0 && errno != EBADF) return fail(errno);
    const int status = program();
    errno = 0;
    const bool isWritten = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    if (isWritten || status != 0) return status;
    return fail(errno != 0 ? errno : EIO);
}

}  // namespace fulcrum
