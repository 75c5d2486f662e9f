// Path joint: B's anchor stays on a path fixed in A's frame, driven or free, and B may rotate with the path.
//
//   P, T, N, B, turn  of the path at the point nearest to B's anchor (Path.h), world space       u = p2 - p1, e = u - P
//   s           arc length of that point from the start of the path, m
//   Rows:       C = e . N, e . B, J = [-n, -(r1 + u) x n, n, r2 x n] with n = N, B
//               C = s - ..., the same with n = T (LinearX)
//               rotation: with c the rotation vector from the path's frame to B's, C = c . n, and
//               dC/dt = n . (w2 - w1) - (n . turn) ds/dt: the path's frame turns as B moves along
// An open path has stops at its ends. If they are soft, B may run beyond: the path goes on straight there, P = P_end +
// (e . T) T without turn.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Constraints/Joints/Path.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

enum class PathRotation : uint8_t {
    Free,              // B rotates freely
    Tangent,           // the x axis of B's frame is along the path
    TangentAndNormal,  // and its y axis along the normal
    Constant,          // B does not rotate relative to A
};

// B's anchor stays on a path that is given in the frame of A's anchor. If B rotates with the path, its frame is aligned
// with the path's: x along the tangent, y along the normal. So give anchor B: the attachment point, and which axes of B
// these are.
struct PathJointSettings : JointSettings {
    std::shared_ptr<const Path> path = Path::Straight(1.0f);  // not null
    AxisControl along{};                                      // m from its start, m/s, N
    PathRotation rotation = PathRotation::Free;
};
MaybeError Check(const PathJointSettings& settings);
std::unique_ptr<JointType> MakeType(const PathJointSettings& settings);

class PathJoint final : public JointType {
public:
    // along: m, N; measured from the start of the path; on closed paths laps are counted.
    PathJoint(std::shared_ptr<const Path> path, const AxisControl& along, PathRotation rotation);

    const char* Kind() const override { return "path"; }
    JointDrawing Drawing() const override;
    JointLocks Locks() const override {
        return {LinearLock::None, rotation_ == PathRotation::Constant ? AngularLock::All : AngularLock::None, 0, 0};
    }
    uint32_t MaxRows() const override;
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    void RowsAt(const JointPose& pose, JointRowList& rows) const override { RowsOfCopy(*this, pose, rows); }
    AxisControl* Control(JointAxis axis) override { return axis == JointAxis::LinearX ? &along_ : nullptr; }
    uint32_t FirstSlot(JointAxis axis) const override;
    double Coordinate(JointAxis axis, const JointPose& pose) const override;
    std::span<double> State() override;
    void VisitSettings(const SettingVisitor& visit) override;
    const Path& GetPath() const { return *path_; }

private:
    AxisControl Bounded() const;
    void AddRotationRows(const JointPose& pose, const PathSample& at, const JointRow& along, JointRowList& rows) const;

    std::shared_ptr<const Path> path_;
    AxisControl along_;
    PathRotation rotation_;
    double parameter_ = 0;
};

}  // namespace fulcrum
