#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::RackAndPinionScene {
namespace {

constexpr double kRadius = 0.5;   // m, of the pinions
constexpr int kTurnAround = 120;  // steps
constexpr float kWay = 2;         // m, to either side: the stops

// Two pinions: a motor turns the first to and fro, a weight on its rack spins the other.
void Build(SceneWorld& world) {
    std::vector<Vector3> rim;
    for (int i = 0; i < 16; ++i)
        for (const double z : {-0.1, 0.1})
            rim.push_back(Position(kRadius * Cos(2 * kPi * i / 16), kRadius * Sin(2 * kPi * i / 16), z).cast<float>());
    const ShapePtr wheel = world.HullOf(rim);
    for (const bool driven : {true, false}) {
        const Position center(driven ? -3 : 4, 4, 0),
            edge = center + (driven ? Position(0, -kRadius - 0.1, 0) : Position(kRadius + 0.1, 0, 0));
        const Vector3 way = driven ? Vector3(1, 0, 0) : Vector3(0, 1, 0);
        const BodyId frame = AddHook(world, center + Position(0, 0, -0.5));
        const BodyId pinion = world.Add({.shape = wheel, .position = center, .layer = 1});
        world.Show(pinion, {.look = Look::Brass, .teeth = 20});
        const BodyId rack = world.Add({.shape = driven ? world.BoxOf(2.5f, 0.1f, 0.1f) : world.BoxOf(0.1f, 2.5f, 0.1f),
                                       .position = edge,
                                       .mass = 20,
                                       .layer = 1});
        auto bearing = JointOf<HingeJointSettings>(frame, pinion, center, {0, 0, 1});
        if (driven) bearing.angle.motor = MotorToSpeed(3, 500);
        auto guide = JointOf<SliderJointSettings>(frame, rack, edge, way);
        guide.slide = Limited(-kWay, kWay);
        world.joints.push_back(world.Join(bearing));
        world.joints.push_back(world.Join(guide));
        auto teeth = JointOfTwo<RackAndPinionJointSettings>(pinion, rack, center, edge, {0, 0, 1});
        teeth.anchorB->axis = way;
        teeth.ratio = static_cast<float>(1 / kRadius);
        world.Join(teeth);
    }
}

void NoContacts(SystemSettings& settings) { settings.layerCollides[1] &= ~2u; }

void Drive(SceneWorld& world, double) {
    const float speed = world.StepCount() / kTurnAround % 2 ? -3.0f : 3.0f;
    (void)world.Joints().SetMotor(world.joints[0], JointAxis::AngularX, MotorToSpeed(speed, 500));
}

double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (size_t i = 0; i < world.joints.size(); i += 2) {
        const double angle = world.Joints().GetCoordinate(world.joints[i], JointAxis::AngularX);
        const double way = world.Joints().GetCoordinate(world.joints[i + 1], JointAxis::LinearX);
        // The angle may be off by whole turns: without limits and motor nobody counts them.
        worst = std::max({worst, std::fabs(std::remainder(angle * kRadius - way, 2 * kPi * kRadius)),
                          std::fabs(way) - double(kWay)});
    }
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "rack_and_pinion",
    .description = "a pinion drives its rack to and fro between stops; the weight of another rack spins its pinion",
    .steps = 480,
    .sleeping = false,
    .view = {.color = ColorMode::Plain, .from = {0.15f, 0.15f, 1}, .picture = 0.2},
    .adjust = NoContacts,
    .build = Build,
    .beforeStep = Drive,
    .accuracy = Accuracy,
    .accuracyMeaning = "how far a rack is from its pinion's angle times the radius, or beyond a stop",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.002}},
};

}  // namespace fulcrum::RackAndPinionScene
