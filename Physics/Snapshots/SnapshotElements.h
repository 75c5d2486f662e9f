// The members of settings, bodies, colliders, pairs and joints that a snapshot contains. Each structure's members are
// all listed by a structured binding, so a new member does not compile until it is handled here. The same function
// writes and reads an element. See Snapshots.md for what is left out.
#pragma once

#include <Fulcrum/Physics/Snapshots/SnapshotStream.h>
#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <array>
#include <cmath>

namespace fulcrum {

template <>
struct IsPlain<BodyId> : std::true_type {};
template <>
struct IsPlain<JointId> : std::true_type {};
template <>
struct IsPlain<ColliderRun> : std::true_type {};
template <>
struct IsPlain<LoadLevel> : std::true_type {};
template <>
struct IsPlain<ContactRecord::Point> : std::true_type {};
// 15 floats, two bytes and 16 bits: no padding.
template <>
struct IsPlain<BodyDynamics> : std::true_type {};
static_assert(sizeof(BodyId) == 8 && sizeof(JointId) == 8 && sizeof(ColliderRun) == 12 && sizeof(LoadLevel) == 3 &&
              sizeof(ContactRecord::Point) == 24);

// Bit fields, which cannot be bound by reference.
template <class Stream, class... Bits>
FULCRUM_INLINE_IN_LOOP uint8_t VisitBits(Stream& s, Bits... bits) {
    uint8_t all = 0;
    if constexpr (Stream::kWrites) {
        int place = 0;
        ((all = static_cast<uint8_t>(all | unsigned{bits} << place++)), ...);
    }
    s(all);
    return all;
}

template <class Stream, class Spring>
void VisitSpring(Stream& s, Spring& spring) {
    auto& [mode, frequency, dampingRatio, stiffness, damping, form] = spring;
    s(mode, frequency, dampingRatio, stiffness, damping, form);
}

template <class Stream, class Control>
void VisitControl(Stream& s, Control& control) {
    auto& [limited, limits, motor, friction] = control;
    auto& [min, max, limitSpring] = limits;
    auto& [mode, targetSpeed, targetPosition, motorSpring, minForce, maxForce] = motor;
    s(limited, min, max, mode, targetSpeed, targetPosition, minForce, maxForce, friction);
    VisitSpring(s, limitSpring);
    VisitSpring(s, motorSpring);
}

template <class Stream, class Settings>
void VisitSystemSettings(Stream& s, Settings& settings) {
    auto& [gravity, solver, accuracy, sleep, events, measuresErrors, narrowPhase, speculativeDistance, penetrationSlop,
           contactFrequency, contactDampingRatio, contactPushSpeed, depenetrationSpeed, exactJointLoad, jointPushSpeed,
           restitutionSpeed, boundsMargin, layerCollides] = settings;
    auto& [substeps, velocityIterations, positionIterations, positionCorrection, baumgarte, baumgarteSlop] = solver;
    auto& [penetration, jointError] = accuracy;
    auto& [sleepEnabled, sleepSeconds, sleepSpeed] = sleep;
    auto& [reportsContacts, reportsStays, reportsBodies] = events;
    s(gravity, substeps, velocityIterations, positionIterations, positionCorrection, baumgarte, baumgarteSlop);
    s(penetration, jointError, sleepEnabled, sleepSeconds, sleepSpeed, narrowPhase);
    s(speculativeDistance, penetrationSlop, contactFrequency, contactDampingRatio, contactPushSpeed);
    s(depenetrationSpeed, exactJointLoad, jointPushSpeed, restitutionSpeed);
    s(boundsMargin, layerCollides, reportsContacts, reportsStays, reportsBodies, measuresErrors);
}

template <class Stream, class Override>
FULCRUM_INLINE_IN_LOOP void VisitMassOverride(Stream& s, Override& massOverride) {
    auto& [massA, inertiaA, massB, inertiaB] = massOverride;
    s(massA, inertiaA, massB, inertiaB);
}

template <class Stream, class Effort>
void VisitEffort(Stream& s, Effort& effort) {
    auto& [substeps, velocityIterations, positionIterations] = effort;
    s(substeps, velocityIterations, positionIterations);
}

// ---- Bodies

// Upper bound of the bytes of a body's element, filter and children included.
inline constexpr size_t kMostOfBody = 512;

// Except the group's filter.
template <class Stream, class Filter>
FULCRUM_INLINE_IN_LOOP void VisitFilter(Stream& s, Filter& filter) {
    auto& [category, mask, group] = filter;
    s(category, mask, group.group, group.subGroup);
    if constexpr (!Stream::kWrites) group.filter = nullptr;
}

// Except the compound.
template <class Stream, class Children>
FULCRUM_INLINE_IN_LOOP void VisitChildren(Stream& s, Children& children) {
    auto& [compound, origin, massUnit, moreColliders] = children;
    s(origin, massUnit, moreColliders);
}

// Members that few bodies use. isOdd: whether this one uses any.
template <class Stream, class Cold>
FULCRUM_INLINE_IN_LOOP void VisitOddities(Stream& s, Cold& body, bool isOdd) {
    if constexpr (!Stream::kWrites) {
        body.singleMove = SingleMove::None;
        body.directMisses = 0;
        body.lastPush = {};
        body.gravity = Vector3::Zero();
        body.isSteady = body.isWorld = body.hasGravity = body.wasDirect = false;
        if (!isOdd) body.keptMass = nullptr;
    }
    if (!isOdd) return;
    const uint8_t bits =
        VisitBits(s, body.isSteady, body.hasGravity, body.keptMass != nullptr, body.isWorld, body.wasDirect);
    if constexpr (!Stream::kWrites) {
        body.isSteady = bits & 1;
        body.hasGravity = bits >> 1 & 1;
        body.isWorld = bits >> 3 & 1;
        body.wasDirect = bits >> 4 & 1;
        if (!(bits >> 2 & 1)) body.keptMass = nullptr;
        else if (!body.keptMass) body.keptMass = std::make_unique<KeptMass>();
    }
    s(body.singleMove, body.directMisses, body.lastPush.force, body.lastPush.torque);
    if (body.hasGravity) s(body.gravity);
    if (!body.keptMass) return;
    auto& [mass, inertia, principalAxes] = *body.keptMass;
    s(mass, inertia, principalAxes);
}

// Of an index without a body only the generation matters. A body that was removed has its colliders until the next
// step.
template <class Stream, class Cold>
FULCRUM_INLINE_IN_LOOP bool VisitCold(Stream& s, Cold& body) {
    auto& [shape, userData, material, force, torque, penetrationTarget, filter, firstCollider, colliderCount, children,
           generation, awakePlace, sleepingIsland, continuous, singleMove, directMisses, wasDirect, keptMass, lastPush,
           gravity, placed, isSteady, exists, removed, isSensor, isWorld, hasGravity] = body;
    s(generation);
    // Members that few bodies use.
    bool isOdd = false;
    if constexpr (Stream::kWrites)
        isOdd = singleMove != SingleMove::None || directMisses > 0 || wasDirect || keptMass || !lastPush.IsZero() ||
                isSteady || isWorld || hasGravity;
    const uint8_t bits = VisitBits(s, exists, placed, removed, isSensor, filter != nullptr, children != nullptr, isOdd);
    if constexpr (!Stream::kWrites) {
        exists = bits & 1;
        placed = bits >> 1 & 1;
        removed = bits >> 2 & 1;
        isSensor = bits >> 3 & 1;
        if (!(bits >> 4 & 1)) filter = nullptr;
        else if (!filter) filter = std::make_unique<BodyFilter>();
        if (!(bits >> 5 & 1)) children = nullptr;
        else if (!children) children = std::make_unique<BodyChildren>();
        isOdd = bits >> 6 & 1;
        if (!exists && !removed) {
            const uint32_t itsGeneration = generation;
            body = {};
            generation = itsGeneration;
        }
    }
    if (!exists && !removed) return false;
    auto& [friction, restitution, frictionRule, restitutionRule] = material;
    s(friction, restitution, frictionRule, restitutionRule, penetrationTarget, firstCollider, colliderCount,
      sleepingIsland, continuous);
    if (filter) VisitFilter(s, *filter);
    if (children) VisitChildren(s, *children);
    VisitOddities(s, body, isOdd);
    return true;
}

// userData is a section of its own; the other members are derived.
template <class Stream, class Bodies>
FULCRUM_INLINE_IN_LOOP void VisitBody(Stream& s, Bodies& bodies, uint32_t i) {
    auto& state = bodies.states[i];
    auto& mass = bodies.masses[i];
    auto& pose = bodies.poses[i];
    auto& dynamics = bodies.dynamics[i];
    auto& cold = bodies.cold[i];
    auto& remainder = bodies.remainders[i];
    if constexpr (!Stream::kWrites) state = {};
    if (!VisitCold(s, cold)) {
        if constexpr (!Stream::kWrites) mass = {}, pose = {}, dynamics = {};
        return;
    }
    // Displacements are zero between steps.
    auto& [linear, angular, stateSpare, marks, deltaPosition, deltaRotation, halfTurn] = state;
    auto& [inverseInertia, inverseMass, flags] = mass;
    auto& [rotation, acceleration, boundsChangedIn, position, innerRadius, spare] = pose;
    s(linear, angular, marks, inverseInertia, inverseMass, flags, rotation, acceleration, boundsChangedIn, position,
      innerRadius, dynamics, remainder.value, remainder.isGiven);
    if (dynamics.hasForce) s(cold.force, cold.torque);
    else if constexpr (!Stream::kWrites) cold.force = cold.torque = Vector3::Zero();
    auto& [lately, before] = bodies.slowMotions[i];
    if (dynamics.awake && dynamics.slowSeconds > 0) s(lately.linear, lately.angular, before.linear, before.angular);
    else if constexpr (!Stream::kWrites) lately = before = {};
}

// ---- Colliders

inline constexpr size_t kMostOfCollider = 64;

// For an empty collider only its membership in a list matters. The child shape is derived from the body's shape.
template <class Stream, class Collider>
FULCRUM_INLINE_IN_LOOP void VisitCollider(Stream& s, Collider& collider, bool isEmpty) {
    auto& [fat, previous, body, moving, queued, sensor] = collider;
    const auto isSame = [](const Bounds& a, const Bounds& b) { return std::memcmp(&a, &b, sizeof a) == 0; };
    bool isFat = false, isNone = false;
    if constexpr (Stream::kWrites) {
        isFat = !isEmpty && isSame(previous, fat);
        isNone = !isEmpty && !isFat && isSame(previous, Bounds{});
    }
    const uint8_t bits = VisitBits(s, isEmpty, moving && !isEmpty, queued, sensor && !isEmpty, isFat, isNone);
    if constexpr (!Stream::kWrites) {
        const uint32_t itsBody = body;  // AttachPieces compares it
        collider = {};
        body = itsBody;
        isEmpty = bits & 1;
        queued = bits >> 2 & 1;
        if (isEmpty) return;
        moving = bits >> 1 & 1;
        sensor = bits >> 3 & 1;
        isFat = bits >> 4 & 1;
        isNone = bits >> 5 & 1;
    }
    if (isEmpty) return;
    s(fat);
    if (!isFat && !isNone) s(previous);
    else if constexpr (!Stream::kWrites) previous = isFat ? fat : Bounds{};
}

// ---- Pairs

inline constexpr size_t kMostOfPair = 512;

// Except bodies, which are derived from the colliders, and the contact; hasContact: whether there is one.
// more: of surfaces, see PairContact. Returns false if there is no pair.
template <class Stream, class Pair>
FULCRUM_INLINE_IN_LOOP bool VisitPair(Stream& s, Pair& pair, bool& isActive, bool& hasContact, uint32_t& more) {
    auto& [bodyA, bodyB, colliderA, colliderB, cache, contact, pointCount, exists, fixedB, offset, surface, touching,
           onSeam, kept, isMore, material] = pair;
    auto& [kind, indexA, indexB, axis] = cache;
    const uint8_t bits = VisitBits(s, exists, fixedB, offset, surface, touching, onSeam, isMore, isActive);
    if constexpr (!Stream::kWrites) {
        exists = bits & 1;
        fixedB = bits >> 1 & 1;
        offset = bits >> 2 & 1;
        surface = bits >> 3 & 1;
        touching = bits >> 4 & 1;
        onSeam = bits >> 5 & 1;
        kept = false;
        isMore = bits >> 6 & 1;
        isActive = bits >> 7 & 1;
        material = 0;
        more = contact = ~0u;
    }
    if (!exists) return false;
    s(colliderA, colliderB, pointCount, hasContact, kind);
    if (kind != PairCache::Kind::None) s(indexA, indexB, axis);
    else if constexpr (!Stream::kWrites) cache = {};
    if (surface) s(material, more);
    return true;
}

// Except the indices of pairs; for a pair with this many points.
template <class Stream, class Contact>
FULCRUM_INLINE_IN_LOOP void VisitContact(Stream& s, Contact& contact, uint32_t points) {
    auto& [reference, features, color, triangle, pair, more] = contact;
    s(reference, triangle, color.color);
    if (color.color != ColorSlot{}.color) s(color.slot);
    for (uint32_t i = 0; i < std::min<uint32_t>(points, Manifold::kMaxPoints); ++i) s(features[i]);
}

// For a pair with this many points.
template <class Stream, class Record>
FULCRUM_INLINE_IN_LOOP void VisitRecord(Stream& s, Record& record, uint32_t points) {
    auto& [normal, pointCount, friction, restitution, twistRadius, marks, impulse, frictionImpulse, twistImpulse, all] =
        record;
    s(friction, restitution, marks);
    if (points == 0) return;
    s(normal, pointCount, twistRadius, impulse, frictionImpulse, twistImpulse);
    for (uint32_t i = 0; i < std::min<uint32_t>(points, ContactRecord::kMaxPoints); ++i) s(all[i]);
}

template <class Stream, class Velocity>
FULCRUM_INLINE_IN_LOOP void VisitSurfaceVelocity(Stream& s, Velocity& velocity) {
    auto& [linear, angular] = velocity;
    s(linear, angular);
}

// ---- Joints

inline constexpr size_t kMostOfJoint = 1024 + 2 * sizeof(float) * JointRowList::kMaxRows;

template <class Stream, class Record>
void VisitJointRecord(Stream& s, Record& record) {
    auto& [anchorA, anchorB, lineAxis, freeAxis, frameA, frameB, ownImpulse, ownAngularImpulse, ownSpare, lockForce,
           lockTorque, lockSpare, totalForce, totalTorque, totalSpare] = record;
    if constexpr (!Stream::kWrites) record = {};
    s(anchorA, anchorB, lineAxis, freeAxis, frameA, frameB, ownImpulse, ownAngularImpulse);
    s(lockForce, lockTorque, totalForce, totalTorque);
}

// Except the type. Returns false if there is no joint.
template <class Stream, class Joint>
bool VisitJoint(Stream& s, Joint& joint, bool& isBreakable) {
    auto& [body, next, type, locks, maxRows, neighbors, color, generation, exists, enabled, collideConnected,
           overridesMass, fixed, isStrained, wasPastLimit, isBeyondTarget, stepsBeyond, priority, breakForce,
           breakTorque, effort, errorTarget, massOverride, userData] = joint;
    s(generation, exists);
    if (!exists) return false;
    auto& [linear, angular, line, axis] = locks;
    s(body, next, linear, angular, line, axis, maxRows, color.color);
    if constexpr (!Stream::kWrites) color.slot = 0;
    if (color.color != ColorSlot{}.color) s(color.slot);
    s(isBreakable, enabled, collideConnected, overridesMass, fixed, priority, breakForce, breakTorque, errorTarget);
    VisitEffort(s, effort);
    if (overridesMass) VisitMassOverride(s, massOverride);
    else if constexpr (!Stream::kWrites) massOverride = {};
    s(isStrained, wasPastLimit, isBeyondTarget, stepsBeyond);
    return true;
}

// State and controls of a joint type. Its settings are a section of their own. Returns false if the type's state has
// another size than the data.
template <class Stream>
bool VisitType(Stream& s, JointType& type) {
    s(type.impulses, type.forces, type.turnedA, type.turnedB);
    const std::span<double> state = type.State();
    uint32_t count = static_cast<uint32_t>(state.size());
    s(count);
    if (count != state.size()) return false;
    s.Reserve(count * sizeof(double) + kMostOfJoint);
    for (double& number : state) s(number);
    for (int axis = 0; axis < 6; ++axis) {
        AxisControl* control = type.Control(static_cast<JointAxis>(axis));
        bool is = control != nullptr;
        s(is);
        if (is != (control != nullptr)) return false;
        if (control) VisitControl(s, *control);
    }
    return true;
}

// ---- What is listed

template <class Stream, class Body>
void VisitDispersing(Stream& s, Body& dispersing) {
    auto& [body, direction, hasPlace, place, secondsLeft, startStep, push, ownVelocity] = dispersing;
    s(body, direction, hasPlace, place, secondsLeft, startStep, push, ownVelocity);
}

template <class Stream, class Event>
void VisitEvent(Stream& s, Event& event) {
    auto& [sensor, body, kind, time] = event;
    s(sensor, body, kind, time);
}

// ---- Events: what the next ones follow from

// Except temporaries of one step.
template <class Stream, class Contact>
FULCRUM_INLINE_IN_LOOP void VisitReported(Stream& s, Contact& contact) {
    auto& [bodyA, bodyB, childA, childB, isOn, kind, manifoldCount] = contact;
    if constexpr (!Stream::kWrites) contact = {};
    s(isOn);
    if (isOn) s(bodyA, bodyB, childA, childB);
}

template <class Stream, class Body>
void VisitReportedBody(Stream& s, Body& body) {
    auto& [position, rotation, generation, isAwake] = body;
    s(position, rotation, generation, isAwake);
}

template <class Stream, class Broken>
void VisitBroken(Stream& s, Broken& joint) {
    auto& [id, force, torque] = joint;
    s(id, force, torque);
}

template <class Stream, class Group>
void VisitSavedEffort(Stream& s, Group& group) {
    auto& [body, culprit, effort, isLoaded, isWaiting] = group;
    s(body, culprit, isLoaded, isWaiting);
    VisitEffort(s, effort);
}

// Visits the elements of a list one by one, each of at most `most` bytes.
template <class Stream, class List, class Visit>
void VisitList(Stream& s, List& list, size_t most, Visit&& visit) {
    uint32_t count = static_cast<uint32_t>(list.size());
    s.Reserve(sizeof count + list.size() * most);
    s(count);
    // An element has a byte or more: a damaged count must not ask for more memory than there is data.
    if constexpr (!Stream::kWrites) list.resize(s.HasFailed() || count > s.Left().size() ? 0 : count);
    for (auto& element : list) visit(element);
}

}  // namespace fulcrum
