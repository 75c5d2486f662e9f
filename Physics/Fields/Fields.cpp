#include <Fulcrum/Physics/Fields/Fields.h>

#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Collision/Shapes/Submersion.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Validation.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

// Calls visit(piece, pose) for the convex pieces of a shape whose center frame is at `center`.
template <class Visit>
void VisitConvex(const Shape& shape, const Pose& center, Visit&& visit) {
    if (shape.IsConvex()) visit(static_cast<const ConvexShape&>(shape), center);
    if (!shape.IsCompound()) return;
    const auto& compound = static_cast<const CompoundShape&>(shape);
    for (const CompoundShape::Child& child : compound.Children())
        if (child.shape) visit(*child.shape, center * compound.PoseOf(child));
}

// Pieces that overlap both count, as in the mass.
Lift SubmergedOf(const Shape& shape, const Pose& center, const Vector3& up, double level) {
    Lift lift;
    Position moment = Position::Zero();  // about the center
    VisitConvex(shape, center, [&](const ConvexShape& piece, const Pose& pose) {
        const double height = Dot<double>(up.cast<double>(), pose.position);
        const double reach = double{piece.OuterRadius()};
        if (height - reach >= level) return;
        const SubmergedPart part = Submerged(piece, InverseRotate(pose.rotation, up), level - height);
        lift.volume += part.volume;
        moment += (pose.Transform(Vector3(part.center.cast<float>())) - center.position) * part.volume;
    });
    if (lift.volume > 0) lift.center = center.position + moment * (1 / lift.volume);
    return lift;
}

// A dynamic body, and what acts on it.
class FieldBody {
public:
    FieldBody(PhysicsSystem& system, BodyId id, double dt)
        : bodies_(system.Bodies()),
          id_(id),
          dt_(static_cast<float>(dt)),
          gravity_(Vector3(bodies_.GetGravity(id) * bodies_.GetGravityFactor(id))),
          mass_(bodies_.GetMass(id)),
          shape_(bodies_.GetShape(id)),
          center_{bodies_.GetCenterOfMass(id), bodies_.GetPose(id).rotation} {}

    const Position& Center() const { return center_.position; }

    void Add(const Water& water) {
        const Lift lift = SubmergedOf(*shape_, center_, water.up, water.level);
        if (!(lift.volume > 0)) return;
        const float displaced = static_cast<float>(double{water.density} * lift.volume);  // kg
        AddAt(water.up * (-Dot(gravity_, water.up) * displaced), lift.center);
        const Vector3 against = water.velocity - bodies_.GetLinearVelocity(id_);
        force_ += against * (mass_ * Decay(water.drag * displaced / mass_));
        torque_ -= bodies_.GetAngularMomentum(id_) * Decay(water.angularDrag * displaced / mass_);
    }
    void Add(const Wind& wind) {
        // v' = -k |v| v: v / (1 + k |v| t) after t. Rates of several pieces add up.
        float rate = 0;  // 1/s, of all of them
        VisitConvex(*shape_, center_,
                    [&](const ConvexShape& piece, const Pose& pose) { rate += DragOf(wind, piece, pose).rate; });
        const float held = mass_ / (1 + rate * dt_);
        VisitConvex(*shape_, center_, [&](const ConvexShape& piece, const Pose& pose) {
            const auto [against, ofPiece] = DragOf(wind, piece, pose);
            AddAt(against * (ofPiece * held), pose.position);
        });
    }
    void Add(const ForceField& field) {
        Vector3 acceleration = field.acceleration;
        if (field.accelerationAt) acceleration += field.accelerationAt(center_.position);
        force_ += acceleration * mass_;
    }
    void Push() const {
        // Refused if the body was frozen, or a field's function returned no finite number: nothing is added.
        (void)bool(bodies_.AddForce(id_, force_));
        (void)bool(bodies_.AddTorque(id_, torque_));
    }

private:
    struct Drag {
        Vector3 against;  // m/s, of the wind
        float rate;       // 1/s: the acceleration of the body by the piece's drag, divided by `against`
    };
    Drag DragOf(const Wind& wind, const ConvexShape& piece, const Pose& pose) const {
        const Vector3 against = wind.velocity - bodies_.GetVelocityAt(id_, pose.position);
        const float speed = Length(against);
        if (!(speed > 0)) return {against, 0};
        const float area = ShadowArea(piece, InverseRotate(pose.rotation, Vector3(against * (1 / speed))));
        return {against, 0.5f * wind.density * wind.dragCoefficient * area * speed / mass_};
    }
    void AddAt(const Vector3& force, const Position& point) {
        force_ += force;
        torque_ += Cross<float>(Vector3((point - center_.position).cast<float>()), force);
    }
    // 1/s: the rate that, held for the step, has the effect of v' = -rate v.
    float Decay(float rate) const { return (1 - static_cast<float>(Exp(double{-rate * dt_}))) / dt_; }

    BodyInterface& bodies_;
    BodyId id_;
    float dt_;
    Vector3 gravity_;
    float mass_;
    ShapePtr shape_;
    Pose center_;  // center frame
    Vector3 force_ = Vector3::Zero(), torque_ = Vector3::Zero();
};

bool IsInside(const FieldRegion& region, const Position& point) {
    return region.lower.isAtMost(point) && point.isAtMost(region.upper);
}

// The box of all regions.
template <class Field>
void Include(const std::vector<Field>& fields, FieldRegion& all) {
    for (const Field& field : fields) {
        all.lower = all.lower.cwiseMin(field.region.lower);
        all.upper = all.upper.cwiseMax(field.region.upper);
    }
}

MaybeError Check(const FieldRegion& region) {
    return FirstOf(CheckFinite("region.lower", region.lower), CheckFinite("region.upper", region.upper));
}
MaybeError Check(const Water& w) {
    if (MaybeError e = FirstOf(Check(w.region), CheckFinite("up", w.up), CheckRange("level", w.level, -1e18, 1e18),
                               CheckNotNegative("density", w.density), CheckFinite("velocity", w.velocity),
                               CheckNotNegative("drag", w.drag), CheckNotNegative("angularDrag", w.angularDrag)))
        return e;
    if (std::fabs(Length(w.up) - 1) <= 1e-3f) return std::nullopt;
    return Error{ErrorCode::Unnormalized, "up must be of length 1"};
}
MaybeError Check(const Wind& w) {
    return FirstOf(Check(w.region), CheckFinite("velocity", w.velocity), CheckNotNegative("density", w.density),
                   CheckNotNegative("dragCoefficient", w.dragCoefficient));
}
MaybeError Check(const ForceField& f) { return FirstOf(Check(f.region), CheckFinite("acceleration", f.acceleration)); }

// Names the list, too.
template <class Field>
MaybeError CheckAll(const char* list, const std::vector<Field>& fields) {
    for (size_t i = 0; i < fields.size(); ++i)
        if (MaybeError e = Check(fields[i]))
            return Error{e->code, std::string(list) + "[" + std::to_string(i) + "]." + e->message};
    return std::nullopt;
}

}  // namespace

Status Fields::Apply(PhysicsSystem& system, double dt, const QueryFilter& filter) {
    const DefaultFloats floats;
    if (MaybeError error = FirstOf(CheckPositive("dt", dt), CheckRange("dt", dt, 0, 1), CheckAll("waters", waters),
                                   CheckAll("winds", winds), CheckAll("forces", forces)))
        return *error;
    FieldRegion all{Position::Constant(1e18), Position::Constant(-1e18)};
    Include(waters, all);
    Include(winds, all);
    Include(forces, all);
    system.Queries().FindInBox(all.lower, all.upper, found, filter);
    BodyId last;
    for (const OverlapHit& hit : found) {
        if (hit.body == last || system.Bodies().GetMotionType(hit.body) != MotionType::Dynamic) continue;
        last = hit.body;
        FieldBody body(system, hit.body, dt);
        const auto addAll = [&](const auto& fields) {
            for (const auto& field : fields)
                if (IsInside(field.region, body.Center())) body.Add(field);
        };
        addAll(waters);
        addAll(winds);
        addAll(forces);
        body.Push();
    }
    return Done{};
}

Lift SubmergedVolume(const BodyInterface& bodies, BodyId id, const Vector3& up, double level) {
    const DefaultFloats floats;
    if (!bodies.Exists(id)) return {};
    return SubmergedOf(*bodies.GetShape(id), {bodies.GetCenterOfMass(id), bodies.GetPose(id).rotation}, up, level);
}

}  // namespace fulcrum
