#include <Fulcrum/Samples/Runner/Progress.h>

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

namespace fulcrum {
namespace {

constexpr int kBarWidth = 40;
constexpr int kPlainStep = 10;  // per cent, between two numbers where stderr is no terminal

// "about 7 min left"; nothing before there is anything to go by.
std::string TimeLeft(double elapsed, int done, int total) {
    if (done == 0) return "";
    const double seconds = elapsed * (total - done) / done;
    const bool isLong = seconds >= 5400, isShort = seconds < 90;
    const long count = std::lround(isLong ? seconds / 3600 : isShort ? seconds : seconds / 60);
    return "about " + std::to_string(count) + (isLong ? " h" : isShort ? " s" : " min") + " left";
}

}  // namespace

Progress::Progress(const char* title, int total, ProgressShows shows)
    : title_(title), total_(total), terminal_(isatty(STDERR_FILENO) == 1), shows_(shows) {
    if (!terminal_) std::fprintf(stderr, "%s:", title_);
    Draw(0);
}

Progress::~Progress() { std::fputs(terminal_ ? "\r\033[K" : "\n", stderr); }

void Progress::Advance(int steps) {
    done_ += steps;
    const int percent = static_cast<int>(int64_t{100} * done_ / total_);
    if (percent / (terminal_ ? 1 : kPlainStep) == shown_ / (terminal_ ? 1 : kPlainStep)) return;
    Draw(percent);
    shown_ = percent;
}

void Progress::Draw(int percent) const {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    const std::string left = shows_ == ProgressShows::TimeLeft ? TimeLeft(elapsed.count(), done_, total_) : "";
    if (!terminal_) {
        std::fprintf(stderr, " %d%%%s", percent, left.empty() ? "" : (" (" + left + ")").c_str());
    } else {
        const size_t filled = static_cast<size_t>(kBarWidth * percent / 100);
        const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
        const std::string beside = shows_ == ProgressShows::TimeLeft
                                       ? left
                                       : "step " + std::to_string(done_) + " of " + std::to_string(total_);
        std::fprintf(stderr, "\r\033[K%s [%s] %3d%%  %s", title_, bar.c_str(), percent, beside.c_str());
    }
    std::fflush(stderr);
}

}  // namespace fulcrum
