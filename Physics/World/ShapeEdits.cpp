#include <Fulcrum/Physics/World/ShapeEdits.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Lifts.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/ReserveMore.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

const HeightField& FieldOf(const BodyStore& bodies, uint32_t body) {
    return static_cast<const HeightField&>(*bodies.cold[body].shape);
}

// A box of a shape's frame at a pose relative to the origin of bounds, with the margin that its fat bounds have.
Bounds FatBoundsOf(const Bounds& box, const SystemSettings& settings, const Shape& shape, const Pose& pose) {
    const Matrix3 rotation = ToMatrix(pose.rotation);
    const Vector3 center = rotation * box.Center(), half = box.HalfExtents();
    const Vector3 reach =
        rotation.x.cwiseAbs() * half.x() + rotation.y.cwiseAbs() * half.y() + rotation.z.cwiseAbs() * half.z();
    const Bounds tight = RoundedOutwards(pose.position + Vector3(center - reach).cast<double>(),
                                         pose.position + Vector3(center + reach).cast<double>());
    return BoundsAlong(tight, Vector3::Zero(),
                       0.5f * SpeculativeDistance(settings, shape) + BoundsMargin(settings, shape));
}

// Pairs are searched for anew if the bounds are others than before.
void UpdateBoundsOf(WorldState& world, uint32_t body, uint32_t index) {
    Collider& collider = world.colliders.colliders[index];
    const Bounds before = collider.fat;
    SetFatBounds(world.settings, world.bodies, world.colliders, index);
    if (before.Contains(collider.fat) && collider.fat.Contains(before)) return;
    world.colliders.TreeOf(collider).Update(index, collider.fat);
    collider.previous = {};
    world.colliders.Queue(index);
    if (world.pairs.HasAny(index)) world.bodies.poses[body].boundsChangedIn = static_cast<uint32_t>(world.step + 1);
}

// The manifolds with what is near the changed part are computed anew, however little it moved.
void ForgetManifoldsInside(WorldState& world, uint32_t collider, const Bounds& changed) {
    world.pairs.VisitOf(collider, [&](uint32_t index) {
        const Pair& pair = world.pairs.pairs[index];
        const uint32_t other = pair.colliderA == collider ? pair.colliderB : pair.colliderA;
        if (pair.contact == PairStore::kNone || !world.colliders.colliders[other].fat.Overlaps(changed)) return;
        world.pairs.contacts[pair.contact].reference.position =
            Vector3::Constant(std::numeric_limits<float>::infinity());
    });
}

void UpdateEdited(WorldState& world, uint32_t body) {
    world.bodies.SetRadii(body, FieldOf(world.bodies, body));
    if (!world.sensors.IsEmpty()) world.sensors.changed.push_back(body);
    VisitColliders(world, body, [&](uint32_t index) {
        UpdateBoundsOf(world, body, index);
        world.outsideFatBounds.Forget(index);
    });
}

void HeedEdit(WorldState& world, uint32_t body, const HeightField::EditedPart& edit) {
    VisitColliders(world, body, [&](uint32_t index) {
        Pose pose = ColliderPoseOf(world.bodies, world.colliders, index);
        pose.position -= world.colliders.boundsOrigin;
        const Bounds changed = FatBoundsOf(edit.changed, world.settings, FieldOf(world.bodies, body), pose);
        ForgetManifoldsInside(world, index, changed);
        if (world.colliders.colliders[index].sensor) return;
        WakeInside(world, changed);
        for (const uint32_t inside : world.sleeping.inside)
            if (world.bodies.dynamics[inside].motion == MotionType::Dynamic) world.bodies.MarkPlaced(inside);
        LiftByEdit(world, index, edit.version, world.sleeping.inside);
    });
}

template <class Visit>
void VisitEdited(WorldState& world, uint64_t since, Visit&& visit) {
    world.bodies.editable.Visit([&](uint32_t body) {
        if (world.bodies.cold[body].exists && FieldOf(world.bodies, body).Version() > since) visit(body);
    });
}

}  // namespace

bool AreShapesEditedSince(const BodyStore& bodies, uint64_t version) {
    bool areEdited = false;
    bodies.editable.Visit(
        [&](uint32_t body) { areEdited |= bodies.cold[body].exists && FieldOf(bodies, body).Version() > version; });
    return areEdited;
}

void HeedShapeEditsUntil(WorldState& world, uint64_t latest) {
    // Before anything is changed: the call that heeds the edits may not take place.
    ReserveForChange(world, {.placed = world.bodies.Count()});
    if (!world.sensors.IsEmpty()) ReserveMore(world.sensors.changed, world.bodies.editable.Size());
    ReserveLifts(world);
    const uint64_t since = world.heededShapeVersion;
    VisitEdited(world, since, [&](uint32_t body) { UpdateEdited(world, body); });
    // Each edit as if it had been heeded at once, in the order in which they were made, whichever fields they are of.
    for (uint64_t heeded = since, next = 0; heeded < latest; heeded = next) {
        next = latest;
        VisitEdited(world, heeded, [&](uint32_t body) {
            next = std::min(next, FieldOf(world.bodies, body).NextEdit(heeded).version);
        });
        VisitEdited(world, heeded, [&](uint32_t body) {
            const HeightField::EditedPart edit = FieldOf(world.bodies, body).NextEdit(heeded);
            if (edit.version == next) HeedEdit(world, body, edit);
        });
        world.heededShapeVersion = next;
    }
}

}  // namespace fulcrum
