// What tests of snapshots share: bytes of a world, and what a world names that its snapshots do not contain.
#pragma once

#include <Fulcrum/UnitTests/Support/JointScene.h>

#include <algorithm>

namespace fulcrum::testing {

using Bytes = std::vector<std::byte>;

// Fails the test where saving does.
inline Bytes SnapshotOf(const PhysicsSystem& system) {
    Bytes bytes;
    const Status saved = system.SaveSnapshot(bytes);
    if (!saved) ADD_FAILURE() << saved.GetError().message;
    return bytes;
}

// The shapes and group filters of all bodies, and the joint scene's own type of joint.
struct Assets {
    std::vector<ShapePtr> shapes;
    std::vector<std::shared_ptr<const GroupFilter>> filters;

    explicit Assets(const PhysicsSystem& system) {
        system.VisitBodies([&](BodyId id) {
            shapes.push_back(system.Bodies().GetShape(id));
            const auto filter = system.Bodies().GetGroup(id).filter;
            if (filter && std::ranges::find(filters, filter) == filters.end()) filters.push_back(filter);
        });
    }
    SnapshotSources All() const {
        return {.shapes = shapes, .groupFilters = filters, .makeJoint = [](JointId) { return MakeScrew(); }};
    }
};

}  // namespace fulcrum::testing
