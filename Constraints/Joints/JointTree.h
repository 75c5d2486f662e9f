// Joints that hold bodies together as a tree, solved exactly and at once: chains under heavy loads, which iterations
// bring to rest only after as many of them as the load is heavier than a link. The Solve stage runs it before the
// iterations of the tree's island, which then find little left to do. One thread per tree.
//
// With M the masses, L the Jacobian of all locks and b their biases the impulses x are the solution of
//     [M  -L^T] [dv]   [   0    ]
//     [L    0 ] [x ] = [-L v - b]
// Bodies are eliminated from the leaves to the root; each leaves its mark on the 6x6 block of its parent, so the time
// grows with the number of bodies alone. A tree that hangs on what does not move has that as its root. Further joints
// with what does not move are leaves without mass: they are given a small compliance, and the iterations do the rest.
// In double, because the blocks span many orders of magnitude. Source of the elimination: D. Baraff, "Linear-Time
// Dynamics using Lagrange Multipliers", SIGGRAPH 1996.
#pragma once

#include <Fulcrum/Constraints/Joints/JointBatch.h>

#include <Eigen/Core>

#include <span>

namespace fulcrum {

// Where the solver finds a joint's parts.
struct JointPlaceInBatch {
    uint32_t batch = 0, lane = 0;
};

struct JointTreeSlot {
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    static constexpr uint32_t kNone = ~0u;

    uint32_t body = 0;
    bool still = false;  // the body does not move: a root
    uint32_t parent =
        kNone;               // slot of the body that the joint below leads to, smaller than this one's; kNone: the root
    uint32_t joint = kNone;  // index of its record
    bool isA = false;        // whether `body` is the joint's body A
    JointPlaceInBatch place;

    // Of the last factorization and solve.
    int rows = 0;
    Matrix6 own, other;         // Jacobian of the joint's locks for `body` and for the parent, `rows` rows
    Matrix6 mass;               // of the body with all that hangs on it; factor and inverse are kept beside
    Matrix6 inverse, response;  // mass^-1, mass^-1 own^T
    Matrix6 effectiveMass;      // (own response)^-1
    Vector6 load, velocityChange, residual;  // force on the body, what it does, error of the velocity rows
};

// A further joint of a body of the tree with one that does not move.
struct JointTreeAnchor {
    uint32_t slot = 0, joint = 0;
    bool isA = false;
    JointPlaceInBatch place;
    int rows = 0;
    JointTreeSlot::Matrix6 own;
    double stiffness = 0;  // 1 / compliance
    JointTreeSlot::Vector6 residual;
};

struct JointTree {
    std::span<JointTreeSlot> slots;  // parents before children
    std::span<JointTreeAnchor> anchors;
};

// After the parts were set up: at the start of the step and after every substep.
void FactorizeTree(const JointTree& tree, const JointBatch<kLanes>* batches, const BodyMass* masses);

// Makes the velocities meet all locks of the tree: J v = -bias, or J v = 0 where `relax`. Adds to the parts' total
// impulses.
void SolveTree(const JointTree& tree, JointBatch<kLanes>* batches, BodyState* states, bool relax);

}  // namespace fulcrum
