// Direct solutions of islands against closed forms, brute force over active sets, and the conditions of the minimum.
#include "DirectProblems.h"

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum {
namespace {

using Outcome = DirectResult::Outcome;
constexpr uint32_t kNone = DirectRow::kNone;

// x of a x = b, by elimination with pivots.
std::vector<double> SolveDense(std::vector<std::vector<double>> a, std::vector<double> b) {
    const size_t n = b.size();
    for (size_t k = 0; k < n; ++k) {
        size_t pivot = k;
        for (size_t i = k; i < n; ++i)
            if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
        std::swap(a[k], a[pivot]);
        std::swap(b[k], b[pivot]);
        for (size_t i = k + 1; i < n; ++i) {
            const double times = a[i][k] / a[k][k];
            for (size_t j = k; j < n; ++j) a[i][j] -= times * a[k][j];
            b[i] -= times * b[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
    return b;
}

double MassOf(const DirectBody& body, int k) { return 1 / InverseMassOf(body, static_cast<size_t>(k)); }

double Energy(const IslandOfRows& island, bool isBefore) {
    double energy = 0;
    for (size_t i = 0; i < island.bodies.size(); ++i)
        for (int k = 0; k < 6; ++k) {
            const double v = isBefore ? island.bodies[i].velocity[k] : island.velocities[i].v[k];
            energy += 0.5 * MassOf(island.bodies[i], k) * v * v;
        }
    return energy;
}

// M (v - v*) = J^T impulses, and each impulse is the row's function of its velocity.
TEST(DirectSolver, EndsAtTheMinimum) {
    for (uint32_t seed = 0; seed < 200; ++seed) {
        IslandOfRows island;
        FillRandomIsland(island, seed, true);
        island.settings.tolerance = 1e-8;
        island.settings.mostFactorizations = 100;
        const DirectResult result = island.Solve();
        ASSERT_EQ(result.outcome, Outcome::Solved) << seed;
        EXPECT_LE(result.residual, 1e-8);
        std::vector<DirectColumn> force(island.bodies.size());
        for (size_t i = 0; i < island.bodies.size(); ++i)
            for (int k = 0; k < 6; ++k)
                force[i][k] = MassOf(island.bodies[i], k) * (island.velocities[i].v[k] - island.bodies[i].velocity[k]);
        for (const DirectRow& row : island.rows) {
            const double expected = std::clamp(-row.inverseGamma * island.RowSpeed(row), row.lo, row.hi);
            // The velocities' rounding, over gamma of down to e^-12.
            EXPECT_NEAR(row.impulse, expected, 1e-9) << seed;
            for (int k = 0; k < 6; ++k) {
                if (row.a != kNone) force[row.a][k] -= row.ja[k] * row.impulse;
                if (row.b != kNone) force[row.b][k] -= row.jb[k] * row.impulse;
            }
        }
        // Masses are at most e^4 kg, and the torque's scale is at most that of the mass times 3.
        for (const DirectColumn& f : force)
            for (const double x : f) EXPECT_NEAR(x, 0, 1e-8 * 200) << seed;
    }
}

TEST(DirectSolver, AddsNoEnergyWithoutBias) {
    for (uint32_t seed = 0; seed < 200; ++seed) {
        IslandOfRows island;
        FillRandomIsland(island, seed, false);
        for (DirectRow& row : island.rows) row.inverseGamma *= 1e3;
        island.settings.tolerance = 1e-6;
        island.settings.mostFactorizations = 200;
        ASSERT_EQ(island.Solve().outcome, Outcome::Solved) << seed;
        EXPECT_LE(Energy(island, false), Energy(island, true) * (1 + 1e-6)) << seed;
    }
}

// A chain that hangs straight down, with every joint twice. The vertical velocities u fulfil
//     m (u + g h) = impulse of the joint above - impulse of the joint below,    impulse = 2 d (u above - u)
TEST(DirectSolver, ChainWithHeavyEndAndDoubledJointsIsExact) {
    constexpr uint32_t kLinks = 100;
    constexpr double kFall = 9.81 / 240, kD = 1e6;
    IslandOfRows island;
    island.settings.tolerance = 1e-9;
    std::vector<std::vector<double>> a(kLinks, std::vector<double>(kLinks));
    std::vector<double> b(kLinks);
    for (uint32_t i = 0; i < kLinks; ++i) {
        const double mass = i + 1 == kLinks ? 1e4 : 1;
        island.AddBody(mass, 0.1 * mass, {0, 0, -kFall, 0, 0, 0});
        for (int twice = 0; twice < 2; ++twice) island.AddBall(i > 0 ? i - 1 : kNone, i, {0, 0, -0.5}, {0, 0, 0.5}, kD);
        a[i][i] += mass + 2 * kD;
        if (i > 0) {
            a[i][i - 1] = a[i - 1][i] = -2 * kD;
            a[i - 1][i - 1] += 2 * kD;
        }
        b[i] = -mass * kFall;
    }
    const DirectResult result = island.Solve();
    ASSERT_EQ(result.outcome, Outcome::Solved);
    EXPECT_EQ(result.factorizations, 1u);
    const std::vector<double> expected = SolveDense(a, b);
    for (uint32_t i = 0; i < kLinks; ++i) {
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(island.velocities[i].v[k], k == 2 ? expected[i] : 0, 1e-9);
        const double above = i > 0 ? expected[i - 1] : 0;
        for (uint32_t r = 6 * i + 2; r < 6 * i + 6; r += 3)
            EXPECT_NEAR(island.rows[r].impulse, kD * (above - expected[i]), 1e-9 * 1e4);
    }
}

// Two boxes, one on the other on the ground, four corners each: of the 256 sets of rows that hold, the one in which all
// of them push and all others separate.
TEST(DirectSolver, ContactsAgreeWithBruteForceOverActiveSets) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 20; ++round) {
        IslandOfRows island;
        for (int i = 0; i < 2; ++i) {
            DirectColumn velocity;
            for (double& v : velocity) v = uniform(random);
            velocity[2] -= 0.5;
            island.AddBody(i == 0 ? 1 : std::exp(3 * uniform(random)), 0.2, velocity);
        }
        for (uint32_t b = 0; b < 2; ++b)
            for (const double x : {-0.5, 0.5})
                for (const double y : {-0.5, 0.5}) {
                    DirectRow& row = island.AddPoint(b == 0 ? kNone : 0, b, {x, y, 0.5}, {x, y, -0.5}, {0, 0, 1}, 1e3);
                    row.lo = 0;
                    row.c = 0.1 * uniform(random);
                }
        ASSERT_EQ(island.Solve().outcome, Outcome::Solved);

        int found = 0;
        for (uint32_t set = 0; set < 256; ++set) {
            std::vector<std::vector<double>> h(12, std::vector<double>(12));
            std::vector<double> right(12);
            for (size_t i = 0; i < 12; ++i) {
                h[i][i] = MassOf(island.bodies[i / 6], static_cast<int>(i % 6));
                right[i] = h[i][i] * island.bodies[i / 6].velocity[i % 6];
            }
            const auto jacobian = [](const DirectRow& row) {
                std::array<double, 12> j{};
                for (size_t k = 0; k < 6; ++k) {
                    if (row.a != kNone) j[6 * row.a + k] = row.ja[k];
                    j[6 * row.b + k] = row.jb[k];
                }
                return j;
            };
            for (size_t r = 0; r < 8; ++r) {
                if (!(set >> r & 1)) continue;
                const DirectRow& row = island.rows[r];
                const auto j = jacobian(row);
                for (size_t i = 0; i < 12; ++i) {
                    right[i] -= row.inverseGamma * row.c * j[i];
                    for (size_t k = 0; k < 12; ++k) h[i][k] += row.inverseGamma * j[i] * j[k];
                }
            }
            const std::vector<double> v = SolveDense(h, right);
            bool fits = true;
            for (size_t r = 0; r < 8; ++r) {
                double speed = island.rows[r].c;
                const auto j = jacobian(island.rows[r]);
                for (size_t i = 0; i < 12; ++i) speed += j[i] * v[i];
                fits &= (speed < 0) == (set >> r & 1);
            }
            if (!fits) continue;
            ++found;
            for (size_t i = 0; i < 12; ++i) EXPECT_NEAR(island.velocities[i / 6].v[i % 6], v[i], 1e-9);
        }
        EXPECT_EQ(found, 1);
    }
}

// ---- Friction: a block of 2 kg on a slope, x down along it, z its normal ----

constexpr double kFall = 9.81 / 240;

struct Block {
    Block(double angle, double friction, double spin = 0, double twistRadius = 0.1) {
        island.AddBody(2, 0.5, {kFall * std::sin(angle), 0, -kFall * std::cos(angle), 0, 0, spin});
        island.AddPoint(kNone, 0, {}, {}, {0, 0, 1}, 1e3).lo = 0;
        island.AddPoint(kNone, 0, {}, {}, {1, 0, 0}, 1e3);
        island.AddPoint(kNone, 0, {}, {}, {0, 1, 0}, 1e3);
        island.AddRow(kNone, 0, {}, {0, 0, 0, 0, 0, 1}, 0, 1e3);
        island.patches.push_back({0, 1, friction, twistRadius});
    }
    double Normal() const { return island.rows[0].impulse; }
    const double* Velocity() const { return island.velocities[0].v; }
    IslandOfRows island;
};

TEST(DirectSolver, BlockSticksWithinTheConeAndDoesNotCreep) {
    Block block(0.5, std::tan(0.5) * 1.01);
    for (int i = 0; i < 5; ++i) {
        const DirectResult result = block.island.Solve();
        ASSERT_EQ(result.outcome, Outcome::Solved);
        EXPECT_TRUE(result.limitsAgree);
    }
    EXPECT_NEAR(block.Velocity()[0], 0, 1e-9);
    EXPECT_NEAR(block.island.rows[1].impulse, -2 * kFall * std::sin(0.5), 1e-9);
    // gamma takes d / (d + m) of it.
    EXPECT_NEAR(block.Normal(), 2 * kFall * std::cos(0.5) * 1000 / 1002, 1e-9);
}

// At rest each solution takes over what the one before has found, and leaves 2 / 1002 of the rest.
TEST(DirectSolver, BlockAtRestDoesNotSink) {
    Block block(0.5, std::tan(0.5) * 1.01);
    block.island.isAtRest = true;
    const double weight = 2 * kFall * std::cos(0.5);
    double left = weight;
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(block.island.Solve().outcome, Outcome::Solved);
        left *= 2.0 / 1002;
        EXPECT_NEAR(block.Normal(), weight - left, 1e-9) << i;
        EXPECT_NEAR(block.Velocity()[2], -left / 2, 1e-9) << i;
    }
}

// A rounding of a stiff row's impulse is a large change of its velocity. The last impulses tell that the second row,
// which hardly carries anything, is not at its limit: else it would take another factorization to find out.
TEST(DirectSolver, WhatRestsTakesOneFactorization) {
    for (int i = 0; i < 8; ++i) {
        const double load = 1 + 0.05 * i;
        Block block(0, 1);
        block.island.bodies[0].velocity[2] *= load;
        std::vector<DirectRow>& rows = block.island.rows;
        rows.insert(rows.begin() + 1, rows.front());
        block.island.patches.front().normals = 2;
        for (DirectRow& row : rows) row.inverseGamma = 1e7;
        rows[1].c = 2 * kFall * load / rows[0].inverseGamma * (1 - 1e-5);
        ASSERT_EQ(block.island.Solve().outcome, Outcome::Solved);
        ASSERT_GT(rows[1].impulse, 0);
        ASSERT_LT(rows[1].impulse, 1e-5 * rows[0].impulse);
        for (DirectRow& row : rows) row.impulse = double{static_cast<float>(row.impulse)};
        block.island.factor.isValid = false;
        const DirectResult result = block.island.SolveAgain();
        EXPECT_EQ(result.outcome, Outcome::Solved);
        EXPECT_EQ(result.factorizations, 1u) << i;
    }
}

TEST(DirectSolver, BlockSlidesOutsideOfTheCone) {
    for (const double friction : {0.01, 0.3, std::tan(0.5) * 0.999}) {
        Block block(0.5, friction);
        const DirectResult result = block.island.Solve();
        ASSERT_EQ(result.outcome, Outcome::Solved);
        EXPECT_TRUE(result.limitsAgree);
        const double normal = 2 * kFall * std::cos(0.5) * 1000 / 1002;
        EXPECT_NEAR(block.Normal(), normal, 1e-9);
        EXPECT_NEAR(block.Velocity()[0], kFall * std::sin(0.5) - friction * normal / 2, 1e-9);
        EXPECT_NEAR(block.island.rows[1].impulse, -friction * normal, 1e-9);
        EXPECT_NEAR(block.Velocity()[1], 0, 1e-9);
    }
}

// At the limit of the cone the tangents need as much as they get.
TEST(DirectSolver, BlockAtTheLimitOfTheConeIsAtRest) {
    Block block(0.5, std::tan(0.5) * 1002 / 1000);
    for (int i = 0; i < 5; ++i) ASSERT_EQ(block.island.Solve().outcome, Outcome::Solved);
    EXPECT_NEAR(block.Velocity()[0], 0, 1e-9);
}

TEST(DirectSolver, FrictionIsIsotropic) {
    for (int i = 0; i < 16; ++i) {
        const double direction = 0.4 * i;
        Block block(0, 0.4);
        double* v = block.island.bodies[0].velocity;
        v[0] = 3 * std::cos(direction);
        v[1] = 3 * std::sin(direction);
        ASSERT_EQ(block.island.Solve().outcome, Outcome::Solved);
        const double speed = 3 - 0.4 * block.Normal() / 2;
        EXPECT_NEAR(block.Velocity()[0], speed * std::cos(direction), 1e-9);
        EXPECT_NEAR(block.Velocity()[1], speed * std::sin(direction), 1e-9);
    }
}

TEST(DirectSolver, TwistIsLimitedByItsRadius) {
    for (const double spin : {-4.0, 4.0}) {
        Block block(0, 0.6, spin);
        ASSERT_EQ(block.island.Solve().outcome, Outcome::Solved);
        const double limit = 0.6 * 0.1 * block.Normal();
        EXPECT_NEAR(block.Velocity()[5], spin - std::copysign(limit, spin) / 0.5, 1e-9);
    }
    Block slow(0, 0.6, 0.001);
    for (int i = 0; i < 5; ++i) ASSERT_EQ(slow.island.Solve().outcome, Outcome::Solved);
    EXPECT_NEAR(slow.Velocity()[5], 0, 1e-9);
    Block without(0, 0.6, 4, 0);
    ASSERT_EQ(without.island.Solve().outcome, Outcome::Solved);
    EXPECT_EQ(without.Velocity()[5], 4);
}

// ---- Limits, locks, stiffness ----

// I (w - w*) = clamp(d (target - w), -limit, limit)
TEST(DirectSolver, MotorReachesItsSpeedOrItsLimit) {
    for (const double limit : {0.1, 0.5, 0.7, 10.0}) {
        IslandOfRows island;
        island.AddBody(1, 0.25, {});
        DirectRow& motor = island.AddRow(kNone, 0, {}, {0, 0, 0, 1, 0, 0}, -2, 1e4);
        motor.lo = -limit;
        motor.hi = limit;
        ASSERT_EQ(island.Solve().outcome, Outcome::Solved);
        const double expected = std::min(limit / 0.25, 2 * 1e4 / (1e4 + 0.25));
        EXPECT_NEAR(island.velocities[0].v[3], expected, 1e-9);
        EXPECT_NEAR(island.rows[0].impulse, 0.25 * expected, 1e-9);
    }
}

TEST(DirectSolver, LockedDirectionsDoNotMove) {
    IslandOfRows island;
    island.AddBody(2, 0.5, {1, 2, 3, 0, 0, 0});
    island.bodies[0].lockedAxes = 0b010;
    // Only rotation about (0.6, 0.8, 0): 3 u u^T.
    const double inverse[6] = {3 * 0.36, 3 * 0.64, 0, 3 * 0.48, 0, 0};
    std::copy_n(inverse, 6, island.bodies[0].inverseInertia);
    island.AddRow(kNone, 0, {}, {1, 1, 0, 1, 0, 1}, 0, 1e5);
    ASSERT_EQ(island.Solve().outcome, Outcome::Solved);
    // The row moves x with 1 / 2 kg, and rotation with 0.6^2 * 3.
    const double impulse = -3 / (1e-5 + 0.5 + 3 * 0.36);
    const double* v = island.velocities[0].v;
    EXPECT_NEAR(v[0], 1 + impulse / 2, 1e-9);
    EXPECT_EQ(v[1], 2);
    EXPECT_EQ(v[2], 3);
    EXPECT_NEAR(v[3], 3 * 0.36 * impulse, 1e-9);
    EXPECT_NEAR(v[4], 3 * 0.48 * impulse, 1e-9);
    EXPECT_EQ(v[5], 0);
}

TEST(DirectSolver, BodiesThatCannotMoveKeepTheirVelocity) {
    IslandOfRows island;
    island.AddBody(1, 1, {0, 0, -1, 0, 0, 0});
    island.bodies[0].inverseMass = 0;
    for (double& x : island.bodies[0].inverseInertia) x = 0;
    island.AddBall(kNone, 0, {}, {1, 0, 0}, 1e6);
    ASSERT_EQ(island.Solve().outcome, Outcome::Solved);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(island.velocities[0].v[k], k == 2 ? -1 : 0);
}

// (I + G) w = I w*
TEST(DirectSolver, StiffnessHoldsRotationBack) {
    IslandOfRows island;
    island.AddBody(1, 0.5, {0, 0, 0, 1, 2, 3});
    island.stiffness.push_back({0, {0.1, 0.2, 0.3, 0.05, -0.1, 0.02}});
    ASSERT_EQ(island.Solve().outcome, Outcome::Solved);
    const std::vector<double> expected =
        SolveDense({{0.6, 0.05, -0.1}, {0.05, 0.7, 0.02}, {-0.1, 0.02, 0.8}}, {0.5, 1, 1.5});
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(island.velocities[0].v[3 + k], expected[k], 1e-9);
}

// ---- What it says ----

TEST(DirectSolver, UsesAnOldFactorWhereThatSuffices) {
    IslandOfRows island;
    for (uint32_t i = 0; i < 20; ++i) {
        island.AddBody(1, 0.1, {0.01 * i, 0, -0.1, 0, 0, 0});
        island.AddBall(i > 0 ? i - 1 : kNone, i, {0.5, 0, 0}, {-0.5, 0, 0}, 1e6);
    }
    island.settings.tolerance = 1e-8;
    EXPECT_EQ(island.Solve().factorizations, 1u);
    // The next substep: other velocities.
    for (DirectBody& body : island.bodies) body.velocity[1] += 0.3;
    const DirectResult result = island.SolveAgain();
    EXPECT_EQ(result.outcome, Outcome::Solved);
    EXPECT_EQ(result.factorizations, 0u);
    EXPECT_GT(result.chordSteps, 0u);
    const std::vector<DirectVelocity> chord = island.velocities;
    island.Solve();
    for (size_t i = 0; i < chord.size(); ++i)
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(chord[i].v[k], island.velocities[i].v[k], 1e-6);
}

TEST(DirectSolver, LeavesEverythingAsItWasUnlessSolved) {
    const auto check = [](IslandOfRows& island, Outcome expected) {
        island.velocities.assign(island.bodies.size(), {{7, 7, 7, 7, 7, 7}});
        const std::vector<DirectRow> rows = island.rows;
        EXPECT_EQ(island.SolveAgain().outcome, expected);
        for (const DirectVelocity& velocity : island.velocities) EXPECT_EQ(velocity.v[0], 7);
        for (size_t r = 0; r < rows.size(); ++r) EXPECT_EQ(island.rows[r].impulse, rows[r].impulse);
    };
    IslandOfRows capped;
    FillRandomIsland(capped, 6, true);
    capped.settings.mostFactorizations = 1;
    capped.FindPattern();
    check(capped, Outcome::Capped);

    IslandOfRows notFinite;
    FillRandomIsland(notFinite, 6, true);
    notFinite.bodies[1].velocity[2] = std::numeric_limits<double>::quiet_NaN();
    notFinite.FindPattern();
    check(notFinite, Outcome::Failed);

    IslandOfRows outside;
    for (int i = 0; i < 3; ++i) outside.AddBody(1, 1, {});
    outside.AddBall(0, 1, {}, {}, 1);
    outside.FindPattern();
    outside.AddBall(1, 2, {}, {}, 1);
    check(outside, Outcome::OutsidePattern);
}

// A pattern of more edges than the rows have serves as well.
TEST(DirectSolver, SolvesFewerRowsWithTheSamePattern) {
    IslandOfRows island;
    for (uint32_t i = 0; i < 5; ++i) {
        island.AddBody(1 + i, 0.1, {0, 0, -0.1 * i, 0, 0, 0});
        island.AddBall(i > 0 ? i - 1 : kNone, i, {0.5, 0, 0}, {-0.5, 0, 0}, 1e6);
    }
    island.FindPattern();
    island.rows.resize(9);
    ASSERT_EQ(island.SolveAgain().outcome, Outcome::Solved);
    const std::vector<DirectVelocity> superset = island.velocities;
    ASSERT_EQ(island.Solve().outcome, Outcome::Solved);
    for (size_t i = 0; i < 5; ++i)
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(superset[i].v[k], island.velocities[i].v[k], 1e-10);
}

TEST(DirectSolver, SolvesNothing) {
    IslandOfRows island;
    EXPECT_EQ(island.Solve().outcome, Outcome::Solved);
    island.AddBody(1, 1, {1, 2, 3, 4, 5, 6});
    EXPECT_EQ(island.Solve().outcome, Outcome::Solved);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(island.velocities[0].v[k], k + 1);
}

}  // namespace
}  // namespace fulcrum
