// Turns the states of a world into a Recording, frame by frame. Used by the runner; one thread.
#pragma once

#include <Fulcrum/Samples/Runner/JointRecorder.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>
#include <Fulcrum/Samples/Viewer/Recording.h>

#include <map>
#include <optional>
#include <vector>

namespace fulcrum {

inline Vector3 PlaceFrom(const Position& position, const Position& origin) {
    return Vector3((position - origin).cast<float>());
}

class Recorder {
public:
    // The first frame is the world as it is now. Frames are recorded at an interval of steps that gives at most 60 a
    // second and keeps pages of large worlds small; the last of the `steps` steps of dt seconds is always a frame.
    // `world` must outlive this; its drawings are turned on.
    Recorder(SceneWorld& world, int steps, double dt);

    // After every step.
    void AfterStep();

    // In its place, to draw a world while it runs: the world as it is now. It is the recording's only frame, without
    // contacts and figures, and valid until the next call.
    const RecordedFrame& Now();

    // The body that a recorded one is, or whose child.
    BodyId IdOf(uint32_t recorded) const { return ids_[recorded]; }

    Recording recording;

private:
    // A shape, and its state when it was recorded. Kept alive, so that no other gets its address.
    struct KnownShape {
        ShapePtr shape;
        uint32_t index = 0;        // into recording.shapes
        uint64_t fingerprint = 0;  // of a height field's heights and cells
    };
    struct ShownShape {
        const Shape* shape = nullptr;
        uint32_t index = 0;  // into recording.shapes
    };

    // The body that uses it says what its materials look like.
    uint32_t RecordShape(const ShapePtr& shape, BodyId user);
    void AddNewBodies();
    void AddRecordedBody(BodyId id, ChildId child, const ShapePtr& shape);
    void CollectShapes();
    bool IsThere(uint32_t body) const;
    ShapePtr ShapeOf(uint32_t body) const;
    Pose PoseOf(uint32_t body) const;
    void AddFrame();
    void CollectIslands();
    void CollectContacts();
    void CollectDrawing();
    // In RecorderFigures.cpp.
    void NoteView();
    void NoteLooks(BodyId id, uint32_t body);
    void PutLooks(BodyId user, RecordedShape& shape) const;
    void NoteStep();
    void CollectFigures();
    std::optional<uint32_t> RecordedBodyOf(BodyId id) const;

    const SceneWorld& world_;
    int steps_;
    int interval_ = 1;  // steps a frame
    std::map<const Shape*, KnownShape> shapes_;
    std::vector<ShownShape> shown_;  // by recorded body
    size_t editedTriangles_ = 0;     // of all edits that were recorded
    std::vector<BodyId> ids_;        // of the recorded bodies
    // By recorded body: the children of a mutable compound are bodies of their own, each drawn where it is as long as
    // it is there. Of all others no child.
    std::vector<ChildId> children_;
    std::vector<uint32_t> recorded_;  // by BodyId::index: index of the recorded body, or of the first of its children
    std::map<std::pair<BodyId, ChildId>, uint32_t> recordedChildren_;
    std::vector<uint8_t> settled_;  // by recorded body: 1: its resting state is recorded
    std::vector<int32_t> islands_;  // by recorded body
    std::vector<int32_t> firstOfIsland_;
    std::vector<RecordedState> states_;
    std::vector<RecordedContact> contacts_;
    std::vector<RecordedLine> lines_;
    std::vector<RecordedPoint> points_;
    std::vector<RecordedShapeChange> shapeChanges_;
    std::optional<JointRecorder> joints_;
    bool isLive_ = false;      // frames are made by Now
    RecordedFigures figures_;  // of the steps since the last frame
    int stepsOfFigures_ = 0;
};

}  // namespace fulcrum
