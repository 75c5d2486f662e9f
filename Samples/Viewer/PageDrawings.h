// A recording's lines and points as a column of a page, in the varints of PageData.h. Called by PageData.
// Page/decodeDrawings.js reads it.
//
//   drawings  per frame: number of lines; per line the differences of color, both ends x y z to what is expected;
//   number of
//             points; per point those of color, x y z
// Lengths are in header.drawings.step meters. Expected is the line or point of the same number in the frame before;
// where that has fewer, the one before in this frame, of a line its beginning for both ends. So what stands still costs
// zeros, which deflate to next to nothing. The column is empty where nothing is drawn in any frame.
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
