// Penetration of the bodies of a scene, computed from shapes and poses only, independent of the engine's contacts. Used
// by Simulation after each step, outside of what is timed; one thread.
//
// The measure is the penetration depth of two bodies, over the inner radius of the smaller one (of the largest ball
// that fits inside). 1 means that a ball inside one body has its center on the other's surface; beyond that it is
// ambiguous on which side the body belongs. For a body whose center is behind the nearest triangle of a mesh or
// height field the depth is how far it must go along that triangle's normal.
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
    // Pairs that overlap before the first step by more than kStartsOverlapped count only after they have separated.
    explicit PenetrationMeter(const SceneWorld& world);

    // Measures the bodies at their current poses. Returns whether there is a new maximum.
    bool Measure();

    // The largest measured penetration, relative to the bodies' size.
    const Penetration& Worst() const { return worst_; }

private:
    struct Placed {
        uint32_t seenIn = 0;  // number of the measurement
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
