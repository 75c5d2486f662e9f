#include <Fulcrum/Physics/Joints/ConeJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

namespace {

constexpr float kPi = 3.14159265f;
// A hundredth of a degree, as in SwingTwist.h: a half angle closer to 0 is a locked axis, one closer to 180 degrees no
// limit.
constexpr float kNarrow = 1.7e-4f;

struct Swing {
    float angle;   // rad
    Vector3 axis;  // unit
};

Swing SwingOf(const Quaternion& frameA, const Quaternion& frameB) {
    const Matrix3 a = ToMatrix(frameA);
    const Vector3 xB = ToMatrix(frameB).x;
    const Vector3 across = Cross(a.x, xB);
    const float sine = Length(across);
    return {Atan2(sine, Dot(a.x, xB)), sine > 1e-6f ? Vector3(across * (1.0f / sine)) : a.y};
}

}  // namespace

MaybeError Check(const ConeJointSettings& s) {
    return CheckWith(s, CheckRange("halfAngle", s.halfAngle, 0.0, static_cast<double>(kPi)),
                     CheckSpring("spring", s.spring));
}

std::unique_ptr<JointType> MakeType(const ConeJointSettings& s) {
    return std::make_unique<ConeJoint>(s.halfAngle, s.spring);
}

ConeJoint::ConeJoint(float halfAngle, const SpringSettings& spring) {
    control_.limited = true;
    control_.limits = {-std::numeric_limits<float>::infinity(), halfAngle, spring};
}

bool ConeJoint::IsAxle() const { return control_.limits.max < kNarrow && IsHard(control_.limits.spring); }
bool ConeJoint::IsFree() const { return control_.limits.max > kPi - kNarrow; }

JointLocks ConeJoint::Locks() const {
    return {LinearLock::Point, IsAxle() ? AngularLock::Axis : AngularLock::None, 0, 0};
}

void ConeJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const Swing swing = SwingOf(pose.frameA, pose.frameB);
    JointRow motion;
    pose.SetAbout(motion, swing.axis);
    pose.SetPivot(motion, JointRow::Pivot::Across, ToMatrix(pose.frameA).x, ToMatrix(pose.frameB).x);
    // Rotation perpendicular to e increases the angle, too, the more the closer the axes are: use the whole angular
    // velocity.
    const Vector3 angular = pose.AngularVelocity();
    const float across = Length(Vector3(angular - swing.axis * Dot(angular, swing.axis)));
    AddControlRows(control_, pose, motion, swing.angle, kAngularSlackSpeed + across, 0, rows);
}

double ConeJoint::Coordinate(JointAxis axis, const JointPose& pose) const {
    return axis == JointAxis::AngularY ? static_cast<double>(SwingOf(pose.frameA, pose.frameB).angle)
                                       : JointType::Coordinate(axis, pose);
}

JointDrawing ConeJoint::Drawing() const { return {.rotations = true, .coneAngle = HalfAngle()}; }

}  // namespace fulcrum
