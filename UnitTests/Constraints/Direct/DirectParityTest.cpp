// The direct solver gives the same bits in every build: a hash of what it finds for random mechanisms.
#include <Fulcrum/Constraints/Direct/DirectSolver.h>

#include <gtest/gtest.h>

#include <bit>
#include <vector>

namespace fulcrum {
namespace {

class Numbers {
public:
    // -1..1
    double Next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 40) / (1 << 23) - 1;
    }

private:
    uint64_t state_ = 1;
};

// A chain that hangs on something fixed, from five bodies on with two more joints; some bodies with a locked axis, some
// rows with limits, some springs.
struct RandomChain {
    std::vector<DirectBody> bodies;
    std::vector<DirectRow> rows;
    std::vector<DirectEdge> edges;
    std::vector<DirectStiffness> stiffness;

    RandomChain(uint32_t trial, Numbers& numbers) : bodies(2 + trial % 20) {
        const auto count = static_cast<uint32_t>(bodies.size());
        for (DirectBody& body : bodies) {
            for (double& v : body.velocity) v = numbers.Next();
            const double mass = 1 + 100 * (numbers.Next() + 1);
            body.inverseMass = 1 / mass;
            for (int k = 0; k < 3; ++k) body.inverseInertia[k] = 1 / (mass * (0.02 + 0.1 * (numbers.Next() + 1)));
            for (int k = 3; k < 6; ++k) body.inverseInertia[k] = 0.1 * body.inverseInertia[0] * numbers.Next();
            if (trial % 7 == 3) body.lockedAxes = 2;
        }
        Join(DirectRow::kNone, 0, trial, numbers);
        for (uint32_t i = 1; i < count; ++i) Join(i - 1, i, trial, numbers);
        if (count > 4) {
            Join(0, count - 1, trial, numbers);
            Join(1, count - 2, trial, numbers);
        }
        if (trial % 5 == 0) stiffness.push_back({0, {1.5, 1.1, 2, 0.1, 0, 0}});
    }

    void Join(uint32_t a, uint32_t b, uint32_t trial, Numbers& numbers) {
        double armA[3], armB[3];
        for (double& x : armA) x = 0.5 * numbers.Next();
        for (double& x : armB) x = 0.5 * numbers.Next();
        for (int k = 0; k < 3; ++k) {
            DirectRow& row = rows.emplace_back();
            const int x = (k + 1) % 3, y = (k + 2) % 3;
            row.a = a;
            row.b = b;
            row.ja[k] = -1;
            row.jb[k] = 1;
            row.ja[3 + x] = -armA[y];
            row.ja[3 + y] = armA[x];
            row.jb[3 + x] = armB[y];
            row.jb[3 + y] = -armB[x];
            row.c = 0.01 * numbers.Next();
            row.impulse = numbers.Next();
            row.inverseGamma = trial % 3 == 2 && k == 1 ? 3 : 1e7;
            if (trial % 3 != 1 || k != 2) continue;
            row.lo = -1;
            row.hi = 1;
        }
        if (a != DirectRow::kNone) edges.push_back({a, b});
    }
};

TEST(DirectParity, HashOfRandomMechanisms) {
    uint64_t hash = 14695981039346656037u;
    const auto add = [&](double x) { hash = (hash ^ std::bit_cast<uint64_t>(x)) * 1099511628211u; };
    Numbers numbers;
    for (uint32_t trial = 0; trial < 300; ++trial) {
        RandomChain chain(trial, numbers);
        ScratchArena scratch;
        const auto count = static_cast<uint32_t>(chain.bodies.size());
        const auto pattern = FindDirectPattern(count, chain.edges, scratch);
        DirectFactor factor = MakeDirectFactor(*pattern, scratch);
        std::vector<DirectVelocity> velocities(count);
        const auto addVelocities = [&] {
            for (const DirectVelocity& velocity : velocities)
                for (const double v : velocity.v) add(v);
        };
        for (int substep = 0; substep < 4; ++substep) {
            const DirectResult result = SolveDirectly({chain.bodies, chain.rows, {}, chain.stiffness}, *pattern,
                                                      {.tolerance = 1e-4}, factor, velocities, scratch);
            ASSERT_EQ(result.outcome, DirectResult::Outcome::Solved) << trial;
            addVelocities();
            for (const DirectRow& row : chain.rows) add(row.impulse);
            for (uint32_t i = 0; i < count; ++i)
                for (int k = 0; k < 6; ++k) chain.bodies[i].velocity[k] = velocities[i].v[k] + 0.01 * k;
            std::vector<DirectRow> rows = chain.rows;
            ASSERT_TRUE(StepDirectly({chain.bodies, rows, {}, {}}, *pattern, factor, velocities, scratch));
            addVelocities();
        }
    }
    EXPECT_EQ(hash, 0x80c6d0793c6776c7u) << std::hex << hash;
}

}  // namespace
}  // namespace fulcrum
