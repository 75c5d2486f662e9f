// What a page needs to draw the world of a scene: the recording of its first frame, in the format of the pages of
// recordings, and then the states of its bodies after each step.
#include <Fulcrum/Samples/Viewer/PageData.h>
#include <Fulcrum/Web/Bindings/Exchange.h>

#include <cstddef>

namespace fulcrum::web {

static_assert(sizeof(RecordedState) == 56 && offsetof(RecordedState, position) == 4 &&
                  offsetof(RecordedState, rotation) == 16 && offsetof(RecordedState, velocity) == 32 &&
                  offsetof(RecordedState, awake) == 44 && offsetof(RecordedState, island) == 48 &&
                  offsetof(RecordedState, isThere) == 52 && sizeof(RecordedJointState) == 56 &&
                  offsetof(RecordedJointState, enabled) == 4 && offsetof(RecordedJointState, limits) == 8 &&
                  sizeof(RecordedLine) == 28 && offsetof(RecordedLine, color) == 24 && sizeof(RecordedPoint) == 16 &&
                  offsetof(RecordedPoint, color) == 12,
              "Page/live.js reads these");

template <class T>
double AddressOf(const std::vector<T>& items) {
    return static_cast<double>(std::bit_cast<uintptr_t>(items.data()));
}

// Begins anew to record the world as it is: also after a body came, whose shape the page must draw.
FULCRUM_FOR_JAVASCRIPT int fulcrum_show(World* world) {
    if (!world->scene) return Fail({ErrorCode::Unsupported, "only worlds of scenes can be shown"});
    world->recorder = std::make_unique<Recorder>(*world->scene, 1, 1.0 / 60);
    Shared().answer = EncodePageData(world->recorder->recording);
    return 1;
}

// After each step. The number of bodies that are drawn; the numbers are the address of their RecordedStates, whether
// what is drawn has changed, so that it must be shown anew, the origin, and address and count of the states of joints
// that changed (RecordedJointState), of the scene's lines and of its points.
FULCRUM_FOR_JAVASCRIPT uint32_t fulcrum_readShown(World* world) {
    Recording& recording = world->recorder->recording;
    const size_t shapes = recording.shapes.size(), bodies = recording.bodies.size(), joints = recording.joints.size();
    const RecordedFrame& now = world->recorder->Now();
    double* numbers = Shared().numbers.data();
    numbers[0] = AddressOf(recording.latest);
    numbers[1] =
        recording.shapes.size() != shapes || recording.bodies.size() != bodies || recording.joints.size() != joints;
    for (int k = 0; k < 3; ++k) numbers[2 + k] = recording.origin[k];
    numbers[5] = AddressOf(now.joints);
    numbers[6] = static_cast<double>(now.joints.size());
    numbers[7] = AddressOf(now.lines);
    numbers[8] = static_cast<double>(now.lines.size());
    numbers[9] = AddressOf(now.points);
    numbers[10] = static_cast<double>(now.points.size());
    return static_cast<uint32_t>(bodies);
}

// The body of the world that a drawn one is; the numbers are its id.
FULCRUM_FOR_JAVASCRIPT void fulcrum_shownBody(World* world, uint32_t shown) {
    const BodyId id = world->recorder->IdOf(shown);
    PutId(id.index, id.generation);
}

}  // namespace fulcrum::web
