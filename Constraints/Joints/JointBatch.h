// N joints with the same locks, solved in lanes. No two joints of a batch share a dynamic body.
//
// A joint consists of a linear lock, an angular lock (both parts) and scalar rows. Within a joint the rows are solved
// first, then the locks, which therefore win. Four measures make few iterations sufficient:
// - The parts are set up in every substep from the displacements since the start of the step, so that a joint follows
//   the arcs along which its bodies move.
// - Velocity rows aim at the end of the substep: their bias is the second-order part of the motion, evaluated anew
//   in each pass, from its velocities (AimAtEnd). Bodies then move along chords, and the joint stays closed.
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
#include <Fulcrum/Constraints/WarmStart.h>

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
    float ownSpare[2] = {0, 0};
    float lockForce[3] = {0, 0, 0}, lockTorque[3] = {0, 0, 0}, lockSpare[2] = {0, 0};
    float totalForce[3] = {0, 0, 0}, totalTorque[3] = {0, 0, 0}, totalSpare[2] = {0, 0};

    enum Rows { kAnchors, kFrames, kOwn, kLocks, kTotal };
    const float* Row(int row) const {
        return reinterpret_cast<const float*>(this) + kRowFloats * static_cast<size_t>(row);
    }
    float* Row(int row) { return reinterpret_cast<float*>(this) + kRowFloats * static_cast<size_t>(row); }
    // Indices in the first row, in the second, and in the rows of impulses and forces.
    enum Places {
        kAnchorA = 0,
        kAnchorB = 3,
        kLineAxis = 6,
        kFreeAxis = 7,
        kFrameA = 0,
        kFrameB = 4,
        kForce = 0,
        kTorque = 3
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
    // pushRate: of springs massScale beta, 1/s, see RowSoftness.h; of hard motors of limited force the part of the
    // error that they drive back per second; 0 for rows whose error is corrected in the poses. mostPush: m/s or rad/s,
    // limit of either; that of springs is kUnlimited.
    RowSoftness<Real> softness;
    Real pushRate, mostPush;
    Real speedPart;  // of springs: see SpringSoftness.h
    // Inequality rows with an error above `openAbove` are open: they only limit the approach so that the gap closes no
    // faster than within a substep (gapRate C, 1/s), with `openSoftness`. Springs are not relaxed: their openSoftness
    // is (0, 1). gapRate is also that of motors of limited force.
    Real openAbove, gapRate;
    RowSoftness<Real> openSoftness;
    Real turnsWithA;       // 1: J rotates with A from substep to substep
    Real radial;           // 1: the row acts along the line between the anchors and rotates with it
    Real across, between;  // 1: that JointRow::Pivot
    Vec3<Real> ofA, ofB;   // its directions
    Real isLock;           // 1: one of the block of lock rows, see JointBatch::lockRowCount
    // Change of the impulses of the block's rows by a unit of impulse.
    Real lockRows[JointRowList::kMostLocks];
    // kg or kg m2: effective mass without the reaction of the block, which gives springs their stiffness.
    Real freeMass;
    uint8_t slot[N];  // 0xFF: no row
    RowHold hold[N];

    // Mask of the lanes whose error is corrected in the poses.
    FULCRUM_FORCE_INLINE auto IsCorrected() const {
        return (mostPush > Real(0.0f)) & (mostPush < Real(JointRow::kUnlimited)) & (pushRate <= Real(0.0f));
    }
};

template <int N>
struct JointBatch {
    using Real = Wide<N>;
    uint32_t joint[N];  // indices of the records; the first `count` lanes are in use
    uint32_t bodyA[N], bodyB[N];
    int32_t count;
    uint32_t fixedA, fixedB;          // bit i: the body of lane i is not dynamic
    uint32_t kinematicA, kinematicB;  // bit i: but it moves
    uint32_t high;                    // bit i: of high priority, its error is corrected wholly
    uint32_t strained, pastLimit;     // bit i: at the start of the step, see JointStrain.h
    LinearLock linear;
    AngularLock angular;
    uint32_t rowCount;                   // maximum over the lanes
    uint32_t rowRoom;                    // the most that the types may add
    bool rowsTurnWithA, radial, pivots;  // set if any row of any lane has it
    bool springs;                        // likewise a speedPart
    uint32_t neighbors[N] = {};          // other joints with rows that a dynamic body of the lane has, at most
    bool turning;                        // inertias of some lane turn from substep to substep: they are read again
    JointRows<N>* rows;
    // Rows that are locks (JointRow::isLock) are solved as one block, by elimination: the response of each includes the
    // reaction of those before it, so that one pass satisfies all; that of other rows includes the reaction of the
    // block. Rows from this index on are locks in no lane.
    uint32_t lockRowCount;
    bool overridesMass = false;  // some lane has a MassOverride

    InverseMass<Real> massA, massB;
    PointPart<Real> point;
    Vec3<Real> startArmA, startArmB, startOffset;
    Vec3<Real> earlierLinear, earlierAngular;         // sums of the locks' impulses and reactions over earlier substeps
    Real turns;                                       // 1: an inertia of this lane turns
    Vec3<Real> reactionLinear, reactionAngular;       // reaction of the locks to the rows; only if there are rows
    Twist<Real> wayA, wayB;                           // displacements at the last set-up of the rows
    Vec3<Real> radialArmA, radialArmB, radialOffset;  // the anchors' arms and offset then, if `radial`

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

    // Scales of a MassOverride; only if `overridesMass`.
    Real massScaleA, inertiaScaleA, massScaleB, inertiaScaleB;

    void SetMassOverride(int lane, const MassOverride& o) {
        massScaleA.Set(lane, o.inverseMassScaleA);
        inertiaScaleA.Set(lane, o.inverseInertiaScaleA);
        massScaleB.Set(lane, o.inverseMassScaleB);
        inertiaScaleB.Set(lane, o.inverseInertiaScaleB);
    }
};

struct JointSolveSettings {
    float dt, substepDt;  // s
    float inverseDt;      // 1/s, of the substep
    float elapsed;        // s since the start of the step
    float impulseScale;   // dt of this substep / dt of the last: scales the warm start
    float maxPushSpeed;   // m/s and rad/s: largest correction of an error, over a substep
    float sleepSeconds;   // SleepSettings::seconds, see JointType::quiet
    float baumgarte;  // 0..1: fraction of an error corrected per position iteration, limited to maxPushSpeed substepDt
    // CorrectJoints: locks are left to DirectIsland; their bias becomes the correction that is wanted.
    bool leavesLocks;
    bool isDirect;   // of an island that DirectIsland solves, see JointPose
    bool continues;  // AddWarmStart: the impulses are those of an earlier substep of the step, not of the last step
};

// Results of Prepare, and the errors of rows, which Store adds.
struct JointFindings {
    float linearError = 0, angularError = 0;  // m, rad: largest joint errors
    uint32_t linearJoint = ~0u, angularJoint = ~0u;
    bool turning = false;  // the inertia of some jointed body turns from substep to substep
};

// Fills the batch; its lanes, fixed and kinematic bits, locks and rowRoom must be set.
template <int N>
void PrepareJoints(JointBatch<N>& batch, const JointRecord* records, JointType* const* types,
                   const ConstSolverBodies& bodies, const JointSolveSettings& settings, JointFindings& findings);

// Sets the biases of the locks for the current velocities, and adds the impulses of the last substep to those of the
// bodies, with their work: see WarmStart.h. Sums the impulses of the step.
template <int N>
void AddWarmStart(JointBatch<N>& batch, BodyState* states, WarmStart* starts, const JointSolveSettings& settings);
// Scales the impulses by those of WarmStart.
template <int N>
void ScaleImpulses(JointBatch<N>& batch, const WarmStart* starts);

// One iteration over locks and rows.
template <int N>
void SolveJointVelocities(JointBatch<N>& batch, BodyState* states, const JointSolveSettings& settings);
// Sets the biases of the locks for the current velocities.
template <int N>
void AimJoints(JointBatch<N>& batch, BodyState* states, const JointSolveSettings& settings);

// A position iteration (Baumgarte): sets the parts up at the displaced poses and corrects the poses, adds no velocity.
// starts: if not null, AddWarmStart follows for the next substep,
// while all is at hand.
template <int N>
void CorrectJoints(JointBatch<N>& batch, const SolverBodies& bodies, WarmStart* starts,
                   const JointSolveSettings& settings);

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
