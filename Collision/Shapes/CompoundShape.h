// The base of Compound and MutableCompound: convex shapes, each at a pose of its own, and a tree of their AABBs.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

#include <span>
#include <vector>

namespace fulcrum {

class CompoundShape : public Shape {
public:
    ~CompoundShape() override;

    struct ChildSettings {
        ShapePtr shape;                      // convex; of a Compound, another compound, too
        Vector3 position = Vector3::Zero();  // of the child's user frame in the compound's user frame, m
        Quaternion rotation{};               // unit
        float density = 1;                   // relative to the other children's, > 0
    };
    struct Child {
        std::shared_ptr<const ConvexShape> shape;  // null: removed
        RelativePose pose;                         // of the child's center frame in the children's frame
        float density = 1;                         // as it was given
    };

    // By index; in a mutable compound some may have been removed.
    std::span<const Child> Children() const;
    const Child& ChildAt(uint32_t index) const { return children_[index]; }
    // The children's boxes in the children's frame, by index.
    const BoundsTree& Tree() const { return tree_; }
    // The origin of the children's frame in the center frame, m; axes are the same. Zero except for mutable compounds,
    // whose children keep their poses in the user's frame when the center of mass moves.
    Vector3 Origin() const {
        return type_ == ShapeType::Compound ? Vector3(Vector3::Zero()) : Vector3(-mass_.centerOfMass);
    }
    // In the center frame.
    RelativePose PoseOf(const Child& child) const { return {child.pose.position + Origin(), child.pose.rotation}; }
    // The settings that recreate the child.
    ChildSettings SettingsOf(const Child& child) const;
    // The settings that recreate the compound, without removed children.
    std::vector<ChildSettings> Settings() const;

protected:
    using Shape::Shape;
    // Errors: Unsupported (null; not convex, nor a compound where one may be), NonFinite, Unnormalized, NonPositive;
    // they begin with `name`.
    static Status Check(const ChildSettings& child, const char* name, bool mayBeCompound = false);
    // The child's box in the children's frame.
    static Bounds BoundsOf(const Child& child);

    // A shape may outlive the world that its thread is working on.
    static BoundsTree TreeOutsideOfWorlds() {
        const MemoryScope scope(nullptr);
        return {};
    }

    std::vector<Child> children_;
    BoundsTree tree_ = TreeOutsideOfWorlds();
};

}  // namespace fulcrum
