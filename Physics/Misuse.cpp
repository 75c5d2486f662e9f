#include <Fulcrum/Physics/Misuse.h>

#include <atomic>
#include <cstdint>

namespace fulcrum {

namespace {

// Limits the output: a listener that queries in every callback would fill the disk.
constexpr uint32_t kMostPrinted = 100;

void Print(const Error& error) {
    static std::atomic<uint32_t> printed{0};
    const uint32_t before = printed.fetch_add(1, std::memory_order_relaxed);
    if (before >= kMostPrinted) return;
    const char* end = before + 1 == kMostPrinted ? " (no more such errors are printed)" : "";
    Log(LogLevel::Warning, (error.message + end).c_str());
}

std::atomic<MisuseHandler> theHandler{nullptr};

}  // namespace

void SetMisuseHandler(MisuseHandler handler) { theHandler.store(handler, std::memory_order_release); }

void ReportMisuse(const Error& error) {
    const MisuseHandler handler = theHandler.load(std::memory_order_acquire);
    (handler ? handler : Print)(error);
}

}  // namespace fulcrum
