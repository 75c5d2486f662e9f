// The recording of a run for the viewers: shapes, bodies, joints, their states frame by frame, contacts, drawings and
// the report. Filled in by the runner through AppendFrame, read by HtmlWriter and GlbWriter. Knows nothing of the
// engine but its Math types. One thread at a time.
#pragma once

#include <Fulcrum/Math/Pose.h>
#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Samples/Viewer/RecordedDrawing.h>
#include <Fulcrum/Samples/Viewer/RecordedFigures.h>
#include <Fulcrum/Samples/Viewer/RecordedJoint.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fulcrum {

enum class RecordedShapeKind : uint8_t { Sphere, Box, Capsule, Hull, Compound };

struct RecordedChild {
    uint32_t shape = 0;  // index into Recording::shapes, smaller than that of the compound itself
    RelativePose pose;   // in the compound's frame
};

// Only the members of its kind count. Lengths in meters.
struct RecordedShape {
    RecordedShapeKind kind = RecordedShapeKind::Sphere;
    std::string name;                                // for people; the kind's name where empty
    float radius = 0;                                // sphere, capsule
    float halfHeight = 0;                            // capsule: half length of its segment, along y
    Vector3 halfExtents = Vector3::Zero();           // box
    std::vector<Vector3> vertices;                   // hull
    std::vector<std::array<uint32_t, 3>> triangles;  // hull: counter-clockwise seen from outside
    std::vector<RecordedChild> children;             // compound
    std::vector<uint8_t> looks;                      // hull: one a triangle, as RecordedLook::look; empty: all 0
};

enum class RecordedMotion : uint8_t { Static, Kinematic, Dynamic };

struct RecordedBody {
    uint32_t shape = 0;  // index into Recording::shapes
    RecordedMotion motion = RecordedMotion::Dynamic;
    float mass = 0;    // kg; counts for dynamic bodies only
    std::string name;  // may be empty; the page writes it beside the body
    bool isSensor = false;
    RecordedLook look{};
};

struct RecordedState {
    uint32_t body = 0;                   // index into Recording::bodies
    Vector3 position = Vector3::Zero();  // m, origin of the shape's frame, relative to Recording::origin
    Quaternion rotation;                 // of the shape's frame
    Vector3 velocity = Vector3::Zero();  // m/s, linear
    bool awake = true;
    int32_t island = -1;  // -1: in none
    bool isThere = true;  // false: the body was removed, and does not come back
};

// From this frame on a body has another shape, or an edited one.
struct RecordedShapeChange {
    uint32_t body = 0, shape = 0;  // indices into Recording::bodies and shapes
};

struct RecordedContact {
    Vector3 point = Vector3::Zero();   // m, relative to Recording::origin
    Vector3 normal = Vector3::Zero();  // unit, from body A to body B
    float separation = 0;              // m, negative where the bodies overlap
    float impulse = 0;                 // N s, along the normal, over the step
    uint32_t bodyA = 0, bodyB = 0;     // indices into Recording::bodies
};

struct RecordedFrame {
    double time = 0;                        // s
    std::vector<RecordedState> states;      // ascending by body; only those that changed since the frame before
    std::vector<RecordedContact> contacts;  // empty where `hasContacts` is false
    bool hasContacts = false;
    std::vector<RecordedJointState> joints;  // ascending by joint; only those that changed since the frame before
    RecordedJointErrors jointErrors;
    std::vector<RecordedLine> lines;    // of this frame alone
    std::vector<RecordedPoint> points;  // likewise
    std::vector<RecordedShapeChange> shapes;
    RecordedFigures figures;
};

// A line of the viewer's panel. Lines of one section are consecutive.
struct ReportLine {
    std::string section, label, value;
};

struct Recording {
    std::string title;        // the scene's name
    std::string description;  // one sentence or two
    Position origin = Position::Zero();
    std::vector<RecordedShape> shapes;
    std::vector<RecordedBody> bodies;
    std::vector<RecordedJoint> joints;
    std::vector<RecordedFrame> frames;
    std::vector<ReportLine> report;
    RecordedView view;
    std::vector<std::string> stageNames;  // of RecordedFigures::stageMs
    bool hasFigures = false;              // whether frames have them

    // Kept by AppendFrame.
    std::vector<RecordedState> latest;  // of every body
    std::vector<RecordedJointState> latestJoints;
    size_t contactInterval = 1;    // contacts are kept of every so many frames
    size_t contactCount = 0;       // of all frames
    size_t largestContactCut = 0;  // most contacts that a frame lost to kMostContactsPerFrame
};

inline constexpr size_t kMostContacts = 400'000;  // of a whole recording: about 5 MB in a page
inline constexpr size_t kMostContactsPerFrame = 50'000;

// Adds a frame at `time` seconds. `states` names bodies ascending by index, all of them or, from the second frame on,
// only those that may have changed; states that did not change, are not finite or name no body of the recording are
// dropped. A body that was added to the recording since the last frame is present from this one on, at the origin if it
// is not named. To bound memory, contacts are kept of every frame first, of every second once there are more than
// kMostContacts, then of every fourth, and so on; of more than kMostContactsPerFrame in one frame an even selection is
// kept. Joints need only be named if they may have changed; one that no frame has named yet counts as switched off.
// Lines and points that are not finite are dropped.
void AppendFrame(Recording& recording, double time, std::span<const RecordedState> states,
                 std::span<const RecordedContact> contacts, const RecordedFrameJoints& joints = {},
                 const RecordedFrameDrawing& drawing = {}, std::span<const RecordedShapeChange> shapes = {},
                 const RecordedFigures& figures = {});

// Frames from <= i < until, in which a body is there with one shape.
struct RecordedPresence {
    uint32_t body = 0, shape = 0;
    size_t from = 0, until = 0;
};

// Of all bodies, ascending by body, then frame; of a body that changes its shape several, of one that no frame has
// none.
std::vector<RecordedPresence> PresencesOf(const Recording& recording);

// Whether the next frame's contacts would be kept, for skipping their collection.
bool WantsContacts(const Recording& recording);

// Checks that every index is valid. Error UnknownId names the first that is not.
Status CheckRecording(const Recording& recording);

}  // namespace fulcrum
