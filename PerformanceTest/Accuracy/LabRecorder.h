// Records a run of the lab for the viewer: its first world, whose bodies and joints may come and go but keep their
// shapes. Used by LabWorld; one thread.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Samples/Runner/JointRecorder.h>
#include <Fulcrum/Samples/Viewer/Recording.h>

#include <map>
#include <optional>
#include <vector>

namespace fulcrum::accuracy {

class LabRecorder {
public:
    // Adds a frame of the world as it is at `time` seconds, unless it is less than 1/60 s after the last one; nothing
    // once the recording has a million states of bodies, or if the world is not that of the first call.
    void AddFrame(const PhysicsSystem& system, double time);
    // The same before a world is destroyed: the last frame, if it is the first one's.
    void End(const PhysicsSystem& system, double time);

    Recording recording;

private:
    uint32_t RecordShape(const ShapePtr& shape);
    void AddNewBodies();
    std::optional<uint32_t> RecordedBodyOf(BodyId id) const;

    const PhysicsSystem* system_ = nullptr;
    std::map<ShapePtr, uint32_t> shapes_;  // by shape, index into recording.shapes
    std::vector<BodyId> ids_;              // of the recorded bodies
    std::vector<uint32_t> recorded_;       // by BodyId::index
    std::optional<JointRecorder> joints_;
    std::vector<RecordedState> states_;
    std::vector<RecordedContact> contacts_;
    double next_ = 0;  // s, of the next frame
    size_t stateCount_ = 0;
    bool hasEnded_ = false;
};

}  // namespace fulcrum::accuracy
