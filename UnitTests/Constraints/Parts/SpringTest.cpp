// Springs against closed forms: the continuous oscillator, the implicit recursion, the force law at rest.
#include "RandomBodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace fulcrum {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDt = 1.0 / 60.0;

// The oscillator x'' + 2 zeta w x' + w^2 x = 0 from x(0) = 1, x'(0) = 0, for zeta below and above 1.
double Continuum(double frequency, double zeta, double t) {
    const double w = 2.0 * kPi * frequency;
    if (zeta < 1.0) {
        const double wd = w * std::sqrt(1.0 - zeta * zeta);
        return std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t));
    }
    const double root = std::sqrt(zeta * zeta - 1.0);
    const double s1 = -w * (zeta - root), s2 = -w * (zeta + root);
    return (s2 * std::exp(s1 * t) - s1 * std::exp(s2 * t)) / (s2 - s1);
}

// A row part that is a spring along x between the world and a mass: K is its inverse.
class Spring {
public:
    void Set(float dt, float k, float bias, float error, const SpringConstants<float>& constants,
             float startSpeed = 0.0f, float coupled = 1.0f) {
        part_.SetJacobian(AxisJacobian<float>({Vector3::Zero(), Vector3::Zero(), Vector3(1, 0, 0)}));
        part_.CalculateProperties({}, {k, {}});
        soft_ = SpringSoftnessOf(dt, k, constants, coupled);
        part_.SetBias(soft_.softness.massScale * bias + soft_.errorRate * error + soft_.speedPart * startSpeed,
                      soft_.softness);
    }
    // From J v and the total impulse before.
    float SolveTotalLambda(float velocity, float totalLambda) {
        part_.SetTotalLambda(totalLambda);
        return part_.SolveTotalLambda({}, {Vector3(velocity, 0, 0), Vector3::Zero()});
    }
    float GetSoftMass() const { return part_.GetEffectiveMass() * soft_.softness.massScale; }

private:
    RowPart<float> part_;
    SpringSoftness<float> soft_;
};

// One mass on a spring to the world: velocity solve with warm start, then x += dt v. `load` is an acceleration.
struct Oscillator {
    float inverseMass = 0.5f;
    float x = 1.0f, v = 0.0f, lambda = 0.0f;

    void Step(const SpringSettings& settings, float load = 0.0f, int iterations = 1) {
        const float dt = static_cast<float>(kDt);
        Spring part;
        part.Set(dt, inverseMass, 0.0f, x, ToConstants(settings), v);
        v += load * dt;
        v += inverseMass * lambda;
        for (int i = 0; i < iterations; ++i) {
            const float total = part.SolveTotalLambda(v, lambda);
            v += inverseMass * (total - lambda);
            lambda = total;
        }
        x += dt * v;
    }
};

// v holds (x - x of the step before) / dt, so that is what starts an oscillator on the continuum's curve.
Oscillator OnTheCurve(double frequency, double zeta) {
    Oscillator oscillator;
    oscillator.v = static_cast<float>((1.0 - Continuum(frequency, zeta, -kDt)) / kDt);
    return oscillator;
}

double LargestError(double frequency, double zeta, SpringForm form, int steps) {
    Oscillator oscillator = OnTheCurve(frequency, zeta);
    const SpringSettings settings{
        .frequency = static_cast<float>(frequency), .dampingRatio = static_cast<float>(zeta), .form = form};
    double worst = 0.0;
    for (int i = 1; i <= steps; ++i) {
        oscillator.Step(settings);
        worst = std::max(worst, std::fabs(static_cast<double>(oscillator.x) - Continuum(frequency, zeta, i * kDt)));
    }
    return worst;
}

// s = 1/D, 1 - 1/D, p = Kx/D and l = L/D of the linear map v' = (s - l) v - p x / dt, x' = x + dt v'.
struct Gains {
    float massScale, impulseScale;
    double errorGain, speedGain;

    Gains(float dt, const SpringConstants<float>& constants, float coupled = 1.0f) {
        const SpringSoftness<float> soft = SpringSoftnessOf(dt, 1.0f, constants, coupled);
        massScale = soft.softness.massScale;
        impulseScale = soft.softness.impulseScale;
        speedGain = static_cast<double>(soft.speedPart);
        errorGain = static_cast<double>(soft.errorRate) * static_cast<double>(dt);
    }
    Gains(float frequency, float zeta, SpringForm form, float coupled = 1.0f)
        : Gains(static_cast<float>(kDt), FrequencyConstants(frequency, zeta, form), coupled) {}

    // Of kinetic energy, as SpringSettings.h has it.
    double TakenShare() const {
        const double d = 1.0 / static_cast<double>(impulseScale);
        return d * (0.25 * errorGain - 0.5 * (static_cast<double>(massScale) - speedGain));
    }
};

// Frequency (Hz) and damping ratio of that map, from its eigenvalues.
void EffectiveMotion(const Gains& gains, double& frequency, double& zeta) {
    const double determinant = static_cast<double>(gains.impulseScale) - gains.speedGain;
    const double trace = 1.0 + determinant - gains.errorGain;
    const double decay = -0.5 * std::log(determinant) / kDt;
    const double damped = std::acos(0.5 * trace / std::sqrt(determinant)) / kDt;
    frequency = damped / (2.0 * kPi);
    zeta = decay / std::sqrt(decay * decay + damped * damped);
}

TEST(Spring, ExactFormMeetsTheContinuousOscillator) {
    // Rounding: each of 600 steps adds an error of about 1e-7 to x and v, which sum up like a random walk to some 3e-6
    // where little decays; the three gains are wrong by half a unit each (6e-8).
    EXPECT_LT(LargestError(2.0, 0.1, SpringForm::Exact, 600), 1e-5);
    EXPECT_LT(LargestError(2.0, 0.1, SpringForm::Automatic, 600), 1e-5);
    // Without damping (no softened mass: the row is a pure force) nothing of the error decays: 126 rad, and the gains'
    // error turns it by 1e-5.
    EXPECT_LT(LargestError(2.0, 0.0, SpringForm::Exact, 600), 3e-5);
    EXPECT_LT(LargestError(11.0, 0.05, SpringForm::Exact, 600), 1e-5);
    EXPECT_LT(LargestError(2.0, 0.9999, SpringForm::Exact, 600), 1e-5);
    EXPECT_LT(LargestError(2.0, 1.0001, SpringForm::Exact, 600), 1e-5);
    EXPECT_LT(LargestError(2.0, 3.0, SpringForm::Exact, 600), 1e-5);
}

TEST(Spring, ImplicitFormFollowsItsRecursion) {
    const double w = 2.0 * kPi * 2.0, zeta = 0.1;
    Oscillator oscillator;
    double x = 1.0, v = 0.0;
    for (int i = 0; i < 600; ++i) {
        oscillator.Step({.frequency = 2.0f, .dampingRatio = 0.1f, .form = SpringForm::Implicit});
        v = (v - w * w * kDt * x) / (1.0 + 2.0 * zeta * w * kDt + w * w * kDt * kDt);
        x += kDt * v;
        ASSERT_NEAR(static_cast<double>(oscillator.x), x, 1e-5) << i;
    }
}

TEST(Spring, ImplicitFormIsTheSoftRowOfTheLiterature) {
    // gamma = 1 / (h (c + h k)), b += beta C with beta = h k gamma, delta = -(J v + b + gamma lambda) / (K + gamma).
    const double h = kDt, k = 80.0, c = 3.0, inverse = 0.7, error = 0.3, bias = -0.4, v = 1.3, lambda = 0.6;
    const double gamma = 1.0 / (h * (c + h * k));
    const double expected = lambda - (v + bias + h * k * gamma * error + gamma * lambda) / (inverse + gamma);
    Spring part;
    part.Set(static_cast<float>(h), 0.7f, -0.4f, 0.3f, StiffnessConstants(80.0f, 3.0f, SpringForm::Implicit));
    EXPECT_NEAR(static_cast<double>(part.SolveTotalLambda(1.3f, 0.6f)), expected, 1e-6);
    EXPECT_NEAR(static_cast<double>(part.GetSoftMass()), 1.0 / (inverse + gamma), 1e-6);
}

TEST(Spring, FormsDampAsDocumented) {
    double frequency = 0.0, zeta = 0.0;
    EffectiveMotion(Gains(2.0f, 0.1f, SpringForm::Implicit), frequency, zeta);
    EXPECT_NEAR(zeta, 0.2002, 1e-3);
    EXPECT_NEAR(frequency, 1.9227, 1e-3);
    EffectiveMotion(Gains(2.0f, 0.1f, SpringForm::Exact), frequency, zeta);
    EXPECT_NEAR(zeta, 0.1, 1e-5);
    EXPECT_NEAR(frequency, 2.0 * std::sqrt(0.99), 1e-5);
    EffectiveMotion(Gains(2.0f, 0.0f, SpringForm::Automatic), frequency, zeta);
    EXPECT_NEAR(zeta, 0.0, 1e-6);
    EXPECT_NEAR(frequency, 2.0, 1e-5);
    // A force law without damping: faster by (w h)^2 / 24.
    const double angle = 2.0 * kPi * 2.0 * kDt, stiffness = std::pow(angle / kDt, 2);
    EffectiveMotion(Gains(static_cast<float>(kDt), StiffnessConstants(static_cast<float>(stiffness), 0.0f)), frequency,
                    zeta);
    EXPECT_NEAR(zeta, 0.0, 1e-6);
    EXPECT_NEAR(frequency, 2.0 * (1 + angle * angle / 24), 2e-5);
}

TEST(Spring, AutomaticChoosesTheForm) {
    const auto same = [](const Gains& a, const Gains& b) {
        return a.impulseScale == b.impulseScale && a.massScale == b.massScale && a.errorGain == b.errorGain &&
               a.speedGain == b.speedGain;
    };
    const auto automatic = [](float f, float zeta, float coupled = 1.0f) {
        return Gains(f, zeta, SpringForm::Automatic, coupled);
    };
    for (const float zeta : {0.0f, 0.1f, 0.7f, 0.72f, 3.0f})
        EXPECT_TRUE(same(automatic(2.0f, zeta), Gains(2.0f, zeta, SpringForm::Exact))) << zeta;
    // Six steps a period and four; more if several springs are coupled.
    const auto exact = [&](float f, float coupled) {
        return same(automatic(f, 0.0f, coupled), Gains(f, 0.0f, SpringForm::Exact));
    };
    const auto implicit = [&](float f, float coupled) {
        return same(automatic(f, 0.0f, coupled), Gains(f, 0.0f, SpringForm::Implicit));
    };
    EXPECT_TRUE(exact(9.9f, 1.0f) && !exact(10.1f, 1.0f) && !implicit(14.9f, 1.0f) && implicit(15.1f, 1.0f));
    EXPECT_TRUE(exact(4.8f, 4.0f) && !exact(4.9f, 4.0f) && !implicit(6.8f, 4.0f) && implicit(7.0f, 4.0f));
    EXPECT_TRUE(exact(1.9f, 24.0f) && !exact(2.0f, 24.0f) && !implicit(2.7f, 24.0f) && implicit(2.8f, 24.0f));
    EXPECT_TRUE(same(automatic(9.9f, 1.5f), Gains(9.9f, 1.5f, SpringForm::Exact)));
    EXPECT_TRUE(same(automatic(15.1f, 1.5f), Gains(15.1f, 1.5f, SpringForm::Implicit)));
}

TEST(Spring, AutomaticNeverFeedsEnergy) {
    // D - 1 + L >= 0, and of springs that are coupled less than the kinetic energy is taken; rounding allowed.
    for (const bool isLaw : {false, true})
        for (float f = 0.05f; f < 4000.0f; f *= 1.07f)
            for (float zeta = 0.0f; zeta < 4.0f; zeta += 0.0371f)
                for (const float coupled : {1.0f, 2.0f, 5.0f, 24.0f, 1000.0f}) {
                    const float w = 2.0f * static_cast<float>(kPi) * f;
                    const Gains gains(static_cast<float>(kDt),
                                      isLaw ? StiffnessConstants(w * w, 2.0f * zeta * w) : FrequencyConstants(f, zeta),
                                      coupled);
                    ASSERT_GE(static_cast<double>(gains.massScale) + gains.speedGain, -2e-7) << f << " " << zeta;
                    ASSERT_LE(static_cast<double>(coupled) * gains.TakenShare(), 0.5001) << f << " " << zeta;
                }
}

TEST(Spring, ManySpringsOnFewBodiesStayBounded) {
    // 8 masses of 0.03 to 30 kg, 28 undamped springs, a single iteration: the energy of the header, which bounds the
    // motion, never grows by more than what a single iteration leaves unsolved. It stays while springs are exact.
    for (const float frequency : {1.0f, 3.0f, 9.0f, 30.0f}) {
        testing::RandomPoses random(3);
        constexpr int kMasses = 8;
        double inverse[kMasses], v[kMasses] = {}, x[kMasses];
        for (double& m : inverse) m = std::pow(10.0, static_cast<double>(random.Between(-1.5f, 1.5f)));
        for (double& p : x) p = static_cast<double>(random.Between(-0.1f, 0.1f));
        const auto spring = FrequencyConstants(frequency, 0.0f);
        constexpr float kCoupled = kMasses - 1;
        const Gains gains(static_cast<float>(kDt), spring, kCoupled);
        const double stiffness = gains.errorGain / static_cast<double>(gains.impulseScale) / (kDt * kDt);
        const double taken = gains.TakenShare();
        std::vector<float> lambdas(kMasses * kMasses, 0.0f);
        std::vector<Spring> parts(kMasses * kMasses);
        double first = 0.0, largest = 0.0, last = 0.0;
        for (int step = 0; step < 600; ++step) {
            double energy = 0.0, start[kMasses];
            for (int i = 0; i < kMasses; ++i) {
                energy += 0.5 * v[i] * v[i] / inverse[i];
                start[i] = v[i];
            }
            for (int i = 0; i < kMasses; ++i)
                for (int j = 0; j < i; ++j) {
                    const int row = i * kMasses + j;
                    const double k = inverse[i] + inverse[j], error = x[i] - x[j];
                    const double speed = start[i] - start[j], middle = error - 0.5 * kDt * speed;
                    energy += 0.5 * (stiffness * middle * middle - taken * speed * speed) / k;
                    parts[row].Set(static_cast<float>(kDt), static_cast<float>(k), 0.0f, static_cast<float>(error),
                                   spring, static_cast<float>(speed), kCoupled);
                    v[i] += inverse[i] * static_cast<double>(lambdas[row]);
                    v[j] -= inverse[j] * static_cast<double>(lambdas[row]);
                }
            for (int i = 0; i < kMasses; ++i)
                for (int j = 0; j < i; ++j) {
                    const int row = i * kMasses + j;
                    const float total = parts[row].SolveTotalLambda(static_cast<float>(v[i] - v[j]), lambdas[row]);
                    v[i] += inverse[i] * static_cast<double>(total - lambdas[row]);
                    v[j] -= inverse[j] * static_cast<double>(total - lambdas[row]);
                    lambdas[row] = total;
                }
            for (int i = 0; i < kMasses; ++i) x[i] += kDt * v[i];
            if (step == 0) first = energy;
            largest = std::max(largest, energy);
            last = energy;
        }
        EXPECT_LT(largest, 1.001 * first) << frequency;
        if (frequency < 3.0f) {
            EXPECT_GT(last, 0.99 * first) << frequency;
        }
        if (frequency > 5.0f) {
            EXPECT_LT(last, 0.1 * first) << frequency;
        }
    }
}

TEST(Spring, ForceLawHoldsAtRest) {
    // k x = m g: 2 kg, 50 N/m. After 30 s of decay at c / (2 m) = 1 /s nothing but rounding is left of the motion.
    Oscillator oscillator;
    const SpringSettings law{.mode = SpringMode::StiffnessAndDamping, .stiffness = 50.0f, .damping = 4.0f};
    for (int i = 0; i < 1800; ++i) oscillator.Step(law, -9.81f);
    EXPECT_NEAR(oscillator.x, -2.0f * 9.81f / 50.0f, 2e-6f);
    // By frequency, critically damped, likewise: g / w^2.
    Oscillator suspension;
    for (int i = 0; i < 1800; ++i) suspension.Step({.frequency = 2.0f, .dampingRatio = 1.0f}, -9.81f);
    const double w = 2.0 * kPi * 2.0;
    EXPECT_NEAR(static_cast<double>(suspension.x), -9.81 / (w * w), 2e-6);
}

TEST(Spring, MoreIterationsChangeNothingAlone) {
    for (const SpringForm form : {SpringForm::Exact, SpringForm::Implicit}) {
        Oscillator once, often;
        const SpringSettings settings{.frequency = 3.0f, .dampingRatio = 0.2f, .form = form};
        for (int i = 0; i < 100; ++i) {
            once.Step(settings);
            often.Step(settings, 0.0f, 8);
        }
        EXPECT_NEAR(once.x, often.x, 1e-5f);
    }
}

TEST(Spring, NoStiffnessMeansHard) {
    for (const SpringSettings& settings :
         {SpringSettings{}, SpringSettings{.dampingRatio = 0.5f},
          SpringSettings{.mode = SpringMode::StiffnessAndDamping, .damping = 7.0f, .form = SpringForm::Exact}}) {
        const SpringSoftness<float> soft = SpringSoftnessOf(0.01f, 0.3f, ToConstants(settings));
        EXPECT_EQ(soft.softness.massScale, 1.0f);
        EXPECT_EQ(soft.softness.impulseScale, 0.0f);
        EXPECT_EQ(soft.errorRate, 0.0f);
        Spring spring;
        spring.Set(0.01f, 0.3f, 0.2f, 5.0f, ToConstants(settings));
        RowPart<float> hard;
        hard.SetJacobian(AxisJacobian<float>({Vector3::Zero(), Vector3::Zero(), Vector3(1, 0, 0)}));
        hard.CalculateProperties({}, {0.3f, {}});
        hard.SetBias(0.2f);
        hard.SetTotalLambda(0.4f);
        EXPECT_EQ(spring.SolveTotalLambda(1.5f, 0.4f),
                  hard.SolveTotalLambda({}, {Vector3(1.5f, 0, 0), Vector3::Zero()}));
    }
}

TEST(Spring, ExtremesStayFinite) {
    const float largest = std::numeric_limits<float>::max();
    for (const SpringForm form : {SpringForm::Automatic, SpringForm::Exact, SpringForm::Implicit})
        for (const SpringMode mode : {SpringMode::FrequencyAndDamping, SpringMode::StiffnessAndDamping})
            for (const float stiffness : {1e-30f, 1.0f, 1e6f, 1e20f, largest})
                for (const float damping : {0.0f, 1e-30f, 1.0f, 1e20f, largest})
                    for (const float dt : {1e-5f, 0.01f, 1.0f}) {
                        const SpringSettings settings{mode, stiffness, damping, stiffness, damping, form};
                        const Gains gains(dt, ToConstants(settings));
                        // No spring is stiffer than hard (v' = -x / dt), but one of two to three steps a period.
                        EXPECT_TRUE(gains.massScale >= 0.0f && gains.massScale <= 1.0f);
                        EXPECT_TRUE(gains.impulseScale >= 0.0f && gains.impulseScale <= 1.0f);
                        EXPECT_TRUE(gains.errorGain >= 0.0 && gains.errorGain <= 4.0);
                    }
}

TEST(Spring, BadSettingsAreNamed) {
    EXPECT_TRUE(Validate(SpringSettings{}));
    EXPECT_TRUE(Validate(SpringSettings{.frequency = 3.0f, .dampingRatio = 2.0f}));
    const Status negative = Validate({.frequency = -1.0f});
    ASSERT_FALSE(negative);
    EXPECT_EQ(negative.GetError().code, ErrorCode::Negative);
    EXPECT_EQ(negative.GetError().message, "spring frequency is -1; it must be 0 or more");
    const Status notANumber = Validate({.damping = std::numeric_limits<float>::quiet_NaN()});
    ASSERT_FALSE(notANumber);
    EXPECT_EQ(notANumber.GetError().code, ErrorCode::NonFinite);
    EXPECT_FALSE(Validate({.dampingRatio = std::numeric_limits<float>::infinity()}));
    EXPECT_FALSE(Validate({.stiffness = -1e-9f}));
}

}  // namespace
}  // namespace fulcrum
