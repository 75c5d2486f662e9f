// Islands for the tests of the direct solver: bodies and rows in vectors, solved in one call.
#pragma once

#include "DirectGraphs.h"

#include <Fulcrum/Constraints/Direct/DirectSolver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace fulcrum {

using DirectColumn = std::array<double, 6>;

// 1/kg or 1/(kg m2), of a body with a diagonal inertia.
inline double InverseMassOf(const DirectBody& body, size_t k) {
    return k < 3 ? body.inverseMass : body.inverseInertia[k - 3];
}

struct IslandOfRows {
    std::vector<DirectBody> bodies;
    std::vector<DirectRow> rows;
    std::vector<DirectPatch> patches;
    std::vector<DirectStiffness> stiffness;
    std::vector<DirectVelocity> velocities;
    DirectSettings settings{.tolerance = 1e-10};
    bool isAtRest = false;
    DirectFactor factor;
    DirectPattern pattern;

    uint32_t AddBody(double mass, double inertia, const DirectColumn& velocity = {}) {
        DirectBody body{.velocity = {}, .inverseMass = 1 / mass, .inverseInertia = {}};
        std::copy(velocity.begin(), velocity.end(), body.velocity);
        for (int k = 0; k < 3; ++k) body.inverseInertia[k] = inertia > 0 ? 1 / inertia : 0;
        bodies.push_back(body);
        return static_cast<uint32_t>(bodies.size() - 1);
    }
    DirectRow& AddRow(uint32_t a, uint32_t b, const DirectColumn& ja, const DirectColumn& jb, double c,
                      double inverseGamma) {
        DirectRow row;
        row.a = a;
        row.b = b;
        std::copy(ja.begin(), ja.end(), row.ja);
        std::copy(jb.begin(), jb.end(), row.jb);
        row.c = c;
        row.inverseGamma = inverseGamma;
        rows.push_back(row);
        return rows.back();
    }
    // Velocity of point b over point a along `axis`, at arms from the centers.
    DirectRow& AddPoint(uint32_t a, uint32_t b, const std::array<double, 3>& armA, const std::array<double, 3>& armB,
                        const std::array<double, 3>& axis, double inverseGamma) {
        const auto jacobian = [&](const std::array<double, 3>& r, double sign) {
            return DirectColumn{sign * axis[0],
                                sign * axis[1],
                                sign * axis[2],
                                sign * (r[1] * axis[2] - r[2] * axis[1]),
                                sign * (r[2] * axis[0] - r[0] * axis[2]),
                                sign * (r[0] * axis[1] - r[1] * axis[0])};
        };
        return AddRow(a, b, jacobian(armA, -1), jacobian(armB, 1), 0, inverseGamma);
    }
    void AddBall(uint32_t a, uint32_t b, const std::array<double, 3>& armA, const std::array<double, 3>& armB,
                 double inverseGamma) {
        for (size_t k = 0; k < 3; ++k) {
            std::array<double, 3> axis{};
            axis[k] = 1;
            AddPoint(a, b, armA, armB, axis, inverseGamma);
        }
    }

    void FindPattern() {
        pattern = *FindDirectPattern(static_cast<uint32_t>(bodies.size()), DirectEdgesOf(rows, arena_), arena_);
        factor = MakeDirectFactor(pattern, arena_);
        velocities.assign(bodies.size(), {});
    }
    // With the factor of the last solution, if there is one.
    DirectResult SolveAgain() {
        return SolveDirectly({bodies, rows, patches, stiffness, isAtRest}, pattern, settings, factor, velocities,
                             arena_);
    }
    DirectResult Solve() {
        FindPattern();
        return SolveAgain();
    }
    double RowSpeed(const DirectRow& row) const {
        double speed = row.c;
        for (int k = 0; k < 6; ++k) {
            if (row.a != DirectRow::kNone) speed += row.ja[k] * velocities[row.a].v[k];
            if (row.b != DirectRow::kNone) speed += row.jb[k] * velocities[row.b].v[k];
        }
        return speed;
    }

private:
    ScratchArena arena_;
};

// Bodies of diagonal inertia; joints, limits, motors and springs between them and to the ground.
inline void FillRandomIsland(IslandOfRows& island, uint32_t seed, bool hasBias) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const auto column = [&] {
        DirectColumn result;
        for (double& x : result) x = uniform(-1, 1);
        return result;
    };
    const uint32_t count = 2 + seed % 9;
    for (uint32_t i = 0; i < count; ++i) island.AddBody(std::exp(uniform(-2, 4)), std::exp(uniform(-3, 2)), column());
    for (DirectEdge edge : RandomEdges(count, 2 * count, seed)) {
        if (uniform(0, 1) < 0.2) edge.b = DirectRow::kNone;
        const int rows = 1 + static_cast<int>(random() % 4);
        for (int i = 0; i < rows; ++i) {
            DirectRow& row = island.AddRow(edge.a, edge.b, column(), column(), hasBias ? uniform(-1, 1) : 0,
                                           std::exp(uniform(-2, 7)));
            const auto kind = random() % 3;
            if (kind == 1) row.lo = 0;
            if (kind == 2) row.lo = -(row.hi = uniform(0, 2));
        }
    }
}

}  // namespace fulcrum
