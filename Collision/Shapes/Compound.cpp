#include <Fulcrum/Collision/Shapes/Compound.h>

#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>

namespace fulcrum {

Compound::Compound() : CompoundShape(ShapeType::Compound) {}
Compound::~Compound() = default;

// The children of a compound whose center frame is at `pose`, with densities that make `density` on average.
static void AddChildrenOf(const CompoundShape& compound, const RelativePose& pose, float density,
                          std::vector<CompoundShape::Child>& children) {
    double volume = 0, mass = 0;
    for (const CompoundShape::Child& child : compound.Children()) {
        if (!child.shape) continue;
        volume += double{child.shape->Mass().volume};
        mass += double{child.density} * double{child.shape->Mass().volume};
    }
    for (const CompoundShape::Child& child : compound.Children()) {
        if (!child.shape) continue;
        const RelativePose own = compound.PoseOf(child);
        children.push_back({child.shape,
                            {pose.Transform(own.position), pose.rotation * own.rotation},
                            static_cast<float>(double{density} * double{child.density} * volume / mass)});
    }
}

Result<std::shared_ptr<const Compound>> Compound::Create(std::span<const ChildSettings> children,
                                                         const Vector3& centerOffset) {
    const DefaultFloats floats;
    if (children.empty()) return Error{ErrorCode::Degenerate, "a compound needs at least one child"};

    std::vector<SolidMass> solids;
    std::vector<double> densities;
    for (const ChildSettings& child : children) {
        const std::string name = Message("child %d", static_cast<int>(solids.size()));
        if (const Status status = Check(child, name.c_str(), true); !status) return status.GetError();
        solids.push_back(
            Transformed(ToSolidMass(child.shape->Mass()), Normalized(child.rotation), child.position.cast<double>()));
        densities.push_back(double{child.density});
    }
    if (!IsFinite(centerOffset)) return Error{ErrorCode::NonFinite, "centerOffset is not finite"};
    SolidMass whole = CombinedMass(solids, densities);
    const Position d = centerOffset.cast<double>();
    whole.center += d;
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
        const Position center = solids[i].center - whole.center;
        const std::string name = Message("child %d", static_cast<int>(i));
        if (const Status status = CheckPlace(name.c_str(), center.cast<float>()); !status) return status.GetError();
        const RelativePose pose{center.cast<float>(), Normalized(children[i].rotation)};
        if (children[i].shape->IsCompound())
            AddChildrenOf(static_cast<const CompoundShape&>(*children[i].shape), pose, children[i].density, posed);
        else
            posed.push_back(
                {std::static_pointer_cast<const ConvexShape>(children[i].shape), pose, children[i].density});
    }
    if (posed.empty()) return Error{ErrorCode::Degenerate, "the compounds that are its children have none"};
    const std::shared_ptr<Compound> compound(new Compound);
    compound->Assemble(std::move(posed), mass.Value());
    return std::shared_ptr<const Compound>(compound);
}

// Bounds, radii and tree, from the children in the center frame and the total mass.
void Compound::Assemble(std::vector<Child> children, const MassProperties& mass) {
    children_ = std::move(children);
    mass_ = mass;
    innerRadius_ = children_[0].shape->InnerRadius();
    for (const Child& child : children_) {
        const Bounds bounds = BoundsOf(child);
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
