#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>

#include <Fulcrum/PerformanceTest/Accuracy/LabRecorder.h>
#include <Fulcrum/PerformanceTest/Peers/Peer.h>

#include <algorithm>
#include <chrono>

namespace fulcrum::accuracy {
namespace {

void ThrowIfLacking(const Status& status) {
    if (!status) throw NotInPeer(status.GetError().message);
}

}  // namespace

void LabRun::Require(bool holds, const std::string& condition) {
    if (!holds && std::find(failedConditions.begin(), failedConditions.end(), condition) == failedConditions.end())
        failedConditions.push_back(condition);
}

int LabRun::Steps(double seconds) const { return std::max(1, static_cast<int>(std::lround(seconds * setting.rate))); }

LabWorld::LabWorld(LabRun& run, const Vector3& gravity, void (*change)(SystemSettings&)) : run_(run) {
    SystemSettings settings = run.setting.System();
    settings.gravity = gravity;
    settings.sleep.enabled = false;
    change(settings);
    Create(settings);
}

LabWorld::LabWorld(LabRun& run, SystemSettings settings) : run_(run) {
    const SystemSettings effort = run.setting.System();
    settings.solver = effort.solver;
    settings.sleep.enabled = false;
    settings.narrowPhase = effort.narrowPhase;
    if (std::isinf(effort.exactJointLoad)) settings.exactJointLoad = effort.exactJointLoad;
    if (run.setting.family == Family::Target || run.setting.family == Family::Fixed) {
        settings.accuracy.penetration = effort.accuracy.penetration;
        settings.accuracy.jointError = effort.accuracy.jointError;
    }
    Create(settings);
}

void LabWorld::Create(const SystemSettings& settings) {
    system_ = PhysicsSystem::Create(settings, run_.jobs).Value();
    const Setting& setting = run_.setting;
    if (setting.peer) peer_ = setting.peer->create(*system_, setting.solver.velocityIterations);
}

LabWorld::~LabWorld() {
    if (run_.recorder) run_.recorder->End(*system_, time_);
    bool isInside = true;
    for (const Built& built : dynamic_) {
        if (!Bodies().Exists(built.id)) continue;
        const double way = (At(built.id) - built.position).norm();
        isFinite_ &= std::isfinite(way);
        isInside &= way <= domain;
    }
    run_.Require(isFinite_, "every pose is finite");
    run_.Require(isInside, "no body leaves its domain");
    run_.work.seconds += work_.seconds;
    run_.work.simulatedSeconds += work_.simulatedSeconds;
    run_.work.traversals += work_.traversals;
    run_.work.effortReturns +=
        static_cast<int>(std::ranges::count_if(returns_, [&](double time) { return time > 0.5 * time_; }));
    run_.work.hash = run_.work.hash * 31 + system_->HashPoses();
}

BodyId LabWorld::Add(const BodySettings& settings) {
    const BodyId id = system_->Bodies().Create(settings).Value();
    if (peer_) ThrowIfLacking(peer_->AddBody(id, settings));
    if (settings.motion == MotionType::Dynamic) dynamic_.push_back({id, settings.position});
    return id;
}

BodyId LabWorld::AddFloor(float friction, float restitution, double halfWidth, const Position& origin) {
    return Add({.shape = BoxOf(halfWidth, 1, halfWidth),
                .motion = MotionType::Static,
                .position = origin + Position(0, -1, 0),
                .material = {.friction = friction, .restitution = restitution}});
}

void LabWorld::Joined(JointId id, const JointSettings& settings) {
    if (peer_) ThrowIfLacking(peer_->AddJoint(id, settings));
}

PhysicsSystem& LabWorld::Ours(const char* what) {
    if (peer_) throw NotInPeer(what);
    return *system_;
}

int LabWorld::AwakeBodies() const {
    if (!peer_) return static_cast<int>(system_->Report().awakeBodies);
    return static_cast<int>(
        std::ranges::count_if(dynamic_, [&](const Built& built) { return Bodies().IsAwake(built.id); }));
}

void LabWorld::Step(double dt) {
    if (run_.recorder) run_.recorder->AddFrame(*system_, time_);
    using Clock = std::chrono::steady_clock;
    const uint32_t awakeBefore = system_->Report().awakeBodies;
    const Clock::time_point start = Clock::now();
    if (!peer_) (void)system_->Update(dt).Value();
    else if (!run_.isLost) peer_->Step(dt);
    work_.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    work_.simulatedSeconds += dt;
    time_ += dt;
    if (peer_) {
        run_.isLost = run_.isLost || !peer_->CopyTo(*system_);
        isFinite_ &= !run_.isLost;
        return;
    }
    const StepReport& report = system_->Report();
    const SolverSettings& solver = system_->Settings().solver;
    const double passes = solver.substeps * (solver.velocityIterations + solver.positionIterations);
    double more = 0;  // passes over bodies beyond the system's
    system_->VisitEfforts([&](const IslandEffortReport& effort) {
        const int own = effort.substeps * (effort.velocityIterations + effort.positionIterations);
        more += effort.bodies * (own - passes);
    });
    // Those that fell asleep at the end of the step were solved in it.
    const double solvedBodies = std::max({1u, awakeBefore, report.awakeBodies});
    work_.traversals += static_cast<double>(report.contacts + report.joints) * (passes + more / solvedBodies);
    isFinite_ &= report.frozenBodies == 0;
    if (dt == 0) return;  // such a step solves nothing
    if (run_.setting.family == Family::Target) returns_.insert(returns_.end(), efforts_.Sample(*system_), time_);
}

double LabWorld::FastestBody() {
    double fastest = 0;
    for (const Built& built : dynamic_) fastest = std::max(fastest, Speed(built.id).norm());
    return fastest;
}

double LabWorld::SumOfGaps() {
    double sum = 0;
    Joints().Visit(
        [&](JointId id) { sum += (Joints().GetFrameB(id).position - Joints().GetFrameA(id).position).norm(); });
    return sum;
}

BodyId AddHook(LabWorld& world, const Position& position) {
    return world.Add({.shape = SphereOf(0.01), .motion = MotionType::Static, .position = position, .mask = 0});
}

std::vector<BodyId> AddStack(LabWorld& world, int count, double edge, double offset, Random& random,
                             const Position& origin) {
    const ShapePtr cube = BoxOf(edge / 2, edge / 2, edge / 2);
    std::vector<BodyId> boxes;
    for (int i = 0; i < count; ++i) {
        const double x = random.Between(-offset, offset), z = random.Between(-offset, offset);
        boxes.push_back(world.Add({.shape = cube, .position = origin + Position(x, (i + 0.5) * edge, z)}));
    }
    return boxes;
}

std::vector<BodyId> AddPyramid(LabWorld& world, int base, double edge, double spacing, double rise, double topMass) {
    const ShapePtr cube = BoxOf(edge / 2, edge / 2, edge / 2);
    std::vector<BodyId> boxes;
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            boxes.push_back(
                world.Add({.shape = cube,
                           .position = {edge * spacing * (i - 0.5 * (base - row - 1)), edge * (0.5 + rise * row), 0},
                           .mass = row == base - 1 ? static_cast<float>(topMass) : 0.0f}));
    return boxes;
}

Chain AddChain(LabWorld& world, int links, double endMass, double stretch, const Position& origin) {
    const ShapePtr link = BoxOf(0.45, 0.05, 0.05), ball = SphereOf(0.4);
    Chain chain;
    BodyId last = AddHook(world, origin);
    const int count = links + (endMass > 0 ? 1 : 0);
    for (int i = 0; i < count; ++i) {
        const bool isBall = i == links;
        const BodyId next = world.Add({.shape = isBall ? ball : link,
                                       .position = origin + Position((i + 0.5) * stretch, 0, 0),
                                       .mass = isBall ? static_cast<float>(endMass) : 1.0f,
                                       .mask = 0});
        PointJointSettings joint;
        joint.bodyA = last;
        joint.bodyB = next;
        joint.space = JointSpace::Body;
        joint.anchorA.point = {i == 0 ? 0.0 : 0.5, 0, 0};
        joint.anchorB = JointAnchor{.point = {-0.5, 0, 0}};
        world.Join(joint);
        chain.bodies.push_back(next);
        last = next;
    }
    chain.length = count - 0.5;
    return chain;
}

void Crossings::Sample(double time, double value) {
    if (last_ && (last_->second < 0) != (value < 0))
        times_.push_back(last_->first + (time - last_->first) * last_->second / (last_->second - value));
    last_ = {time, value};
}

std::optional<double> Crossings::Period() const {
    if (times_.size() < 3) return std::nullopt;
    return 2 * (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1);
}

}  // namespace fulcrum::accuracy
