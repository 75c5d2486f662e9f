#include <Fulcrum/UnitTests/Random/Twin.h>

#include <cmath>
#include <sstream>

namespace fulcrum::testing {

namespace {

void AddBody(const BodyInterface& bodies, BodyId id, BitHash& hash) {
    hash.Add(id);
    hash.Add(bodies.GetPose(id));
    hash.Add(bodies.GetCenterOfMass(id));
    hash.Add(bodies.GetLinearVelocity(id));
    hash.Add(bodies.GetAngularVelocity(id));
    hash.Add(bodies.GetAngularMomentum(id));
    hash.Add(bodies.GetMass(id));
    hash.Add(bodies.GetMotionType(id));
    hash.Add(bodies.GetContinuous(id));
    hash.Add(bodies.GetCategory(id));
    hash.Add(bodies.GetMask(id));
    hash.Add(bodies.GetGroup(id).group);
    hash.Add(bodies.GetGroup(id).subGroup);
    hash.Add(bodies.GetUserData(id));
    hash.Add(bodies.IsSensor(id));
    hash.Add(bodies.IsAwake(id));
    hash.Add(bodies.IsFrozen(id));
    if (const ShapePtr shape = bodies.GetShape(id)) {
        hash.Add(shape->Type());
        hash.Add(shape->LocalBounds().lower);
        hash.Add(shape->LocalBounds().upper);
        hash.Add(shape->Mass().centerOfMass);
    }
    if (const MutableCompound* children = bodies.GetChildren(id)) hash.Add(children->Count());
}

void AddControl(const AxisControl& control, BitHash& hash) {
    hash.Add(control.limited);
    hash.Add(control.limits.min);
    hash.Add(control.limits.max);
    hash.Add(control.limits.spring.frequency);
    hash.Add(control.motor.mode);
    hash.Add(control.motor.targetSpeed);
    hash.Add(control.motor.targetPosition);
    hash.Add(control.motor.minForce);
    hash.Add(control.motor.maxForce);
    hash.Add(control.friction);
}

void AddJoint(const JointInterface& joints, JointId id, BitHash& hash) {
    hash.Add(id);
    hash.Add(joints.IsEnabled(id));
    hash.Add(joints.GetForce(id));
    hash.Add(joints.GetTorque(id));
    hash.Add(joints.GetFrameA(id));
    hash.Add(joints.GetFrameB(id));
    hash.Add(joints.GetError(id).distance);
    for (int axis = 0; axis < 6; ++axis) {
        hash.Add(joints.GetCoordinate(id, static_cast<JointAxis>(axis)));
        if (const AxisControl* control = joints.GetControl(id, static_cast<JointAxis>(axis)))
            AddControl(*control, hash);
    }
}

void AddSettings(const SystemSettings& settings, BitHash& hash) {
    hash.Add(settings.gravity);
    hash.Add(settings.solver.substeps);
    hash.Add(settings.solver.velocityIterations);
    hash.Add(settings.solver.positionIterations);
    hash.Add(settings.solver.positionCorrection);
    hash.Add(settings.solver.baumgarte);
    hash.Add(settings.solver.baumgarteSlop);
    hash.Add(settings.sleep.enabled);
    hash.Add(settings.sleep.seconds);
    hash.Add(settings.speculativeDistance);
    hash.Add(settings.contactPushSpeed);
    hash.Add(settings.depenetrationSpeed);
    hash.Add(settings.boundsMargin);
    for (const uint32_t layer : settings.layerCollides) hash.Add(layer);
}

// Names the first thing that is wrong.
class Complaints {
public:
    template <class T>
    void Finite(const char* what, uint32_t index, const T& value) {
        if (IsFine(value) || !text_.empty()) return;
        std::ostringstream text;
        text << what << " of " << index << " is not finite";
        text_ = text.str();
    }
    void Holds(const char* what, uint32_t index, bool holds) {
        if (holds || !text_.empty()) return;
        std::ostringstream text;
        text << what << " of " << index;
        text_ = text.str();
    }
    const std::string& Text() const { return text_; }

private:
    static bool IsFine(float value) { return std::isfinite(value); }
    static bool IsFine(double value) { return std::isfinite(value); }
    template <class T>
    static bool IsFine(const T& value) {
        return IsFinite(value);
    }
    std::string text_;
};

void CheckBodies(const Twin& twin, Complaints& complaints) {
    const BodyInterface& bodies = twin.system->Bodies();
    twin.system->VisitBodies([&](BodyId id) {
        const Pose pose = bodies.GetPose(id);
        complaints.Finite("body: position", id.index, pose.position);
        complaints.Finite("body: rotation", id.index, pose.rotation);
        complaints.Holds("body: rotation is no unit quaternion", id.index,
                         std::abs(LengthSquared(pose.rotation) - 1) < 1e-4f);
        complaints.Finite("body: center of mass", id.index, bodies.GetCenterOfMass(id));
        complaints.Finite("body: linear velocity", id.index, bodies.GetLinearVelocity(id));
        complaints.Finite("body: angular velocity", id.index, bodies.GetAngularVelocity(id));
        complaints.Finite("body: kinetic energy", id.index, bodies.GetKineticEnergy(id));
        complaints.Finite("body: mass", id.index, bodies.GetMass(id));
        complaints.Holds("body: frozen and not at rest", id.index,
                         !bodies.IsFrozen(id) ||
                             (bodies.GetLinearVelocity(id).isZero(0) && bodies.GetAngularVelocity(id).isZero(0)));
    });
}

void CheckContacts(const Twin& twin, Complaints& complaints) {
    twin.system->VisitContacts([&](const ContactView& contact) {
        const uint32_t index = contact.bodyA.index;
        complaints.Finite("contact: normal", index, contact.normal);
        complaints.Holds("contact: normal is no unit vector", index,
                         std::abs(LengthSquared(contact.normal) - 1) < 1e-3f);
        complaints.Holds("contact: number of points", index, !contact.points.empty() && contact.points.size() <= 4);
        for (const ContactView::Point& point : contact.points) {
            complaints.Finite("contact: position", index, point.position);
            complaints.Finite("contact: separation", index, point.separation);
            complaints.Finite("contact: impulse", index, point.impulse);
        }
    });
}

void CheckJoints(const Twin& twin, Complaints& complaints) {
    const JointInterface& joints = twin.system->Joints();
    joints.Visit([&](JointId id) {
        complaints.Finite("joint: force", id.index, joints.GetForce(id));
        complaints.Finite("joint: torque", id.index, joints.GetTorque(id));
        complaints.Finite("joint: lock force", id.index, joints.GetLockForce(id));
        complaints.Finite("joint: lock torque", id.index, joints.GetLockTorque(id));
        complaints.Finite("joint: frame A", id.index, joints.GetFrameA(id).position);
        complaints.Finite("joint: frame B", id.index, joints.GetFrameB(id).position);
        complaints.Finite("joint: error", id.index, joints.GetError(id).distance);
        complaints.Finite("joint: angle error", id.index, joints.GetError(id).angle);
        for (int axis = 0; axis < 6; ++axis)
            complaints.Finite("joint: coordinate", id.index, joints.GetCoordinate(id, static_cast<JointAxis>(axis)));
    });
}

void CheckReports(const Twin& twin, Complaints& complaints) {
    const StepReport& report = twin.system->Report();
    complaints.Finite("report: largest penetration", 0, report.largestPenetration);
    complaints.Finite("report: largest joint error", 0, report.largestJointError);
    complaints.Finite("report: largest joint angle", 0, report.largestJointAngle);
    const StepErrors& errors = report.errors;
    complaints.Finite("report: energy change", 0, errors.energyChange);
    complaints.Finite("report: energy gain", 0, errors.energyGain);
    complaints.Finite("report: momentum error", 0, errors.momentumError);
    complaints.Finite("report: angular momentum error", 0, errors.angularMomentumError);
    complaints.Finite("report: push energy", 0, errors.pushEnergy);
    for (const SensorEvent& event : twin.system->SensorEvents())
        complaints.Holds("sensor event: time", event.sensor.index, event.time >= 0 && event.time <= 1);
}

}  // namespace

uint64_t HashOfState(const Twin& twin) {
    BitHash hash;
    twin.system->VisitBodies([&](BodyId id) { AddBody(twin.system->Bodies(), id, hash); });
    twin.system->Joints().Visit([&](JointId id) { AddJoint(twin.system->Joints(), id, hash); });
    AddSettings(twin.system->Settings(), hash);
    for (const SensorEvent& event : twin.system->SensorEvents()) {
        hash.Add(event.sensor);
        hash.Add(event.body);
        hash.Add(event.kind);
        hash.Add(event.time);
    }
    return hash.Value();
}

std::string WrongIn(const Twin& twin) {
    Complaints complaints;
    CheckBodies(twin, complaints);
    CheckContacts(twin, complaints);
    CheckJoints(twin, complaints);
    CheckReports(twin, complaints);
    return complaints.Text();
}

double KineticEnergy(const Twin& twin) {
    double sum = 0;
    twin.system->VisitBodies([&](BodyId id) {
        if (twin.system->Bodies().GetMotionType(id) == MotionType::Dynamic)
            sum += twin.system->Bodies().GetKineticEnergy(id);
    });
    return sum;
}

}  // namespace fulcrum::testing
