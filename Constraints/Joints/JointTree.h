// Joints that hold bodies together as a tree, solved exactly by a direct factorization: chains under heavy loads, for
// which iterations converge only after as many as the load is heavier than a link. The Solve stage runs it before the
// iterations of the tree's island, which then find little left to do. One thread per tree.
//
// With M the masses, L the Jacobian of all locks and b their biases the impulses x are the solution of
//     [M  -L^T] [dv]   [   0    ]
//     [L    0 ] [x ] = [-L v - b]
// Bodies are eliminated from the leaves to the root; each adds its articulated inertia to its parent, so the time
// grows with the number of bodies alone. A tree that hangs on what does not move has that as its root. Further joints
// with what does not move are leaves without mass: they are given a small compliance, and the iterations do the rest.
// In double, because the masses span many orders of magnitude.
//
// A ball joint leaves its body the three directions of turning about the anchor. With its mass taken about the anchor,
//     [A    B] [u]   [force ]                                    u   velocity of the anchor
//     [B^T  C] [w] = [torque]                                    w   angular velocity
// what the parent feels at the anchor is the mass A - B C^-1 B^T: a 3x3 inverse is all that there is to do. Other
// locks take the 6x6 inverse.
// Sources of the eliminations: R. Featherstone, "Rigid Body Dynamics Algorithms" (articulated-body inertia); D. Baraff,
// "Linear-Time Dynamics using Lagrange Multipliers", SIGGRAPH 1996.
#pragma once

#include <Fulcrum/Constraints/Joints/JointBatch.h>

#include <Eigen/Core>

#include <span>

namespace fulcrum {

// Where the solver finds a joint's parts.
struct JointPlaceInBatch {
    uint32_t batch = 0, lane = 0;
};

// Force and torque of a unit of velocity and angular velocity, about one point.
struct ArticulatedMass {
    Sym3<double> linear;
    Mat3<double> coupling;  // force = linear v + coupling w, torque = coupling^T v + angular w
    Sym3<double> angular;
};

struct JointTreeSlot {
    static constexpr uint32_t kNone = ~0u;

    uint32_t body = 0;
    bool still = false;  // the body does not move: a root
    bool isA = false;    // whether `body` is the joint's body A
    uint32_t parent =
        kNone;               // slot of the body that the joint below leads to, smaller than this one's; kNone: the root
    uint32_t joint = kNone;  // index of its record
    uint32_t block = kNone;  // where the joint is no ball joint, or missing: place in JointTree::blocks
    JointPlaceInBatch place;

    // Of the last factorization. What follows is about the reference point: the anchor of a ball joint, else the
    // center of mass.
    Vec3<double> reference;  // m, from the center of mass
    Vec3<double> parentArm;  // m, from the parent's reference point to the anchor; of ball joints
    // Of the body with all that hangs on it. Of ball joints, once eliminated: A - B C^-1 B^T, B C^-1 and C^-1.
    ArticulatedMass mass;

    // Of the last solve.
    Twist<double> load;                       // N s and N m s, on the body
    Vec3<double> speed, freeForce, freeTurn;  // of ball joints: the residual; what `load` does on its own
    Twist<double> change;                     // of the velocity
};

// What slots have in place of the matrices of ball joints.
struct JointTreeBlock {
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    using Matrix6 = Eigen::Matrix<double, 6, 6>;

    int rows = 0;           // of the joint's locks
    Matrix6 own, other;     // their Jacobian for the body and for the parent, `rows` rows
    Matrix6 inverse;        // mass^-1
    Matrix6 response;       // mass^-1 own^T
    Matrix6 effectiveMass;  // (own response)^-1
    Vector6 residual;       // error of the velocity rows
};

// A further joint of a body of the tree with one that does not move.
struct JointTreeAnchor {
    uint32_t slot = 0, joint = 0;
    bool isA = false;
    JointPlaceInBatch place;
    int rows = 0;
    JointTreeBlock::Matrix6 own, other;
    double stiffness = 0;  // 1 / compliance
    JointTreeBlock::Vector6 residual;
};

struct JointTree {
    std::span<JointTreeSlot> slots;  // parents before children
    std::span<JointTreeBlock> blocks;
    std::span<JointTreeAnchor> anchors;
};

// After the parts were set up: at the start of the step and after every substep.
void FactorizeTree(const JointTree& tree, const JointBatch<kLanes>* batches, const BodyMass* masses);

// Makes the velocities satisfy all locks of the tree: J v = -bias, or J v = 0 where `relax`. Adds to the parts' total
// impulses.
void SolveTree(const JointTree& tree, JointBatch<kLanes>* batches, BodyState* states, bool relax);

}  // namespace fulcrum
