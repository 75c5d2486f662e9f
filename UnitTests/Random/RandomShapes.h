// Shapes of random kinds and sizes; null if the sizes were refused.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/UnitTests/Random/Values.h>

namespace fulcrum::testing {

ShapePtr RandomConvex(Values& values);
// Of any type; a compound has children of any convex type.
ShapePtr RandomShape(Values& values);
// One that may be dynamic.
ShapePtr RandomSolid(Values& values);

}  // namespace fulcrum::testing
