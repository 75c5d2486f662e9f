// What a process of its own does is told, however it ends.
#include <Fulcrum/Assets/Meshes/ChildProcess.h>

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdlib>

namespace fulcrum {
namespace {

constexpr std::array<std::byte, 1000> kSome{};

void SendSome(const SendBytes& send) { send(kSome); }
void SendForever(const SendBytes& send) {
    bool isRead = true;
    while (isRead) isRead = send(kSome);
}
void Crash(const SendBytes& send) {
    send(kSome);
    std::abort();
}
void Throw(const SendBytes&) { throw 1; }
void Compute(const SendBytes&) {
    for (std::atomic<uint32_t> i = 0;;) ++i;
}

TEST(ChildProcess, ReturnsWhatItSent) {
    const ProcessRun run = RunInProcess(SendSome, {.mostSent = kSome.size()});
    EXPECT_EQ(run.end, ProcessEnd::Returned);
    EXPECT_EQ(run.sent.size(), kSome.size());
}

TEST(ChildProcess, SaysHowItEnded) {
    EXPECT_EQ(RunInProcess(SendForever, {.mostSent = 100'000}).end, ProcessEnd::SentTooMuch);
    EXPECT_EQ(RunInProcess(Throw).end, ProcessEnd::Died);
    EXPECT_EQ(RunInProcess(Compute, {.seconds = 1}).end, ProcessEnd::TookTooLong);
    const ProcessRun crashed = RunInProcess(Crash);
    EXPECT_EQ(crashed.end, ProcessEnd::Died);
    EXPECT_EQ(crashed.sent.size(), kSome.size());
}

}  // namespace
}  // namespace fulcrum
