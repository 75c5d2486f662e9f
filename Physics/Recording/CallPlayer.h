// Plays the entries of a recording in a world. Used by Replay.cpp and Shrink.cpp; one thread.
#pragma once

#include <Fulcrum/Physics/Recording/CallRecording.h>
#include <Fulcrum/Physics/Recording/CallTable.h>

#include <memory>

namespace fulcrum {

// The objects of a recording, read once for all players.
Result<RecordedObjects> ReadObjects(const CallRecording& recording, const ReplaySources& sources);

struct PlayedCall {
    bool isDone = false;  // false: it was refused, or left out because it names what is missing
    bool isLeftOut = false;
    CreatedIds recorded, created;
    Error error{};  // why it was refused
};

class CallPlayer {
public:
    // All must outlive the player. With `leavesOut`, calls may be left out: ids are translated then.
    CallPlayer(const CallRecording& recording, const RecordedObjects& objects, const ReplaySources& sources,
               bool leavesOut);

    // Creates the world. Errors: those of PhysicsSystem::Create and RestoreSnapshot.
    Status Start(JobSystem* jobs);
    PhysicsSystem& System() { return *system_; }

    // Plays the call that is the entry of this number. Errors: Unsupported (it needs a listener that the sources do not
    // have), Degenerate (damaged).
    Result<PlayedCall> Play(size_t entry);
    // Of a batch the part of this number alone, a body or, after those, a joint.
    Result<PlayedCall> PlayPart(size_t entry, size_t part);

private:
    void Note(const PlayedCall& call);

    const CallRecording& recording_;
    const RecordedObjects& objects_;
    const ReplaySources& sources_;
    const bool leavesOut_;
    RecordedIds ids_;
    std::unique_ptr<PhysicsSystem> system_;
};

// How many parts a call that added a batch has; 0: it is none, or was refused, or is damaged.
struct BatchSize {
    size_t bodies = 0, joints = 0;
};
BatchSize SizeOfBatch(const CallRecording& recording, size_t entry, const RecordedObjects& objects);

}  // namespace fulcrum
