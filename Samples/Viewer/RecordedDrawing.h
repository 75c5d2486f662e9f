// Lines and points that a recording shows besides its bodies, frame by frame: rays, hits, normals. Part of Recording.h;
// plain data.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <cstdint>
#include <span>

namespace fulcrum {

struct RecordedLine {
    Vector3 from = Vector3::Zero(), to = Vector3::Zero();  // m, relative to Recording::origin
    uint32_t color = 0;                                    // 0xRRGGBB
};

struct RecordedPoint {
    Vector3 place = Vector3::Zero();  // m, relative to Recording::origin
    uint32_t color = 0;               // 0xRRGGBB
};

struct RecordedFrameDrawing {
    std::span<const RecordedLine> lines;
    std::span<const RecordedPoint> points;
};

}  // namespace fulcrum
