// The engine's shapes and kinds of motion as recordings have them. Free functions, any thread.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Samples/Viewer/Recording.h>

namespace fulcrum {

// Of every shape but compounds, which become one of no children. Spheres, capsules and boxes stay what they are; others
// become the triangles of the drawing interface (VisitTriangles), planes a square of 200 m, surfaces with their
// materials as looks.
RecordedShape RecordedShapeOf(const Shape& shape);

RecordedMotion RecordedMotionOf(MotionType motion);

}  // namespace fulcrum
