#include <Fulcrum/Jobs/ScratchArena.h>

#include <algorithm>

namespace fulcrum {

namespace {
constexpr size_t kFirstBlockBytes = 64 * 1024;
}

// Each block is as large as all before it together: the capacity doubles, so there are few blocks.
void ScratchArena::AddBlock(size_t minimumBytes) {
    const size_t bytes = std::max({minimumBytes, capacity_, kFirstBlockBytes});
    blocks_.emplace_back(bytes);
    next_ = blocks_.back().Begin();
    left_ = bytes;
    capacity_ += bytes;
}

void ScratchArena::Reset() {
    if (blocks_.empty()) return;
    if (blocks_.size() > 1) {
        // The sum of the blocks may be twice what was needed. A quarter more, since steps differ.
        const size_t used = capacity_ - left_, room = (used + used / 4 + kAlignment - 1) & ~(kAlignment - 1);
        blocks_.clear();
        next_ = nullptr;
        left_ = capacity_ = 0;
        AddBlock(room);
    }
    next_ = blocks_.front().Begin();
    left_ = capacity_;
}

}  // namespace fulcrum
