// What the page knows of curves, looks and the view. Called by PageData; Page/decodeFigures.js reads it.
//
// - header.figures: the names of the series, in their order; empty where frames have none
// - column figures: series after series, one 32 bit float a frame, low byte first
// - header.view: { color, from, lower, upper, picture, joints }
// - header.looks: [body, { look, teeth, velocity, turning, pivot }] of bodies that have one
#pragma once

#include <Fulcrum/Samples/Viewer/Recording.h>

#include <nlohmann/json.hpp>

#include <string>

namespace fulcrum {

nlohmann::ordered_json FigureNames(const Recording& recording);
std::string FigureColumn(const Recording& recording);
nlohmann::ordered_json ViewHeader(const RecordedView& view);
nlohmann::ordered_json LookHeader(const Recording& recording);

}  // namespace fulcrum
