// Keeps joints that are pushed together from adding kinetic energy. Joints, contacts and limits are passive: an exact
// solution leaves no more kinetic energy than the bodies would have without them, plus the work of motors and springs.
// A push of the velocity iterations that relax iterations do not remove is more, and in a mechanism whose joints and
// limits depend strongly on each other may grow from step to step. So in islands with such a push the velocities at the
// end of each substep are scaled down to what is allowed. Used by Solve for groups of small islands; in large ones what
// others lose in the same substep would hide it. One thread per group.
#pragma once

#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

#include <span>

namespace fulcrum {

// Whether some joint of the group is pushed fast at the start of the step.
bool PushesJoints(const SolverLayout& layout, const SolverGroup& group);

// The motion of an island as a rigid body with its momentum and angular momentum.
struct RigidMotion {
    Position center = Position::Zero();   // m, of mass, relative to the lowest body's
    Position linear = Position::Zero();   // m/s
    Position angular = Position::Zero();  // rad/s
    double energy = 0;                    // J
};

struct IslandEnergy {
    uint32_t lowest = 0;  // body of it
    bool isPushed = false;
    bool isDriven = false;        // by a kinematic body, a surface velocity or masses that differ by constraint
    bool isHeld = false;          // by something that does not move
    double mass = 0;              // kg
    double free = 0, solved = 0;  // J, kinetic, without and with the constraints of the substep
    bool exceeds = false;         // free < solved
    double work = 0;              // J, by motors and springs
    RigidMotion rigid;            // zero if it is held
    float scale = 1;              // of velocities relative to `rigid`
};

class EnergyLimit {
public:
    // parents, islandOf: by body of the world; members, islands: as many as the group has bodies. All uninitialized.
    EnergyLimit(BodyStore& bodies, const JointStore& joints, const PairStore& pairs, const SolverLayout& layout,
                const SolverGroup& group, std::span<uint32_t> parents, std::span<uint32_t> islandOf,
                std::span<uint32_t> members, std::span<IslandEnergy> islands);

    // In each substep: before the poses are integrated, and at its end. A gyroscopic torque adds no energy, but that of
    // a push would.
    void NoteFree();
    void Apply();

private:
    struct Velocity {
        Vector3 linear, angular;
    };
    Velocity FreeOf(uint32_t body) const {
        const float* row = bodies_.unconstrained[body].row;
        return {{row[0], row[1], row[2]}, {row[3], row[4], row[5]}};
    }
    Velocity SolvedOf(uint32_t body) const { return {bodies_.LinearVelocityOf(body), bodies_.AngularVelocityOf(body)}; }
    static bool IsLimited(const IslandEnergy& island) { return island.isPushed && !island.isDriven; }
    IslandEnergy& IslandOf(uint32_t body) const { return islands_[islandOf_[body]]; }
    Quaternion RotationOf(uint32_t body) const;
    Position PlaceOf(uint32_t body) const;
    double EnergyOf(uint32_t body, const Velocity& velocity) const;
    void AddWork();
    void FindRigidMotion(IslandEnergy& island) const;

    BodyStore& bodies_;
    const JointStore& joints_;
    const SolverLayout& layout_;
    const SolverGroup& group_;
    std::span<const uint32_t> islandOf_;  // by body: in `islands_`
    // Sorted: their order in the group is another one after a snapshot was restored, and sums depend on it.
    std::span<const uint32_t> members_;
    std::span<IslandEnergy> islands_;
};

}  // namespace fulcrum
