#include <Fulcrum/Collision/Shapes/Compound.h>

#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>

#include <algorithm>

namespace fulcrum {
namespace {

Status CheckChild(const Compound::ChildSettings& child, int index) {
    if (!child.shape) return Error{ErrorCode::Unsupported, Message("child %d has no shape", index)};
    if (!child.shape->IsConvex()) {
        return Error{ErrorCode::Unsupported, Message("child %d is a %s: children must be convex", index,
                                                     ShapeTypeName(child.shape->Type()))};
    }
    if (!IsFinite(child.position) || !IsFinite(child.rotation) || !std::isfinite(child.density)) {
        return Error{ErrorCode::NonFinite, Message("position, rotation or density of child %d is not finite", index)};
    }
    const double lengthSquared = double{LengthSquared(child.rotation)};
    if (!(std::fabs(lengthSquared - 1) < 1e-3)) {
        return Error{ErrorCode::Unnormalized,
                     Message("the rotation of child %d has length %g: it must be 1", index, std::sqrt(lengthSquared))};
    }
    if (!(child.density > 0)) {
        return Error{ErrorCode::NonPositive,
                     Message("the density of child %d is %g: it must be larger than 0", index, double{child.density})};
    }
    return Done{};
}

// Bounds of a child in the compound's frame by its supports along the axes; rounded outwards by what the rotation of the
// direction and of the point may lose, a few units in the last place of the child's size.
Bounds ChildBounds(const ConvexShape& shape, const RelativePose& pose) {
    const Quaternion& q = pose.rotation;
    const bool turned = q.x != 0 || q.y != 0 || q.z != 0;
    const double slack = turned ? 0x1p-21 * double{shape.OuterRadius()} : 0;
    Position lower, upper;
    for (int axis = 0; axis < 3; ++axis) {
        if (!turned) {
            lower[axis] = double{pose.position[axis]} + double{shape.LocalBounds().lower[axis]};
            upper[axis] = double{pose.position[axis]} + double{shape.LocalBounds().upper[axis]};
            continue;
        }
        const Vector3 direction = InverseRotate(q, Vector3(Vector3::Unit(axis)));
        const Vector3 high = Rotate(q, shape.Support(direction)), low = Rotate(q, shape.Support(Vector3(-direction)));
        lower[axis] = double{pose.position[axis]} + double{low[axis]} - slack;
        upper[axis] = double{pose.position[axis]} + double{high[axis]} + slack;
    }
    return RoundedOutwards(lower, upper);
}

}  // namespace

Result<std::shared_ptr<const Compound>> Compound::Create(std::span<const ChildSettings> children,
                                                           const Vector3& centreOffset) {
    if (children.empty()) return Error{ErrorCode::Degenerate, "a compound needs at least one child"};

    std::vector<SolidMass> solids;
    std::vector<double> densities;
    for (const ChildSettings& child : children) {
        if (const Status status = CheckChild(child, static_cast<int>(solids.size())); !status) return status.GetError();
        solids.push_back(Transformed(ToSolidMass(child.shape->Mass()), Normalized(child.rotation),
                                     child.position.cast<double>()));
        densities.push_back(double{child.density});
    }
    if (!IsFinite(centreOffset)) return Error{ErrorCode::NonFinite, "centreOffset is not finite"};
    SolidMass whole = CombinedMass(solids, densities);
    const Position d = centreOffset.cast<double>();
    whole.centre += d;
    whole.inertia.xx += whole.volume * (d.y() * d.y() + d.z() * d.z());
    whole.inertia.yy += whole.volume * (d.x() * d.x() + d.z() * d.z());
    whole.inertia.zz += whole.volume * (d.x() * d.x() + d.y() * d.y());
    whole.inertia.xy -= whole.volume * d.x() * d.y();
    whole.inertia.xz -= whole.volume * d.x() * d.z();
    whole.inertia.yz -= whole.volume * d.y() * d.z();
    const Result<MassProperties> mass = ToMassProperties(whole);
    if (!mass) return mass.GetError();

    std::vector<Child> posed;
    for (size_t i = 0; i < children.size(); ++i) {
        const Position centre = solids[i].centre - whole.centre;
        posed.push_back({std::static_pointer_cast<const ConvexShape>(children[i].shape),
                         {centre.cast<float>(), Normalized(children[i].rotation)}, children[i].density});
    }
    const std::shared_ptr<Compound> compound(new Compound);
    compound->Assemble(std::move(posed), mass.Value());
    return std::shared_ptr<const Compound>(compound);
}

std::vector<Compound::ChildSettings> Compound::Settings() const {
    std::vector<ChildSettings> settings;
    for (const Child& child : children_) {
        // From the centre frames to the users'.
        const Vector3 own = Rotate(child.pose.rotation, child.shape->Mass().centreOfMass);
        settings.push_back({.shape = child.shape,
                            .position = child.pose.position + mass_.centreOfMass - own,
                            .rotation = child.pose.rotation,
                            .density = child.density});
    }
    return settings;
}

// What follows from children in the centre frame and the mass of all.
void Compound::Assemble(std::vector<Child> children, const MassProperties& mass) {
    children_ = std::move(children);
    mass_ = mass;
    innerRadius_ = children_[0].shape->InnerRadius();
    for (const Child& child : children_) {
        const Bounds bounds = ChildBounds(*child.shape, child.pose);
        bounds_.Include(bounds);
        tree_.Insert(static_cast<uint32_t>(&child - children_.data()), bounds);
        innerRadius_ = std::min(innerRadius_, child.shape->InnerRadius());
        outerRadius_ = std::max(outerRadius_, Length(child.pose.position) + child.shape->OuterRadius());
    }
    tree_.Rebuild();
}

ShapeResult ShapeFileAccess::MakeCompound(std::vector<Compound::Child> children, const MassProperties& mass) {
    const std::shared_ptr<Compound> compound(new Compound);
    compound->Assemble(std::move(children), mass);
    return ShapePtr(compound);
}

}  // namespace fulcrum
