// The functions of BodyInterface that change shapes: edits of children, SetShape.
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Physics/BodyInterface.h>
#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/BodyReading.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/Waking.h>
#include <Fulcrum/Physics/World/WorldChange.h>

namespace fulcrum {

namespace {

// Sets mass and inertia from the mass in kg and the shape's mass properties at density 1.
void ChangeMass(WorldState& world, uint32_t body, const MassProperties& shape, float kilograms) {
    SetMass(world.bodies.dynamics[body], shape.principalAxes, kilograms,
            Vector3(shape.principalInertia * (kilograms / shape.volume)));
    world.bodies.UpdateInertia(body);
    if (world.joints.HasAny(body)) world.coloring.Invalidate();
}

void ReserveEdit(WorldState& world, uint32_t body, const MutableCompound::Edit& edit) {
    const BodyCold& cold = world.bodies.cold[body];
    Additions more{.removedPairs = CountPairsOf(world, body)};
    more.InTree(world.bodies.dynamics[body].motion != MotionType::Static, cold.isSensor) += 1;
    const uint32_t before = ColliderRoomOf(world, body);
    if (edit.index >= before) more.colliders = world.colliders.ReserveRun(before);
    ReserveForChange(world, more);
    cold.children->compound->Reserve(edit);
}

ChildId Commit(WorldState& world, const WorldLock::Exclusive& alone, uint32_t body, const MutableCompound::Edit& edit,
               bool updatesMass) {
    ReserveEdit(world, body, edit);
    alone.Begin();
    BodyCold& cold = world.bodies.cold[body];
    const Vector3 center = cold.shape->Mass().centerOfMass;
    BodyChildren& children = *cold.children;
    const std::span<const CompoundShape::Child> all = children.compound->Children();
    // Kept alive: pairs still refer to it.
    const ShapePtr before = edit.index < all.size() ? all[edit.index].shape : nullptr;
    WakeBody(world, body);
    const ChildId id = children.compound->Commit(edit);
    world.bodies.SetRadii(body, *cold.shape);
    if (updatesMass) {
        MoveCenterOfMass(world, body, center, edit.mass.centerOfMass);
        children.origin = children.compound->Origin();
        ChangeMass(world, body, edit.mass, static_cast<float>(children.massUnit * edit.relativeMass));
    }
    UpdateChildCollider(world, body, edit.index);
    return id;
}

// plan(compound, mass) returns the edit.
template <class Plan>
Result<ChildId> EditChildren(WorldState& world, const WorldLock::Exclusive& alone, BodyId id, MassUpdate mass,
                             const Plan& plan) {
    if (!world.bodies.Find(id)) return Unknown(id);
    if (MaybeError e = CheckEnum("mass", mass, MassUpdate::Keep)) return *e;
    const BodyCold& cold = world.bodies.cold[id.index];
    if (!cold.children) {
        return Error{ErrorCode::Unsupported, std::string("the body's shape is a ") + ShapeTypeName(cold.shape->Type()) +
                                                 "; only mutable compounds have children to edit"};
    }
    // Static and kinematic bodies have no mass to update, and their center stays in place.
    const bool updates = mass == MassUpdate::Update && world.bodies.dynamics[id.index].motion == MotionType::Dynamic;
    const Result<MutableCompound::Edit> edit = plan(*cold.children->compound, updates ? mass : MassUpdate::Keep);
    if (!edit) return edit.GetError();
    if (updates) {
        const float kilograms = static_cast<float>(cold.children->massUnit * edit.Value().relativeMass);
        const MassProperties& shape = edit.Value().mass;
        if (MaybeError e = CheckInverses("child", "child", kilograms,
                                         Vector3(shape.principalInertia * (kilograms / shape.volume))))
            return *e;
    }
    return Commit(world, alone, id.index, edit.Value(), updates);
}

Status WithoutId(const Result<ChildId>& result) {
    if (!result) return result.GetError();
    return Done{};
}

}  // namespace

Result<ChildId> BodyInterface::AddChild(BodyId id, const CompoundShape::ChildSettings& child, MassUpdate mass) {
    const WorldChange<&BodyInterface::AddChild> change(world_, id, child, mass);
    if (change.Refusal()) return *change.Refusal();
    return change.Created(EditChildren(world_, change, id, mass,
                                       [&](const MutableCompound& c, MassUpdate m) { return c.PlanAdd(child, m); }));
}

Status BodyInterface::SetChild(BodyId id, ChildId child, const CompoundShape::ChildSettings& settings,
                               MassUpdate mass) {
    const WorldChange<&BodyInterface::SetChild> change(world_, id, child, settings, mass);
    if (change.Refusal()) return *change.Refusal();
    return WithoutId(EditChildren(world_, change, id, mass, [&](const MutableCompound& c, MassUpdate m) {
        return c.PlanSet(child, settings, m);
    }));
}

Status BodyInterface::MoveChild(BodyId id, ChildId child, const Vector3& position, const Quaternion& rotation,
                                MassUpdate mass) {
    const WorldChange<&BodyInterface::MoveChild> change(world_, id, child, position, rotation, mass);
    if (change.Refusal()) return *change.Refusal();
    return WithoutId(EditChildren(world_, change, id, mass, [&](const MutableCompound& c, MassUpdate m) {
        return c.PlanMove(child, position, rotation, m);
    }));
}

Status BodyInterface::RemoveChild(BodyId id, ChildId child, MassUpdate mass) {
    const WorldChange<&BodyInterface::RemoveChild> change(world_, id, child, mass);
    if (change.Refusal()) return *change.Refusal();
    return WithoutId(EditChildren(world_, change, id, mass,
                                  [&](const MutableCompound& c, MassUpdate m) { return c.PlanRemove(child, m); }));
}

const MutableCompound* BodyInterface::GetChildren(BodyId id) const {
    const BodyReading reading(world_, locks_, id);
    const bool has = reading && world_.bodies.cold[id.index].children;
    return has ? world_.bodies.cold[id.index].children->compound : nullptr;
}

Status BodyInterface::SetShape(BodyId id, const ShapePtr& shape, MassUpdate mass) {
    const WorldChange<&BodyInterface::SetShape> change(world_, id, shape, mass);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    const uint32_t body = id.index;
    BodyCold& cold = world_.bodies.cold[body];
    BodyDynamics& d = world_.bodies.dynamics[body];
    if (MaybeError e = FirstOf(CheckEnum("mass", mass, MassUpdate::Keep), CheckShape(shape.get(), d.motion))) return *e;
    if (MaybeError e = CheckContinuous(cold.continuous, *shape)) return *e;
    const bool updates = mass == MassUpdate::Update && d.motion == MotionType::Dynamic;
    const MassProperties next = shape->Mass();
    const double massUnit = cold.children ? cold.children->massUnit : double{GetMass(id)} / RelativeMassOf(*cold.shape);
    const float kilograms = updates ? static_cast<float>(massUnit * RelativeMassOf(*shape)) : GetMass(id);
    if (updates) {
        if (MaybeError e =
                CheckInverses("shape", "shape", kilograms, Vector3(next.principalInertia * (kilograms / next.volume))))
            return *e;
    }
    OwnShape own(shape);
    const uint32_t count = ColliderCountOf(*shape);
    const bool hasRoom = count == cold.colliderCount || world_.colliders.HasFree(count);
    Additions more{.colliders = hasRoom ? 0 : count, .removedPairs = CountPairsOf(world_, body)};
    more.InTree(d.motion != MotionType::Static, cold.isSensor) += count;
    ReserveForChange(world_, more);
    world_.colliders.ReserveFree(cold.colliderCount, cold.MoreColliders());
    change.Begin();
    WakeBody(world_, body);
    WakeNeighbors(world_, body);
    WakeJoined(world_, body);
    DropColliders(world_, body);
    const ShapePtr before = cold.shape;
    SetShapeOf(world_, body, std::move(own));
    MoveCenterOfMass(world_, body, before->Mass().centerOfMass, next.centerOfMass);
    world_.bodies.SetRadii(body, *shape);
    if (updates) ChangeMass(world_, body, next, kilograms);
    if (cold.children) cold.children->massUnit = double{kilograms} / RelativeMassOf(*shape);
    MakeColliders(world_, body);
    if (d.motion == MotionType::Dynamic) world_.bodies.MarkPlaced(body);
    RequeueColliders(world_.bodies, world_.colliders, body);
    if (!world_.sensors.IsEmpty()) world_.sensors.changed.push_back(body);  // also if no collider is left to mark it
    WakeNeighbors(world_, body);
    return Done{};
}

}  // namespace fulcrum
