#include <Fulcrum/Physics/World/BodyStore.h>

#include <Fulcrum/Math/Assert.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/ReserveMore.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

uint32_t BodyStore::Allocate() {
    uint32_t index;
    if (!free_.empty()) {
        index = free_.back();
        free_.pop_back();
    } else {
        index = Size();
        states.emplace_back();
        masses.emplace_back();
        poses.emplace_back();
        unconstrained.emplace_back();
        dynamics.emplace_back();
        cold.emplace_back();
        remainders.emplace_back();
        slowMotions.emplace_back();
        for (IndexSet* set : {&reportsContacts, &pushed, &singleMoves, &editable}) set->Reserve(index + 1);
    }
    cold[index].exists = true;
    if (notesSleepChanges) sleepChanges.push_back(index);
    ++count_;
    return index;
}

void BodyStore::Reserve(size_t more, size_t placedMore) {
    const size_t grown = more - std::min(more, free_.size());
    ReserveMore(states, grown);
    ReserveMore(masses, grown);
    ReserveMore(poses, grown);
    ReserveMore(unconstrained, grown);
    ReserveMore(dynamics, grown);
    ReserveMore(cold, grown);
    ReserveMore(remainders, grown);
    ReserveMore(slowMotions, grown);
    const size_t size = Size() + grown;
    for (IndexSet* set : {&reportsContacts, &pushed, &singleMoves, &editable})
        set->ReserveRoom(static_cast<uint32_t>(size));
    ReserveRoom(awake, size);
    ReserveMore(placed, placedAsleep_ + placedMore);
    // Two for a new body that is awake, and for one that falls asleep again.
    if (notesSleepChanges) ReserveMore(sleepChanges, size - awake.size() + more + 2);
}

void BodyStore::Free(uint32_t index) {
    FULCRUM_ASSERT(!dynamics[index].awake);
    const uint32_t generation = cold[index].generation + 1;
    const bool isPlacedAsleep = cold[index].placed && !dynamics[index].awake;
    states[index] = {};
    masses[index] = {};
    poses[index] = {};
    dynamics[index] = {};
    slowMotions[index] = {};
    cold[index] = {};
    cold[index].generation = generation;
    placedAsleep_ -= isPlacedAsleep;
    for (IndexSet* set : {&reportsContacts, &pushed, &singleMoves, &editable}) set->Erase(index);
    // After the last generation the index is not used again, so that no id becomes valid again.
    if (generation != 0) free_.push_back(index);
    --count_;
}

void BodyStore::MarkAwake(uint32_t index) {
    if (dynamics[index].awake) return;
    dynamics[index].awake = true;
    if (notesSleepChanges) sleepChanges.push_back(index);
    dynamics[index].slowSeconds = 0;
    cold[index].directMisses = 0;
    cold[index].wasDirect = false;
    if (cold[index].placed) {
        placed.push_back(index);
        --placedAsleep_;
    }
    cold[index].awakePlace = static_cast<uint32_t>(awake.size());
    awake.push_back(index);
}

void BodyStore::MarkPlaced(uint32_t index) {
    if (cold[index].placed) return;
    cold[index].placed = true;
    placedAsleep_ += !dynamics[index].awake;
    // One that sleeps is listed as it wakes; until then the list need only say that there is one.
    if (dynamics[index].motion != MotionType::Dynamic || dynamics[index].awake || placed.empty())
        placed.push_back(index);
}

void BodyStore::ForgetPlaced() {
    for (const uint32_t body : placed) {
        if (dynamics[body].awake) cold[body].placed = false;
        else if (dynamics[body].motion != MotionType::Dynamic) UnmarkPlaced(body);
    }
    placed.clear();
    constexpr size_t kMostKept = 64;  // capacity: levels are created once
    // Room for those that sleep is asked for by every change of the world.
    if (placed.capacity() > std::max(kMostKept, 2 * size_t{placedAsleep_ + 2})) placed = {};
}

void BodyStore::UnmarkPlaced(uint32_t index) {
    if (!cold[index].placed) return;
    cold[index].placed = false;
    placedAsleep_ -= !dynamics[index].awake;
}

void BodyStore::CountPlacedAsleep() {
    placedAsleep_ = 0;
    for (uint32_t i = 0; i < Size(); ++i) placedAsleep_ += cold[i].placed && !dynamics[i].awake;
}

void BodyStore::MarkAsleep(uint32_t index) {
    if (!dynamics[index].awake) return;
    dynamics[index].awake = false;
    placedAsleep_ += cold[index].placed;
    if (notesSleepChanges) sleepChanges.push_back(index);
    const uint32_t place = cold[index].awakePlace;
    awake[place] = awake.back();
    cold[awake[place]].awakePlace = place;
    awake.pop_back();
}

namespace {

void Write(BodyPose& to, const Position& position, const Quaternion& q) {
    to.rotation[0] = q.x;
    to.rotation[1] = q.y;
    to.rotation[2] = q.z;
    to.rotation[3] = q.w;
    for (int k = 0; k < 3; ++k) to.position[k] = position[k];
}

}  // namespace

void BodyStore::SetCenterPose(uint32_t index, const Pose& pose) {
    const Position onGrid = OnGrid(pose.position);
    remainders[index] = {pose.position - onGrid, true};
    Write(poses[index], onGrid, pose.rotation);
}

void BodyStore::MoveCenter(uint32_t index, const Vector3& displacement, const Quaternion& rotation) {
    Position rest = displacement.cast<double>();
    if (!remainders[index].isGiven) rest += remainders[index].value;
    const Position step = OnGrid(rest);
    remainders[index] = {rest - step, false};
    Write(poses[index], CenterOf(index) + step, rotation);
}

SymmetricMatrix3 InverseOfFreeAxes(const BodyDynamics& d, const Matrix3& axes) {
    Vector3 principal;
    for (int k = 0; k < 3; ++k) principal[k] = d.inverseInertia[k] > 0 ? 1.0f / d.inverseInertia[k] : 0.0f;
    const SymmetricMatrix3 w = RotatedDiagonal(axes, principal);
    const unsigned locked = d.LockedRotations();
    const bool x = !(locked & 1), y = !(locked & 2), z = !(locked & 4);
    SymmetricMatrix3 i;
    const auto pair = [](float a, float b, float c, float& ia, float& ib, float& ic) {
        const float determinant = a * b - c * c;
        // Products of extreme moments may overflow a float although their inverses fit.
        const double exact = std::isnormal(determinant) ? double{determinant} : double{a} * b - double{c} * c;
        ia = static_cast<float>(b / exact);
        ib = static_cast<float>(a / exact);
        ic = static_cast<float>(-c / exact);
    };
    if (!(d.inverseMass > 0)) return i;
    if (x && y && !z) pair(w.xx, w.yy, w.xy, i.xx, i.yy, i.xy);
    else if (x && z && !y) pair(w.xx, w.zz, w.xz, i.xx, i.zz, i.xz);
    else if (y && z && !x) pair(w.yy, w.zz, w.yz, i.yy, i.zz, i.yz);
    else if (x) i.xx = 1.0f / w.xx;
    else if (y) i.yy = 1.0f / w.yy;
    else if (z) i.zz = 1.0f / w.zz;
    return i;
}

BodyMass BodyStore::MassAlong(uint32_t index, const Matrix3& axes) const {
    const BodyDynamics& d = dynamics[index];
    BodyMass m;
    if (d.frozen) return m;
    m.inverseMass = d.inverseMass;
    const bool turns = (d.HasGyroscopicTorque() || d.RotatesAboutTwoAxes()) && d.motion == MotionType::Dynamic;
    m.flags = static_cast<float>(d.LockedTranslations() * BodyMass::kLockedX + (turns ? BodyMass::kTurns : 0));
    const Vector3 inverse(d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]);
    SymmetricMatrix3 i;
    if (d.spherical) i.xx = i.yy = i.zz = inverse.x();
    else i = RotatedDiagonal(axes, inverse);
    if (d.LocksRotation()) i = InverseOfFreeAxes(d, axes);
    m.inverseInertia[0] = i.xx;
    m.inverseInertia[1] = i.yy;
    m.inverseInertia[2] = i.zz;
    m.inverseInertia[3] = i.xy;
    m.inverseInertia[4] = i.xz;
    m.inverseInertia[5] = i.yz;
    return m;
}

void SetMass(BodyDynamics& d, const Quaternion& q, float mass, const Vector3& inertia) {
    const float axes[4] = {q.x, q.y, q.z, q.w};
    for (int k = 0; k < 4; ++k) d.principalAxes[k] = axes[k];
    d.inverseMass = 1.0f / mass;
    for (int k = 0; k < 3; ++k) d.inverseInertia[k] = 1.0f / inertia[k];
    const float spread = inertia.maxCoeff() - inertia.minCoeff();
    d.spherical = spread <= 1e-5f * inertia.maxCoeff();
}

Vector3 AngularMomentum(const BodyDynamics& d, const Quaternion& rotation, const Vector3& w) {
    const Quaternion axes = rotation * d.PrincipalAxes();
    Vector3 local = InverseRotate(axes, w);
    for (int k = 0; k < 3; ++k) local[k] = d.inverseInertia[k] > 0 ? local[k] / d.inverseInertia[k] : 0.0f;
    constexpr float kMost = 1e38f;  // so that their sum does not overflow
    return Rotate(axes, Vector3(local.cwiseMax(-kMost).cwiseMin(kMost)));
}

double RotationalEnergy(const BodyDynamics& d, const Quaternion& rotation, const Vector3& w) {
    return 0.5 * TwiceRotationalEnergy<double>(d, InverseRotate(rotation * d.PrincipalAxes(), w));
}

size_t HeapBytes(const BodyCold& body) {
    return (body.filter ? sizeof(BodyFilter) : 0) + (body.children ? sizeof(BodyChildren) : 0) +
           (body.keptMass ? sizeof(KeptMass) : 0);
}

size_t HeapBytes(const BodyStore& store) {
    const auto& [states, masses, poses, unconstrained, dynamics, cold, remainders, slowMotions, placed, awake,
                 worldBody, continuousCount, targetCount, reportsContacts, pushed, singleMoves, editable, sleepChanges,
                 notesSleepChanges, free, count, placedAsleep] = store;
    return HeapBytes(states, masses, poses, unconstrained, dynamics, cold, remainders, slowMotions, placed, awake,
                     worldBody, continuousCount, targetCount, reportsContacts, pushed, singleMoves, editable,
                     sleepChanges, notesSleepChanges, free, count, placedAsleep);
}

}  // namespace fulcrum
