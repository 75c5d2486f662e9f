// Impacts of many bodies at once, where most rows and patches change between their limits and the range between them:
// Newton's steps alone end at one kink after another, the interior point method finds the solution.
#include "DirectProblems.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum {
namespace {

using Outcome = DirectResult::Outcome;
using Point = std::array<double, 3>;
constexpr uint32_t kNone = DirectRow::kNone;
constexpr double kSpeedOfGravity = 9.81 / 240;  // m/s, gained in a substep

struct Impacts {
    explicit Impacts(uint32_t seed) : random(seed) { island.settings.tolerance = 1e-3 * kSpeedOfGravity; }

    double Between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

    // A cube that falls, and moves by up to a meter and a radian per second besides.
    uint32_t AddCube(double mass, double edge) {
        DirectColumn velocity;
        for (double& v : velocity) v = Between(-1, 1);
        velocity[1] -= kSpeedOfGravity;
        return island.AddBody(mass, mass * edge * edge / 6, velocity);
    }
    double ResponseOf(const DirectRow& row) const {
        double sum = 0;
        const auto add = [&](uint32_t body, const double(&j)[6]) {
            if (body == kNone) return;
            for (size_t k = 0; k < 6; ++k) sum += InverseMassOf(island.bodies[body], k) * j[k] * j[k];
        };
        add(row.a, row.ja);
        add(row.b, row.jb);
        return sum;
    }
    // B on A, or on the ground. corners: of the manifold, along t1 and t2 from its center. softness: gamma over J M^-1
    // J^T. The gap is in m.
    void AddContact(uint32_t a, uint32_t b, const Point& armA, const Point& armB, const Point& normal, double friction,
                    double softness, double gap, const std::vector<std::array<double, 2>>& corners) {
        const double across = std::hypot(normal[0], normal[1]);
        const Point t1{normal[1] / across, -normal[0] / across, 0};
        const Point t2{normal[1] * t1[2] - normal[2] * t1[1], normal[2] * t1[0] - normal[0] * t1[2],
                       normal[0] * t1[1] - normal[1] * t1[0]};
        const auto at = [&](const Point& arm, const std::array<double, 2>& corner) {
            Point result = arm;
            for (size_t k = 0; k < 3; ++k) result[k] += corner[0] * t1[k] + corner[1] * t2[k];
            return result;
        };
        const auto begin = static_cast<uint32_t>(island.rows.size());
        double radius = 0;
        for (const auto& corner : corners) {
            DirectRow& row = island.AddPoint(a, b, at(armA, corner), at(armB, corner), normal, 0);
            row.lo = 0;
            row.c = gap * 240;
            row.inverseGamma = 1 / (softness * ResponseOf(row));
            radius += std::hypot(corner[0], corner[1]) / static_cast<double>(corners.size());
        }
        for (const Point& t : {t1, t2}) island.AddPoint(a, b, armA, armB, t, 0);
        DirectColumn turnA{}, turnB{};
        for (size_t k = 0; k < 3; ++k) turnA[3 + k] = -(turnB[3 + k] = normal[k]);
        island.AddRow(a, b, turnA, turnB, 0, 0);
        DirectRow* tangents = &island.rows[island.rows.size() - 3];
        for (int k = 0; k < 3; ++k) tangents[k].inverseGamma = 1 / (softness * ResponseOf(tangents[k]));
        tangents[0].inverseGamma = tangents[1].inverseGamma =
            std::min(tangents[0].inverseGamma, tangents[1].inverseGamma);
        island.patches.push_back({begin, static_cast<uint32_t>(corners.size()), friction, radius});
    }

    struct Errors {
        // m/s: by how much the velocities differ from those by the impulses, and the rows' from what their impulses
        // say.
        double speed = 0;
        double excess = 0;      // m/s, of friction beyond its limit
        double direction = -1;  // cosine of friction and sliding: what slides is braked against its motion
    };
    Errors Largest() const {
        Errors largest;
        double& worst = largest.speed;
        std::vector<DirectColumn> velocity(island.bodies.size());
        for (size_t i = 0; i < velocity.size(); ++i) std::copy_n(island.bodies[i].velocity, 6, velocity[i].begin());
        const auto move = [&](uint32_t body, const double(&j)[6], double impulse) {
            if (body == kNone) return;
            for (size_t k = 0; k < 6; ++k) velocity[body][k] += InverseMassOf(island.bodies[body], k) * j[k] * impulse;
        };
        for (const DirectRow& row : island.rows) {
            move(row.a, row.ja, row.impulse);
            move(row.b, row.jb, row.impulse);
        }
        for (size_t i = 0; i < velocity.size(); ++i)
            for (size_t k = 0; k < 6; ++k)
                worst = std::max(worst, std::abs(velocity[i][k] - island.velocities[i].v[k]));
        std::vector<bool> isFriction(island.rows.size());
        for (const DirectPatch& patch : island.patches) {
            const uint32_t t = patch.firstNormal + patch.normals;
            double sum = 0;
            for (uint32_t r = patch.firstNormal; r < t; ++r) sum += island.rows[r].impulse;
            const DirectRow &x = island.rows[t], &y = island.rows[t + 1];
            const double speedX = island.RowSpeed(x), speedY = island.RowSpeed(y), limit = patch.friction * sum,
                         impulse = std::hypot(x.impulse, y.impulse), speed = std::hypot(speedX, speedY);
            largest.excess = std::max(largest.excess, (impulse - limit) * ResponseOf(x));
            if (speed > 0.01 && impulse > 0)
                largest.direction =
                    std::max(largest.direction, (x.impulse * speedX + y.impulse * speedY) / (impulse * speed));
            for (uint32_t k = 0; k < 3; ++k) isFriction[t + k] = true;
        }
        for (size_t r = 0; r < island.rows.size(); ++r) {
            const DirectRow& row = island.rows[r];
            if (isFriction[r]) continue;
            const double speed = island.RowSpeed(row), yields = row.impulse / row.inverseGamma;
            worst = std::max(worst, row.impulse > row.lo ? std::abs(speed + yields) : std::max(0.0, -speed));
        }
        return largest;
    }

    IslandOfRows island;
    std::mt19937 random;
};

const std::vector<std::array<double, 2>> kCorners = {{-0.4, -0.4}, {0.4, -0.4}, {0.4, 0.4}, {-0.4, 0.4}};

// A flat pyramid of cubes, every one of which moves.
void FillPyramid(Impacts& impacts, int base, double softness) {
    std::vector<uint32_t> below;
    for (int layer = 0; layer < base; ++layer) {
        std::vector<uint32_t> cubes;
        for (int i = 0; i < base - layer; ++i) {
            cubes.push_back(impacts.AddCube(1000, 1));
            const double gap = impacts.Between(0, 0.005);
            if (layer == 0)
                impacts.AddContact(kNone, cubes.back(), {}, {0, -0.5, 0}, {0, 1, 0}, 0.6, softness, gap, kCorners);
            for (int side = 0; side < (layer > 0 ? 2 : 0); ++side) {
                const double offset = side == 0 ? -0.275 : 0.275;
                impacts.AddContact(below[static_cast<size_t>(i + side)], cubes.back(), {-offset, 0.5, 0},
                                   {offset, -0.5, 0}, {0, 1, 0}, 0.6, softness, gap, kCorners);
            }
        }
        below = cubes;
    }
}

// A heap of cubes of masses over two decades, in contact with two others each, some jointed.
void FillHeap(Impacts& impacts, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t cube = impacts.AddCube(std::pow(10, impacts.Between(0, 2)), impacts.Between(0.1, 0.9));
        const auto arm = [&](double y) { return Point{impacts.Between(-0.2, 0.2), y, impacts.Between(-0.2, 0.2)}; };
        const bool isLow = i < std::max(count / 4, 1u);
        for (int k = 0; k < (isLow ? 1 : 2); ++k) {
            Point normal{impacts.Between(-0.5, 0.5), 1, impacts.Between(-0.5, 0.5)};
            const double length = std::sqrt(normal[0] * normal[0] + 1 + normal[2] * normal[2]);
            for (double& x : normal) x /= length;
            const uint32_t other = isLow ? kNone : static_cast<uint32_t>(impacts.random() % i);
            const double softness = 1e-3 / static_cast<double>(1u << impacts.random() % 12);
            std::vector<std::array<double, 2>> corners(kCorners.begin(), kCorners.begin() + 1 + impacts.random() % 4);
            for (auto& corner : corners)
                for (double& x : corner) x *= 0.5;
            const double friction = impacts.Between(0.3, 0.9), gap = impacts.Between(-0.003, 0.003);
            impacts.AddContact(other, cube, arm(0.3), arm(-0.3), normal, friction, softness, std::max(gap, 0.0),
                               corners);
        }
        if (i == 0 || impacts.random() % 3 != 0) continue;
        impacts.island.AddBall(static_cast<uint32_t>(impacts.random() % i), cube, {0.3, 0.2, 0}, {-0.3, 0.1, 0.1}, 1e7);
    }
}

TEST(DirectImpacts, PyramidsWhoseCubesAllMoveAreSolved) {
    for (const double softness : {1e-3, 1e-5, 1e-6})
        for (uint32_t seed = 1; seed <= 3; ++seed) {
            Impacts impacts(seed);
            FillPyramid(impacts, 10, softness);
            const DirectResult result = impacts.island.Solve();
            EXPECT_EQ(result.outcome, Outcome::Solved) << softness << ", seed " << seed;
            const Impacts::Errors largest = impacts.Largest();
            EXPECT_LT(largest.speed, 1e-3) << softness << ", seed " << seed;
            EXPECT_LT(largest.excess, 0.01) << softness << ", seed " << seed;
            EXPECT_LT(largest.direction, -0.99) << softness << ", seed " << seed;
        }
}

// Newton's steps alone solve 14 of 24, with 100 factorizations at most and 83 on average.
TEST(DirectImpacts, MostHeapsAreSolved) {
    int solved = 0;
    uint32_t factorizations = 0;
    constexpr uint32_t kHeaps = 24;
    for (uint32_t seed = 0; seed < kHeaps; ++seed) {
        Impacts impacts(seed);
        FillHeap(impacts, 5 + seed);
        impacts.island.settings.mostFactorizations = 100;
        const DirectResult result = impacts.island.Solve();
        factorizations += result.factorizations;
        if (result.outcome != Outcome::Solved) continue;
        ++solved;
        const Impacts::Errors largest = impacts.Largest();
        EXPECT_LT(largest.speed, 0.01) << "seed " << seed;
        EXPECT_LT(largest.direction, -0.9) << "seed " << seed;
    }
    EXPECT_GE(solved, 22);
    EXPECT_LT(factorizations, 50 * kHeaps);
}

}  // namespace
}  // namespace fulcrum
