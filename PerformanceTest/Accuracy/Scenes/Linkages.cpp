// Mechanisms with closed loops: planar linkages that a crank drives, whose every pose follows from the crank's angle,
// and a platform on six legs.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kJoints{.joints = true};

// Bars of 1 kg in the x-y plane: a crank about the first of the fixed pins, and pairs of bars, each of which pins a new
// node to two that are there. One degree of freedom. Nodes: the fixed pins, the crank's tip, those of the pairs.
struct Linkage {
    struct Pair {
        size_t from, to;        // nodes
        double length, second;  // m, of the bars from them; the new node lies to the left of the line between them
    };
    std::vector<Position> pins;
    double crank;  // m
    std::vector<Pair> pairs;

    // By the crank's angle, rad.
    std::vector<Position> NodesAt(double angle) const {
        std::vector<Position> nodes = pins;
        nodes.push_back(pins[0] + Position(std::cos(angle), std::sin(angle), 0) * crank);
        for (const Pair& pair : pairs) {
            const Position from = nodes[pair.from], line = nodes[pair.to] - from;
            const double distance = line.norm();
            // The law of cosines.
            const double along = (distance * distance + pair.length * pair.length - pair.second * pair.second) /
                                 (2 * distance),
                         across = std::sqrt(pair.length * pair.length - along * along);
            nodes.push_back(from + (line * along + Position(-line.y(), line.x(), 0) * across) / distance);
        }
        return nodes;
    }
    // By their nodes: the crank, then two of each pair. The last one turns about a fixed pin.
    std::vector<std::pair<size_t, size_t>> Bars() const {
        std::vector<std::pair<size_t, size_t>> bars{{0, pins.size()}};
        for (size_t i = 0; i < pairs.size(); ++i) {
            bars.push_back({pairs[i].from, pins.size() + 1 + i});
            bars.push_back({pairs[i].to, pins.size() + 1 + i});
        }
        return bars;
    }
};

double AngleOf(const Position& line) { return std::atan2(line.y(), line.x()); }

// Motion of the bars as the crank turns at `speed`, rad/s.
struct Motion {
    struct Bar {
        Position center, velocity;
        double length, angle, turn;  // m, rad, rad/s
    };
    std::vector<Bar> bars;

    static constexpr double kThickness = 0.04;  // m

    Motion(const Linkage& linkage, double angle, double speed) {
        constexpr double kStep = 1e-6;  // rad: rounding and curvature are both below 1e-9
        const std::vector<Position> nodes = linkage.NodesAt(angle), before = linkage.NodesAt(angle - kStep),
                                    after = linkage.NodesAt(angle + kStep);
        const auto velocityOf = [&](size_t node) -> Position {
            return (after[node] - before[node]) * (speed / (2 * kStep));
        };
        for (const auto& [a, b] : linkage.Bars()) {
            const Position line = nodes[b] - nodes[a], rate = velocityOf(b) - velocityOf(a);
            bars.push_back({(nodes[a] + nodes[b]) / 2, (velocityOf(a) + velocityOf(b)) / 2, line.norm(), AngleOf(line),
                            line.cross(rate).z() / line.squaredNorm()});
        }
    }
    double KineticEnergy() const {
        double energy = 0;
        for (const Bar& bar : bars) {
            const double inertia = (bar.length * bar.length + kThickness * kThickness) / 12;
            energy += 0.5 * (bar.velocity.squaredNorm() + inertia * bar.turn * bar.turn);
        }
        return energy;
    }
    double Energy() const {
        double energy = KineticEnergy();
        for (const Bar& bar : bars) energy += kGravity * bar.center.y();
        return energy;
    }
};

// Drives the crank from `angle(0)` on; each step's speed takes it to the angle at the step's end.
void Drive(LabRun& run, const Linkage& linkage, double (*angle)(double time), double seconds) {
    LabWorld world(run);
    const auto speedFrom = [&](double t) { return (angle(t + run.Dt()) - angle(t)) / run.Dt(); };
    const Motion start(linkage, angle(0), speedFrom(0));
    std::vector<BodyId> bodies;
    for (const Motion::Bar& bar : start.bars)
        bodies.push_back(world.Add({.shape = BoxOf(bar.length / 2, Motion::kThickness / 2, Motion::kThickness / 2),
                                    .position = bar.center,
                                    .rotation = RotationAbout({0, 0, 1}, bar.angle),
                                    .linearVelocity = bar.velocity.cast<float>(),
                                    .angularVelocity = {0, 0, static_cast<float>(bar.turn)},
                                    .mass = 1,
                                    .mask = 0}));
    // Of each node the first bar holds the others.
    const std::vector<Position> nodes = linkage.NodesAt(angle(0));
    const std::vector<std::pair<size_t, size_t>> bars = linkage.Bars();
    std::vector<std::optional<BodyId>> holders(nodes.size());
    for (size_t i = 0; i < linkage.pins.size(); ++i) holders[i] = AddHook(world, nodes[i]);
    JointMotor motor = MotorToSpeed(static_cast<float>(speedFrom(0)), std::numeric_limits<float>::infinity());
    std::optional<JointId> driven;
    for (size_t i = 0; i < bars.size(); ++i)
        for (const size_t node : {bars[i].first, bars[i].second}) {
            if (!holders[node]) {
                holders[node] = bodies[i];
                continue;
            }
            auto hinge = JointOf<HingeJointSettings>(*holders[node], bodies[i], nodes[node], {0, 0, 1});
            if (!driven) hinge.angle.motor = motor;
            const JointId id = world.Join(hinge);
            if (!driven) driven = id;
        }

    const auto facing = [&](BodyId id) {
        const Vector3 x = Rotate(world.Bodies().GetPose(id).rotation, Vector3(1, 0, 0));
        return std::atan2(double(x.y()), double(x.x()));
    };
    double ofAngle = 0, ofCrank = 0, gaps = 0, ofEnergy = 0, kinetic = 0;
    for (int i = run.Steps(seconds); i > 0; --i) {
        const double speed = speedFrom(world.Time());
        if (const float target = static_cast<float>(speed); target != motor.targetSpeed) {
            motor.targetSpeed = target;
            (void)world.Ours("motors with another speed in each step")
                .Joints()
                .SetMotor(*driven, JointAxis::AngularX, motor);
        }
        world.Step();
        const Motion now(linkage, angle(world.Time()), speed);
        const auto deviation = [&](size_t bar) {
            return std::abs(std::remainder(facing(bodies[bar]) - now.bars[bar].angle, 2 * kPi));
        };
        ofAngle = std::max(ofAngle, deviation(bars.size() - 1));
        ofCrank = std::max(ofCrank, deviation(0));
        gaps = std::max(gaps, world.SumOfGaps());
        ofEnergy = std::max(ofEnergy, std::abs(world.Energy() - now.Energy()));
        kinetic = std::max(kinetic, now.KineticEnergy());
    }
    run.Error("angle", ofAngle);
    run.Error("crank", ofCrank);
    run.Error("gaps", gaps / linkage.crank);
    run.Error("energy", ofEnergy / kinetic);
    run.Observe(std::cos(facing(bodies.back())));
}

// A crank that turns all the way round, as it is shorter than the others: 0.3 + 1 < 0.9 + 0.7 m.
void FourBar(LabRun& run) {
    Drive(
        run,
        {.pins = {{0, 0, 0}, {1, 0, 0}}, .crank = 0.3, .pairs = {{.from = 2, .to = 1, .length = 0.9, .second = 0.7}}},
        [](double time) { return kPi / 2 + 5 * time; }, 10);
}

// Three rockers, one after the other: seven bars, ten hinges, three loops. The crank starts at rest at the end of its
// way.
void SevenBars(LabRun& run) {
    const Linkage linkage{.pins = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
                          .crank = 0.5,
                          .pairs = {{.from = 4, .to = 1, .length = 1.05, .second = 0.6},
                                    {.from = 5, .to = 2, .length = 1.05, .second = 0.65},
                                    {.from = 6, .to = 3, .length = 1.05, .second = 0.7}}};
    Drive(
        run, linkage, [](double time) { return kPi / 2 - 0.8 * std::cos(2 * kPi * time); }, 10);
}

// A plate of 100 kg on six rods of 5 kg with ball joints at both ends; three planes of symmetry, so that each carries
// as much. It stays where it is built. A rod's weight W acts half at each end across its direction u, by the moments
// about its foot; along u its top gives t: the plate's weight is 6 (t u + (W - u (u . W)) / 2) in sum, of which the
// vertical part counts.
void Stewart(LabRun& run) {
    constexpr double kPlate = 100, kRod = 5, kHeight = 1.2, kOuter = 1, kInner = 0.6, kOff = kPi / 12;
    LabWorld world(run);
    const BodyId plate = world.Add({.shape = Cylinder::Create(0.05f, static_cast<float>(kInner)).Value(),
                                    .position = {0, kHeight, 0},
                                    .mass = static_cast<float>(kPlate),
                                    .mask = 0});
    std::vector<JointId> tops;
    double load = 0;  // N, at the top of a rod
    for (int i = 0; i < 6; ++i) {
        const double side = i % 2 == 0 ? 1 : -1, foot = 2 * kPi / 3 * (i / 2) + side * kOff,
                     top = 2 * kPi / 3 * (i / 2) + side * (kPi / 3 - kOff);
        const Position at = Position(std::cos(foot), 0, std::sin(foot)) * kOuter,
                       end = Position(std::cos(top), 0, std::sin(top)) * kInner + Position(0, kHeight, 0),
                       line = end - at;
        const double length = line.norm(), rise = line.y() / length, weight = kRod * kGravity;
        const Position axis = Position(0, 1, 0).cross(line) / std::hypot(line.x(), line.z());
        const BodyId rod = world.Add({.shape = BoxOf(0.03, length / 2, 0.03),
                                      .position = (at + end) / 2,
                                      .rotation = RotationAbout(axis.cast<float>(), std::acos(rise)),
                                      .mass = static_cast<float>(kRod),
                                      .mask = 0});
        world.Join(JointOf<PointJointSettings>(AddHook(world, at), rod, at));
        tops.push_back(world.Join(JointOf<PointJointSettings>(rod, plate, end)));
        // t u on the plate, and half of the rod's weight across u.
        const double across = weight * std::sqrt(1 - rise * rise) / 2,
                     along = (kPlate * kGravity + 6 * across * std::sqrt(1 - rise * rise)) / (6 * rise);
        load = std::hypot(along, across);
    }
    double off = 0;
    for (int i = run.Steps(10); i > 0; --i) {
        world.Step();
        const Quaternion rotation = world.Bodies().GetPose(plate).rotation;
        for (const Vector3& edge : {Vector3(1, 0, 0), Vector3(0, 0, 1)}) {
            const Vector3 turned = Rotate(rotation, edge) - edge;
            const Position way = world.At(plate) - Position(0, kHeight, 0);
            off = std::max(off, (way + turned.cast<double>() * kInner).norm());
        }
    }
    run.Error("place", off / kHeight);
    run.Error("gaps", world.SumOfGaps() / kHeight);
    if (!world.IsPeer()) {
        double ofLoad = 0;
        for (const JointId top : tops)
            ofLoad = std::max(ofLoad, Relative(double(Length(world.Joints().GetForce(top))), load));
        run.Error("load", ofLoad);
    }
    run.Observe(world.At(plate).y() / kHeight);
}

}  // namespace

std::vector<LabScene> LinkageScenes() {
    return {
        {.name = "four_bar",
         .what = "a crank of 0.3 m at 5 rad/s, a coupler, a rocker, 10 s",
         .error = "largest deviation of the rocker's angle from the closed form, rad",
         .influences = kJoints,
         .testBound = 3e-5,
         .run = FourBar},
        {.name = "seven_bars",
         .what = "a crank driven to and fro at 1 Hz, three rockers one after the other, 10 s",
         .error = "largest deviation of the last rocker's angle from the closed form, rad",
         .influences = kJoints,
         .testBound = 0.015,
         .run = SevenBars},
        {.name = "stewart",
         .what = "a plate of 100 kg at rest on six rods with ball joints, 10 s",
         .error = "largest distance from where it was built, over its height",
         .influences = kJoints,
         .testBound = 1e-6,
         .run = Stewart},
    };
}

}  // namespace fulcrum::accuracy
