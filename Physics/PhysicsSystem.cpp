#include <Fulcrum/Physics/PhysicsSystem.h>

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/Physics/Snapshots/Snapshots.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/Stages/Step.h>
#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/BodyPairs.h>
#include <Fulcrum/Physics/World/BodyReading.h>
#include <Fulcrum/Physics/World/Filters.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/ReserveMore.h>
#include <Fulcrum/Physics/World/ShapeEdits.h>
#include <Fulcrum/Physics/World/TargetChanges.h>
#include <Fulcrum/Physics/World/UnionFind.h>
#include <Fulcrum/Physics/World/Waking.h>
#include <Fulcrum/Physics/World/WorldChange.h>

#include <cstring>

namespace fulcrum {

Result<std::unique_ptr<PhysicsSystem>> PhysicsSystem::Create(const SystemSettings& settings, JobSystem* jobs,
                                                             MemoryResource* memory) {
    const DefaultFloats floats;
    if (MaybeError error = Check(settings)) return *error;
    const MemoryScope scope(memory);
    auto world = std::make_unique<WorldState>(memory);
    world->settings = settings;
    world->jobs = std::make_unique<WorldJobs>(jobs, world->lock);
    KeepForEvents(*world);
    auto step = std::make_unique<StepState>();
    step->findings.resize(world->jobs->WorkerCount());
    step->ofWorkers.resize(world->jobs->WorkerCount());
    return std::unique_ptr<PhysicsSystem>(new PhysicsSystem(std::move(world), std::move(step)));
}

PhysicsSystem::PhysicsSystem(std::unique_ptr<WorldState> world, std::unique_ptr<StepState> step)
    : world_(std::move(world)),
      step_(std::move(step)),
      snapshots_(std::make_unique<SnapshotRoom>()),
      bodies_(*world_),
      lockingBodies_(*world_, true),
      joints_(*world_),
      queries_(*world_) {}
PhysicsSystem::~PhysicsSystem() = default;

Status PhysicsSystem::Update(double dt) {
    const DefaultFloats floats;
    if (MaybeError error = CheckRange("dt", dt, 0, 1)) return *error;
    WorldState& world = *world_;
    const WorldChange<&PhysicsSystem::Update> change(world, dt);
    if (change.Refusal()) return *change.Refusal();
    change.Begin();
    RunStep(world, *step_, dt);
    if (world.callObserver) world.callObserver->EndStep(HashOfState(world, *step_, *snapshots_));
    return Done{};
}

void PhysicsSystem::Optimize() const {
    const DefaultFloats floats;
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal()) return ReportMisuse(*alone.Refusal());
    ColliderStore& colliders = world_->colliders;
    for (BoundsTree* tree : {&colliders.staticTree, &colliders.movingTree, &colliders.sensorTree})
        tree->Rebuild(LoopOn(*world_->jobs));
}

const StepEvents& PhysicsSystem::Events() const {
    static const StepEvents kNone;
    const std::optional<Error> refusal = WorldLock::RefusalOfReading(world_->lock, WorldLock::Access::Queries);
    if (refusal) ReportMisuse(*refusal);
    return refusal || !IsReadable(*world_) ? kNone : step_->events.events;
}

std::span<const SensorEvent> PhysicsSystem::SensorEvents() const {
    if (!IsReadable(*world_)) return {};
    return world_->sensors.events;
}

std::span<const BodyId> PhysicsSystem::BodiesInside(BodyId sensor) const {
    const SensorStore& store = world_->sensors;
    if (!IsReadable(*world_) || !store.Has(sensor)) return {};
    return store.sensors[store.PlaceOf(sensor)].inside;
}

const StepReport& PhysicsSystem::Report() const {
    (void)IsReadable(*world_);  // as far as the step has come
    return step_->report;
}
const SystemSettings& PhysicsSystem::Settings() const {
    (void)IsReadable(*world_);
    return world_->settings;
}

Status PhysicsSystem::SetSettings(const SystemSettings& settings) {
    const DefaultFloats floats;
    if (MaybeError error = Check(settings)) return *error;
    const WorldChange<&PhysicsSystem::SetSettings> change(*world_, settings);
    if (change.Refusal()) return *change.Refusal();
    const bool refilters = settings.layerCollides != world_->settings.layerCollides;
    ReserveForChange(*world_, {.removedPairs = refilters ? world_->pairs.pairs.size() : 0});
    ReserveMore(world_->sensors.changed, world_->sensors.sensors.size());
    if (settings.events.contacts) world_->pairs.ReserveReported();
    if (settings.events.bodies) ReserveRoom(step_->events.bodies, world_->bodies.Size());
    change.Begin();
    const std::array<uint32_t, 32> before = world_->settings.layerCollides;
    const bool changesGravity = settings.gravity != world_->settings.gravity,
               endsSleep = world_->settings.sleep.enabled && !settings.sleep.enabled;
    // The pair caches of one method are invalid for the other.
    if (settings.narrowPhase != world_->settings.narrowPhase)
        for (Pair& pair : world_->pairs.pairs) pair.cache = {};
    const bool hadBodyEvents = world_->settings.events.bodies;
    ChangeAccuracy(*world_, settings.accuracy);
    world_->settings = settings;
    // The efforts of islands and the choice of trees depend on the settings.
    world_->coloring.Invalidate();
    if (refilters) RefilterLayers(*world_, before);
    if (changesGravity || endsSleep)
        WakeIf(*world_, [&](uint32_t body) {
            return endsSleep ||
                   (!world_->bodies.cold[body].hasGravity && world_->bodies.dynamics[body].gravityFactor != 0);
        });
    KeepForEvents(*world_);
    if (!settings.events.bodies) step_->events.bodies = {};
    else if (!hadBodyEvents) BeginBodyEvents(world_->bodies, step_->events);
    for (const Sensor& sensor : world_->sensors.sensors) world_->sensors.changed.push_back(sensor.id.index);
    return Done{};
}

void PhysicsSystem::SetContactListener(const ContactListener* listener) {
    const WorldChange<&PhysicsSystem::SetContactListener> change(*world_, listener);
    if (change.Refusal()) return ReportMisuse(*change.Refusal());
    ReserveForChange(*world_, {.removedPairs = world_->pairs.pairs.size()});
    if (listener) world_->pairs.ReserveListenersData();
    change.Begin();
    ChangeListener(*world_, listener);
}

void PhysicsSystem::SetStepObserver(StepObserver* observer) {
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal() && alone.Refusal()->code != ErrorCode::BrokenWorld) return ReportMisuse(*alone.Refusal());
    world_->observer = observer;
}

void PhysicsSystem::SetCallObserver(CallObserver* observer) {
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal() && alone.Refusal()->code != ErrorCode::BrokenWorld) return ReportMisuse(*alone.Refusal());
    world_->callObserver = observer;
}

WorldLock::Exclusive PhysicsSystem::HoldForChanges() {
    const std::optional<Error> refusal = WorldLock::RefusalOfChanging(world_->lock);
    if (refusal) ReportMisuse(*refusal);
    else (void)IsReadable(*world_);
    return WorldLock::Exclusive(world_->lock, WorldLock::Access::Edits);
}

Status PhysicsSystem::SaveSnapshot(std::vector<std::byte>& bytes) const {
    const DefaultFloats floats;
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal()) return *alone.Refusal();
    HeedShapeEdits(*world_);
    return WriteSnapshot(*world_, *step_, *snapshots_, bytes);
}

Status PhysicsSystem::RestoreSnapshot(std::span<const std::byte> bytes, const SnapshotSources& sources) {
    const WorldChange<&PhysicsSystem::RestoreSnapshot> change(*world_, bytes, sources);
    if (change.Refusal() && change.Refusal()->code != ErrorCode::BrokenWorld) return *change.Refusal();
    return ReadSnapshot(bytes, sources, *snapshots_, *world_, *step_, change);
}

uint64_t PhysicsSystem::HashState() const {
    const DefaultFloats floats;
    const WorldLock::Exclusive alone(world_->lock);
    if (alone.Refusal()) return ReportMisuse(*alone.Refusal()), 0;
    HeedShapeEdits(*world_);
    return HashOfState(*world_, *step_, *snapshots_);
}

void PhysicsSystem::VisitBodies(FunctionRef<void(BodyId)> visit) const {
    if (!IsReadable(*world_)) return;
    const BodyStore& bodies = world_->bodies;
    for (uint32_t i = 0; i < bodies.Size(); ++i)
        if (bodies.cold[i].exists && i != bodies.worldBody) visit(bodies.IdOf(i));
}

static void VisitContact(const WorldState& world, uint32_t index, FunctionRef<void(const ContactView&)> visit) {
    const Pair& pair = world.pairs.pairs[index];
    if (!pair.touching || pair.pointCount == 0 || pair.onSeam || !world.pairs.active.Contains(index)) return;
    ContactView::Point room[ContactRecord::kMaxPoints];
    visit(ViewSolvedContact(world.bodies, world.colliders, world.pairs, index, room));
}

void PhysicsSystem::VisitContacts(FunctionRef<void(const ContactView&)> visit) const {
    const DefaultFloats floats;
    if (!IsReadable(*world_)) return;
    const WorldState& world = *world_;
    world.pairs.active.Visit([&](uint32_t index) { VisitContact(world, index, visit); });
}

void PhysicsSystem::VisitContactsOf(BodyId body, FunctionRef<void(const ContactView&)> visit) const {
    const DefaultFloats floats;
    const WorldState& world = *world_;
    if (!IsReadable(world) || !world.bodies.Find(body)) return;
    VisitPairsOf(world.bodies, world.colliders, world.pairs, {&body.index, 1}, [&](uint32_t first) {
        for (uint32_t index = first; index != PairStore::kNone; index = world.pairs.MoreOf(index))
            VisitContact(world, index, visit);
    });
}

void PhysicsSystem::VisitIslands(FunctionRef<void(BodyId, uint32_t island)> visit) const {
    const DefaultFloats floats;
    if (!IsReadable(*world_)) return;
    const BodyStore& bodies = world_->bodies;
    const WorldLock::Scope scope(world_->lock, WorldLock::OfThisThread(world_->lock));  // for its memory
    Array<uint32_t> parents(bodies.Size());
    UnionFind sets(parents);
    world_->pairs.active.Visit([&](uint32_t index) {
        const Pair& pair = world_->pairs.pairs[index];
        if (pair.touching && !pair.fixedB) sets.Unite(pair.bodyA, pair.bodyB);
    });
    for (const Joint& joint : world_->joints.joints)
        if (joint.exists && joint.enabled && !joint.fixed[0] && !joint.fixed[1])
            sets.Unite(joint.body[0], joint.body[1]);
    // Sleeping bodies form the islands in which they fell asleep.
    Array<uint32_t> first(bodies.Size(), ~0u);
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

void PhysicsSystem::VisitEfforts(FunctionRef<void(const IslandEffortReport&)> visit) const {
    const DefaultFloats floats;
    if (IsReadable(*world_) && step_->report.islandsWithMoreEffort > 0)
        fulcrum::VisitEfforts(world_->settings.solver, world_->bodies, step_->solver, visit);
}

double PhysicsSystem::GetEnergy() const {
    const DefaultFloats floats;
    if (!IsReadable(*world_)) return 0;
    double energy = 0;
    const BodyStore& bodies = world_->bodies;
    for (uint32_t i = 0; i < bodies.Size(); ++i) {
        if (!bodies.cold[i].exists || bodies.dynamics[i].motion != MotionType::Dynamic) continue;
        const BodyId id = bodies.IdOf(i);
        const Position gravity = bodies.GravityOf(i, world_->settings.gravity).cast<double>();
        energy += bodies_.GetKineticEnergy(id) - double(bodies_.GetMass(id)) *
                                                     double(bodies.dynamics[i].gravityFactor) *
                                                     Dot<double>(gravity, bodies.CenterOf(i));
    }
    return energy;
}

uint64_t PhysicsSystem::HashPoses() const {
    const DefaultFloats floats;
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

size_t PhysicsSystem::MemoryUsed() const {
    (void)IsReadable(*world_);
    return sizeof(WorldState) + HeapBytes(*world_) + sizeof(StepState) + HeapBytes(*step_) + sizeof(SnapshotRoom) +
           HeapBytes(*snapshots_);
}

}  // namespace fulcrum
