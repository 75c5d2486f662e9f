// The engine's shapes and kinds of motion as recordings have them. Free functions, any thread.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Samples/Viewer/Recording.h>

namespace fulcrum {

// Of every shape but compounds, which become one of no children. Curved shapes other than spheres and capsules become
// meshes, planes a square of 200 m, surfaces their triangles with their materials as looks.
RecordedShape RecordedShapeOf(const Shape& shape);

RecordedMotion RecordedMotionOf(MotionType motion);

}  // namespace fulcrum
