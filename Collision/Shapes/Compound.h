// Static compound of convex shapes, each at a pose of its own. The broad phase sees each child by itself, so that a pair
// of bodies carries one manifold per touching pair of children.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
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
        float density;      // as it was given
    };

    // Mass is the sum of the children's (overlaps count twice), scaled so that the whole has density 1 on average.
    // `centreOffset`, m, moves the centre of mass from there, as ballast would; the inertia is then that about the new centre
    // (parallel axes). InnerRadius is the smallest child's: no child may pass through a surface unseen.
    // Errors: Degenerate (no child), Unsupported (null or not convex child), NonFinite, Unnormalized, NonPositive,
    // OutOfRange (the inertia is no normal float).
    static Result<std::shared_ptr<const Compound>> Create(std::span<const ChildSettings> children,
                                                          const Vector3& centreOffset = Vector3::Zero());
    // What this compound was made of, for making another.
    std::vector<ChildSettings> Settings() const;

    std::span<const Child> Children() const { return children_; }
    // The children's boxes in the compound's centre frame, by index.
    const BoundsTree& Tree() const { return tree_; }

private:
    friend struct ShapeFileAccess;
    void Assemble(std::vector<Child> children, const MassProperties& mass);

    Compound() : Shape(ShapeType::Compound) {}
    std::vector<Child> children_;
    BoundsTree tree_;
};

}  // namespace fulcrum
