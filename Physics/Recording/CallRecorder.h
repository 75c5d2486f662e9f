// Records all calls that change a world, so that Replay.h can play them again bit for bit: to reproduce a failure that
// a player saw, on another machine or in a debugger. From the thread that changes the world; Docs/Replay.md.
//
//     auto recorder = CallRecorder::ToFile(system, "game.calls").Value();   // and play on
//
// Records what goes through PhysicsSystem, BodyInterface and JointInterface, whoever calls: also ragdolls and fields.
// Not recorded are code (listeners, types of joints of one's own: ReplaySources.h) and queries, which change nothing.
#pragma once

#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/PhysicsSystem.h>

#include <memory>
#include <string>

namespace fulcrum {

struct CustomShapeFormat;

class CallRecorder {
public:
    // Takes the bytes of the recording piece by piece; returns false if they could not be written.
    using Sink = Function<bool(std::span<const std::byte> bytes)>;

    // Records from now on, until the recorder is destroyed, which must be before the system; it takes the place of any
    // other CallObserver. If the world is not as it was created, the recording begins with a snapshot of it. Each
    // step's calls are written before the step, so that those of a program that crashes are there. customShapes:
    // formats that write shapes of one's own; others are recorded by ContentHash alone. Errors: those of SaveSnapshot;
    // Unsupported (the sink failed; the world cannot be restored at this time, as when a body's shape was removed since
    // the last step).
    static Result<std::unique_ptr<CallRecorder>> Create(PhysicsSystem& system, Sink sink,
                                                        std::span<const CustomShapeFormat> customShapes = {});
    // Into a file, which is overwritten once the beginning of the recording is written. Errors also: Unsupported (it
    // cannot be written).
    static Result<std::unique_ptr<CallRecorder>> ToFile(PhysicsSystem& system, const std::string& file,
                                                        std::span<const CustomShapeFormat> customShapes = {});
    ~CallRecorder();
    CallRecorder(const CallRecorder&) = delete;
    CallRecorder& operator=(const CallRecorder&) = delete;

    // The first error; recording has stopped there. Unsupported: the sink failed.
    Status GetStatus() const;

private:
    class Observer;
    explicit CallRecorder(std::unique_ptr<Observer> observer);
    std::unique_ptr<Observer> observer_;
};

}  // namespace fulcrum
