// A recording in memory, and what replays of it are checked for.
#pragma once

#include <Fulcrum/Physics/Recording/CallRecorder.h>
#include <Fulcrum/Physics/Recording/Replay.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <gtest/gtest.h>

#include <functional>

namespace fulcrum::testing {

using Bytes = std::vector<std::byte>;

inline CallRecorder::Sink SinkInto(Bytes& bytes) {
    return [&bytes](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    };
}

// What `play` calls, from the world as it is.
template <class Play>
Bytes RecordingOf(PhysicsSystem& system, const Play& play) {
    Bytes bytes;
    {
        const auto recorder = CallRecorder::Create(system, SinkInto(bytes));
        EXPECT_TRUE(recorder) << recorder.GetError().message;
        if (!recorder) return {};
        play();
        const Status status = recorder.Value()->GetStatus();
        EXPECT_TRUE(status) << status.GetError().message;
    }
    return bytes;
}

inline CallRecording Parsed(const Bytes& bytes) { return CallRecording::Read(bytes).Value(); }

// Replays with one, two and four threads: all end with the state `hash`.
inline void ExpectSameReplays(const Bytes& bytes, uint64_t hash, const ReplaySources& sources = {}) {
    const CallRecording recording = Parsed(bytes);
    EXPECT_TRUE(recording.IsComplete());
    for (const uint32_t threads : {1u, 2u, 4u}) {
        ThreadPool jobs(threads);
        const Result<ReplayReport> report = Replay(recording, {.jobs = &jobs, .sources = sources});
        ASSERT_TRUE(report) << report.GetError().message;
        EXPECT_FALSE(report.Value().divergence) << report.Value().divergence->what;
        EXPECT_EQ(report.Value().stateHash, hash) << threads << " threads";
        EXPECT_EQ(report.Value().calls, recording.Calls());
        EXPECT_EQ(report.Value().steps, recording.Steps());
    }
}

}  // namespace fulcrum::testing
