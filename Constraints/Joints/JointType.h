// Base class of joint types: defines which motions a joint locks, and which rows it adds in a step. Locks are set up
// from the current poses in every substep; rows keep their Jacobian for a step, or rotate it with body A. A
// user-defined constraint is a class derived from JointType. Called by the Prepare stage, for different joints on
// different threads, for one joint on one.
#pragma once

#include <Fulcrum/Constraints/Joints/AxisControl.h>
#include <Fulcrum/Constraints/Joints/JointRow.h>
#include <Fulcrum/Constraints/Joints/SettingVisitor.h>
#include <Fulcrum/Constraints/Parts/AnglePart.h>
#include <Fulcrum/Constraints/Parts/AxisPart.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <array>
#include <span>
#include <utility>

namespace fulcrum {

// How the anchor of body B may move relative to that of body A.
enum class LinearLock : uint8_t {
    None,   // freely
    Line,   // along one axis that moves with A
    Point,  // not at all (ball joint)
};
// How body B may rotate relative to body A.
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

// State of the two bodies at the start of a step, world axes. Frame A is the joint's frame fixed in body A, frame B
// that fixed in body B; they coincide if the joint has no error and no free axis.
struct JointPose {
    Vector3 armA, armB;  // m, from the center of mass to the anchor
    Vector3 offset;      // m, from A's anchor to B's
    Quaternion frameA, frameB;
    Twist<float> velocityA, velocityB;  // m/s of the centers of mass, rad/s
    float dt = 0, substepDt = 0;        // s
    // The island's joints are solved at once, so that motors of others may take this one to any of its limits within
    // the step, however far.
    bool isDirect = false;
    Position anchorA = Position::Zero();                           // m, world space
    Vector3 turnedA = Vector3::Zero(), turnedB = Vector3::Zero();  // rad: rotation of the bodies in the last step

    // Approximate rotation of B relative to A about an axis in the last step, rad.
    double TurnedAbout(const Vector3& axis) const { return Dot(axis, Vector3(turnedB - turnedA)); }

    // Velocity of B's anchor relative to the point of A at the same place, m/s.
    Vector3 AnchorVelocity() const {
        return velocityB.linear + Cross<float>(velocityB.angular, armB) - velocityA.linear -
               Cross<float>(velocityA.angular, Vector3(armA + offset));
    }
    Vector3 AngularVelocity() const { return velocityB.angular - velocityA.angular; }  // rad/s, of B relative to A
    // Set the Jacobian to that of the motion of B's anchor along the unit axis n of A, and to that of the rotation of B
    // relative to A about `axis`; both rotate with A.
    void SetAlong(JointRow& row, const Vector3& n) const {
        row.turnsWithA = true;
        row.about = false;
        row.pivot = JointRow::Pivot::None;
        row.jacobian = AxisJacobian<float>({armA + offset, armB, n});
    }
    static void SetAbout(JointRow& row, const Vector3& axis) {
        row.turnsWithA = row.about = true;
        row.pivot = JointRow::Pivot::None;
        row.jacobian = AngleJacobian<float>(axis);
    }
    // After SetAbout: the axis is that of the pivot, and stays so while the bodies rotate. ofA, ofB: unit, world.
    static void SetPivot(JointRow& row, JointRow::Pivot pivot, const Vector3& ofA, const Vector3& ofB) {
        row.pivot = pivot;
        row.ofA = ofA;
        row.ofB = ofB;
    }
    // Current rate of the row's C: J v.
    float SpeedOf(const JointRow& row) const { return RelativeMotion<>(row.jacobian, velocityA, velocityB); }
};

struct JointDrawing;

class JointType {
public:
    FULCRUM_WORLD_MEMORY
    virtual ~JointType() = default;

    // The type's name for display, and what to draw of the joint (JointDrawing.h), by default its frames only.
    virtual const char* Kind() const { return "custom"; }
    virtual JointDrawing Drawing() const;

    virtual JointLocks Locks() const { return {}; }
    // Upper bound of the rows that CollectRows adds as long as neither Locks nor motor modes change. If 0, CollectRows
    // is never called.
    virtual uint32_t MaxRows() const { return 0; }
    // Adds the rows of the step. Limits out of reach within the step and motors that are off add none.
    virtual void CollectRows(const JointPose& pose, JointRowList& rows) {
        (void)pose;
        (void)rows;
    }

    // Whether the world takes up part of what it does to its bodies: gears turn in bearings, ropes of pulleys hang from
    // fixed points. Linear and angular momentum of the bodies change then.
    virtual bool ReactsOnWorld() const { return false; }

    // Called once, when the joint is created, with the current poses (velocities and times are zero): types store
    // reference values here, such as the length of a rope or the phase of gears.
    virtual void Start(const JointPose& pose) { (void)pose; }
    // Limits, motor and friction of an axis, which may be read and changed between steps; null if the type has none
    // there.
    virtual AxisControl* Control(JointAxis axis) {
        (void)axis;
        return nullptr;
    }
    // Valid ranges of its limits.
    virtual LimitBounds BoundsOf(JointAxis axis) const {
        (void)axis;
        return {};
    }
    // First slot of an axis' rows, which are in the order of ControlSlots.
    virtual uint32_t FirstSlot(JointAxis axis) const {
        (void)axis;
        return 0;
    }
    // Sets the target orientation of position motors: of frame B relative to frame A, unit. For types with such motors.
    virtual void SetTargetOrientation(const Quaternion& target) { (void)target; }
    // Position of B along or about an axis, m or rad. Default: position of B's anchor along the axis of frame A, and
    // components of the rotation vector of frame B relative to A. Types that count revolutions or measure something
    // else override it.
    virtual double Coordinate(JointAxis axis, const JointPose& pose) const;
    // State that the type keeps from step to step besides impulses; copied by snapshots.
    virtual std::span<double> State() { return {}; }
    // Shows the visitor all other data of the type, always in the same order: settings of its creation and values
    // measured by Start, but not what Control returns. Snapshots use it to compare and to recreate joints.
    virtual void VisitSettings(const SettingVisitor& visit) { (void)visit; }
    // The rows that CollectRows would add, with the type as it is: their errors are read between steps. By default
    // those of CollectRows, after which State has its values again; types that have State override it, since reads may
    // be concurrent.
    virtual void RowsAt(const JointPose& pose, JointRowList& rows) const;

    // By slot, 0 if there was no row: impulses of the last substep, N s or N m s, and the average forces of the step, N
    // or N m. Written by the Store stage, as are the rotations of the last step.
    std::array<float, JointRowList::kMaxRows> impulses{}, forces{};
    Vector3 turnedA = Vector3::Zero(), turnedB = Vector3::Zero();
    // Whoever is faster, or accelerates more, may be driven by its motors and springs, and does not sleep. Written by
    // the Prepare stage of each step.
    struct Quiet {
        float speed = JointRow::kUnlimited, acceleration = JointRow::kUnlimited;  // m/s, m/s2
    };
    Quiet quiet;

protected:
    // RowsAt of a type that may be copied.
    template <class Type>
    static void RowsOfCopy(const Type& type, const JointPose& pose, JointRowList& rows) {
        Type copy(type);
        copy.CollectRows(pose, rows);
    }
};

inline double JointType::Coordinate(JointAxis axis, const JointPose& pose) const {
    const auto index = static_cast<int>(axis);
    if (index < 3) return InverseRotate(pose.frameA, pose.offset)[index];
    return RotationVectorOf<float>(pose.frameA.Conjugate() * pose.frameB)[index - 3];
}

}  // namespace fulcrum
