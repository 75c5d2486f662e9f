#include <Fulcrum/Physics/World/BodyColliders.h>

#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/ShapeEdits.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>

namespace fulcrum {

namespace {

const CompoundShape* AsCompound(const Shape& shape) {
    return shape.IsCompound() ? static_cast<const CompoundShape*>(&shape) : nullptr;
}

// The collider of a child of a mutable compound; allocates a further run if needed.
uint32_t ColliderOf(WorldState& world, uint32_t body, uint32_t child) {
    ColliderStore& store = world.colliders;
    BodyCold& cold = world.bodies.cold[body];
    ColliderRun at{cold.firstCollider, cold.colliderCount, cold.MoreColliders()};
    uint32_t before = 0, last = ColliderStore::kNone;
    while (child - before >= at.count) {
        before += at.count;
        uint32_t next = at.next;
        if (next == ColliderStore::kNone) {
            next = store.AddRun(ColliderStore::LengthOfNextRun(before));
            (last == ColliderStore::kNone ? cold.children->moreColliders : store.runs[last].next) = next;
        }
        last = next;
        at = store.runs[next];
    }
    return at.first + (child - before);
}

void Insert(WorldState& world, uint32_t body, uint32_t index) {
    Collider& collider = world.colliders.colliders[index];
    collider.body = body;
    collider.moving = world.bodies.dynamics[body].motion != MotionType::Static;
    collider.sensor = world.bodies.cold[body].isSensor;
    SetFatBounds(world.settings, world.bodies, world.colliders, index);
    world.colliders.TreeOf(collider).Insert(index, collider.fat);
    world.pendingTrees.Note();
}

// A sensor supports no bodies.
void WakeNear(WorldState& world, uint32_t index) {
    if (!world.colliders.colliders[index].sensor) WakeInside(world, world.colliders.colliders[index].fat);
}

void Erase(WorldState& world, uint32_t index) {
    world.colliders.TreeOf(world.colliders.colliders[index]).Remove(index);
    world.outsideFatBounds.Forget(index);
}

void RemovePairsOf(WorldState& world, uint32_t collider) {
    world.pairs.VisitOf(collider, [&](uint32_t pair) { RemovePair(world.pairs, world.coloring, pair); });
}

// Invalidates the manifolds of the collider's pairs, so that they are recomputed however little bodies moved; impulses
// are kept.
void ForgetManifoldsOf(WorldState& world, uint32_t collider) {
    world.pairs.VisitOf(collider, [&](uint32_t pair) {
        const uint32_t contact = world.pairs.pairs[pair].contact;
        if (contact != PairStore::kNone)
            world.pairs.contacts[contact].reference.position =
                Vector3::Constant(std::numeric_limits<float>::infinity());
    });
}

void ShiftContacts(WorldState& world, uint32_t body, const Vector3& by) {
    VisitColliders(world, body, [&](uint32_t collider) {
        world.pairs.VisitOf(collider, [&](uint32_t first) {
            for (uint32_t index = first; index != PairStore::kNone; index = world.pairs.MoreOf(index)) {
                const Pair& pair = world.pairs.pairs[index];
                if (pair.contact == PairStore::kNone) continue;
                const bool isA = pair.bodyA == body;
                for (ContactRecord::Point& point : world.pairs.RecordOf(pair).points)
                    for (int k = 0; k < 3; ++k) (isA ? point.onA : point.onB)[k] -= by[k];
            }
        });
    });
}

}  // namespace

ColliderShape PieceOfChild(const CompoundShape& compound, const CompoundShape::Child& child) {
    return {.shape = child.shape.get(),
            .offset = true,
            .onOrigin = compound.Type() == ShapeType::MutableCompound,
            .local = child.pose};
}

OwnShape::OwnShape(const ShapePtr& given) : shape(given) {
    if (shape->Type() != ShapeType::MutableCompound) return;
    const std::shared_ptr<MutableCompound> own = static_cast<const MutableCompound&>(*given).Copy();
    shape = own;
    children = std::make_unique<BodyChildren>(BodyChildren{.compound = own.get(), .origin = own->Origin()});
}

void SetShapeOf(WorldState& world, uint32_t body, OwnShape&& own) {
    BodyCold& cold = world.bodies.cold[body];
    if (IsEditable(*own.shape)) world.bodies.editable.Insert(body);
    else world.bodies.editable.Erase(body);
    cold.shape = std::move(own.shape);
    cold.children = std::move(own.children);
}

const ShapePtr& ShapeOfWorldBody() {
    static const ShapePtr kEmpty = EmptyShape::Create();
    return kEmpty;
}

uint32_t ColliderCountOf(const Shape& shape) {
    if (const CompoundShape* compound = AsCompound(shape)) return static_cast<uint32_t>(compound->Children().size());
    return shape.Type() == ShapeType::Empty ? 0 : 1;
}

void MakeColliders(WorldState& world, uint32_t body) {
    ColliderStore& store = world.colliders;
    BodyCold& cold = world.bodies.cold[body];
    const Shape& shape = *cold.shape;
    const CompoundShape* compound = AsCompound(shape);
    cold.colliderCount = ColliderCountOf(shape);
    cold.firstCollider = store.Allocate(cold.colliderCount);
    const bool moving = world.bodies.dynamics[body].motion != MotionType::Static;
    if (!cold.isSensor) (moving ? store.movingLayers : store.staticLayers) |= 1u << world.bodies.dynamics[body].layer;
    for (uint32_t i = 0; i < cold.colliderCount; ++i) {
        const uint32_t index = cold.firstCollider + i;
        if (compound) store.shapes[index] = PieceOfChild(*compound, compound->ChildAt(i));
        else store.shapes[index].shape = &shape;
        if (store.shapes[index].shape) Insert(world, body, index);
    }
}

void DropColliders(WorldState& world, uint32_t body) {
    VisitColliders(world, body, [&](uint32_t index) {
        Erase(world, index);
        RemovePairsOf(world, index);
    });
    ColliderStore& store = world.colliders;
    std::erase_if(store.moved, [&](uint32_t index) { return store.colliders[index].body == body; });
    BodyCold& cold = world.bodies.cold[body];
    store.Free(cold.firstCollider, cold.colliderCount);
    store.FreeRuns(cold.MoreColliders());
    cold.firstCollider = cold.colliderCount = 0;
    if (cold.children) cold.children->moreColliders = ColliderStore::kNone;
}

uint32_t ColliderRoomOf(const WorldState& world, uint32_t body) {
    uint32_t room = world.bodies.cold[body].colliderCount;
    for (uint32_t run = world.bodies.cold[body].MoreColliders(); run != ColliderStore::kNone;
         run = world.colliders.runs[run].next)
        room += world.colliders.runs[run].count;
    return room;
}

void UpdateChildCollider(WorldState& world, uint32_t body, uint32_t child) {
    const BodyCold& cold = world.bodies.cold[body];
    const CompoundShape::Child& is = cold.children->compound->ChildAt(child);
    if (!world.sensors.IsEmpty()) world.sensors.changed.push_back(body);
    const uint32_t index = ColliderOf(world, body, child);
    const Shape* was = world.colliders.shapes[index].shape;
    if (was) {
        WakeNear(world, index);
        if (was != is.shape.get()) RemovePairsOf(world, index);
        else ForgetManifoldsOf(world, index);
    }
    if (!is.shape) {
        Erase(world, index);
        world.colliders.shapes[index] = {};
        world.colliders.movedHasEmpty |= world.colliders.colliders[index].queued;
        return;
    }
    world.colliders.shapes[index] = PieceOfChild(*cold.children->compound, is);
    if (was) {
        SetFatBounds(world.settings, world.bodies, world.colliders, index);
        const Collider& collider = world.colliders.colliders[index];
        world.colliders.TreeOf(collider).Update(index, collider.fat);
        world.outsideFatBounds.Forget(index);
        world.bodies.poses[body].boundsChangedIn = static_cast<uint32_t>(world.step + 1);
    } else {
        Insert(world, body, index);
    }
    world.colliders.colliders[index].previous = {};
    world.colliders.Queue(index);
    WakeNear(world, index);
}

void MoveToItsTree(WorldState& world, uint32_t body) {
    ColliderStore& store = world.colliders;
    const BodyCold& cold = world.bodies.cold[body];
    const BodyDynamics& d = world.bodies.dynamics[body];
    if (!cold.isSensor) (d.motion != MotionType::Static ? store.movingLayers : store.staticLayers) |= 1u << d.layer;
    VisitColliders(world, body, [&](uint32_t i) {
        Collider& collider = store.colliders[i];
        store.TreeOf(collider).Remove(i);
        collider.moving = d.motion != MotionType::Static;
        collider.sensor = cold.isSensor;
        SetFatBounds(world.settings, world.bodies, world.colliders, i);
        store.TreeOf(collider).Insert(i, collider.fat);
        world.outsideFatBounds.Forget(i);
    });
    world.pendingTrees.Note();
    RequeueColliders(world.bodies, world.colliders, body);
}

double RelativeMassOf(const Shape& shape) {
    return shape.Type() == ShapeType::MutableCompound ? static_cast<const MutableCompound&>(shape).RelativeMass()
                                                      : double{shape.Mass().volume};
}

void WakeNeighbors(WorldState& world, uint32_t body) {
    if (world.bodies.cold[body].isSensor) return;
    VisitColliders(world, body, [&](uint32_t i) { WakeInside(world, world.colliders.colliders[i].fat); });
}

void MoveCenterOfMass(WorldState& world, uint32_t body, const Vector3& from, const Vector3& to) {
    if (from == to) return;
    BodyStore& bodies = world.bodies;
    Pose pose = bodies.ExactCenterPoseOf(body);
    const Position before = pose.position;
    pose.position = before - Rotate(pose.rotation, from).cast<double>() + Rotate(pose.rotation, to).cast<double>();
    bodies.SetCenterPose(body, pose);
    const Vector3 moved = (pose.position - before).cast<float>();
    const Vector3 angular = bodies.AngularVelocityOf(body);
    bodies.SetVelocity(body, bodies.LinearVelocityOf(body) + Cross<float>(angular, moved), angular);
    BodyCold& cold = bodies.cold[body];
    cold.torque -= Cross<float>(moved, cold.force);

    const Vector3 shift = to - from;
    ShiftContacts(world, body, shift);
    world.joints.VisitOf(body, [&](uint32_t index) {
        JointRecord& record = world.joints.records[index];
        float(&anchor)[3] = world.joints.joints[index].SideOf(body) ? record.anchorB : record.anchorA;
        for (int k = 0; k < 3; ++k) anchor[k] -= shift[k];
    });
}

}  // namespace fulcrum
