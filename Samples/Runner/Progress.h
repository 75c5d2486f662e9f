// Shows the progress of a run on stderr: a progress bar on a terminal, a few numbers otherwise. One thread.
#pragma once

#include <chrono>

namespace fulcrum {

// What stands beside the percentage: the number of steps, or the time that is left if the rest goes on as it did.
enum class ProgressShows { Steps, TimeLeft };

class Progress {
public:
    Progress(const char* title, int total, ProgressShows shows = ProgressShows::Steps);
    ~Progress();  // leaves the terminal on a clean line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void Advance(int steps = 1);

private:
    void Draw(int percent) const;

    const char* title_;
    int total_;
    int done_ = 0;
    int shown_ = 0;  // per cent
    bool terminal_;
    ProgressShows shows_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace fulcrum
