// A shape without geometry, for bodies that touch nothing: anchors, frames of reference, links that only joints hold.
// Immutable.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// Its mass properties are those of a ball of 1 m3 about the origin: give bodies a mass and inertia of their own.
class EmptyShape final : public Shape {
public:
    static std::shared_ptr<const EmptyShape> Create();

private:
    EmptyShape() : Shape(ShapeType::Empty) {}
};

}  // namespace fulcrum
