// The fields of all settings, each once: for files of scenes, their schema, and recordings of calls. An archive has
//   Field(name, value)            a number, vector, text, shape, another structure or an optional one
//   Choice(name, value, names)    an enumeration by the names of its values, in their order
// No state.
#pragma once

#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/Physics/Settings.h>

#include <array>

namespace fulcrum {

inline constexpr std::array kMotionNames = {"Static", "Kinematic", "Dynamic"};
inline constexpr std::array kCombineRuleNames = {"GeometricMean", "Average", "Minimum", "Multiply", "Maximum"};

template <class Archive>
void Describe(Archive& archive, SpringSettings& s) {
    archive.Choice("mode", s.mode, std::array{"FrequencyAndDamping", "StiffnessAndDamping"});
    archive.Field("frequency", s.frequency);
    archive.Field("dampingRatio", s.dampingRatio);
    archive.Field("stiffness", s.stiffness);
    archive.Field("damping", s.damping);
    archive.Choice("form", s.form, std::array{"Automatic", "Exact", "Implicit"});
}

template <class Archive>
void Describe(Archive& archive, JointLimits& s) {
    archive.Field("min", s.min);
    archive.Field("max", s.max);
    archive.Field("spring", s.spring);
}

template <class Archive>
void Describe(Archive& archive, JointMotor& s) {
    archive.Choice("mode", s.mode, std::array{"Off", "ToVelocity", "ToPosition"});
    archive.Field("targetSpeed", s.targetSpeed);
    archive.Field("targetPosition", s.targetPosition);
    archive.Field("spring", s.spring);
    archive.Field("minForce", s.minForce);
    archive.Field("maxForce", s.maxForce);
}

template <class Archive>
void Describe(Archive& archive, AxisControl& s) {
    archive.Field("limited", s.limited);
    archive.Field("limits", s.limits);
    archive.Field("motor", s.motor);
    archive.Field("friction", s.friction);
}

template <class Archive>
void Describe(Archive& archive, JointAnchor& s) {
    archive.Field("point", s.point);
    archive.Field("axis", s.axis);
    archive.Field("normal", s.normal);
}

template <class Archive>
void Describe(Archive& archive, MassOverride& s) {
    archive.Field("inverseMassScaleA", s.inverseMassScaleA);
    archive.Field("inverseInertiaScaleA", s.inverseInertiaScaleA);
    archive.Field("inverseMassScaleB", s.inverseMassScaleB);
    archive.Field("inverseInertiaScaleB", s.inverseInertiaScaleB);
}

template <class Archive>
void DescribeShared(Archive& archive, JointSettings& s) {
    archive.Choice("space", s.space, std::array{"World", "Body"});
    archive.Field("anchorA", s.anchorA);
    archive.Field("anchorB", s.anchorB);
    archive.Field("enabled", s.enabled);
    archive.Field("collideConnected", s.collideConnected);
    archive.Choice("priority", s.priority, std::array{"Normal", "High"});
    archive.Field("breakForce", s.breakForce);
    archive.Field("breakTorque", s.breakTorque);
    archive.Field("substeps", s.substeps);
    archive.Field("velocityIterations", s.velocityIterations);
    archive.Field("positionIterations", s.positionIterations);
    archive.Field("errorTarget", s.errorTarget);
    archive.Field("massOverride", s.massOverride);
    archive.Field("userData", s.userData);
}

template <class Archive>
void Describe(Archive& archive, PointJointSettings& s) {
    DescribeShared(archive, s);
}
template <class Archive>
void Describe(Archive& archive, FixedJointSettings& s) {
    DescribeShared(archive, s);
}
template <class Archive>
void Describe(Archive& archive, HingeJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("angle", s.angle);
}
template <class Archive>
void Describe(Archive& archive, ConeJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("halfAngle", s.halfAngle);
    archive.Field("spring", s.spring);
}
template <class Archive>
void Describe(Archive& archive, SwingTwistJointSettings& s) {
    DescribeShared(archive, s);
    archive.Choice("shape", s.shape, std::array{"Ellipse", "Pyramid"});
    archive.Field("twist", s.twist);
    archive.Field("swingY", s.swingY);
    archive.Field("swingZ", s.swingZ);
}
template <class Archive>
void Describe(Archive& archive, SixDofJointSettings& s) {
    DescribeShared(archive, s);
    archive.Choice("shape", s.shape, std::array{"Ellipse", "Pyramid"});
    constexpr std::array kNames = {"linearX", "linearY", "linearZ", "angularX", "angularY", "angularZ"};
    for (size_t k = 0; k < kNames.size(); ++k) archive.Field(kNames[k], s.axes[k]);
}

template <class Archive>
void Describe(Archive& archive, DistanceJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("minDistance", s.minDistance);
    archive.Field("maxDistance", s.maxDistance);
    archive.Field("spring", s.spring);
}
template <class Archive>
void Describe(Archive& archive, SliderJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("slide", s.slide);
}
template <class Archive>
void Describe(Archive& archive, GearJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("ratio", s.ratio);
}
template <class Archive>
void Describe(Archive& archive, RackAndPinionJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("ratio", s.ratio);
}
template <class Archive>
void Describe(Archive& archive, PulleyJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("fixedPointA", s.fixedPointA);
    archive.Field("fixedPointB", s.fixedPointB);
    archive.Field("ratio", s.ratio);
    archive.Field("minLength", s.minLength);
    archive.Field("maxLength", s.maxLength);
}
template <class Archive>
void Describe(Archive& archive, PathPoint& s) {
    archive.Field("position", s.position);
    archive.Field("tangent", s.tangent);
    archive.Field("normal", s.normal);
}
template <class Archive>
void Describe(Archive& archive, PathJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("path", s.path);
    archive.Field("along", s.along);
    archive.Choice("rotation", s.rotation, std::array{"Free", "Tangent", "TangentAndNormal", "Constant"});
}
template <class Archive>
void Describe(Archive& archive, WheelJointSettings& s) {
    DescribeShared(archive, s);
    archive.Field("suspension", s.suspension);
    archive.Field("isSteered", s.isSteered);
    archive.Field("steering", s.steering);
    archive.Field("spin", s.spin);
}

template <class Archive>
void Describe(Archive& archive, Material& s) {
    archive.Field("friction", s.friction);
    archive.Field("restitution", s.restitution);
    archive.Choice("frictionRule", s.frictionRule, kCombineRuleNames);
    archive.Choice("restitutionRule", s.restitutionRule, kCombineRuleNames);
}

template <class Archive>
void Describe(Archive& archive, BodySettings& s) {
    archive.Field("shape", s.shape);
    archive.Choice("motion", s.motion, kMotionNames);
    archive.Field("position", s.position);
    archive.Field("rotation", s.rotation);
    archive.Field("linearVelocity", s.linearVelocity);
    archive.Field("angularVelocity", s.angularVelocity);
    archive.Field("density", s.density);
    archive.Field("mass", s.mass);
    archive.Field("inertia", s.inertia);
    archive.Field("material", s.material);
    archive.Field("linearDamping", s.linearDamping);
    archive.Field("angularDamping", s.angularDamping);
    archive.Field("gravityFactor", s.gravityFactor);
    archive.Field("lockedAxes", s.lockedAxes);
    archive.Field("maxLinearSpeed", s.maxLinearSpeed);
    archive.Field("maxAngularSpeed", s.maxAngularSpeed);
    archive.Field("gyroscopicTorque", s.gyroscopicTorque);
    archive.Field("allowSleep", s.allowSleep);
    archive.Field("startAsleep", s.startAsleep);
    archive.Field("layer", s.layer);
    archive.Field("category", s.category);
    archive.Field("mask", s.mask);
    archive.Choice("continuous", s.continuous, std::array{"Off", "Linear", "LinearAndAngular"});
    archive.Field("userData", s.userData);
    archive.Field("penetrationTarget", s.penetrationTarget);
    archive.Field("reportsContacts", s.reportsContacts);
    archive.Field("isSensor", s.isSensor);
    archive.Field("sensorSees", s.sensorSees);
    archive.Field("sensorReportsStay", s.sensorReportsStay);
}

template <class Archive>
void Describe(Archive& archive, SolverSettings& s) {
    archive.Field("substeps", s.substeps);
    archive.Field("velocityIterations", s.velocityIterations);
    archive.Field("positionIterations", s.positionIterations);
    archive.Choice("positionCorrection", s.positionCorrection, std::array{"SoftRelax", "Baumgarte"});
    archive.Field("baumgarte", s.baumgarte);
    archive.Field("baumgarteSlop", s.baumgarteSlop);
}

template <class Archive>
void Describe(Archive& archive, AccuracyTarget& s) {
    archive.Field("penetration", s.penetration);
    archive.Field("jointError", s.jointError);
}

template <class Archive>
void Describe(Archive& archive, SleepSettings& s) {
    archive.Field("enabled", s.enabled);
    archive.Field("seconds", s.seconds);
    archive.Field("linearSpeed", s.linearSpeed);
}

template <class Archive>
void Describe(Archive& archive, EventSettings& s) {
    archive.Field("contacts", s.contacts);
    archive.Field("stays", s.stays);
    archive.Field("bodies", s.bodies);
}

template <class Archive>
void Describe(Archive& archive, SystemSettings& s) {
    archive.Field("gravity", s.gravity);
    archive.Field("solver", s.solver);
    archive.Field("accuracy", s.accuracy);
    archive.Field("sleep", s.sleep);
    archive.Field("events", s.events);
    archive.Field("measuresErrors", s.measuresErrors);
    archive.Choice("narrowPhase", s.narrowPhase, std::array{"Automatic", "Libccd"});
    archive.Field("speculativeDistance", s.speculativeDistance);
    archive.Field("penetrationSlop", s.penetrationSlop);
    archive.Field("contactFrequency", s.contactFrequency);
    archive.Field("contactDampingRatio", s.contactDampingRatio);
    archive.Field("contactPushSpeed", s.contactPushSpeed);
    archive.Field("depenetrationSpeed", s.depenetrationSpeed);
    archive.Field("exactJointLoad", s.exactJointLoad);
    archive.Field("jointPushSpeed", s.jointPushSpeed);
    archive.Field("restitutionSpeed", s.restitutionSpeed);
    archive.Field("boundsMargin", s.boundsMargin);
    archive.Field("layerCollides", s.layerCollides);
}

}  // namespace fulcrum
