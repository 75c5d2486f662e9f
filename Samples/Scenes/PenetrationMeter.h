// How deep bodies of a scene overlap, by their shapes and poses alone: what the engine found, or missed, has no say.
// Used by Simulation after each step, outside of what is timed; one thread.
//
// The measure is the least move that parts two bodies, over the inner radius of the smaller one: that of the largest
// ball that fits inside. 1 means that a ball inside one body has its center on the other's surface; beyond that nobody
// knows any more on which side it belongs. A body whose center is behind a mesh or height field has sunk by as much as
// it must rise.
#pragma once

#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <set>
#include <utility>

namespace fulcrum {

struct Penetration {
    double relative = 0;  // depth over the smaller inner radius
    double depth = 0;     // m
    BodyId bodyA, bodyB;
    int step = 0;
};

class PenetrationMeter {
public:
    // What overlaps before the first step by more than kStartsOverlapped counts from when it has come apart.
    explicit PenetrationMeter(const SceneWorld& world);

    // Looks at the bodies where they are now. Returns whether that is the worst so far.
    bool Measure();

    // The largest of all that was measured, relative to the bodies' size.
    const Penetration& Worst() const { return worst_; }

private:
    struct Placed {
        uint32_t seenIn = 0;  // round of measuring
        BodyId id;
        ShapePtr shape;
        Pose center;  // of the shape's center frame
    };
    using Pair = std::pair<BodyId, BodyId>;

    const Placed& Place(BodyId id);
    bool IsMobile(BodyId id, bool first) const;
    void FindAll(bool first);
    void MeasurePair(const Placed& a, const Placed& b, bool first);

    const SceneWorld& world_;
    uint32_t round_ = 0;
    std::vector<BodyId> mobile_;  // dynamic and awake
    std::vector<Placed> bodies_;  // by index
    std::vector<OverlapHit> near_;
    std::set<Pair> overlapped_;  // since the start
    Penetration worst_;
};

}  // namespace fulcrum
