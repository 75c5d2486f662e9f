// Joints of bodies with locked axes: locks get no impulse along what cannot move, whatever is locked.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace fulcrum::testing {
namespace {

constexpr double kArm = 0.6, kMass = 10;  // m, kg

// A plate that is level with the hinge to the world at its side, and can fall as far as that and its locks let it.
void ExpectHeld(int axis, int locks, int substeps) {
    SystemSettings settings;
    settings.solver.substeps = substeps;
    TestWorld world(settings);
    const BodyId plate = world.Add({.shape = BoxOf(0.6f, 1, 0.05f),
                                    .position = {kArm, 5, 0},
                                    .mass = static_cast<float>(kMass),
                                    .lockedAxes = static_cast<LockedAxes>(locks)});
    const JointId hinge =
        Join(world, HingeJointSettings{Between(kWorldBody, plate, {0, 5, 0}, Vector3(Vector3::Unit(axis)))});
    const auto energy = [&] {
        return double{world.Bodies().GetKineticEnergy(plate)} +
               kMass * kGravity * world.Bodies().GetCenterOfMass(plate).y();
    };
    const double start = energy();
    double gap = 0, rise = 0;
    for (int i = 0; i < 60; ++i) {
        world.Step();
        gap = std::max(gap, double{JointsOf(world).GetError(hinge).distance});
        rise = std::max(rise, energy() - start);
    }
    // Poses are up to a substep ahead of velocities: half a substep of the power of gravity, at the speed of a fall by
    // the arm.
    const double ahead = 0.5 * kStep / substeps * kMass * kGravity * std::sqrt(2 * kGravity * kArm);
    const std::string name =
        "axis " + std::to_string(axis) + ", locks " + std::to_string(locks) + ", substeps " + std::to_string(substeps);
    EXPECT_LT(gap, 0.01) << name;
    EXPECT_LT(rise, ahead) << name;
    EXPECT_TRUE(world.AllFinite()) << name;
}

TEST(LockedHinge, HoldsWhateverIsLocked) {
    for (const int substeps : {1, 4, 16})
        for (int axis = 0; axis < 3; ++axis)
            for (int locks = 0; locks < 63; ++locks) ExpectHeld(axis, locks, substeps);
}

}  // namespace
}  // namespace fulcrum::testing
