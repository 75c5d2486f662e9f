// A recording's lines and points as a column of a page, in the varints of PageData.h. Called by PageData;
// Page/decodeDrawings.js reads it.
// - drawings: per frame: number of lines; per line the differences of color and both ends x y z to the prediction;
//   number of points; per point the differences of color and x y z
//
// Lengths are in header.drawings.step meters. The prediction is the line or point of the same number in the frame
// before; if there is none, the one before in this frame, for a line with its beginning for both ends. So static lines
// cost zeros, which deflate to next to nothing. The column is empty if no frame has drawings.
#pragma once

#include <Fulcrum/Samples/Viewer/Recording.h>

#include <nlohmann/json.hpp>

#include <string>

namespace fulcrum {

// `step`: m, > 0.
std::string DrawingColumn(const Recording& recording, double step);

// The step, and the largest numbers of lines and points in a frame.
nlohmann::ordered_json DrawingHeader(const Recording& recording, double step);

}  // namespace fulcrum
