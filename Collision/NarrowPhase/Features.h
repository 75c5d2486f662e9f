// Feature ids of contact points, which stay the same while the same features touch. Used by the contact builders.
#pragma once

#include <cstdint>

namespace fulcrum {

// Two bits of kind above thirty of contents; never 0.
inline constexpr uint32_t kVertexOfA = 1u << 30, kVertexOfB = 2u << 30, kCrossing = 3u << 30;
// The inner ball of a shape (InnerBall.h).
inline constexpr uint32_t kInnerBall = 1;

// Vertex `v` of A (or B) against a face of the other.
inline uint32_t VertexFeature(bool ofA, uint32_t v) { return (ofA ? kVertexOfA : kVertexOfB) | v; }

// The edge between two vertices, the same in both directions.
inline uint32_t EdgeName(uint32_t v0, uint32_t v1) { return v0 < v1 ? v0 | v1 << 8 : v1 | v0 << 8; }

// An edge of A across an edge of B, by their names. A hash: if two pairs collide, two points may swap their accumulated
// impulses.
inline uint32_t CrossingFeature(uint32_t edgeOfA, uint32_t edgeOfB) {
    return kCrossing | ((edgeOfA * 0x9E3779B1u ^ edgeOfB * 0x85EBCA6Bu) >> 2);
}

// Vertices and edges of a polyhedron's face, or of a segment or point; edge i goes from corner i to the next.
struct FaceNames {
    const uint8_t* corners;  // null: corner i is vertex i
    uint32_t count;

    uint32_t Vertex(uint32_t i) const { return corners != nullptr ? corners[i] : i; }
    uint32_t Edge(uint32_t i) const { return EdgeName(Vertex(i), Vertex(i + 1 == count ? 0 : i + 1)); }
};

}  // namespace fulcrum
