// Chains of bodies whose joints pass torque on fall into a bin and lie across each other as long levers. Joints are not
// torn, nothing gains energy, and all comes to rest, at any number of substeps.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <sstream>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr int kBodies = 20, kChain = 5;
constexpr float kHalf = 2.5f;  // m, of the bin

enum class Lever : uint8_t { Fixed, Hinge };

struct Rest {
    double speed = 0;   // m/s, largest in the last three seconds
    double rise = 0;    // J/kg: by how much the energy rose in them
    double angle = 0;   // rad, largest of the locked ones at the end
    double lowest = 0;  // m, of all centers at the end
};

BodyId AddBody(TestWorld& world, RandomPoses& random, int i) {
    const float a = random.Between(0.25f, 0.5f), b = random.Between(0.25f, 0.5f), c = random.Between(0.25f, 0.5f);
    const float x = random.Between(-1, 1), z = random.Between(-1, 1);
    const ShapePtr shapes[] = {BoxOf(a, b, c), BoxOf(a, 0.12f, c), BoxOf(0.1f, 2 * b, 0.1f)};
    return world.Add({.shape = shapes[random.Below(3)],
                      .position = Position(static_cast<double>(x), 1.5 + 1.4 * i, static_cast<double>(z)),
                      .rotation = random.Rotation()});
}

JointId Link(TestWorld& world, RandomPoses& random, Lever kind, BodyId a, BodyId b) {
    JointSettings between =
        Between(a, b, (world.PositionOf(a) + world.PositionOf(b)) * 0.5, Normalized(random.Direction()));
    const double low = static_cast<double>(random.Between(-1, -0.1f)),
                 high = static_cast<double>(random.Between(0.1f, 1));
    if (kind == Lever::Fixed) {
        return Join(world, Of<FixedJointSettings>(between));
    }
    auto hinge = Of<HingeJointSettings>(between);
    hinge.angle = Limited(low, high);
    return Join(world, hinge);
}

// Of a hinge between the axes: its limits yield to what lies on them.
double LockedAngle(TestWorld& world, Lever kind, JointId id) {
    if (kind == Lever::Fixed) return static_cast<double>(JointsOf(world).GetError(id).angle);
    const auto axisOf = [](const Pose& frame) { return Rotate(frame.rotation, Vector3(1, 0, 0)); };
    const Vector3 a = axisOf(JointsOf(world).GetFrameA(id)), b = axisOf(JointsOf(world).GetFrameB(id));
    return std::atan2(static_cast<double>(Length(Cross(a, b))), static_cast<double>(Dot(a, b)));
}

Rest Fall(Lever kind, int substeps, uint32_t seed) {
    SystemSettings settings = NoSleep();
    settings.solver.substeps = substeps;
    // Of hinges all are solved directly, with their limits.
    if (kind == Lever::Hinge) settings.exactJointLoad = 1e-6f;
    TestWorld world(settings);
    RandomPoses random(seed);
    world.AddFloor();
    for (int side = 0; side < 4; ++side) {
        const double at = side % 2 == 0 ? kHalf + 1.0 : -kHalf - 1.0;
        world.Add({.shape = side < 2 ? BoxOf(1, 40, 5) : BoxOf(5, 40, 1),
                   .motion = MotionType::Static,
                   .position = side < 2 ? Position(at, 36, 0) : Position(0, 36, at)});
    }
    std::vector<BodyId> ids;
    for (int i = 0; i < kBodies; ++i) ids.push_back(AddBody(world, random, i));
    std::vector<JointId> joints;
    for (size_t i = 0; i + 1 < ids.size(); ++i)
        if ((i + 1) % kChain != 0) joints.push_back(Link(world, random, kind, ids[i], ids[i + 1]));

    world.Run(15);
    const auto energyOf = [&] {
        double energy = 0, mass = 0;
        for (const BodyId id : ids) {
            const double m = static_cast<double>(world.Bodies().GetMass(id));
            energy += world.Bodies().GetKineticEnergy(id) + m * kGravity * world.PositionOf(id).y();
            mass += m;
        }
        return energy / mass;
    };
    Rest rest;
    const double before = energyOf();
    for (int i = 0; i < 180; ++i) {
        world.Step();
        rest.rise = std::max(rest.rise, energyOf() - before);
        for (const BodyId id : ids)
            rest.speed = std::max(rest.speed, static_cast<double>(Length(world.VelocityOf(id))));
    }
    for (const JointId id : joints) rest.angle = std::max(rest.angle, LockedAngle(world, kind, id));
    for (const BodyId id : ids) rest.lowest = std::min(rest.lowest, world.PositionOf(id).y());
    EXPECT_TRUE(world.AllFinite());
    return rest;
}

// Falls are chaotic, and one substep does not resolve all levers: some may end otherwise.
void ComesToRest(Lever kind, std::initializer_list<int> substepCounts, int mostRestless) {
    int restless = 0;
    std::ostringstream which;
    for (const int substeps : substepCounts)
        for (uint32_t seed = 1; seed <= 5; ++seed) {
            const Rest rest = Fall(kind, substeps, seed);
            const bool isInside = rest.lowest > -0.25;
            EXPECT_TRUE(isInside || substeps == 1) << rest.lowest << " m, " << substeps << " substeps, seed " << seed;
            // Of hinges some swing for long: they have no friction.
            if (isInside && rest.rise <= 0.01 && rest.angle <= 0.03 && (kind == Lever::Hinge || rest.speed <= 0.01))
                continue;
            ++restless;
            which << substeps << " substeps, seed " << seed << ": rise " << rest.rise << " J/kg, " << rest.angle
                  << " rad, " << rest.speed << " m/s\n";
        }
    EXPECT_LE(restless, mostRestless) << "of " << 5 * substepCounts.size() << '\n' << which.str();
}

TEST(LeversInABin, FixedJointsHoldAndComeToRest) {
    ComesToRest(Lever::Fixed, {1}, 4);
    ComesToRest(Lever::Fixed, {4, 16}, 1);
}
TEST(LeversInABin, HingesAtTheirLimitsGainNoEnergy) { ComesToRest(Lever::Hinge, {4, 16}, 3); }

}  // namespace
}  // namespace fulcrum::testing
