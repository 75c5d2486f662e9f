// Graphs of bodies for the tests of the direct solver.
#pragma once

#include <Fulcrum/Constraints/Direct/DirectPattern.h>

#include <random>
#include <vector>

namespace fulcrum {

using DirectEdges = std::vector<DirectEdge>;

inline DirectEdges ChainEdges(uint32_t bodies) {
    DirectEdges edges;
    for (uint32_t i = 1; i < bodies; ++i) edges.push_back({i - 1, i});
    return edges;
}
// Body i hangs on one before it.
inline DirectEdges TreeEdges(uint32_t bodies, uint32_t seed) {
    std::mt19937 random(seed);
    DirectEdges edges;
    for (uint32_t i = 1; i < bodies; ++i) edges.push_back({static_cast<uint32_t>(random() % i), i});
    return edges;
}
inline DirectEdges GridEdges(uint32_t width, uint32_t height) {
    DirectEdges edges;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            if (x > 0) edges.push_back({y * width + x - 1, y * width + x});
            if (y > 0) edges.push_back({y * width + x, (y - 1) * width + x});
        }
    return edges;
}
// Any, and some of them twice.
inline DirectEdges RandomEdges(uint32_t bodies, uint32_t count, uint32_t seed) {
    std::mt19937 random(seed);
    DirectEdges edges;
    while (edges.size() < count) {
        const DirectEdge edge{static_cast<uint32_t>(random() % bodies), static_cast<uint32_t>(random() % bodies)};
        if (edge.a != edge.b) edges.push_back(edge);
    }
    return edges;
}

}  // namespace fulcrum
