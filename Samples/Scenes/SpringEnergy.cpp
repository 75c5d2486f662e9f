#include <Fulcrum/Samples/Scenes/SpringEnergy.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace fulcrum {
namespace {

// The rates of a constraint by the velocities of the two bodies, and what an impulse along it does to these.
struct Row {
    std::array<Vector3, 4> jacobian{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
    std::array<Vector3, 4> response{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
};

double ProductOf(const Row& a, const Row& b) {
    double sum = 0;
    for (size_t i = 0; i < 4; ++i) sum += Dot<double>(a.jacobian[i].cast<double>(), b.response[i].cast<double>());
    return sum;
}

struct Side {
    float inverseMass = 0;
    Vector3 inverseInertia = Vector3::Zero();  // along the principal axes
    Quaternion principal;                      // of the principal axes, world space
    Vector3 arm = Vector3::Zero();             // m, from the center of mass to the anchor

    Side(const BodyInterface& bodies, BodyId id, const Position& anchor) {
        if (bodies.GetMotionType(id) != MotionType::Dynamic) return;
        const ShapePtr shape = bodies.GetShape(id);
        const MassProperties& mass = shape->Mass();
        const float density = mass.volume > 0 ? bodies.GetMass(id) / mass.volume : 0;
        inverseMass = 1 / bodies.GetMass(id);
        for (int k = 0; k < 3; ++k)
            if (mass.principalInertia[k] * density > 0) inverseInertia[k] = 1 / (mass.principalInertia[k] * density);
        principal = bodies.GetPose(id).rotation * mass.principalAxes;
        arm = (anchor - bodies.GetCenterOfMass(id)).cast<float>();
    }
    Vector3 Turned(const Vector3& torque) const {
        const Vector3 local = InverseRotate(principal, torque);
        return Rotate(principal, Vector3(local.cwiseProduct(inverseInertia)));
    }
};

struct Ends {
    Side a, b;

    Row RowOf(const Vector3& linear, const Vector3& angularA, const Vector3& angularB) const {
        Row row;
        row.jacobian = {Vector3(-linear), angularA, linear, angularB};
        row.response = {Vector3(linear * -a.inverseMass), a.Turned(angularA), Vector3(linear * b.inverseMass),
                        b.Turned(angularB)};
        return row;
    }
    // `a.arm` ends where B's anchor is.
    Row Along(const Vector3& axis) const {
        return RowOf(axis, Vector3(-Cross<float>(a.arm, axis)), Cross<float>(b.arm, axis));
    }
    Row About(const Vector3& axis) const { return RowOf(Vector3::Zero(), Vector3(-axis), axis); }
};

Vector3 AxisOf(const Pose& frame, int axis) {
    Vector3 unit = Vector3::Zero();
    unit[axis] = 1;
    return Rotate(frame.rotation, unit);
}

// What is left of `row` where the others hold: Gram and Schmidt with the inverse masses as metric.
void TakeOut(std::vector<Row>& others, Row& row) {
    for (const Row& other : others) {
        const double size = ProductOf(other, other);
        if (!(size > 0)) continue;
        const auto part = static_cast<float>(ProductOf(row, other) / size);
        for (size_t i = 0; i < 4; ++i) {
            row.jacobian[i] -= other.jacobian[i] * part;
            row.response[i] -= other.response[i] * part;
        }
    }
}

std::vector<Row> LockRows(const Ends& ends, const Pose& frame, const JointLocks& locks) {
    std::vector<Row> rows;
    const auto add = [&](Row row) {
        const double size = ProductOf(row, row);
        TakeOut(rows, row);
        if (ProductOf(row, row) > 1e-6 * size) rows.push_back(row);
    };
    for (int k = 0; k < 3; ++k)
        if (locks.linear == LinearLock::Point || (locks.linear == LinearLock::Line && k != locks.line))
            add(ends.Along(AxisOf(frame, k)));
    for (int k = 0; k < 3; ++k)
        if (locks.angular == AngularLock::All || (locks.angular == AngularLock::Axis && k != locks.axis))
            add(ends.About(AxisOf(frame, k)));
    return rows;
}

// The mass, kg or kg m2, that a row along an axis acts on; 0 where this file does not know the row.
double EffectiveMass(const PhysicsSystem& system, JointId id, JointAxis axis) {
    const JointInterface& joints = system.Joints();
    const JointType& type = *joints.GetType(id);
    const Pose a = joints.GetFrameA(id), b = joints.GetFrameB(id);
    const Ends ends{{system.Bodies(), joints.GetBodyA(id), b.position},
                    {system.Bodies(), joints.GetBodyB(id), b.position}};
    const std::string_view kind = type.Kind();
    const int k = static_cast<int>(axis);
    const JointLocks locks = type.Locks();
    Row row;
    if (kind == "distance") {
        const Vector3 offset = (b.position - a.position).cast<float>();
        row = ends.Along(Length(offset) > 0 ? Normalized(offset) : AxisOf(a, 0));
    } else if (kind == "pulley" || kind == "gear" || kind == "rack and pinion" || kind == "path" || kind == "custom") {
        return 0;
    } else if (k < 3) {
        row = ends.Along(AxisOf(a, k));
    } else if (locks.angular == AngularLock::Axis) {
        row = ends.About(AxisOf(a, locks.axis));
    } else {
        return 0;
    }
    std::vector<Row> held = LockRows(ends, a, locks);
    TakeOut(held, row);
    const double inverse = ProductOf(row, row);
    return inverse > 0 ? 1 / inverse : 0;
}

}  // namespace

double SpringEnergy(const PhysicsSystem& system) {
    const JointInterface& joints = system.Joints();
    double energy = 0;
    joints.Visit([&](JointId id) {
        if (!joints.IsEnabled(id)) return;
        for (int k = 0; k < 6; ++k) {
            const auto axis = static_cast<JointAxis>(k);
            const AxisControl* control = joints.GetControl(id, axis);
            if (!control || !control->limited || IsHard(control->limits.spring)) continue;
            const double at = joints.GetCoordinate(id, axis);
            const double beyond = std::max({0.0, double{control->limits.min} - at, at - double{control->limits.max}});
            if (!(beyond > 0)) continue;
            const SpringSettings& spring = control->limits.spring;
            const double omega = 6.283185307179586 * double{spring.frequency};
            const double stiffness = spring.mode == SpringMode::StiffnessAndDamping
                                         ? double{spring.stiffness}
                                         : EffectiveMass(system, id, axis) * omega * omega;
            energy += 0.5 * stiffness * beyond * beyond;
        }
    });
    return energy;
}

}  // namespace fulcrum
