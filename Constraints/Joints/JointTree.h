// Direct solver for joints that form a tree (articulated-body factorization): chains under heavy loads, where the
// number of iterations to convergence grows with the mass ratio of load and link. The Solve stage runs it before the
// iterations of the tree's island, which then only correct small residuals. One thread per tree.
//
// With M the masses, L the Jacobian of all locks and b their biases the impulses x are the solution of
//     [M  -L^T] [dv]   [   0    ]
//     [L    0 ] [x ] = [-L v - b]
// Bodies are eliminated from the leaves to the root; each adds its articulated inertia to its parent, so the time is
// linear in the number of bodies. If a tree is attached to a static or kinematic body, that body is its root. Further
// joints with such bodies are leaves without mass: they get a small compliance, and the iterations correct the rest. In
// double, because the masses span many orders of magnitude.
//
// A ball joint leaves its body three degrees of freedom: rotation about the anchor. With its mass taken about it,
//     [A    B] [u]   [force ]                                    u   velocity of the anchor
//     [B^T  C] [w] = [torque]                                    w   angular velocity
// The inertia that the parent feels at the anchor is A - B C^-1 B^T, which takes only a 3x3 inverse. Other locks take
// the 6x6 inverse.
// Sources of the eliminations: R. Featherstone, "Rigid Body Dynamics Algorithms" (articulated-body inertia); D. Baraff,
// "Linear-Time Dynamics using Lagrange Multipliers", SIGGRAPH 1996.
#pragma once

#include <Fulcrum/Constraints/Joints/JointBatch.h>

#include <Eigen/Core>

#include <span>

namespace fulcrum {

// Location of a joint's parts in the solver's batches.
struct JointPlaceInBatch {
    uint32_t batch = 0, lane = 0;
};

// Spatial inertia about a point: maps velocity and angular velocity to momentum.
struct ArticulatedMass {
    Sym3<double> linear;
    Mat3<double> coupling;  // force = linear v + coupling w, torque = coupling^T v + angular w
    Sym3<double> angular;
};

struct JointTreeSlot {
    static constexpr uint32_t kNone = ~0u;

    uint32_t body = 0;
    bool fixed = false;       // the body is static or kinematic: a root
    bool isA = false;         // whether `body` is the joint's body A
    uint32_t parent = kNone;  // slot of the parent body, to which the joint below leads; smaller than this slot; kNone:
                              // this is the root
    uint32_t joint = kNone;   // index of its record
    uint32_t block = kNone;   // if the joint is missing or not a ball joint: index in JointTree::blocks
    JointPlaceInBatch place;

    // Results of the last factorization. The following is relative to the reference point: the anchor of a ball joint,
    // else the center of mass.
    Vec3<double> reference;  // m, from the center of mass
    Vec3<double> parentArm;  // m, from the parent's reference point to the anchor; ball joints only
    // Articulated inertia: of the body and its subtree. For ball joints, after elimination: A - B C^-1 B^T, B C^-1 and
    // C^-1.
    ArticulatedMass mass;

    // Results of the last solve.
    Twist<double> load;                       // N s and N m s, on the body
    Vec3<double> speed, freeForce, freeTurn;  // ball joints only: the residual, and the effect of `load` alone
    Twist<double> change;                     // change of velocity
};

// Matrices of a slot whose joint is not a ball joint.
struct JointTreeBlock {
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    using Matrix6 = Eigen::Matrix<double, 6, 6>;

    int rows = 0;           // rows of the joint's locks
    Matrix6 own, other;     // their Jacobian for the body and for the parent, `rows` rows
    Matrix6 inverse;        // mass^-1
    Matrix6 response;       // mass^-1 own^T
    Matrix6 effectiveMass;  // (own response)^-1
    Vector6 residual;       // residual of the velocity rows
};

// A further joint of a body of the tree with a static or kinematic body.
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

// Call after every set-up of the parts: at the start of the step and after every substep.
void FactorizeTree(const JointTree& tree, const JointBatch<kLanes>* batches, const BodyMass* masses);

// Makes the velocities satisfy all locks of the tree: J v = -bias, or J v = 0 where `relax`. Adds to the parts' total
// impulses.
void SolveTree(const JointTree& tree, JointBatch<kLanes>* batches, BodyState* states, bool relax);

}  // namespace fulcrum
