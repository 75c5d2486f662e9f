// Static compound of convex shapes, each at a pose of its own. The broad phase sees each child by itself, so that a pair
// of bodies carries one manifold per touching pair of children.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <span>
#include <vector>

namespace fulcrum {

class Compound final : public Shape {
public:
    struct ChildSettings {
        ShapePtr shape;                         // convex
        Vector3 position = Vector3::Zero();     // of the child's user frame in the compound's user frame, m
        Quaternion rotation{};                  // unit
        float density = 1;                      // relative to the other children's, > 0
    };
    struct Child {
        std::shared_ptr<const ConvexShape> shape;
        RelativePose pose;  // of the child's centre frame in the compound's centre frame
    };

    // Mass is the sum of the children's (overlaps count twice), scaled so that the whole has density 1 on average.
    // InnerRadius is the smallest child's: no child may pass through a surface unseen.
    // Errors: Degenerate (no child), Unsupported (null or not convex child), NonFinite, Unnormalized, NonPositive,
    // OutOfRange (the inertia is no normal float).
    static Result<std::shared_ptr<const Compound>> Create(std::span<const ChildSettings> children);

    std::span<const Child> Children() const { return children_; }

private:
    Compound() : Shape(ShapeType::Compound) {}
    std::vector<Child> children_;
};

}  // namespace fulcrum
