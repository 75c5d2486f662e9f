// What kinds of joints differ in: which motions they lock, and which rows they add in a step. The joint's locks are
// solved anew from the poses in every substep; rows keep their Jacobian for a step, or turn it with body A. A
// user-defined constraint is a class of its own derived from JointType. Called by the Prepare stage, for different
// joints on different threads, for one joint on one.
#pragma once

#include <Fulcrum/Constraints/Joints/AxisControl.h>
#include <Fulcrum/Constraints/Joints/JointRow.h>
#include <Fulcrum/Constraints/Joints/SettingVisitor.h>
#include <Fulcrum/Constraints/Parts/AnglePart.h>
#include <Fulcrum/Constraints/Parts/AxisPart.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <array>
#include <span>
#include <utility>

namespace fulcrum {

// How the anchor of body B may move against that of body A.
enum class LinearLock : uint8_t {
    None,   // anyhow
    Line,   // along one axis that moves with A
    Point,  // not at all
};
// How body B may turn against body A.
enum class AngularLock : uint8_t {
    None,  // anyhow
    Axis,  // about one axis
    All,   // not at all
};

// The free axes are those of the joint's frame: 0, 1, 2 for x, y, z.
struct JointLocks {
    LinearLock linear = LinearLock::None;
    AngularLock angular = AngularLock::None;
    uint8_t line = 0;  // the axis that Line leaves free
    uint8_t axis = 0;  // the axis that Axis leaves free
    friend bool operator==(const JointLocks&, const JointLocks&) = default;
};

// The bodies as a step begins, world axes. Frame A is the joint's frame as it moves with body A, frame B as with body
// B; they coincide where all is locked.
struct JointPose {
    Vector3 armA, armB;  // m, from the center of mass to the anchor
    Vector3 offset;      // m, from A's anchor to B's
    Quaternion frameA, frameB;
    Twist<float> velocityA, velocityB;                             // m/s of the centers of mass, rad/s
    float dt = 0, substepDt = 0;                                   // s
    Position anchorA = Position::Zero();                           // m, world space
    Vector3 turnedA = Vector3::Zero(), turnedB = Vector3::Zero();  // rad: rotation of the bodies in the step before

    // About how far B turned against A in the step before about an axis, rad.
    double TurnedAbout(const Vector3& axis) const { return Dot(axis, Vector3(turnedB - turnedA)); }

    // Velocity of B's anchor against the point of A that is there now, m/s.
    Vector3 AnchorVelocity() const {
        return velocityB.linear + Cross<float>(velocityB.angular, armB) - velocityA.linear -
               Cross<float>(velocityA.angular, Vector3(armA + offset));
    }
    // Frame B as it will have turned against A, and in how many seconds: within the step, and no farther than rows can
    // be linear. A row that is right there, its error put back to now, follows a turn better than one that is right at
    // the start.
    std::pair<Quaternion, float> FrameBAhead() const {
        constexpr float kFarthest = 0.4f;  // rad
        const Vector3 w = AngularVelocity();
        const float speed = Length(w), time = speed * dt > kFarthest ? kFarthest / speed : dt;
        return {RotationFromVector(Vector3(w * time)) * frameB, time};
    }
    Vector3 AngularVelocity() const { return velocityB.angular - velocityA.angular; }  // rad/s, of B against A
    // Jacobians of the motion of B's anchor along the unit axis n of A, and of the rotation of B against A about
    // `axis`; both turn with A.
    void SetAlong(JointRow& row, const Vector3& n) const {
        row.turnsWithA = true;
        row.about = false;
        row.jacobian = AxisJacobian<float>({armA + offset, armB, n});
    }
    static void SetAbout(JointRow& row, const Vector3& axis) {
        row.turnsWithA = row.about = true;
        row.jacobian = AngleJacobian<float>(axis);
    }
    // How fast the row's C changes now: J v.
    float SpeedOf(const JointRow& row) const { return RelativeMotion<>(row.jacobian, velocityA, velocityB); }
};

struct JointDrawing;

class JointType {
public:
    virtual ~JointType() = default;

    // The kind's name, for people; and what pictures show of the joint (JointDrawing.h), by default its frames alone.
    virtual const char* Kind() const { return "custom"; }
    virtual JointDrawing Drawing() const;

    virtual JointLocks Locks() const { return {}; }
    // The largest number of rows that CollectRows adds as long as neither Locks nor motor modes change; 0: it is never
    // called.
    virtual uint32_t MaxRows() const { return 0; }
    // Adds the rows of the step. A limit that cannot be reached within the step, a motor that is off: no row.
    virtual void CollectRows(const JointPose& pose, JointRowList& rows) {
        (void)pose;
        (void)rows;
    }

    // Once, when the joint is made, with the bodies as they then are (velocities and times are zero): what a type
    // measures from there on, such as the length of its rope or the phase of its gears.
    virtual void Start(const JointPose& pose) { (void)pose; }
    // What the joint does along a free axis, to be read and changed between steps; null where the type has nothing
    // there.
    virtual AxisControl* Control(JointAxis axis) {
        (void)axis;
        return nullptr;
    }
    // What its limits may be.
    virtual LimitBounds BoundsOf(JointAxis axis) const {
        (void)axis;
        return {};
    }
    // Slot of the first of an axis' rows, which are in the order of ControlSlots.
    virtual uint32_t FirstSlot(JointAxis axis) const {
        (void)axis;
        return 0;
    }
    // The orientation of frame B against frame A that position motors turn to, unit; for types that have such motors.
    virtual void SetTargetOrientation(const Quaternion& target) { (void)target; }
    // Where B is along or about an axis, m or rad. Here: the way of B's anchor along the axis of frame A, and the
    // rotation vector of frame B against A. Types that count turns, or that measure something else, say so.
    virtual double Coordinate(JointAxis axis, const JointPose& pose) const;
    // What the type carries from step to step besides impulses; snapshots copy these numbers.
    virtual std::span<double> State() { return {}; }
    // Shows the visitor what else the type is made of: what it was made with and what Start measured, without what
    // Control gives, always in the same order. Snapshots tell by it whether a joint is still the one that they saved,
    // and make it anew from it.
    virtual void VisitSettings(const SettingVisitor& visit) { (void)visit; }

    // By slot, 0 where there was no row: impulses of the last substep, N s or N m s, and what they were on average over
    // the step, N or N m. Written by the Store stage, as is what JointPose says of the last step.
    std::array<float, JointRowList::kMaxRows> impulses{}, forces{};
    Vector3 turnedA = Vector3::Zero(), turnedB = Vector3::Zero();
};

inline double JointType::Coordinate(JointAxis axis, const JointPose& pose) const {
    const auto index = static_cast<int>(axis);
    if (index < 3) return InverseRotate(pose.frameA, pose.offset)[index];
    return RotationVectorOf<float>(pose.frameA.Conjugate() * pose.frameB)[index - 3];
}

}  // namespace fulcrum
