// What hangs from one place or two: the shape of a chain at rest, the slowest swing of a rope of rods, a gyroscope, a
// rod that slides along the edge of its cone.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <numeric>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kJoints{.joints = true};

// Links of 1 kg between nodes, each pinned to the one before it, the first to a hook at the first node. Damping: 1/s.
std::vector<BodyId> AddLinks(LabWorld& world, const std::vector<Position>& nodes, double damping,
                             std::vector<JointId>& joints) {
    std::vector<BodyId> links;
    BodyId last = AddHook(world, nodes[0]);
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
        const Position line = nodes[i + 1] - nodes[i];
        const double length = line.norm();
        const BodyId next = world.Add({.shape = BoxOf(0.48 * length, 0.03 * length, 0.03 * length),
                                       .position = (nodes[i] + nodes[i + 1]) / 2,
                                       .rotation = RotationAbout({0, 0, 1}, std::atan2(line.y(), line.x())),
                                       .mass = 1,
                                       .linearDamping = static_cast<float>(damping),
                                       .angularDamping = static_cast<float>(damping),
                                       .mask = 0});
        joints.push_back(world.Join(JointOf<PointJointSettings>(last, next, nodes[i])));
        links.push_back(next);
        last = next;
    }
    return links;
}

// Links of 1 m whose ends are hung 0.6 of their number apart, as a V; damped, they come to rest in a catenary. With H
// the horizontal pull and V_k = m g (k - n / 2) the vertical one at node k, the moments about the middle of link i give
// tan(angle) = (V_i + V_i+1) / 2 H; H is where the links end at the second hook.
void HungChain(LabRun& run) {
    constexpr int kLinks = 20;
    constexpr double kSpan = 0.6 * kLinks, kDamping = 2;  // m, 1/s: what the swings leave after 20 s is e^-20 of them
    const auto slopeOf = [](int link, double pull) { return kGravity * (link + 0.5 - 0.5 * kLinks) / pull; };
    const auto spanAt = [&](double pull) {
        double span = 0;
        for (int i = 0; i < kLinks; ++i) span += 1 / std::hypot(1, slopeOf(i, pull));
        return span;
    };
    double low = 0, high = 1e3 * kLinks * kGravity;
    for (int i = 0; i < 100; ++i) {
        const double pull = (low + high) / 2;
        (spanAt(pull) < kSpan ? low : high) = pull;
    }

    LabWorld world(run);
    std::vector<Position> nodes;
    for (int i = 0; i <= kLinks; ++i) nodes.push_back({0.6 * i, 0.8 * (std::abs(i - 0.5 * kLinks) - 0.5 * kLinks), 0});
    std::vector<JointId> joints;
    const std::vector<BodyId> links = AddLinks(world, nodes, kDamping, joints);
    world.Join(JointOf<PointJointSettings>(AddHook(world, nodes.back()), links.back(), nodes.back()));
    world.Steps(20);

    double off = 0;
    Position node = Position::Zero();
    for (int i = 0; i < kLinks; ++i) {
        const double slope = slopeOf(i, low);
        const Position half = Position(0.5, 0.5 * slope, 0) / std::hypot(1, slope);
        off = std::max(off, (world.At(links[static_cast<size_t>(i)]) - (node + half)).norm());
        node += half * 2;
    }
    run.Error("shape", off / kLinks);
    run.Error("gaps", world.SumOfGaps() / kLinks);
    if (!world.IsPeer())
        run.Error("pull", Relative(double(Length(world.Joints().GetForce(joints[0]))),
                                   std::hypot(low, 0.5 * kLinks * kGravity)));
    run.Observe(world.At(links[kLinks / 2]).y() / kLinks);
}

// A hanging rope of rods of 0.5 m that swings in its slowest mode. With the rods' angles a_i, small, rod i's middle is
// at l (a_0 + .. + a_i-1 + a_i / 2): the energies are M a'.a' / 2 and K a.a / 2 with K = m g l diag(n - i - 1/2), so
// that 1 / w^2 is the largest eigenvalue of K^-1 M. An angle a lengthens the period by a^2 / 16.
void RopeOfRods(LabRun& run) {
    constexpr size_t kRods = 20;
    constexpr double kLength = 0.5, kAngle = 0.01;  // m; rad, of the last rod
    // Of the rods' shapes (AddLinks), about the axes across them.
    constexpr double kInertia = kLength * kLength * (0.96 * 0.96 + 0.06 * 0.06) / 12;
    std::vector<double> angles(kRods, 1);
    double eigenvalue = 0;
    for (int pass = 0; pass < 100; ++pass) {
        // M a = l (sums of the way x of all that hangs below, half of its own), from the accelerations x.
        std::vector<double> next(kRods), ways(kRods);
        double way = 0, sum = 0;
        for (size_t i = 0; i < kRods; ++i) {
            ways[i] = way + 0.5 * kLength * angles[i];
            way += kLength * angles[i];
        }
        for (size_t i = kRods; i-- > 0;) {
            const double moment = kLength * (sum + 0.5 * ways[i]) + kInertia * angles[i];
            next[i] = moment / (kGravity * kLength * (static_cast<double>(kRods - i) - 0.5));
            sum += ways[i];
        }
        eigenvalue = next.back() / angles.back();
        for (size_t i = 0; i < kRods; ++i) angles[i] = next[i] / next.back();
    }

    LabWorld world(run);
    std::vector<Position> nodes{Position::Zero()};
    for (const double angle : angles)
        nodes.push_back(nodes.back() + Position(std::sin(kAngle * angle), -std::cos(kAngle * angle), 0) * kLength);
    std::vector<JointId> joints;
    const std::vector<BodyId> rods = AddLinks(world, nodes, 0, joints);
    const double start = world.Energy(), scale = kRods * kGravity * kLength * kRods;
    Crossings crossings;
    double gaps = 0, ofEnergy = 0;
    for (int i = run.Steps(20); i > 0; --i) {
        world.Step();
        crossings.Sample(world.Time(), world.At(rods.back()).x());
        gaps = std::max(gaps, world.SumOfGaps());
        ofEnergy = std::max(ofEnergy, std::abs(world.Energy() - start) / scale);
    }
    run.Error("period", Relative(crossings.Period().value_or(0), 2 * kPi * std::sqrt(eigenvalue)));
    run.Error("gaps", gaps / (kLength * kRods));
    run.Error("energy", ofEnergy);
    run.Observe(crossings.Times().empty() ? 0 : crossings.Times()[0] / (0.5 * kPi * std::sqrt(eigenvalue)));
}

// A disc that spins at 50 rad/s, its axle held at one end: horizontal, it turns at m g l / (I w) about the vertical and
// stays so. I = m r^2 / 2.
void HeldGyroscope(LabRun& run) {
    constexpr double kSpin = 50, kRadius = 0.3, kArm = 0.5;
    constexpr double kTurn = kGravity * kArm / (0.5 * kRadius * kRadius * kSpin);
    LabWorld world(run);
    const BodyId disc = world.Add({.shape = Cylinder::Create(0.05f, static_cast<float>(kRadius)).Value(),
                                   .position = {kArm, 0, 0},
                                   .rotation = RotationAbout({0, 0, 1}, -kPi / 2),  // its axis, y, along x
                                   .linearVelocity = {0, 0, static_cast<float>(-kTurn * kArm)},
                                   .angularVelocity = {static_cast<float>(kSpin), static_cast<float>(kTurn), 0},
                                   .mass = 1,
                                   .mask = 0});
    const JointId joint = world.Join(JointOf<PointJointSettings>(AddHook(world), disc, {0, 0, 0}));
    double sunk = 0, way = 0, last = 0, gap = 0;
    for (int i = run.Steps(20); i > 0; --i) {
        world.Step();
        const Position at = world.At(disc);
        sunk = std::max(sunk, std::abs(std::atan2(at.y(), std::hypot(at.x(), at.z()))));
        const double angle = std::atan2(-at.z(), at.x());
        way += std::remainder(angle - last, 2 * kPi);
        last = angle;
        gap =
            std::max(gap, (world.Joints().GetFrameB(joint).position - world.Joints().GetFrameA(joint).position).norm());
    }
    run.Error("sinking", sunk);
    run.Error("precession", Relative(way, kTurn * world.Time()));
    run.Error("gap", gap / kArm);
    run.Observe(way / (kTurn * world.Time()));
}

// A rod of 1 m in a cone of 0.5 rad that is thrown across it from 0.3 rad, at 12 rad/s about the vertical: it comes to
// the edge, and the moment about the vertical, I sin(angle)^2 turn, keeps it there, as 4.56 rad/s^2 exceeds
// m g l / (I cos(angle)): 4.1 rad/s. It turns about its own axis as little as at the start.
void Cone(LabRun& run) {
    constexpr double kHalfAngle = 0.5, kStart = 0.3, kTurn = 12;
    LabWorld world(run);
    const Position along(std::sin(kStart), -std::cos(kStart), 0), velocity(0, 0, -0.5 * kTurn * std::sin(kStart));
    const BodyId rod = world.Add({.shape = BoxOf(0.05, 0.5, 0.05),
                                  .position = along * 0.5,
                                  .rotation = RotationAbout({0, 0, 1}, kStart),
                                  .linearVelocity = velocity.cast<float>(),
                                  .angularVelocity = (along.cross(velocity) * 2.0).cast<float>(),
                                  .mass = 1,
                                  .mask = 0});
    ConeJointSettings joint = JointOf<ConeJointSettings>(AddHook(world), rod, {0, 0, 0}, {0, -1, 0});
    joint.anchorB = JointAnchor{.point = {0, 0, 0}, .axis = along.cast<float>()};
    joint.halfAngle = static_cast<float>(kHalfAngle);
    world.Join(joint);
    double beyond = 0, within = 0, way = 0, last = 0, least = world.Energy(), rise = 0;
    const double scale = kGravity * 0.5 * (1 - std::cos(kHalfAngle));
    for (int i = run.Steps(10); i > 0; --i) {
        world.Step();
        const Position at = world.At(rod);
        const double angle = std::atan2(std::hypot(at.x(), at.z()), -at.y()), around = std::atan2(-at.z(), at.x());
        beyond = std::max(beyond, angle - kHalfAngle);
        if (world.Time() > 5) {
            within = std::max(within, kHalfAngle - angle);
            way += std::remainder(around - last, 2 * kPi);
        }
        last = around;
        least = std::min(least, world.Energy());
        rise = std::max(rise, world.Energy() - least);
    }
    const double ratio = std::sin(kStart) / std::sin(kHalfAngle);
    run.Error("beyond", beyond / kHalfAngle);
    run.Error("within", within / kHalfAngle);
    run.Error("turn", Relative(way / 5, kTurn * ratio * ratio));
    run.Error("energy_rise", rise / scale);
    run.Observe(way / (5 * kTurn));
}

}  // namespace

std::vector<LabScene> HangingScenes() {
    return {
        {.name = "hung_chain",
         .what = "20 links of 1 m hung as a V between two places 12 m apart, damped, after 20 s",
         .error = "largest distance of a link from the closed form, over the length",
         .influences = kJoints,
         .testBound = 1e-6,
         .run = HungChain},
        {.name = "rope_of_rods",
         .what = "20 hanging rods of 0.5 m that swing in their slowest mode by 0.01 rad, 20 s",
         .error = "period, relative",
         .influences = kJoints,
         .testBound = 1e-5,
         .run = RopeOfRods},
        {.name = "held_gyroscope",
         .what = "a disc of 0.3 m that spins at 50 rad/s, held at the end of its horizontal axle, 20 s",
         .error = "largest angle by which the axle sinks or rises, rad",
         .influences = kJoints,
         .testBound = 0.25,
         .run = HeldGyroscope},
        {.name = "cone",
         .what = "a rod of 1 m thrown to the edge of its cone of 0.5 rad, along which it slides, 10 s",
         .error = "largest angle beyond the cone's, over that",
         .influences = kJoints,
         .testBound = 1e-5,
         .run = Cone},
    };
}

}  // namespace fulcrum::accuracy
