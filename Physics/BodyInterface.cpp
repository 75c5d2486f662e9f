#include <Fulcrum/Physics/BodyInterface.h>

#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/Physics/JointInterface.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>
#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/BodyPairs.h>
#include <Fulcrum/Physics/World/BodyReading.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/JointChanges.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/Sleeping.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>
#include <Fulcrum/Physics/World/SteadyPushes.h>
#include <Fulcrum/Physics/World/Velocities.h>
#include <Fulcrum/Physics/World/Waking.h>
#include <Fulcrum/Physics/World/WorldChange.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace fulcrum {

namespace {

// The center frame's pose of a body whose own frame is at `position`, `q`, which is normalized.
Pose CenterPose(const Shape& shape, const Position& position, const Quaternion& q) {
    return {position + Rotate(q, shape.Mass().centerOfMass).cast<double>(), q};
}

void FillDynamics(BodyDynamics& d, std::unique_ptr<KeptMass>& keptMass, const BodySettings& s) {
    const MassProperties& mass = s.shape->Mass();
    d.motion = s.motion;
    d.lockedAxes = s.lockedAxes;
    d.gravityFactor = s.gravityFactor;
    d.linearDamping = s.linearDamping;
    d.angularDamping = s.angularDamping;
    d.maxLinearSpeed = std::min(s.maxLinearSpeed, kFastestLinear);
    d.maxAngularSpeed = std::min(s.maxAngularSpeed, kFastestAngular);
    d.gyroscopic = s.gyroscopicTorque;
    d.allowSleep = s.allowSleep;
    d.layer = s.layer & 31u;
    d.continuous = s.continuous != ContinuousCollision::Off;
    const bool isDynamic = s.motion == MotionType::Dynamic;
    // For the others, mass settings take effect when they become dynamic.
    const bool isGiven =
        mass.volume > 0 && (s.mass > 0 || s.density != BodySettings::kUsualDensity || !s.inertia.isZero(0));
    if (!isDynamic && !isGiven) return;
    const float kilograms = s.mass > 0 ? s.mass : s.density * mass.volume;
    const Vector3 inertia =
        s.inertia.isZero(0) ? Vector3(mass.principalInertia * (kilograms / mass.volume)) : s.inertia;
    if (isDynamic) SetMass(d, mass.principalAxes, kilograms, inertia);
    else keptMass = std::make_unique<KeptMass>(KeptMass{kilograms, inertia, mass.principalAxes});
}

// Called for the first body of an empty world: moves the origin of the bounds near it. Limited so that positions near
// zero relative to that origin are rounded by less than the fat bounds' margin.
void PlaceBoundsOrigin(WorldState& world, uint32_t body) {
    constexpr double kStep = 1024, kFarthest = 0x1p40;  // m
    const Position center = world.bodies.CenterOf(body);
    for (int k = 0; k < 3; ++k) {
        const double nearest = std::floor(center[k] / kStep + 0.5) * kStep;
        world.colliders.boundsOrigin[k] = std::clamp(nearest, -kFarthest, kFarthest);
    }
}

// Whether a collider of a body has bounds that overlap those of one that may move.
bool MeetsMoving(const WorldState& world, uint32_t body) {
    bool meets = false;
    VisitColliders(world, body, [&](uint32_t i) {
        world.colliders.movingTree.Query(world.colliders.colliders[i].fat, [&](uint32_t) { meets = true; });
    });
    return meets;
}

// A new static body searches for pairs only if it meets what may move and is already there: what moves there later, or
// is created later, searches itself. A step after many are created has nothing to do with them.
void PlaceStatic(WorldState& world, uint32_t body) {
    if (MeetsMoving(world, body)) {
        world.bodies.MarkPlaced(body);
        return RequeueColliders(world.bodies, world.colliders, body);
    }
    VisitColliders(world, body, [&](uint32_t i) {
        Collider& collider = world.colliders.colliders[i];
        collider.previous = collider.fat;  // as after a search
    });
    if (!world.sensors.IsEmpty()) world.sensors.changed.push_back(body);
}

// What a body has of its own beside its place in the arrays. The settings must be valid.
struct NewBody {
    explicit NewBody(const BodySettings& settings)
        : shape(settings.shape), filter(BodyStore::MakeFilter({settings.category, settings.mask, settings.group})) {
        FillDynamics(dynamics, keptMass, settings);
    }
    OwnShape shape;
    std::unique_ptr<BodyFilter> filter;
    BodyDynamics dynamics;
    std::unique_ptr<KeptMass> keptMass;
};

void Include(Additions& more, const ColliderStore& colliders, const BodySettings& settings) {
    const uint32_t count = ColliderCountOf(*settings.shape);
    ++more.bodies;
    more.placed += settings.motion == MotionType::Kinematic ? 2 : 1;  // listed as it is placed, and as it wakes
    more.sensors += settings.isSensor;
    more.colliders += colliders.HasFree(count) ? 0 : count;
    more.InTree(settings.motion != MotionType::Static, settings.isSensor) += count;
}

BodyId Add(WorldState& world, const BodySettings& settings, NewBody&& own) {
    const uint32_t body = world.bodies.Allocate();
    BodyCold& cold = world.bodies.cold[body];
    SetShapeOf(world, body, std::move(own.shape));
    cold.material = settings.material;
    cold.userData = settings.userData;
    cold.continuous = settings.continuous;
    world.bodies.continuousCount += settings.continuous != ContinuousCollision::Off;
    cold.isSensor = settings.isSensor;
    world.bodies.SetPenetrationTarget(body, settings.penetrationTarget);
    if (settings.reportsContacts) world.bodies.reportsContacts.Insert(body);
    world.bodies.dynamics[body] = own.dynamics;
    cold.keptMass = std::move(own.keptMass);
    world.bodies.SetRadii(body, *settings.shape);
    world.bodies.SetFilter(body, std::move(own.filter));
    if (cold.children) {
        const float kilograms = settings.mass > 0 ? settings.mass : settings.density * settings.shape->Mass().volume;
        cold.children->massUnit = double{kilograms} / RelativeMassOf(*settings.shape);
    }
    world.bodies.SetCenterPose(body, CenterPose(*settings.shape, settings.position, Normalized(settings.rotation)));
    SetVelocityOf(world, body, settings.linearVelocity, settings.angularVelocity);
    world.bodies.UpdateInertia(body);
    if (world.bodies.Count() == (world.bodies.worldBody == BodyStore::kNone ? 1u : 2u)) PlaceBoundsOrigin(world, body);
    MakeColliders(world, body);
    if (settings.motion == MotionType::Static) PlaceStatic(world, body);
    else world.bodies.MarkPlaced(body);
    if (settings.startAsleep) {
        world.bodies.SetVelocity(body, Vector3::Zero(), Vector3::Zero());
        if (!world.sensors.IsEmpty()) world.sensors.changed.push_back(body);
    } else if (settings.motion != MotionType::Static) {
        world.bodies.MarkAwake(body);
        RequeueColliders(world.bodies, world.colliders, body);
    }
    if (settings.isSensor) world.sensors.Add(world.bodies.IdOf(body), settings.sensorSees, settings.sensorReportsStay);
    return world.bodies.IdOf(body);
}

// Calls visit(record) for the contacts of a pair in the last step.
template <class Visit>
void VisitRecords(PairStore& pairs, uint32_t pair, Visit&& visit) {
    for (; pair != PairStore::kNone; pair = pairs.MoreOf(pair))
        if (pairs.pairs[pair].touching) visit(pairs.RecordOf(pairs.pairs[pair]));
}
// N s, along the normals.
float ImpulseOf(PairStore& pairs, uint32_t pair) {
    float sum = 0;
    VisitRecords(pairs, pair, [&](const ContactRecord& record) { sum += record.TotalImpulse(); });
    return sum;
}

// What carried `load` N s of a body that goes, and little else, forgets it, and so does what is below it: the impulses
// with which the next step begins would throw it up.
class Unloading {
public:
    explicit Unloading(WorldState& world) : world_(world) {}
    // What was changed is as before, unless it is kept.
    ~Unloading() {
        for (auto changed = before_.rbegin(); changed != before_.rend(); ++changed)
            world_.pairs.records[changed->record] = changed->was;
    }
    void Keep() { before_.clear(); }

    // `from`, above `body`, goes or is unloaded; kNone for the body that goes, whose contacts are only read.
    void Run(uint32_t body, uint32_t from, float load, int depth = 0) {
        Array<std::pair<uint32_t, float>> contacts;
        float sum = 0;
        for (const uint32_t pair : PairsOf(world_, body)) {
            const Pair& of = world_.pairs.pairs[pair];
            if (of.bodyA == from || of.bodyB == from) continue;
            contacts.emplace_back(pair, ImpulseOf(world_.pairs, pair));
            sum += contacts.back().second;
        }
        constexpr float kMost = 0.75f;  // of what it carries: less is left to the solver
        if (!(sum > 0 && load > kMost * sum)) return;
        const float part = from == BodyStore::kNone ? 1 : std::max(1 - load / sum, 0.0f);
        for (const auto& [pair, impulse] : contacts) {
            if (!(impulse > 0)) continue;
            VisitRecords(world_.pairs, pair, [&](ContactRecord& record) { Scale(record, part); });
            const Pair& of = world_.pairs.pairs[pair];
            const uint32_t other = of.bodyA == body ? of.bodyB : of.bodyA;
            if (depth < kDeepest && world_.bodies.dynamics[other].inverseMass > 0)
                Run(other, body, from == BodyStore::kNone ? impulse : (1 - part) * impulse, depth + 1);
        }
    }

private:
    static constexpr int kDeepest = 64;
    struct Changed {
        uint32_t record;
        ContactRecord was;
    };
    void Scale(ContactRecord& record, float part) {
        if (part == 1) return;
        before_.push_back({static_cast<uint32_t>(&record - world_.pairs.records.data()), record});
        for (float& i : record.impulse) i *= part;
        for (float& i : record.frictionImpulse) i *= part;
        record.twistImpulse *= part;
    }

    WorldState& world_;
    Array<Changed> before_;
};

}  // namespace

Result<BodyId> BodyInterface::Create(const BodySettings& settings) {
    const WorldChange<&BodyInterface::Create> change(world_, settings);
    if (change.Refusal()) return *change.Refusal();
    if (MaybeError error = Check(settings)) return *error;
    NewBody own(settings);
    Additions more;
    Include(more, world_.colliders, settings);
    if (settings.motion == MotionType::Static) world_.colliders.movingTree.Optimize(1);  // PlaceStatic asks it
    ReserveForChange(world_, more);
    change.Begin();
    return change.Created<BodyId>(Add(world_, settings, std::move(own)));
}

Result<BatchIds> BodyInterface::Commit(const BodyBatch& batch) {
    const WorldChange<&BodyInterface::Commit> change(world_, batch);
    if (change.Refusal()) return *change.Refusal();
    const auto motionOf = [&](BodyId id) {
        return BodyBatch::IsBody(id) ? batch.Bodies()[BodyBatch::IndexOf(id)].motion : MotionOf(world_, id);
    };
    // All that may be refused comes first.
    std::vector<std::unique_ptr<JointType>> types;
    types.reserve(batch.Joints().size());
    for (const BodyBatch::Joint& joint : batch.Joints()) {
        auto type = std::visit([&](const auto& settings) { return MakeCheckedType(settings, motionOf); }, joint);
        if (!type) return InList("joints", types.size(), type.GetError());
        types.push_back(std::move(type.Value()));
    }
    Additions more;
    Array<NewBody> own;
    own.reserve(batch.Bodies().size());
    const ColliderStore nothingFree;
    for (const BodySettings& settings : batch.Bodies()) {
        own.emplace_back(settings);
        Include(more, nothingFree, settings);
    }
    if (more.inStatic > 0) world_.colliders.movingTree.Optimize(1);  // PlaceStatic asks it
    for (const BodyBatch::Joint& joint : batch.Joints()) IncludeJoint(world_, CommonOf(joint), more);
    ReserveForChange(world_, more);
    BatchIds ids;
    ids.bodies.reserve(batch.Bodies().size());
    ids.joints.reserve(batch.Joints().size());
    change.Begin();
    JointInterface joints(world_);
    for (size_t i = 0; i < own.size(); ++i) ids.bodies.push_back(Add(world_, batch.Bodies()[i], std::move(own[i])));
    for (size_t i = 0; i < types.size(); ++i) {
        JointSettings settings = CommonOf(batch.Joints()[i]);
        for (BodyId* const body : {&settings.bodyA, &settings.bodyB})
            if (BodyBatch::IsBody(*body)) *body = ids.bodies[BodyBatch::IndexOf(*body)];
        ids.joints.push_back(joints.Add(settings, std::move(types[i])));
    }
    return change.Created<BatchIds>(std::move(ids));
}

Status BodyInterface::Remove(BodyId id) {
    const WorldChange<&BodyInterface::Remove> change(world_, id);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    const uint32_t body = id.index;
    ReserveForChange(world_);
    Unloading unloading(world_);
    if (world_.bodies.dynamics[body].inverseMass > 0)
        unloading.Run(body, BodyStore::kNone, std::numeric_limits<float>::infinity());
    unloading.Keep();
    change.Begin();
    WakeBody(world_, body);
    WakeNeighbors(world_, body);
    world_.joints.VisitOf(body, [&](uint32_t joint) { RemoveJoint(world_, joint); });
    BodyCold& cold = world_.bodies.cold[body];
    world_.bodies.continuousCount -= cold.continuous != ContinuousCollision::Off;
    world_.bodies.SetPenetrationTarget(body, 0);
    if (cold.isSensor) world_.sensors.Remove(id);
    VisitColliders(world_, body, [&](uint32_t i) {
        world_.colliders.TreeOf(world_.colliders.colliders[i]).Remove(i);
        world_.outsideFatBounds.Forget(i);
        // Its contacts end now. Its pairs are removed in the next step, together with those of other removed bodies.
        world_.pairs.VisitOf(i, [&](uint32_t pair) {
            for (; pair != PairStore::kNone; pair = world_.pairs.MoreOf(pair))
                world_.pairs.pairs[pair].touching = false;
        });
    });
    world_.bodies.MarkAsleep(body);
    cold.exists = false;
    cold.removed = true;
    world_.removed.push_back(body);
    return Done{};
}

bool BodyInterface::Exists(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return static_cast<bool>(reading);
}

Status BodyInterface::MoveKinematic(BodyId id, const Position& position, const Quaternion& rotation, float dt) {
    const WorldChange<&BodyInterface::MoveKinematic> change(world_, id, position, rotation, dt);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (world_.bodies.dynamics[id.index].motion != MotionType::Kinematic)
        return Error{ErrorCode::Unsupported, "MoveKinematic needs a kinematic body"};
    if (MaybeError e =
            FirstOf(CheckPosition("position", position), CheckRotation("rotation", rotation), CheckPositive("dt", dt)))
        return *e;
    const Pose now{world_.bodies.ExactCenterOf(id.index), world_.bodies.RotationOf(id.index)};
    const Pose goal = CenterPose(*world_.bodies.cold[id.index].shape, position, Normalized(rotation));
    const Vector3 linear = Vector3((goal.position - now.position).cast<float>()) * (1.0f / dt);
    const Vector3 angular = RotationVectorOf(goal.rotation * now.rotation.Conjugate()) * (1.0f / dt);
    if (MaybeError e = ChangeVelocity(world_, change, id, linear, angular)) return *e;
    world_.bodies.cold[id.index].singleMove = SingleMove::Next;
    world_.bodies.singleMoves.Insert(id.index);
    return Done{};
}

Status BodyInterface::SetVelocity(BodyId id, const Vector3& linear, const Vector3& angular) {
    const WorldChange<&BodyInterface::SetVelocity> change(world_, id, linear, angular);
    if (change.Refusal()) return *change.Refusal();
    if (MaybeError e = ChangeVelocity(world_, change, id, linear, angular)) return *e;
    return Done{};
}

namespace {

MaybeError CheckIsSensor(const WorldState& world, BodyId id) {
    if (!world.bodies.Find(id)) return Unknown(id);
    if (!world.bodies.cold[id.index].isSensor) return Error{ErrorCode::Unsupported, "the body is no sensor"};
    return std::nullopt;
}

MaybeError CheckPushable(const WorldState& world, BodyId id) {
    if (!world.bodies.Find(id)) return Unknown(id);
    const BodyDynamics& d = world.bodies.dynamics[id.index];
    if (d.motion != MotionType::Dynamic) return Error{ErrorCode::Unsupported, "only dynamic bodies can be pushed"};
    if (d.frozen) return Error{ErrorCode::Unsupported, "the body is frozen; SetPose revives it"};
    return std::nullopt;
}

Vector3 ArmTo(const WorldState& world, BodyId id, const Position& point) {
    return (point - world.bodies.CenterOf(id.index)).cast<float>();
}

Status Push(WorldState& world, const WorldLock::Exclusive& alone, BodyId id, const Vector3& force,
            const Vector3& torque) {
    if (MaybeError e = FirstOf(CheckPushable(world, id), CheckFinite("force", force), CheckFinite("torque", torque)))
        return *e;
    if (force.isZero(0) && torque.isZero(0)) return Done{};
    BodyCold& cold = world.bodies.cold[id.index];
    ReserveToWake(world, id.index);
    alone.Begin();
    // Under a steady push it may stay asleep: the step checks whether this one is the same.
    if (!world.bodies.dynamics[id.index].awake && !cold.isSteady) WakeBody(world, id.index);
    cold.force += force;
    cold.torque += torque;
    world.bodies.dynamics[id.index].hasForce = true;
    world.bodies.pushed.Insert(id.index);
    return Done{};
}

Status ApplyImpulse(WorldState& world, const WorldLock::Exclusive& alone, BodyId id, const Vector3& impulse,
                    const Vector3& angularImpulse) {
    if (MaybeError e = FirstOf(CheckPushable(world, id), CheckFinite("impulse", impulse),
                               CheckFinite("angular impulse", angularImpulse)))
        return *e;
    if (impulse.isZero(0) && angularImpulse.isZero(0)) return Done{};
    ReserveToWake(world, id.index);
    alone.Begin();
    WakeBody(world, id.index);
    const BodyMass& m = world.bodies.masses[id.index];
    SetVelocityOf(
        world, id.index, world.bodies.LinearVelocityOf(id.index) + LimitedPush(impulse, m.inverseMass) * m.inverseMass,
        world.bodies.AngularVelocityOf(id.index) + m.InverseInertia() * LimitedPush(angularImpulse, Trace(m)));
    return Done{};
}

}  // namespace

Status BodyInterface::AddForce(BodyId id, const Vector3& force) {
    const WorldChange<&BodyInterface::AddForce> change(world_, id, force);
    if (change.Refusal()) return *change.Refusal();
    return Push(world_, change, id, force, Vector3::Zero());
}
Status BodyInterface::AddTorque(BodyId id, const Vector3& torque) {
    const WorldChange<&BodyInterface::AddTorque> change(world_, id, torque);
    if (change.Refusal()) return *change.Refusal();
    return Push(world_, change, id, Vector3::Zero(), torque);
}
Status BodyInterface::AddForceAt(BodyId id, const Vector3& force, const Position& point) {
    const WorldChange<&BodyInterface::AddForceAt> change(world_, id, force, point);
    if (change.Refusal()) return *change.Refusal();
    if (MaybeError e = FirstOf(CheckPushable(world_, id), CheckPosition("point", point))) return *e;
    return Push(world_, change, id, force, Cross<float>(ArmTo(world_, id, point), force));
}
Status BodyInterface::AddImpulse(BodyId id, const Vector3& impulse) {
    const WorldChange<&BodyInterface::AddImpulse> change(world_, id, impulse);
    if (change.Refusal()) return *change.Refusal();
    return ApplyImpulse(world_, change, id, impulse, Vector3::Zero());
}
Status BodyInterface::AddAngularImpulse(BodyId id, const Vector3& impulse) {
    const WorldChange<&BodyInterface::AddAngularImpulse> change(world_, id, impulse);
    if (change.Refusal()) return *change.Refusal();
    return ApplyImpulse(world_, change, id, Vector3::Zero(), impulse);
}
Status BodyInterface::AddImpulseAt(BodyId id, const Vector3& impulse, const Position& point) {
    const WorldChange<&BodyInterface::AddImpulseAt> change(world_, id, impulse, point);
    if (change.Refusal()) return *change.Refusal();
    if (MaybeError e = FirstOf(CheckPushable(world_, id), CheckPosition("point", point))) return *e;
    return ApplyImpulse(world_, change, id, impulse, Cross<float>(ArmTo(world_, id, point), impulse));
}

Status BodyInterface::SetSensor(BodyId id, bool isSensor) {
    const WorldChange<&BodyInterface::SetSensor> change(world_, id, isSensor);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    BodyCold& cold = world_.bodies.cold[id.index];
    if (cold.isSensor == isSensor) return Done{};
    if (cold.continuous != ContinuousCollision::Off)
        return Error{ErrorCode::Unsupported,
                     "the body has continuous collision; a sensor touches nothing, and is not cast"};
    const Array<uint32_t> pairs = PairsOf(world_, id.index);
    Additions more{.sensors = isSensor, .removedPairs = CountPairsOf(world_, id.index)};
    VisitColliders(world_, id.index,
                   [&](uint32_t i) { ++more.InTree(world_.colliders.colliders[i].moving, isSensor); });
    ReserveForChange(world_, more);
    change.Begin();
    WakeBody(world_, id.index);
    WakeNeighbors(world_, id.index);
    for (const uint32_t pair : pairs) RemovePair(world_.pairs, world_.coloring, pair);
    cold.isSensor = isSensor;
    MoveToItsTree(world_, id.index);
    WakeNeighbors(world_, id.index);
    if (isSensor) world_.sensors.Add(id, SensorSees::Default, true);
    else world_.sensors.Remove(id);
    return Done{};
}

Status BodyInterface::SetSensorSees(BodyId id, SensorSees sees) {
    const WorldChange<&BodyInterface::SetSensorSees> change(world_, id, sees);
    if (change.Refusal()) return *change.Refusal();
    if (MaybeError e = CheckIsSensor(world_, id)) return *e;
    if (MaybeError e = CheckSensor(sees)) return *e;
    ReserveForChange(world_);
    change.Begin();
    world_.sensors.Add(id, sees, world_.sensors.sensors[world_.sensors.PlaceOf(id)].reportsStay);
    return Done{};
}

Status BodyInterface::SetSensorReportsStay(BodyId id, bool reportsStay) {
    const WorldChange<&BodyInterface::SetSensorReportsStay> change(world_, id, reportsStay);
    if (change.Refusal()) return *change.Refusal();
    if (MaybeError e = CheckIsSensor(world_, id)) return *e;
    world_.sensors.sensors[world_.sensors.PlaceOf(id)].reportsStay = reportsStay;
    return Done{};
}

Status BodyInterface::Wake(BodyId id) {
    const WorldChange<&BodyInterface::Wake> change(world_, id);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    ReserveToWake(world_, id.index);
    change.Begin();
    WakeBody(world_, id.index);
    return Done{};
}

Status BodyInterface::Sleep(BodyId id) {
    const WorldChange<&BodyInterface::Sleep> change(world_, id);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (world_.bodies.dynamics[id.index].motion != MotionType::Dynamic)
        return Error{ErrorCode::Unsupported, "only dynamic bodies sleep"};
    if (!world_.bodies.dynamics[id.index].awake) return Done{};
    const Array<uint32_t> island = IslandToSleep(world_, id.index);
    change.Begin();
    SleepAsIsland(world_, island);
    for (const uint32_t body : world_.sleeping.Bodies(world_.bodies.cold[id.index].sleepingIsland))
        ForgetPush(world_.bodies, body);
    return Done{};
}

Pose BodyInterface::GetPose(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    if (!reading) return {};
    const Pose center = world_.seenPoses.ExactPoseOf(world_.lock, world_.bodies, id.index);
    const Vector3 offset = world_.bodies.cold[id.index].shape->Mass().centerOfMass;
    return {center.position - Rotate(center.rotation, offset).cast<double>(), center.rotation};
}

Position BodyInterface::GetCenterOfMass(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    if (!reading) return Position::Zero();
    return world_.seenPoses.ExactPoseOf(world_.lock, world_.bodies, id.index).position;
}
Vector3 BodyInterface::GetLinearVelocity(BodyId id) const {
    const BodyReading reading(world_, locks_, id, WorldLock::Access::Reads);
    return reading ? world_.bodies.LinearVelocityOf(id.index) : Vector3(Vector3::Zero());
}
Vector3 BodyInterface::GetAngularVelocity(BodyId id) const {
    const BodyReading reading(world_, locks_, id, WorldLock::Access::Reads);
    return reading ? world_.bodies.AngularVelocityOf(id.index) : Vector3(Vector3::Zero());
}
Vector3 BodyInterface::GetVelocityAt(BodyId id, const Position& point) const {
    const BodyReading reading(world_, locks_, id, WorldLock::Access::Reads);
    if (!reading) return Vector3::Zero();
    return GetLinearVelocity(id) + Cross<float>(GetAngularVelocity(id), ArmTo(world_, id, point));
}
float BodyInterface::GetMass(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    if (!reading) return 0;
    const float inverse = world_.bodies.dynamics[id.index].inverseMass;
    return inverse > 0 ? 1.0f / inverse : 0.0f;
}
Vector3 BodyInterface::GetAngularMomentum(BodyId id) const {
    const BodyReading reading(world_, locks_, id, WorldLock::Access::Reads);
    if (!reading) return Vector3::Zero();
    return AngularMomentum(world_.bodies.dynamics[id.index], world_.bodies.RotationOf(id.index),
                           GetAngularVelocity(id));
}
double BodyInterface::GetKineticEnergy(BodyId id) const {
    const BodyReading reading(world_, locks_, id, WorldLock::Access::Reads);
    if (!reading || world_.bodies.dynamics[id.index].motion != MotionType::Dynamic) return 0;
    const Position v = GetLinearVelocity(id).cast<double>();
    return 0.5 * double{GetMass(id)} * Dot<double>(v, v) + RotationalEnergy(world_.bodies.dynamics[id.index],
                                                                            world_.bodies.RotationOf(id.index),
                                                                            GetAngularVelocity(id));
}
MotionType BodyInterface::GetMotionType(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].motion : MotionType::Static;
}
ContinuousCollision BodyInterface::GetContinuous(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.cold[id.index].continuous : ContinuousCollision::Off;
}
ShapePtr BodyInterface::GetShape(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.cold[id.index].shape : nullptr;
}
uint64_t BodyInterface::GetCategory(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.FilterOf(id.index).category : 0;
}
uint64_t BodyInterface::GetMask(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.FilterOf(id.index).mask : 0;
}
CollisionGroup BodyInterface::GetGroup(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.FilterOf(id.index).group : CollisionGroup{};
}
uint64_t BodyInterface::GetUserData(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.cold[id.index].userData : 0;
}
float BodyInterface::GetPenetrationTarget(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.cold[id.index].penetrationTarget : 0;
}
bool BodyInterface::ReportsContacts(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading && world_.bodies.reportsContacts.Contains(id.index);
}
bool BodyInterface::IsSensor(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading && world_.bodies.cold[id.index].isSensor;
}
SensorSees BodyInterface::GetSensorSees(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    if (!reading || !world_.sensors.Has(id)) return SensorSees::Nothing;
    return world_.sensors.sensors[world_.sensors.PlaceOf(id)].sees;
}
bool BodyInterface::SensorReportsStay(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading && world_.sensors.Has(id) && world_.sensors.sensors[world_.sensors.PlaceOf(id)].reportsStay;
}
bool BodyInterface::IsAwake(BodyId id) const {
    const BodyReading reading(world_, locks_, id, WorldLock::Access::Reads);
    return reading && world_.bodies.dynamics[id.index].awake;
}
bool BodyInterface::IsFrozen(BodyId id) const {
    const BodyReading reading(world_, locks_, id, WorldLock::Access::Reads);
    return reading && world_.bodies.dynamics[id.index].frozen;
}

}  // namespace fulcrum
