// Functions of BodyInterface that change existing bodies: motion type, mass, damping and limits, collision filters.
#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/BodyInterface.h>
#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/BodyPairs.h>
#include <Fulcrum/Physics/World/BodyReading.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Filters.h>
#include <Fulcrum/Physics/World/Materials.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>
#include <Fulcrum/Physics/World/SteadyPushes.h>
#include <Fulcrum/Physics/World/TargetChanges.h>
#include <Fulcrum/Physics/World/Teleports.h>
#include <Fulcrum/Physics/World/Waking.h>
#include <Fulcrum/Physics/World/WorldChange.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

// A pose returned by GetPose is set with the same bits: normalizing its rotation again would change them.
Quaternion NormalizedUnlessItIs(const Quaternion& q) {
    const double squared = double{q.x} * q.x + double{q.y} * q.y + double{q.z} * q.z + double{q.w} * q.w;
    constexpr double kRounding = 0x1p-21;  // more than the error of four components rounded to float
    return std::fabs(squared - 1) <= kRounding ? q : Normalized(q);
}

// Ends the contacts, of the body's pairs, that its filters forbid, and searches for those that they allow.
void Refilter(WorldState& world, uint32_t body, std::span<const uint32_t> pairs) {
    RemoveForbiddenPairs(world, pairs);
    WakeBody(world, body);
    WakeNeighbors(world, body);
    if (world.bodies.dynamics[body].motion == MotionType::Dynamic) world.bodies.MarkPlaced(body);
    RequeueColliders(world.bodies, world.colliders, body);
}

// Of a body that is not dynamic: the mass it gets when it becomes dynamic.
KeptMass KeptMassOf(const BodyCold& body) {
    if (body.keptMass) return *body.keptMass;
    const MassProperties& shape = body.shape->Mass();
    constexpr float kDensity = BodySettings::kUsualDensity;
    return {shape.volume * kDensity, Vector3(shape.principalInertia * kDensity), shape.principalAxes};
}

KeptMass MassOf(const BodyDynamics& d) {
    KeptMass mass{1.0f / d.inverseMass, Vector3::Zero(), d.PrincipalAxes()};
    for (int k = 0; k < 3; ++k) mass.inertia[k] = 1.0f / d.inverseInertia[k];
    return mass;
}

KeptMass AnyMassOf(const BodyStore& bodies, uint32_t body) {
    const BodyDynamics& d = bodies.dynamics[body];
    return d.motion == MotionType::Dynamic ? MassOf(d) : KeptMassOf(bodies.cold[body]);
}

void SetAnyMass(WorldState& world, const WorldLock::Exclusive& alone, uint32_t body, const KeptMass& mass) {
    const bool isDynamic = world.bodies.dynamics[body].motion == MotionType::Dynamic;
    std::unique_ptr<KeptMass> kept = isDynamic ? nullptr : std::make_unique<KeptMass>(mass);
    if (isDynamic) ReserveForChange(world);
    alone.Begin();
    BodyCold& cold = world.bodies.cold[body];
    if (cold.children) cold.children->massUnit = double{mass.mass} / RelativeMassOf(*cold.shape);
    if (!isDynamic) {
        cold.keptMass = std::move(kept);
        return;
    }
    SetMass(world.bodies.dynamics[body], mass.principalAxes, mass.mass, mass.inertia);
    world.bodies.UpdateInertia(body);
    if (world.joints.HasAny(body)) world.coloring.Invalidate();
    WakeBody(world, body);
    WakeNeighbors(world, body);
}

// What only dynamic bodies have.
void LoseMass(BodyStore& bodies, uint32_t body, std::unique_ptr<KeptMass> kept) {
    BodyDynamics& d = bodies.dynamics[body];
    bodies.cold[body].keptMass = std::move(kept);
    d.inverseMass = 0;
    for (float& inverse : d.inverseInertia) inverse = 0;
    d.spherical = false;
    d.crowded = 0;
    d.dispersing = false;
    d.slowSeconds = 0;
    ForgetPush(bodies, body);
    bodies.UnmarkPlaced(body);
    std::erase(bodies.placed, body);
    bodies.unconstrained[body] = {};
    for (float& a : bodies.poses[body].acceleration) a = 0;
}

void GainMass(BodyStore& bodies, uint32_t body) {
    const KeptMass mass = KeptMassOf(bodies.cold[body]);
    SetMass(bodies.dynamics[body], mass.principalAxes, mass.mass, mass.inertia);
    bodies.cold[body].keptMass = nullptr;
}

}  // namespace

Status BodyInterface::SetMotionType(BodyId id, MotionType motion) {
    const WorldChange<&BodyInterface::SetMotionType> change(world_, id, motion);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    const uint32_t body = id.index;
    BodyStore& bodies = world_.bodies;
    BodyDynamics& d = bodies.dynamics[body];
    if (MaybeError e = CheckEnum("motion", motion, MotionType::Dynamic)) return *e;
    if (d.motion == motion) return Done{};
    if (d.frozen) return Error{ErrorCode::Unsupported, "the body is frozen; SetPose revives it"};
    if (MaybeError e = CheckShape(bodies.cold[body].shape.get(), motion)) return *e;
    if (motion == MotionType::Dynamic) {
        const KeptMass mass = KeptMassOf(bodies.cold[body]);
        if (MaybeError e = CheckInverses("shape", "shape", mass.mass, mass.inertia)) return *e;
    }
    std::unique_ptr<KeptMass> kept = d.motion == MotionType::Dynamic ? std::make_unique<KeptMass>(MassOf(d)) : nullptr;
    const Array<uint32_t> pairs = PairsOf(world_, body);
    Additions more{.removedPairs = CountPairsOf(world_, body)};
    VisitColliders(world_, body,
                   [&](uint32_t) { ++more.InTree(motion != MotionType::Static, bodies.cold[body].isSensor); });
    ReserveForChange(world_, more);
    change.Begin();
    WakeBody(world_, body);
    WakeNeighbors(world_, body);
    WakeJoined(world_, body);
    for (const uint32_t pair : pairs) RemovePair(world_.pairs, world_.coloring, pair);
    if (d.motion == MotionType::Dynamic) LoseMass(bodies, body, std::move(kept));
    if (motion == MotionType::Dynamic) GainMass(bodies, body);
    if (bodies.singleMoves.Erase(body)) bodies.cold[body].singleMove = SingleMove::None;
    d.motion = motion;
    if (motion == MotionType::Static) bodies.SetVelocity(body, Vector3::Zero(), Vector3::Zero());
    const bool moves = !bodies.LinearVelocityOf(body).isZero(0) || !bodies.AngularVelocityOf(body).isZero(0);
    if (motion == MotionType::Dynamic || (motion == MotionType::Kinematic && moves)) bodies.MarkAwake(body);
    else bodies.MarkAsleep(body);
    if (motion == MotionType::Dynamic) bodies.MarkPlaced(body);
    bodies.UpdateInertia(body);
    RecolorJointsOf(bodies, world_.joints, world_.coloring, body);
    world_.coloring.Invalidate();
    MoveToItsTree(world_, body);
    bodies.poses[body].boundsChangedIn = static_cast<uint32_t>(world_.step + 1);
    if (!world_.sensors.IsEmpty()) world_.sensors.changed.push_back(body);
    WakeNeighbors(world_, body);
    WakeJoined(world_, body);
    return Done{};
}

Status BodyInterface::SetMass(BodyId id, float mass) {
    const WorldChange<Overload<BodyId, float>::Of(&BodyInterface::SetMass)> change(world_, id, mass);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = CheckPositive("mass", mass)) return *e;
    KeptMass next = AnyMassOf(world_.bodies, id.index);
    if (!(next.mass > 0)) return Error{ErrorCode::Unsupported, "the body's shape has no volume, and so no mass"};
    next.inertia *= mass / next.mass;
    next.mass = mass;
    if (MaybeError e = CheckInverses("mass", "mass", next.mass, next.inertia)) return *e;
    SetAnyMass(world_, change, id.index, next);
    return Done{};
}

Status BodyInterface::SetMass(BodyId id, float mass, const SymmetricMatrix3& inertia) {
    const WorldChange<Overload<BodyId, float, const SymmetricMatrix3&>::Of(&BodyInterface::SetMass)> change(
        world_, id, mass, inertia);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e =
            FirstOf(CheckPositive("mass", mass), CheckFinite("inertia", Vector3(inertia.xx, inertia.yy, inertia.zz)),
                    CheckFinite("inertia", Vector3(inertia.xy, inertia.xz, inertia.yz))))
        return *e;
    const PrincipalAxes principal =
        Diagonalized({inertia.xx, inertia.yy, inertia.zz, inertia.xy, inertia.xz, inertia.yz});
    if (!(principal.values.minCoeff() > 0))
        return Error{ErrorCode::NonPositive, "inertia has a principal moment that is not larger than 0"};
    const KeptMass next{mass, Vector3(principal.values.cast<float>()), principal.rotation};
    if (MaybeError e = CheckInverses("mass", "inertia", next.mass, next.inertia)) return *e;
    SetAnyMass(world_, change, id.index, next);
    return Done{};
}

SymmetricMatrix3 BodyInterface::GetInertia(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    if (!reading || world_.bodies.dynamics[id.index].motion != MotionType::Dynamic) return {};
    const KeptMass mass = MassOf(world_.bodies.dynamics[id.index]);
    return RotatedDiagonal(ToMatrix(mass.principalAxes), mass.inertia);
}

Status BodyInterface::SetPoses(std::span<const BodyId> ids, std::span<const Pose> poses) {
    const WorldChange<&BodyInterface::SetPoses> change(world_, ids, poses);
    if (change.Refusal()) return *change.Refusal();
    if (ids.size() != poses.size())
        return Error{ErrorCode::OutOfRange, "there are " + std::to_string(ids.size()) + " bodies and " +
                                                std::to_string(poses.size()) + " poses; each body needs one"};
    Array<BodyPlace> places;
    for (size_t i = 0; i < ids.size(); ++i) {
        if (!Exists(ids[i])) return Unknown(ids[i]);
        if (MaybeError e =
                FirstOf(CheckPosition("position", poses[i].position), CheckRotation("rotation", poses[i].rotation)))
            return *e;
        places.push_back({ids[i].index, {poses[i].position, NormalizedUnlessItIs(poses[i].rotation)}});
    }
    Array<BodyId> sorted(ids.begin(), ids.end());
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end())
        return Error{ErrorCode::Unsupported, "a body is named twice; it can be in one place"};
    ReserveForChange(world_, {.placed = places.size()});
    change.Begin();
    Teleport(world_, places);
    return Done{};
}

Status BodyInterface::SetPose(BodyId id, const Position& position, const Quaternion& rotation) {
    const Pose pose{position, rotation};
    return SetPoses({&id, 1}, {&pose, 1});
}

Status BodyInterface::SetMaterial(BodyId id, const Material& material) {
    const WorldChange<&BodyInterface::SetMaterial> change(world_, id, material);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = Check(material)) return *e;
    const Array<uint32_t> pairs = PairsOf(world_, id.index);
    ReserveForChange(world_);
    change.Begin();
    world_.bodies.cold[id.index].material = material;
    for (uint32_t pair : pairs)
        for (; pair != PairStore::kNone; pair = world_.pairs.MoreOf(pair))
            CombineMaterials(world_.bodies, world_.colliders, world_.pairs, pair);
    WakeBody(world_, id.index);
    WakeNeighbors(world_, id.index);
    return Done{};
}

Material BodyInterface::GetMaterial(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.cold[id.index].material : Material{.friction = 0};
}

Status BodyInterface::SetLayer(BodyId id, uint8_t layer) {
    const WorldChange<&BodyInterface::SetLayer> change(world_, id, layer);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = CheckRange("layer", layer, 0, 31)) return *e;
    BodyDynamics& d = world_.bodies.dynamics[id.index];
    const Array<uint32_t> pairs = PairsOf(world_, id.index);
    ReserveForChange(world_, {.removedPairs = CountPairsOf(world_, id.index)});
    change.Begin();
    d.layer = layer & 31u;
    ColliderStore& colliders = world_.colliders;
    if (!world_.bodies.cold[id.index].isSensor)
        (d.motion != MotionType::Static ? colliders.movingLayers : colliders.staticLayers) |= 1u << layer;
    if (!world_.sensors.IsEmpty()) world_.sensors.changed.push_back(id.index);
    Refilter(world_, id.index, pairs);
    return Done{};
}

namespace {

void ChangeFilter(WorldState& world, const WorldLock::Exclusive& alone, uint32_t body, const BodyFilter& filter) {
    std::unique_ptr<BodyFilter> own = BodyStore::MakeFilter(filter);
    const Array<uint32_t> pairs = PairsOf(world, body);
    ReserveForChange(world, {.removedPairs = CountPairsOf(world, body)});
    alone.Begin();
    world.bodies.SetFilter(body, std::move(own));
    Refilter(world, body, pairs);
}

}  // namespace

Status BodyInterface::SetCategoryAndMask(BodyId id, uint64_t category, uint64_t mask) {
    const WorldChange<&BodyInterface::SetCategoryAndMask> change(world_, id, category, mask);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    ChangeFilter(world_, change, id.index, {category, mask, GetGroup(id)});
    return Done{};
}

Status BodyInterface::SetGroup(BodyId id, const CollisionGroup& group) {
    const WorldChange<&BodyInterface::SetGroup> change(world_, id, group);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    ChangeFilter(world_, change, id.index, {GetCategory(id), GetMask(id), group});
    return Done{};
}

Status BodyInterface::SetGravityFactor(BodyId id, float factor) {
    const WorldChange<&BodyInterface::SetGravityFactor> change(world_, id, factor);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = CheckRange("gravityFactor", factor, -1e6, 1e6)) return *e;
    ReserveToWake(world_, id.index);
    change.Begin();
    world_.bodies.dynamics[id.index].gravityFactor = factor;
    WakeBody(world_, id.index);
    return Done{};
}

Status BodyInterface::SetContinuous(BodyId id, ContinuousCollision continuous) {
    const WorldChange<&BodyInterface::SetContinuous> change(world_, id, continuous);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = CheckContinuous(continuous, *world_.bodies.cold[id.index].shape)) return *e;
    constexpr ContinuousCollision kOff = ContinuousCollision::Off;
    BodyCold& cold = world_.bodies.cold[id.index];
    if (cold.isSensor && continuous != kOff)
        return Error{ErrorCode::Unsupported, "a sensor touches nothing, and is not cast"};
    world_.bodies.continuousCount += (continuous != kOff) - (cold.continuous != kOff);
    cold.continuous = continuous;
    world_.bodies.dynamics[id.index].continuous = continuous != kOff;
    return Done{};
}

Status BodyInterface::SetPenetrationTarget(BodyId id, float target) {
    const DefaultFloats floats;
    if (MaybeError error = CheckTarget("penetrationTarget", target)) return *error;
    const WorldChange<&BodyInterface::SetPenetrationTarget> change(world_, id, target);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    ChangePenetrationTarget(world_, id.index, target);
    return Done{};
}

Status BodyInterface::SetReportsContacts(BodyId id, bool reportsContacts) {
    const WorldChange<&BodyInterface::SetReportsContacts> change(world_, id, reportsContacts);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (reportsContacts) world_.bodies.reportsContacts.Insert(id.index);
    else world_.bodies.reportsContacts.Erase(id.index);
    return Done{};
}

Status BodyInterface::SetGravity(BodyId id, const std::optional<Vector3>& gravity) {
    const WorldChange<&BodyInterface::SetGravity> change(world_, id, gravity);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    constexpr double kMost = 1e6;  // as the system's
    if (gravity)
        if (MaybeError e = FirstOf(CheckFinite("gravity", *gravity),
                                   CheckRange("gravity", double{gravity->cwiseAbs().maxCoeff()}, 0, kMost)))
            return *e;
    ReserveToWake(world_, id.index);
    change.Begin();
    BodyCold& cold = world_.bodies.cold[id.index];
    cold.hasGravity = gravity.has_value();
    cold.gravity = gravity.value_or(Vector3(Vector3::Zero()));
    world_.bodies.UpdateSpecial(id.index);
    WakeBody(world_, id.index);
    return Done{};
}

Status BodyInterface::SetDamping(BodyId id, float linear, float angular) {
    const WorldChange<&BodyInterface::SetDamping> change(world_, id, linear, angular);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = FirstOf(CheckNotNegative("linear", linear), CheckNotNegative("angular", angular))) return *e;
    ReserveToWake(world_, id.index);
    change.Begin();
    BodyDynamics& d = world_.bodies.dynamics[id.index];
    // Much damping may be all that held it.
    if (d.linearDamping != linear || d.angularDamping != angular) WakeBody(world_, id.index);
    d.linearDamping = linear;
    d.angularDamping = angular;
    return Done{};
}

Status BodyInterface::SetLockedAxes(BodyId id, LockedAxes axes) {
    const WorldChange<&BodyInterface::SetLockedAxes> change(world_, id, axes);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = CheckRange("axes", static_cast<uint8_t>(axes), 0, 63)) return *e;
    ReserveToWake(world_, id.index);
    change.Begin();
    world_.bodies.dynamics[id.index].lockedAxes = axes;
    world_.bodies.UpdateInertia(id.index);
    if (world_.joints.HasAny(id.index)) world_.coloring.Invalidate();
    WakeBody(world_, id.index);
    return Done{};
}

Status BodyInterface::SetMaxSpeeds(BodyId id, float linear, float angular) {
    const WorldChange<&BodyInterface::SetMaxSpeeds> change(world_, id, linear, angular);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError e = FirstOf(CheckPositive("linear", linear), CheckPositive("angular", angular))) return *e;
    BodyDynamics& d = world_.bodies.dynamics[id.index];
    const float mostLinear = std::min(linear, kFastestLinear), mostAngular = std::min(angular, kFastestAngular);
    ReserveToWake(world_, id.index);
    change.Begin();
    // A limit may be all that held it.
    if (d.maxLinearSpeed != mostLinear || d.maxAngularSpeed != mostAngular) WakeBody(world_, id.index);
    d.maxLinearSpeed = mostLinear;
    d.maxAngularSpeed = mostAngular;
    return Done{};
}

Status BodyInterface::SetUserData(BodyId id, uint64_t userData) {
    const WorldChange<&BodyInterface::SetUserData> change(world_, id, userData);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    world_.bodies.cold[id.index].userData = userData;
    return Done{};
}

Status BodyInterface::SetAllowSleep(BodyId id, bool allowSleep) {
    const WorldChange<&BodyInterface::SetAllowSleep> change(world_, id, allowSleep);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (!allowSleep) ReserveToWake(world_, id.index);
    change.Begin();
    world_.bodies.dynamics[id.index].allowSleep = allowSleep;
    if (!allowSleep) WakeBody(world_, id.index);
    return Done{};
}

Status BodyInterface::SetGyroscopicTorque(BodyId id, bool isOn) {
    const WorldChange<&BodyInterface::SetGyroscopicTorque> change(world_, id, isOn);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    world_.bodies.dynamics[id.index].gyroscopic = isOn;
    world_.bodies.UpdateInertia(id.index);
    return Done{};
}

float BodyInterface::GetGravityFactor(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].gravityFactor : 0.0f;
}
Vector3 BodyInterface::GetGravity(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.GravityOf(id.index, world_.settings.gravity) : Vector3(Vector3::Zero());
}
float BodyInterface::GetLinearDamping(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].linearDamping : 0.0f;
}
float BodyInterface::GetAngularDamping(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].angularDamping : 0.0f;
}
LockedAxes BodyInterface::GetLockedAxes(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].lockedAxes : LockedAxes::None;
}
float BodyInterface::GetMaxLinearSpeed(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].maxLinearSpeed : 0.0f;
}
float BodyInterface::GetMaxAngularSpeed(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].maxAngularSpeed : 0.0f;
}
uint8_t BodyInterface::GetLayer(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading ? world_.bodies.dynamics[id.index].layer : uint8_t{0};
}
bool BodyInterface::HasGyroscopicTorque(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading && world_.bodies.dynamics[id.index].gyroscopic;
}
bool BodyInterface::AllowsSleep(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    return reading && world_.bodies.dynamics[id.index].allowSleep;
}

BodyBounds BodyInterface::GetBounds(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    if (!reading) return {};
    Bounds all;
    const Pose pose = world_.seenPoses.PoseOf(world_.lock, world_.bodies, id.index);
    VisitColliders(world_, id.index, [&](uint32_t collider) {
        all.Include(TightBoundsAt(pose, world_.bodies, world_.colliders, collider));
    });
    const Position center = world_.seenPoses.ExactPoseOf(world_.lock, world_.bodies, id.index).position;
    if (all.IsEmpty()) return {center, center};
    const Position& origin = world_.colliders.boundsOrigin;
    return {origin + all.lower.cast<double>(), origin + all.upper.cast<double>()};
}

}  // namespace fulcrum
