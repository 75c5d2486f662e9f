// Static compound of convex shapes, each at a pose of its own. Each child is a collider of its own in the broad phase,
// so that a pair of bodies has one manifold per touching pair of children.
#pragma once

#include <Fulcrum/Collision/Shapes/CompoundShape.h>

namespace fulcrum {

class Compound final : public CompoundShape {
public:
    ~Compound() override;

    // Mass is the sum of the children's (overlaps count twice), scaled so that the whole has density 1 on average.
    // `centerOffset`, m, moves the center of mass from there, as ballast would; the inertia is then that about the new
    // center (parallel axes). InnerRadius is the smallest child's, since continuous collision must stop the thinnest.
    // A child that is a compound is replaced by its children, with consecutive indices; its mass is that of the
    // compound, with its center offset, at the density given here. A mutable one is copied in its present state.
    // Errors: Degenerate (no child), Unsupported (null child, or one that is neither convex nor a compound), NonFinite,
    // Unnormalized, NonPositive, OutOfRange (the inertia is no normal float).
    static Result<std::shared_ptr<const Compound>> Create(std::span<const ChildSettings> children,
                                                          const Vector3& centerOffset = Vector3::Zero());

private:
    friend struct ShapeFileAccess;
    void Assemble(std::vector<Child> children, const MassProperties& mass);

    Compound();
};

}  // namespace fulcrum
