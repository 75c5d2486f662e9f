// Measures whether a scene comes to rest and stays there: drift of bodies from their initial positions, remaining
// speed, time until all sleep, energy that appears from nothing. Computed from poses and energy only, so that every
// kind of motion is seen. Used by Simulation after each step, outside of what is timed, and by tests; one thread.
#pragma once

#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <limits>
#include <optional>
#include <vector>

namespace fulcrum {

// Distances perpendicular to gravity (of any direction where there is none) between the centers of mass of dynamic
// bodies and where they were, m. What is not finite counts as infinite.
struct Drift {
    double largest = 0, mean = 0;
    BodyId farthest;
};

class DriftMeter {
public:
    // From where the bodies are now.
    explicit DriftMeter(const PhysicsSystem& system);
    // Of those that still exist; bodies created since do not count.
    Drift Measure() const;

private:
    struct Start {
        BodyId id;
        Position center;
    };
    const PhysicsSystem& system_;
    std::vector<Start> starts_;
};

// The largest speed of the awake dynamic bodies, m/s: of the corners of their local bounding boxes, from their poses
// before and after a step, whatever their velocities are. A body that a scene teleports counts as moving.
class SpeedMeter {
public:
    // From where the bodies are now.
    explicit SpeedMeter(const PhysicsSystem& system) : system_(system) { Note(0); }
    // After a step of dt seconds. Returns the largest speed in that step.
    double Measure(double dt) { return Note(dt); }
    // Of all steps.
    double Largest() const { return largest_; }
    BodyId Fastest() const { return fastest_; }

private:
    struct Placed {
        BodyId id;
        Pose center;  // of the shape's center frame
    };
    double Note(double dt);

    const PhysicsSystem& system_;
    std::vector<Placed> before_;  // by index
    double largest_ = 0;
    BodyId fastest_;
};

// Energy that appears from nothing: the largest rise of kinetic plus potential energy above its smallest value so far.
// Meaningful where nothing but gravity drives the bodies, and none comes or goes; losses elsewhere in the same step
// hide a gain. Only bodies that are or were awake are measured.
class EnergyMeter {
public:
    // Bodies have the gravityFactor 1.
    explicit EnergyMeter(const PhysicsSystem& system);
    void Measure();
    double Rise() const { return rise_; }  // J
    // Over the energy at the start, with the potential zero where the lowest corner of a body's bounding box has been.
    double RelativeRise() const;

private:
    void Note(BodyId id);

    const PhysicsSystem& system_;
    double start_ = 0, energy_ = 0, smallest_ = 0, rise_ = 0;  // J
    std::vector<double> energies_;                             // J, by index
    std::vector<BodyId> awake_;                                // at the last measurement
    double weight_ = 0;                                        // N, of all dynamic bodies
    double lowest_ = std::numeric_limits<double>::infinity();  // m, against gravity
};

// Whether no dynamic body is awake.
bool AllAsleep(const PhysicsSystem& system);

// Takes steps of dt seconds until no dynamic body is awake. Returns the simulated time then, s; null: not within
// `limit` seconds. Errors: those of PhysicsSystem::Update.
Result<std::optional<double>> TimeToSleep(SceneWorld& world, double dt, double limit);
Result<std::optional<double>> TimeToSleep(PhysicsSystem& system, double dt, double limit);

// Steps of dt that make up at least so many seconds; a millionth of a step is rounding.
int StepsIn(double seconds, double dt);

}  // namespace fulcrum
