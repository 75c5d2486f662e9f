#include <Fulcrum/Physics/PhysicsSystem.h>

#include <Fulcrum/Physics/Islands/UnionFind.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/State/BodyPairs.h>
#include <Fulcrum/Physics/Validation.h>

#include <algorithm>
#include <chrono>
#include <cstring>

namespace fulcrum {

namespace {

using Clock = std::chrono::steady_clock;

double Milliseconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

// Forgets the bodies that were removed since the last step, and all pairs that they were part of.
void ForgetRemoved(WorldState& world) {
    if (world.removed.empty() && !world.colliders.movedHasEmpty) return;
    VisitPairsOf(world, world.removed, [&](uint32_t pair) { RemovePair(world, pair); });
    std::erase_if(world.colliders.moved, [&](uint32_t i) {
        Collider& collider = world.colliders.colliders[i];
        const bool isGone = !world.colliders.shapes[i].shape || world.bodies.cold[collider.body].removed;
        if (isGone) collider.queued = false;
        return isGone;
    });
    world.colliders.movedHasEmpty = false;
    for (uint32_t body : world.removed) {
        const BodyCold& cold = world.bodies.cold[body];
        world.colliders.Free(cold.firstCollider, cold.colliderCount);
        world.colliders.FreeRuns(cold.MoreColliders());
        world.bodies.Free(body);
    }
    world.removed.clear();
}

void BeginReport(WorldState& world) {
    const uint64_t step = world.report.step + 1;
    world.report = {};
    world.report.step = step;
    world.broken.clear();
    world.sensors.events.clear();
    for (WorkerFindings& f : world.findings) {
        f.libccd = {};
        f.contacts = f.points = f.kept = f.clamped = f.frozen = f.sleepCandidates = 0;
        f.deepest = 0;
        f.deepestPair = f.firstFrozen = ~0u;
        f.bounces = false;
        f.joints = {};
    }
}

// A step shorter than this, in seconds, moves nothing that a float could tell; its inverse would only overflow.
constexpr double kShortestStep = 1e-9;

// Impulses of a short step, scaled up to a long one, are mostly its noise: steps that alternate between 1/240 and 1/30
// s threw a stack of six boxes over with no limit, and leave one of ten standing with this one.
constexpr float kMostImpulseScale = 2;

void CountBodies(WorldState& world) {
    world.report.bodies = world.bodies.Count();
    world.report.awakeBodies = static_cast<uint32_t>(world.bodies.awake.size());
    world.report.islands = world.solver.islands;
    world.report.pairs = static_cast<uint32_t>(world.pairs.active.Size());
    for (int c = 0; c <= ConstraintColoring::kColors; ++c)
        world.report.joints += static_cast<uint32_t>(world.coloring.At(c).Of(ConstraintColoring::Kind::Joint).size());
}

// Runs the stages one after the other and notes how long each took.
class StepTimer {
public:
    explicit StepTimer(StepReport& report) : report_(report), start_(Clock::now()), last_(start_) {}
    void Finished(Stage stage) {
        const Clock::time_point now = Clock::now();
        report_.stageMs[static_cast<size_t>(stage)] = Milliseconds(last_, now);
        last_ = now;
    }
    void FinishedAll() { report_.totalMs = Milliseconds(start_, last_); }

private:
    StepReport& report_;
    Clock::time_point start_, last_;
};

}  // namespace

const char* StageName(Stage stage) {
    static constexpr const char* kNames[kStageCount] = {"UpdateBounds", "FindPairs",  "Collide", "Color",
                                                        "BuildIslands", "Prepare",    "Solve",   "Restitution",
                                                        "Store",        "Continuous", "Sense",   "Sleep"};
    return kNames[static_cast<size_t>(stage)];
}

Result<std::unique_ptr<PhysicsSystem>> PhysicsSystem::Create(const SystemSettings& settings, JobSystem* jobs) {
    if (MaybeError error = Check(settings)) return *error;
    auto world = std::make_unique<WorldState>();
    world->settings = settings;
    if (!jobs) {
        world->ownJobs = std::make_unique<ThreadPool>(1);
        jobs = world->ownJobs.get();
    }
    world->jobs = std::make_unique<WorldJobs>(*jobs, world->lock);
    world->findings.resize(jobs->WorkerCount());
    return std::unique_ptr<PhysicsSystem>(new PhysicsSystem(std::move(world)));
}

PhysicsSystem::PhysicsSystem(std::unique_ptr<WorldState> world)
    : world_(std::move(world)), bodies_(*world_), joints_(*world_), queries_(*world_) {}
PhysicsSystem::~PhysicsSystem() = default;

Status PhysicsSystem::Update(double dt) {
    if (MaybeError error = CheckRange("dt", dt, 0, 1)) return *error;
    WorldState& world = *world_;
    const WorldLock::Exclusive alone(world.lock);
    if (alone.Refusal()) return *alone.Refusal();
    ForgetRemoved(world);
    BeginReport(world);
    if (dt < kShortestStep) {
        CountBodies(world);
        return Done{};
    }
    StepContext step;
    step.dt = static_cast<float>(dt);
    step.substepDt = step.dt / static_cast<float>(world.settings.solver.substeps);
    step.impulseScale =
        world.lastSubstepDt > 0 ? std::min(step.substepDt / world.lastSubstepDt, kMostImpulseScale) : 1.0f;
    world.scratch.Reset();

    StepTimer timer(world.report);
    UpdateBounds(world, step);
    timer.Finished(Stage::UpdateBounds);
    FindPairs(world);
    timer.Finished(Stage::FindPairs);
    Collide(world, step);
    timer.Finished(Stage::Collide);
    Color(world);
    DropGhosts(world);
    timer.Finished(Stage::Color);
    BuildIslands(world);
    timer.Finished(Stage::BuildIslands);
    Prepare(world, step);
    timer.Finished(Stage::Prepare);
    Solve(world, step);
    timer.Finished(Stage::Solve);
    Restitution(world, step);
    timer.Finished(Stage::Restitution);
    Store(world, step);
    timer.Finished(Stage::Store);
    Continuous(world, step);
    timer.Finished(Stage::Continuous);
    Sense(world, step);
    timer.Finished(Stage::Sense);
    Sleep(world);
    timer.Finished(Stage::Sleep);
    timer.FinishedAll();
    world.outsideFatBounds.MarkStale();

    CountBodies(world);
    for (const WorkerFindings& f : world.findings) world.report.libccd += f.libccd;
    return Done{};
}

std::span<const JointId> PhysicsSystem::BrokenJoints() const { return world_->broken; }

std::span<const SensorEvent> PhysicsSystem::SensorEvents() const { return world_->sensors.events; }

std::span<const BodyId> PhysicsSystem::BodiesInside(BodyId sensor) const {
    const SensorStore& store = world_->sensors;
    if (!store.Has(sensor)) return {};
    return store.sensors[store.PlaceOf(sensor)].inside;
}

const StepReport& PhysicsSystem::Report() const { return world_->report; }
const SystemSettings& PhysicsSystem::Settings() const { return world_->settings; }

Status PhysicsSystem::SetSettings(const SystemSettings& settings) {
    if (MaybeError error = Check(settings)) return *error;
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal()) return *alone.Refusal();
    const std::array<uint32_t, 32> before = world_->settings.layerCollides;
    // What one method notes of a pair means nothing to the other.
    if (settings.narrowPhase != world_->settings.narrowPhase)
        for (Pair& pair : world_->pairs.pairs) pair.cache = {};
    world_->settings = settings;
    if (settings.layerCollides != before) RefilterLayers(*world_, before);
    for (const Sensor& sensor : world_->sensors.sensors) world_->sensors.touched.push_back(sensor.id.index);
    return Done{};
}

void PhysicsSystem::SetContactListener(const ContactListener* listener) {
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal()) return ReportMisuse(*alone.Refusal());
    ChangeListener(*world_, listener);
}

void PhysicsSystem::VisitBodies(FunctionRef<void(BodyId)> visit) const {
    const BodyStore& bodies = world_->bodies;
    for (uint32_t i = 0; i < bodies.Size(); ++i)
        if (bodies.cold[i].exists) visit(bodies.IdOf(i));
}

void PhysicsSystem::VisitContacts(FunctionRef<void(const ContactView&)> visit) const {
    const WorldState& world = *world_;
    world.pairs.active.Visit([&](uint32_t index) {
        // A seam has taken the points from the records of some.
        if (!world.pairs.pairs[index].touching || !(world.pairs.records[index].pointCount > 0)) return;
        ContactView::Point room[ContactRecord::kMaxPoints];
        visit(ViewContact(world, index, room));
    });
}

void PhysicsSystem::VisitIslands(FunctionRef<void(BodyId, uint32_t island)> visit) const {
    const BodyStore& bodies = world_->bodies;
    std::vector<uint32_t> parents(bodies.Size());
    UnionFind sets(parents);
    world_->pairs.active.Visit([&](uint32_t index) {
        const Pair& pair = world_->pairs.pairs[index];
        if (pair.touching && !pair.fixedB) sets.Unite(pair.bodyA, pair.bodyB);
    });
    for (const Joint& joint : world_->joints.joints)
        if (joint.exists && joint.enabled && !joint.still[0] && !joint.still[1])
            sets.Unite(joint.body[0], joint.body[1]);
    // Sleepers belong together as they fell asleep.
    std::vector<uint32_t> first(bodies.Size(), ~0u);
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        const uint32_t island = bodies.cold[i].sleepingIsland;
        if (island == SleepingIslands::kNone) continue;
        sets.Unite(i, world_->sleeping.Bodies(island).front());
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        if (!bodies.cold[i].exists || bodies.dynamics[i].motion != MotionType::Dynamic) continue;
        const uint32_t root = sets.Find(i);
        if (first[root] == ~0u) first[root] = count++;
        visit(bodies.IdOf(i), first[root]);
    }
}

double PhysicsSystem::GetEnergy() const {
    double energy = 0;
    const Position gravity = world_->settings.gravity.cast<double>();
    const BodyStore& bodies = world_->bodies;
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        if (!bodies.cold[i].exists || bodies.dynamics[i].motion != MotionType::Dynamic) continue;
        const BodyId id = bodies.IdOf(i);
        energy += bodies_.GetKineticEnergy(id) - double(bodies_.GetMass(id)) *
                                                     double(bodies.dynamics[i].gravityFactor) *
                                                     Dot<double>(gravity, bodies.CenterOf(i));
    }
    return energy;
}

uint64_t PhysicsSystem::HashPoses() const {
    uint64_t hash = 0xCBF29CE484222325ull;  // FNV-1a, 64 bits
    VisitBodies([&](BodyId id) {
        const Pose pose = bodies_.GetPose(id);
        const Quaternion& q = pose.rotation;
        const double numbers[7] = {pose.position.x(), pose.position.y(), pose.position.z(), q.x, q.y, q.z, q.w};
        unsigned char bytes[sizeof numbers];
        std::memcpy(bytes, numbers, sizeof numbers);
        for (unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001B3ull;
    });
    return hash;
}

size_t PhysicsSystem::MemoryUsed() const { return world_->MemoryUsed(); }

}  // namespace fulcrum
