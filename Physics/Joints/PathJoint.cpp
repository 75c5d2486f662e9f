#include <Fulcrum/Physics/Joints/PathJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Constraints/Parts/RotationEulerPart.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

struct PathSlots {
    static constexpr uint32_t kAcross = 0, kAlong = 2, kRotation = 6;
};

// Arc length of B's anchor along the path.
double DistanceAlong(const Path& path, double parameter, const PathSample& at, const Vector3& local) {
    const double beyond = path.IsClosed() ? 0.0 : static_cast<double>(Dot(Vector3(local - at.position), at.tangent));
    return path.LengthAt(parameter) + beyond;
}

}  // namespace

MaybeError Check(const PathJointSettings& s) {
    if (MaybeError e =
            CheckWith(s, CheckControl("along", s.along), CheckEnum("rotation", s.rotation, PathRotation::Constant)))
        return e;
    if (s.path) return std::nullopt;
    return Error{ErrorCode::Unsupported, "path is null; the joint needs one"};
}

std::unique_ptr<JointType> MakeType(const PathJointSettings& s) {
    return std::make_unique<PathJoint>(s.path, s.along, s.rotation);
}

uint32_t PathJoint::FirstSlot(JointAxis axis) const { return axis == JointAxis::LinearX ? PathSlots::kAlong : 0; }

PathJoint::PathJoint(std::shared_ptr<const Path> path, const AxisControl& along, PathRotation rotation)
    : path_(std::move(path)), along_(along), rotation_(rotation) {}

AxisControl PathJoint::Bounded() const {
    if (path_->IsClosed()) return along_;
    AxisControl bounded = along_;
    const auto end = static_cast<float>(path_->Length());
    bounded.limits.min = along_.limited ? std::clamp(along_.limits.min, 0.0f, end) : 0.0f;
    bounded.limits.max = along_.limited ? std::clamp(along_.limits.max, 0.0f, end) : end;
    bounded.limited = true;
    return bounded;
}

uint32_t PathJoint::MaxRows() const {
    const uint32_t rotations = rotation_ == PathRotation::Tangent            ? 2
                               : rotation_ == PathRotation::TangentAndNormal ? 3
                                                                             : 0;
    return 2 + MaxControlRows(Bounded()) + rotations;
}

void PathJoint::Start(const JointPose& pose) { parameter_ = path_->Closest(InverseRotate(pose.frameA, pose.offset)); }

void PathJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const Vector3 local = InverseRotate(pose.frameA, pose.offset);
    parameter_ = path_->Closest(local, parameter_);
    const PathSample at = path_->Sample(parameter_);
    const Vector3 away = local - at.position;
    // The force on A acts at the point of the path where B should be: a lever arm as long as the gap would spin up the
    // bodies.
    constexpr float kNear = 0.1f;  // m
    const float squaredGap = LengthSquared(away);
    const bool isNear = squaredGap < kNear * kNear;
    JointPose acting = pose;
    if (!isNear) acting.armA -= Rotate(pose.frameA, away);
    JointRow along;
    acting.SetAlong(along, Rotate(pose.frameA, at.tangent));
    const double distance = DistanceAlong(*path_, parameter_, at, local);
    AddControlRows(Bounded(), pose, along, distance, kLinearSlackSpeed, PathSlots::kAlong, rows);
    // Far from a curve the nearest point moves along it as bodies rotate, by the gap times their angle, and its frame
    // rotates by that over the radius of curvature: rotation is locked where that is less than half of their angle.
    const bool isFollowing = isNear || squaredGap * LengthSquared(at.turn) < 0.25f;
    if (isFollowing && (rotation_ == PathRotation::Tangent || rotation_ == PathRotation::TangentAndNormal))
        AddRotationRows(pose, at, along, rows);
    uint32_t slot = PathSlots::kAcross;
    for (const Vector3& normal : {at.normal, at.binormal}) {
        JointRow& row = rows.Add(slot++, JointRow::Kind::Equal);
        acting.SetAlong(row, Rotate(pose.frameA, normal));
        row.error = Dot(away, normal);
    }
}

void PathJoint::AddRotationRows(const JointPose& pose, const PathSample& at, const JointRow& along,
                                JointRowList& rows) const {
    const Quaternion ofPath = RotationFromAxesXY(at.tangent, at.normal);
    const Quaternion ofB = ofPath.Conjugate() * (pose.frameA.Conjugate() * pose.frameB);
    // Rotation error of B in the path's frame. If free about the tangent: the rotation between the x axes.
    Vector3 error;
    if (rotation_ == PathRotation::TangentAndNormal) {
        error = RotationVectorOf<float>(ofB);
    } else {
        const Vector3 x = ToMatrix(ofB).x;
        const float sine = std::sqrt(x.y() * x.y() + x.z() * x.z()), angle = Atan2(sine, x.x());
        const float scale = sine > 1e-6f ? angle / sine : 1.0f;
        // Opposite axes: any perpendicular axis, so the normal.
        error = sine > 1e-6f || x.x() > 0.0f ? Vector3(0, -x.z() * scale, x.y() * scale) : Vector3(0, angle, 0);
    }
    // Large errors are pulled, by rotations about the centers of mass that do not move B along the path: with the
    // frame's share of it they would be about other axes, and never end.
    constexpr float kLarge = 0.5f;  // rad
    const bool movesFrame = LengthSquared(error) < kLarge * kLarge;
    const Vector3 axes[3] = {at.tangent, at.normal, at.binormal};
    for (int k = rotation_ == PathRotation::Tangent ? 1 : 0; k < 3; ++k) {
        JointRow& row = rows.Add(PathSlots::kRotation + static_cast<uint32_t>(k), JointRow::Kind::Equal);
        pose.SetAbout(row, Rotate(pose.frameA, axes[k]));
        const float turn = movesFrame ? Dot(axes[k], at.turn) : 0.0f;
        RowJacobian<float>& j = row.jacobian;
        j.a.linear -= along.jacobian.a.linear * turn;
        j.a.angular -= along.jacobian.a.angular * turn;
        j.b.linear -= along.jacobian.b.linear * turn;
        j.b.angular -= along.jacobian.b.angular * turn;
        row.error = error[k];
    }
}

double PathJoint::Coordinate(JointAxis axis, const JointPose& pose) const {
    if (axis != JointAxis::LinearX) return JointType::Coordinate(axis, pose);
    const Vector3 local = InverseRotate(pose.frameA, pose.offset);
    const double parameter = path_->Closest(local, parameter_);
    return DistanceAlong(*path_, parameter, path_->Sample(parameter), local);
}

std::span<double> PathJoint::State() { return {&parameter_, 1}; }

void PathJoint::VisitSettings(const SettingVisitor& visit) {
    visit(rotation_);
    uint32_t count = static_cast<uint32_t>(path_->Points().size());
    bool isClosed = path_->IsClosed();
    visit(count);
    visit(isClosed);
    const auto visitPoint = [&](PathPoint& point) {
        visit(point.position);
        visit(point.tangent);
        visit(point.normal);
    };
    if (!visit.IsReplacing()) {
        for (PathPoint point : path_->Points()) visitPoint(point);
        return;
    }
    std::vector<PathPoint> points(count);
    for (PathPoint& point : points) visitPoint(point);
    Result<std::shared_ptr<const Path>> path = Path::Hermite(points, isClosed);
    if (path) path_ = std::move(path.Value());
}

JointDrawing PathJoint::Drawing() const { return {.path = path_}; }

}  // namespace fulcrum
