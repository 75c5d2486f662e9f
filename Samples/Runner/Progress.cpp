#include <Fulcrum/Samples/Runner/Progress.h>

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace fulcrum {
namespace {

constexpr int kBarWidth = 40;
constexpr int kPlainStep = 10;  // per cent, between two numbers where stderr is no terminal

}  // namespace

Progress::Progress(const char* title, int total) : title_(title), total_(total), terminal_(isatty(STDERR_FILENO) == 1) {
    if (!terminal_) std::fprintf(stderr, "%s:", title_);
    Draw(0);
}

Progress::~Progress() { std::fputs(terminal_ ? "\r\033[K" : "\n", stderr); }

void Progress::Advance() {
    ++done_;
    const int percent = static_cast<int>(int64_t{100} * done_ / total_);
    if (percent / (terminal_ ? 1 : kPlainStep) == shown_ / (terminal_ ? 1 : kPlainStep)) return;
    Draw(percent);
    shown_ = percent;
}

void Progress::Draw(int percent) const {
    if (!terminal_) {
        std::fprintf(stderr, " %d%%", percent);
    } else {
        const size_t filled = static_cast<size_t>(kBarWidth * percent / 100);
        const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
        std::fprintf(stderr, "\r%s [%s] %3d%%  step %d of %d", title_, bar.c_str(), percent, done_, total_);
    }
    std::fflush(stderr);
}

}  // namespace fulcrum
