// Shows the progress of a run on stderr: a progress bar on a terminal, a few numbers otherwise. One thread.
#pragma once

namespace fulcrum {

class Progress {
public:
    Progress(const char* title, int total);
    ~Progress();  // leaves the terminal on a clean line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void Advance();

private:
    void Draw(int percent) const;

    const char* title_;
    int total_;
    int done_ = 0;
    int shown_ = 0;  // per cent
    bool terminal_;
};

}  // namespace fulcrum
