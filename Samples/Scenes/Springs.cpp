#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum::SpringsScene {
namespace {

constexpr std::array<double, 5> kFrequencies{0.5, 1, 2, 3, 5};         // Hz, from left to right
constexpr std::array<double, 5> kDampings{0.05, 0.1, 0.2, 0.4, 0.65};  // ratios, from front to back
constexpr double kStart = 0.5;                                         // m

// A table of weights on springs, all let go half a meter up.
void Build(SceneWorld& world) {
    const ShapePtr cube = world.BoxOf(0.2f, 0.2f, 0.2f);
    for (size_t i = 0; i < kFrequencies.size(); ++i)
        for (size_t k = 0; k < kDampings.size(); ++k) {
            const Position middle(static_cast<double>(i) - 2, 1.5, static_cast<double>(k) - 2),
                place = middle + Position(0, kStart, 0);
            const BodyId weight = world.Add({.shape = cube, .position = place, .mass = 1.0f + static_cast<float>(k)});
            // What a row has in common is written at its end.
            if (k + 1 == kDampings.size()) world.Show(weight, {.label = LabelOf(kFrequencies[i]) + " Hz"});
            else if (i == 0) world.Show(weight, {.label = "damping " + LabelOf(kDampings[k])});
            auto settings = JointOfTwo<SliderJointSettings>(AddHook(world, middle - Position(0, 1, 0)), weight, middle,
                                                            place, {0, 1, 0});
            settings.slide = Limited(0, 0, static_cast<float>(kFrequencies[i]), static_cast<float>(kDampings[k]));
            world.joints.push_back(world.Join(settings));
        }
}

void NoGravity(SystemSettings& settings) { settings.gravity = Vector3::Zero(); }

// x = x0 exp(-zeta w t) (cos(w_d t) + zeta / sqrt(1 - zeta^2) sin(w_d t)).
double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (size_t i = 0; i < kFrequencies.size(); ++i)
        for (size_t k = 0; k < kDampings.size(); ++k) {
            const double omega = 2 * kPi * kFrequencies[i], zeta = kDampings[k], root = std::sqrt(1 - zeta * zeta),
                         phase = omega * root * world.Time();
            const double expected =
                kStart * Exp(-zeta * omega * world.Time()) * (Cos(phase) + zeta / root * Sin(phase));
            const double found =
                world.Joints().GetCoordinate(world.joints[i * kDampings.size() + k], JointAxis::LinearX);
            worst = std::max(worst, std::fabs(found - expected));
        }
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "springs",
    .description = "a table of 25 weights on springs: five frequencies by five damping ratios",
    .steps = 150,
    .sleeping = false,
    .view = {.color = ColorMode::Plain, .from = {-0.25f, 0.75f, 1}, .picture = 0.05},
    .adjust = NoGravity,
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest distance of a weight from where the continuous oscillator is",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.005}},
};

}  // namespace fulcrum::SpringsScene
