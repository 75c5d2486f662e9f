// Helpers of the tests of joints: joints in one line, static bodies to attach others to, and a fit of an oscillator to
// samples. Header only; one thread at a time.
#pragma once

#include <Fulcrum/UnitTests/Support/JointOf.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <optional>
#include <vector>

namespace fulcrum::testing {

inline JointInterface& JointsOf(TestWorld& world) { return world.System().Joints(); }

// Fails the test if the settings are invalid.
template <class Settings>
JointId Join(TestWorld& world, const Settings& settings) {
    const Result<JointId> id = JointsOf(world).Create(settings);
    if (id) return id.Value();
    ADD_FAILURE() << id.GetError().message;
    return {};
}

// Nothing falls and nothing sleeps.
inline SystemSettings Weightless() {
    SystemSettings settings = NoGravity();
    settings.sleep.enabled = false;
    return settings;
}

// A small static body to attach joints to, which collides with nothing.
inline BodyId AddHook(TestWorld& world, const Position& position = Position::Zero()) {
    return world.Add({.shape = SphereOf(0.01f), .motion = MotionType::Static, .position = position});
}

// Body A at A's anchor, in world space; B where it is.
inline JointSettings Between(BodyId a, BodyId b, const Position& point, const Vector3& axis = Vector3(1, 0, 0)) {
    JointSettings settings;
    settings.bodyA = a;
    settings.bodyB = b;
    settings.anchorA.point = point;
    settings.anchorA.axis = axis;
    return settings;
}

// The same with a frame whose axes are those of the world.
inline JointSettings UprightBetween(BodyId a, BodyId b, const Position& point) {
    JointSettings settings = Between(a, b, point);
    settings.anchorA.normal = Vector3(0, 1, 0);
    return settings;
}

inline JointAnchor AnchorAt(const Position& point, const Vector3& axis = Vector3(1, 0, 0)) {
    JointAnchor anchor;
    anchor.point = point;
    anchor.axis = axis;
    return anchor;
}

inline AxisControl Limited(double min, double max, const SpringSettings& spring = {}) {
    AxisControl control;
    control.limited = true;
    control.limits = {static_cast<float>(min), static_cast<float>(max), spring};
    return control;
}

inline JointMotor SpeedMotor(double speed, double force = double(JointRow::kUnlimited)) {
    JointMotor motor;
    motor.mode = MotorMode::ToVelocity;
    motor.targetSpeed = static_cast<float>(speed);
    motor.minForce = static_cast<float>(-force);
    motor.maxForce = static_cast<float>(force);
    return motor;
}

inline JointMotor PositionMotor(double position, const SpringSettings& spring) {
    JointMotor motor;
    motor.mode = MotorMode::ToPosition;
    motor.targetPosition = static_cast<float>(position);
    motor.spring = spring;
    return motor;
}

inline SpringSettings FrequencySpring(double frequency, double dampingRatio, SpringForm form = SpringForm::Automatic) {
    SpringSettings spring;
    spring.frequency = static_cast<float>(frequency);
    spring.dampingRatio = static_cast<float>(dampingRatio);
    spring.form = form;
    return spring;
}

inline SpringSettings StiffnessSpring(double stiffness, double damping, SpringForm form = SpringForm::Automatic) {
    SpringSettings spring;
    spring.mode = SpringMode::StiffnessAndDamping;
    spring.stiffness = static_cast<float>(stiffness);
    spring.damping = static_cast<float>(damping);
    spring.form = form;
    return spring;
}

// x'' + 2 zeta w x' + w^2 x = 0.
struct Oscillator {
    double frequency = 0;     // Hz, w / 2 pi
    double dampingRatio = 0;  // zeta
};

// The oscillator that samples of its motion, dt seconds apart, belong to. Samples `lag` apart obey x(n + 2) = a x(n +
// 1) + b x(n) with a = 2 e^(-zeta w T) cos(w_d T), b = -e^(-2 zeta w T), T = lag dt; a and b by least squares. A lag of
// about a radian is the least sensitive to rounding.
inline Oscillator FitOscillator(const std::vector<double>& x, double dt, size_t lag) {
    double s11 = 0, s12 = 0, s22 = 0, t1 = 0, t2 = 0;
    for (size_t i = 0; i + 2 * lag < x.size(); ++i) {
        const double older = x[i], old = x[i + lag], now = x[i + 2 * lag];
        s11 += old * old;
        s12 += old * older;
        s22 += older * older;
        t1 += now * old;
        t2 += now * older;
    }
    const double determinant = s11 * s22 - s12 * s12;
    const double a = (t1 * s22 - t2 * s12) / determinant, b = (t2 * s11 - t1 * s12) / determinant;
    const double time = static_cast<double>(lag) * dt, root = std::sqrt(-b), cosine = a / (2 * root);
    const double decay = -std::log(root) / time;
    // Beyond critical damping the squared frequency of the damped oscillation is negative.
    const double phase = cosine <= 1 ? std::acos(cosine) : std::acosh(cosine);
    const double squared = decay * decay + (cosine <= 1 ? 1 : -1) * phase * phase / (time * time);
    const double omega = std::sqrt(squared);
    return {omega / (2 * kPi), decay / omega};
}

// Finds the times at which a quantity passes zero, from one sample to the next along a straight line.
class ZeroCrossings {
public:
    void Sample(double time, double value) {
        if (last_ && (*last_ > 0) != (value > 0))
            times_.push_back(lastTime_ + (time - lastTime_) * *last_ / (*last_ - value));
        last_ = value;
        lastTime_ = time;
    }
    size_t Count() const { return times_.size(); }
    // Twice the mean time from one crossing to the next.
    double Period() const { return 2 * (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1); }

private:
    std::optional<double> last_;
    double lastTime_ = 0;
    std::vector<double> times_;
};

}  // namespace fulcrum::testing
