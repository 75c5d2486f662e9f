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

// The point nearest to B's anchor: of the path or, beyond the ends of an open one, of its tangent there.
struct Nearest {
    PathSample at;
    Vector3 onPath;   // m, the nearest point of the path itself
    double distance;  // m, arc length
};

Nearest NearestOf(const Path& path, double parameter, const Vector3& local) {
    Nearest nearest{path.Sample(parameter), {}, path.LengthAt(parameter)};
    PathSample& at = nearest.at;
    nearest.onPath = at.position;
    if (path.IsClosed()) return nearest;
    const float along = Dot(Vector3(local - at.position), at.tangent);
    nearest.distance += static_cast<double>(along);
    if ((parameter <= 0.0 && along < 0.0f) || (parameter >= path.End() && along > 0.0f)) {
        at.position += at.tangent * along;
        at.second = at.turn = Vector3::Zero();
    }
    return nearest;
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
    const auto [at, onPath, distance] = NearestOf(*path_, parameter_, local);
    const AxisControl control = Bounded();
    const Vector3 away = local - at.position;
    // The force on A acts at the point where B should be: a lever arm as long as the gap would spin up the bodies. A
    // soft limit lets B run beyond the end.
    constexpr float kNear = 0.1f;  // m
    const Vector3 gap = IsHard(control.limits.spring) ? Vector3(local - onPath) : away;
    const float squaredGap = LengthSquared(gap);
    const bool isNear = squaredGap < kNear * kNear;
    JointPose acting = pose;
    if (!isNear) acting.armA -= Rotate(pose.frameA, gap);
    JointRow along;
    acting.SetAlong(along, Rotate(pose.frameA, at.tangent));
    uint32_t slot = PathSlots::kAcross;
    for (const Vector3& normal : {at.normal, at.binormal}) {
        JointRow& row = rows.Add(slot++, JointRow::Kind::Equal);
        row.isLock = true;
        acting.SetAlong(row, Rotate(pose.frameA, normal));
        row.error = Dot(away, normal);
    }
    // Far from a curve the nearest point moves along it as bodies rotate, by the gap times their angle, and its frame
    // rotates by that over the radius of curvature: rotation is locked where that is less than half of their angle.
    const bool isFollowing = squaredGap * LengthSquared(at.turn) < 0.25f;
    if (isFollowing && (rotation_ == PathRotation::Tangent || rotation_ == PathRotation::TangentAndNormal))
        AddRotationRows(pose, at, along, rows);
    AddControlRows(control, pose, along, distance, kLinearSlackSpeed, PathSlots::kAlong, rows);
}

void PathJoint::AddRotationRows(const JointPose& pose, const PathSample& at, const JointRow& along,
                                JointRowList& rows) const {
    const Quaternion ofPath = RotationFromAxesXZ(at.tangent, at.binormal);
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
    // Large errors are corrected by rotations that do not move B along the path: with the frame's share of it they
    // would be about other axes, and never end.
    constexpr float kLarge = 0.5f;  // rad
    const bool movesFrame = LengthSquared(error) < kLarge * kLarge;
    const Vector3 axes[3] = {at.tangent, at.normal, at.binormal};
    for (int k = rotation_ == PathRotation::Tangent ? 1 : 0; k < 3; ++k) {
        JointRow& row = rows.Add(PathSlots::kRotation + static_cast<uint32_t>(k), JointRow::Kind::Equal);
        row.isLock = true;
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
    return NearestOf(*path_, path_->Closest(local, parameter_), local).distance;
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
