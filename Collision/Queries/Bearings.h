// What a moving shape rests on at the start of a cast with ignoreSeparating: planes along which, or away from which, it
// moves. A piece of the world that lies entirely below one of them only continues the floor, or the wall, on which the
// shape stands or glides: the shape, which does not get deeper below the plane than it is, cannot hit it. The narrow
// phase has the same rule for contacts (RemoveSeamContacts), with the same tolerance.
//
// The answer does not depend on the order in which planes are added. Allocates memory only when a thread needs more
// than ever before.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <vector>

namespace fulcrum {

class Bearings {
public:
    Bearings();
    ~Bearings();
    Bearings(const Bearings&) = delete;
    Bearings& operator=(const Bearings&) = delete;

    // The plane normal . (x - center of the moving shape at the start) = height, in m; unit normal, world axes.
    void Add(const Vector3& normal, float height);
    // After all were added: keeps one of those that are nearly the same.
    void Merge();
    // Whether a shape whose center frame is at `pose` relative to that center lies at most `flush` m above a plane.
    bool Hide(const ConvexShape& shape, const Pose& pose, float flush) const;

private:
    struct Plane {
        Vector3 normal;
        float height;
    };
    std::vector<Plane> planes_;
};

}  // namespace fulcrum
