// N joints with the same locks, solved in lanes. No two joints of a batch share a dynamic body.
//
// A joint consists of a linear lock, an angular lock (both parts) and scalar rows. Within a joint the rows are solved
// first, then the locks, which therefore win. Four measures make few iterations sufficient:
// - The parts are set up in every substep from the displacements since the start of the step, so that a joint follows
//   the arcs along which its bodies move.
// - Within a step, bodies keep their velocities from substep to substep, which replaces the warm start (Solve stage).
//   Only the change due to the rotation of a part's impulse is added: `turnedA` and `turnedB`.
// - A joint that locks translation and rotation solves both as one block.
// - A row's impulse response includes the reaction of the locks. With L the locks' Jacobian its response is
//       M^-1 (J^T - L^T (L M^-1 L^T)^-1 L M^-1 J^T):
//   a row disturbs no lock, and a spring or motor acts on the inertia that it actually moves. The reaction of the
//   locks, `lockLinear` and `lockAngular` per unit of impulse, is kept apart from the locks' own impulses, so that
//   their softness does not act on it.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Constraints/Parts/DualAxisPart.h>
#include <Fulcrum/Constraints/Parts/HingeRotationPart.h>
#include <Fulcrum/Constraints/Parts/PointPart.h>
#include <Fulcrum/Constraints/Parts/RotationEulerPart.h>
#include <Fulcrum/Constraints/Parts/RowPart.h>

namespace fulcrum {

// Persistent data of a joint, rows of eight floats.
struct alignas(32) JointRecord {
    float anchorA[3] = {0, 0, 0}, anchorB[3] = {0, 0, 0};      // m, in the bodies' center frames
    float lineAxis = 0, freeAxis = 0;                          // JointLocks::line and ::axis
    float frameA[4] = {0, 0, 0, 1}, frameB[4] = {0, 0, 0, 1};  // x y z w, in the bodies' center frames
    // On B, world axes: the locks' own impulses of the last substep, N s and N m s. Below, average forces and torques
    // over the last step, N and N m: of the locks with their reaction to the rows, and of locks and rows together,
    // about the anchor.
    float ownImpulse[3] = {0, 0, 0}, ownAngularImpulse[3] = {0, 0, 0};
    float wasPulled = 0;  // >= 1: it was far apart in the last step; 0.5: connected to joints that were
    // s: time left of the period after a teleport of a body of its mechanism. Counted down by the Store stage, except
    // in steps in which one of its springs is overstretched.
    float secondsOfTeleport = 0;
    float lockForce[3] = {0, 0, 0}, lockTorque[3] = {0, 0, 0}, lockSpare[2] = {0, 0};
    float totalForce[3] = {0, 0, 0}, totalTorque[3] = {0, 0, 0}, totalSpare[2] = {0, 0};

    enum Rows { kAnchors, kFrames, kOwn, kLocks, kTotal };
    const float* Row(int row) const {
        return reinterpret_cast<const float*>(this) + kRowFloats * static_cast<size_t>(row);
    }
    float* Row(int row) { return reinterpret_cast<float*>(this) + kRowFloats * static_cast<size_t>(row); }
    // Indices in the first row, in the second, in the rows of forces, and of the other members of kOwn.
    enum Places {
        kAnchorA = 0,
        kAnchorB = 3,
        kLineAxis = 6,
        kFreeAxis = 7,
        kFrameA = 0,
        kFrameB = 4,
        kForce = 0,
        kTorque = 3,
        kWasPulled = 6,
        kSecondsOfTeleport = 7
    };
};
static_assert(sizeof(JointRecord) == 160);
FULCRUM_CHECK_PLACE(JointRecord, anchorA, JointRecord::kAnchors, JointRecord::kAnchorA);
FULCRUM_CHECK_PLACE(JointRecord, anchorB, JointRecord::kAnchors, JointRecord::kAnchorB);
FULCRUM_CHECK_PLACE(JointRecord, lineAxis, JointRecord::kAnchors, JointRecord::kLineAxis);
FULCRUM_CHECK_PLACE(JointRecord, freeAxis, JointRecord::kAnchors, JointRecord::kFreeAxis);
FULCRUM_CHECK_PLACE(JointRecord, frameA, JointRecord::kFrames, JointRecord::kFrameA);
FULCRUM_CHECK_PLACE(JointRecord, frameB, JointRecord::kFrames, JointRecord::kFrameB);
FULCRUM_CHECK_PLACE(JointRecord, ownImpulse, JointRecord::kOwn, JointRecord::kForce);
FULCRUM_CHECK_PLACE(JointRecord, ownAngularImpulse, JointRecord::kOwn, JointRecord::kTorque);
FULCRUM_CHECK_PLACE(JointRecord, wasPulled, JointRecord::kOwn, JointRecord::kWasPulled);
FULCRUM_CHECK_PLACE(JointRecord, secondsOfTeleport, JointRecord::kOwn, JointRecord::kSecondsOfTeleport);
FULCRUM_CHECK_PLACE(JointRecord, lockForce, JointRecord::kLocks, JointRecord::kForce);
FULCRUM_CHECK_PLACE(JointRecord, lockTorque, JointRecord::kLocks, JointRecord::kTorque);
FULCRUM_CHECK_PLACE(JointRecord, totalForce, JointRecord::kTotal, JointRecord::kForce);
FULCRUM_CHECK_PLACE(JointRecord, totalTorque, JointRecord::kTotal, JointRecord::kTorque);

// What the C of a row is where it is not as it should be: see RowErrors.h.
enum class RowHold : uint8_t { Nothing, Distance, Angle };

// One row of each of N joints; lanes without a row have a zero Jacobian and are inactive.
template <int N>
struct JointRows {
    using Real = Wide<N>;
    RowPart<Real> part;                  // its response includes the reaction of the locks
    Vec3<Real> lockLinear, lockAngular;  // change of the locks' impulses by a unit of impulse
    Real startError, error;              // C, m or rad, at the start of the step and now
    Real speed;                          // m/s or rad/s: target of J v
    Real lowest, highest;                // N s or N m s, limits of the accumulated impulse
    Real earlier;                        // N s or N m s: sum over earlier substeps
    // Error correction, see RowSoftness.h: pushRate is massScale beta, 1/s; mostPush the limit of pushRate C, m/s or
    // rad/s.
    RowSoftness<Real> softness;
    Real pushRate, mostPush;
    // Inequality rows with an error above `openAbove` are open: they only limit the approach so that the gap closes no
    // faster than within a substep (gapRate C, 1/s), with `openSoftness`. Springs are not relaxed: their openSoftness
    // is (0, 1).
    Real openAbove, gapRate;
    RowSoftness<Real> openSoftness;
    Real turnsWithA;       // 1: J rotates with A from substep to substep
    Real radial;           // 1: the row acts along the line between the anchors and rotates with it
    Real across, between;  // 1: that JointRow::Pivot
    Vec3<Real> ofA, ofB;   // its directions
    Real about;            // 1: its error is an angle
    Real waits;            // 1: inactive in this step, because the joint is far apart
    Real isLock;           // 1: one of the block of lock rows, see JointBatch::lockRowCount
    // Change of the impulses of the block's rows by a unit of impulse.
    Real lockRows[JointRowList::kMostLocks];
    // kg or kg m2: effective mass without the reaction of the block, which gives springs their stiffness.
    Real freeMass;
    Real pulled;      // N s or N m s: impulse applied to pseudo-velocities, see PullJoints
    uint8_t slot[N];  // 0xFF: no row
    RowHold hold[N];
};

template <int N>
struct JointBatch {
    using Real = Wide<N>;
    uint32_t joint[N];  // indices of the records; the first `count` lanes are in use
    uint32_t bodyA[N], bodyB[N];
    int32_t count;
    uint32_t fixedA, fixedB;          // bit i: the body of lane i is not dynamic
    uint32_t kinematicA, kinematicB;  // bit i: but it moves
    uint32_t inTree;                  // bit i: the direct solver solves the locks of lane i, see JointTree.h
    uint32_t strained;                // bit i: at the start of the step, see JointStrain.h
    uint32_t pushed;                  // bit i: faster than kFastPush at the start of the step, see EnergyLimit.h
    LinearLock linear;
    AngularLock angular;
    uint32_t rowCount;                   // maximum over the lanes
    uint32_t rowRoom;                    // the most that the types may add
    bool rowsTurnWithA, radial, pivots;  // set if any row of any lane has it
    bool turning;                        // inertias of some lane turn from substep to substep: they are read again
    JointRows<N>* rows;
    // Rows that are locks (JointRow::isLock) are solved as one block, by elimination: the response of each includes the
    // reaction of those before it, so that one pass satisfies all; that of other rows includes the reaction of the
    // block. Rows from this index on are locks in no lane.
    uint32_t lockRowCount;
    bool overridesMass = false;  // some lane has a MassOverride
    bool isGuided = false;       // some lane has a body with locked translations
    Real guided;                 // 1: that lane

    InverseMass<Real> massA, massB;
    PointPart<Real> point;
    Vec3<Real> startArmA, startArmB, startOffset;
    Twist<Real> turnedA, turnedB;
    Vec3<Real> earlierLinear, earlierAngular;    // sums of the locks' impulses and reactions over earlier substeps
    Real turns;                                  // 1: the inertia of this lane rotates
    Vec3<Real> reactionLinear, reactionAngular;  // reaction of the locks to the rows; only if there are rows
    Twist<Real> wayA, wayB;                      // displacements at the last set-up of the rows

    RotationEulerPart<Real> rotation;
    Quat<Real> inverseInitial;  // of rotations since the start of the step, for AngularLock::All
    HingeRotationPart<Real> hinge;
    Vec3<Real> startAxisA, startAxisB, startNormal;  // for AngularLock::Axis; the normal belongs to B
    DualAxisPart<Real> line;
    Vec3<Real> startLine, startLineNormal;  // for LinearLock::Line, belongs to A

    // If a joint has both locks, their rows are solved as one block: with C = L_linear M^-1 L_angular^T, by columns,
    // and S = K_linear - C K_angular^-1 C^T.
    Vec3<Real> cross[3];
    Sym3<Real> coupledPoint;  // S^-1
    Sym2<Real> coupledLine;

    // For lanes that are far apart: the pseudo-velocity that closes their gap, in place of a bias, see PullJoints.
    bool far;                            // some lane is far apart
    Real isFar;                          // >= 1: this one is, see JointRecord::wasPulled
    Real isDistant;                      // 1: the gap is so large that it is closed without lever arms
    Real follows;                        // 0.5: its bodies have pseudo-velocities, maybe from other joints
    Real secondsOfTeleport;              // at the end of the step, see JointRecord
    Vec3<Real> pullLinear, pullAngular;  // m/s, rad/s

    // Scales of a MassOverride; only if `overridesMass`.
    Real massScaleA, inertiaScaleA, massScaleB, inertiaScaleB;

    void SetMassOverride(int lane, const MassOverride& o) {
        massScaleA.Set(lane, o.inverseMassScaleA);
        inertiaScaleA.Set(lane, o.inverseInertiaScaleA);
        massScaleB.Set(lane, o.inverseMassScaleB);
        inertiaScaleB.Set(lane, o.inverseInertiaScaleB);
    }
};

// Rotation vectors of a step up to this length, rad, are composed as rotations; longer ones are added, since the
// composition is singular at a full revolution.
namespace joints {
inline constexpr float kFarthestTurn = 5.5f;
}

struct JointSolveSettings {
    float dt, substepDt;  // s
    float inverseDt;      // 1/s, of the substep
    float elapsed;        // s since the start of the step
    float impulseScale;   // dt of this substep / dt of the last: scales the warm start
    // Errors are corrected by a soft block, like contact overlaps: see ContactSolveSettings.
    float pushRate;
    RowSoftness<float> softness;
    float maxPushSpeed;  // m/s and rad/s
    float sleepSeconds;  // SleepSettings::seconds, see JointType::quiet
    // The same of locks in trees, which are hard: softness would undo part of the direct solution.
    float treePushRate, maxTreePushSpeed;
    bool pushes;      // false: errors are corrected by position iterations (CorrectJoints), and rows are hard
    float baumgarte;  // 0..1: fraction of an error corrected per position iteration, limited to maxPushSpeed substepDt
    bool continues;   // first velocity iteration of a substep other than the step's first
    bool firstPass;   // first relax iteration of a substep, or first iteration of PullJoints
};

// Results of Prepare, and the errors of rows, which Store adds.
struct JointFindings {
    float linearError = 0, angularError = 0;  // m, rad: largest joint errors
    uint32_t linearJoint = ~0u, angularJoint = ~0u;
    bool far = false;     // some joints are far apart, see PullJoints
    bool pushed = false;  // some joints are pushed fast, see EnergyLimit.h
};

// Fills the batch; its lanes, fixed and kinematic bits, locks and rowRoom must be set.
template <int N>
void PrepareJoints(JointBatch<N>& batch, const JointRecord* records, JointType* const* types,
                   const ConstSolverBodies& bodies, const JointSolveSettings& settings, JointFindings& findings);

// Applies the impulses of the last step.
template <int N>
void WarmStartJoints(const JointBatch<N>& batch, BodyState* states);

// Adds the change of the parts' impulses due to their rotation in the last substep. SolveJointVelocities does that
// itself if settings.continues is set.
template <int N>
void RotateJointImpulses(JointBatch<N>& batch, BodyState* states);

template <int N>
void SolveJointVelocities(JointBatch<N>& batch, BodyState* states, const JointSolveSettings& settings);

// Relax iteration: sets the parts up at the displaced poses and solves the velocities there without error correction.
template <int N>
void RelaxJoints(JointBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings);

// Only the set-up of RelaxJoints, for solves without relax iterations.
template <int N>
void UpdateJoints(JointBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings);

// A position iteration (Baumgarte): sets the parts up at the displaced poses and corrects the poses, adds no velocity.
// Joints that are far apart are left to PullJoints.
template <int N>
void CorrectJoints(JointBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings);

// One iteration over the pseudo-velocities (split impulses), which are in `pseudo` in place of the velocities: joints
// that are far apart are pulled together, the others resist.
template <int N>
void PullJoints(JointBatch<N>& batch, BodyState* pseudo, const JointSolveSettings& settings);

// Writes the impulses back, divided by `impulseScale`, the average forces of the step, dt seconds long, and the
// rotation of the bodies.
template <int N>
void StoreJoints(const JointBatch<N>& batch, JointRecord* records, JointType* const* types, const BodyState* states,
                 float dt, float impulseScale);

// After StoreJoints: notes the errors that the rows had at the start of the step, if the forces of the step were below
// their limits. substepDt: of the batch, s.
template <int N>
void NoteRowErrors(const JointBatch<N>& batch, const JointType* const* types, float substepDt, JointFindings& findings);

}  // namespace fulcrum
