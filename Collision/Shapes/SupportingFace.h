// The feature of a convex core that faces a direction: a flat face, a straight edge or a point. Filled by shapes,
// clipped by the narrow phase. Lives on the stack of one call.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

struct SupportingFace {
    static constexpr int kMaxVertices = 32;

    int count = 0;                   // 1: a point, 2: an edge, more: a face, counter-clockwise seen from outside
    Vector3 vertices[kMaxVertices];  // of the core, in the shape's center frame, m
    uint16_t names[kMaxVertices];    // vertex ids, the same from step to step while the same feature touches
    Vector3 normal;                  // unit, outwards; of a face only
    // Of a point: the other end of the edge that faces the direction once the shape has tipped over, if it has one.
    bool hasAhead = false;
    uint16_t aheadName;
    Vector3 ahead;

    void Add(const Vector3& vertex, int name) {
        vertices[count] = vertex;
        names[count++] = static_cast<uint16_t>(name);
    }
    void AddAhead(const Vector3& vertex, int name) {
        hasAhead = true;
        ahead = vertex;
        aheadName = static_cast<uint16_t>(name);
    }
};

}  // namespace fulcrum
