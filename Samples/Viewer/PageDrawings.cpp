#include <Fulcrum/Samples/Viewer/PageDrawings.h>

#include <Fulcrum/Samples/Viewer/PageColumn.h>

#include <algorithm>

namespace fulcrum {
namespace {

struct Most {
    size_t lines = 0, points = 0;
};

Most MostOfAFrame(const Recording& recording) {
    Most most;
    for (const RecordedFrame& frame : recording.frames) {
        most.lines = std::max(most.lines, frame.lines.size());
        most.points = std::max(most.points, frame.points.size());
    }
    return most;
}

template <size_t Places>
struct Steps {
    std::array<int64_t, 3 * Places> places{};
    int64_t color = 0;
};

// Larger coordinates are clamped, so that 53 bits hold their steps.
Steps3 PlaceSteps(const Vector3& place, double step) {
    constexpr float kMost = 1e9f;  // m
    return Quantized(place.cwiseMax(-kMost).cwiseMin(kMost), step);
}

Steps<2> StepsOf(const RecordedLine& line, double step) {
    const Steps3 from = PlaceSteps(line.from, step), to = PlaceSteps(line.to, step);
    return {{from[0], from[1], from[2], to[0], to[1], to[2]}, line.color};
}

Steps<1> StepsOf(const RecordedPoint& point, double step) { return {PlaceSteps(point.place, step), point.color}; }

// `latest`: those of the frame before; updated to those of this one.
template <class Item, size_t Places>
void Put(const std::vector<Item>& items, double step, std::vector<Steps<Places>>& latest, Column& column) {
    column.PutUnsigned(items.size());
    Steps<Places> before;
    for (size_t i = 0; i < items.size(); ++i) {
        const Steps<Places> now = StepsOf(items[i], step);
        if (i == latest.size()) {
            for (size_t k = 3; k < 3 * Places; ++k) before.places[k] = before.places[k - 3];
            latest.push_back(before);
        }
        column.PutSigned(now.color - latest[i].color);
        column.PutDifference(now.places, latest[i].places);
        latest[i] = before = now;
    }
    latest.resize(items.size());
}

}  // namespace

std::string DrawingColumn(const Recording& recording, double step) {
    const Most most = MostOfAFrame(recording);
    if (most.lines + most.points == 0) return {};
    Column column;
    std::vector<Steps<2>> lines;
    std::vector<Steps<1>> points;
    for (const RecordedFrame& frame : recording.frames) {
        Put(frame.lines, step, lines, column);
        Put(frame.points, step, points, column);
    }
    return column.Bytes();
}

nlohmann::ordered_json DrawingHeader(const Recording& recording, double step) {
    const Most most = MostOfAFrame(recording);
    return {{"step", step}, {"mostLines", most.lines}, {"mostPoints", most.points}};
}

}  // namespace fulcrum
