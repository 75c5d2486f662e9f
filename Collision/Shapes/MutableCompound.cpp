#include <Fulcrum/Collision/Shapes/MutableCompound.h>

#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <bit>

namespace fulcrum {
namespace {

// Of density 1 on average.
Result<MassProperties> MassOf(const CompoundSum& total) {
    const double scale = total.volume / total.mass;
    const Sym3<double>& i = total.inertia;
    SolidMass whole;
    whole.volume = total.volume;
    whole.center = total.center;
    whole.inertia = {i.xx * scale, i.yy * scale, i.zz * scale, i.xy * scale, i.xz * scale, i.yz * scale};
    return ToMassProperties(whole);
}

template <class T>
Status Forget(const Result<T>& result) {
    if (!result) return result.GetError();
    return Done{};
}

}  // namespace

MutableCompound::MutableCompound() : CompoundShape(ShapeType::MutableCompound) {}
MutableCompound::MutableCompound(const MutableCompound&) = default;
MutableCompound::~MutableCompound() = default;

Result<std::shared_ptr<MutableCompound>> MutableCompound::Create(std::span<const ChildSettings> children) {
    const DefaultFloats floats;
    if (children.empty()) return Error{ErrorCode::Degenerate, "a compound needs at least one child"};
    const std::shared_ptr<MutableCompound> compound(new MutableCompound);
    for (const ChildSettings& settings : children) {
        const std::string name = Message("child %u", compound->count_);
        const Result<Child> child = Posed(settings, name.c_str());
        if (!child) return child.GetError();
        compound->generations_.push_back(0);
        compound->Place(compound->count_, child.Value(), CompoundSums::Of(child.Value(), BoundsOf(child.Value())));
    }
    compound->tree_.Rebuild();
    if (const Status status = compound->ComputeMass(); !status) return status.GetError();
    return compound;
}

// ---- Ids

std::shared_ptr<MutableCompound> MutableCompound::Copy() const {
    return std::shared_ptr<MutableCompound>(new MutableCompound(*this));
}

bool MutableCompound::Exists(ChildId id) const {
    return id.index < children_.size() && children_[id.index].shape && generations_[id.index] == id.generation;
}

ChildId MutableCompound::IdOf(uint32_t index) const {
    return index < children_.size() && children_[index].shape ? ChildId{index, generations_[index]} : ChildId{};
}

Status MutableCompound::CheckId(ChildId id) const {
    if (Exists(id)) return Done{};
    return Error{ErrorCode::UnknownId,
                 Message("no child has the id (index %u, generation %u)", id.index, id.generation)};
}

// ---- Plans

Result<MutableCompound::Child> MutableCompound::Posed(const ChildSettings& child, const char* name) {
    if (const Status status = Check(child, name); !status) return status.GetError();
    const Quaternion rotation = Normalized(child.rotation);
    const Quat<double> q{rotation.x, rotation.y, rotation.z, rotation.w};
    const Position center =
        child.position.cast<double>() + Rotate<double>(q, child.shape->Mass().centerOfMass.cast<double>());
    if (const Status status = CheckPlace(name, center.cast<float>()); !status) return status.GetError();
    return Child{
        std::static_pointer_cast<const ConvexShape>(child.shape), {center.cast<float>(), rotation}, child.density};
}

Result<MutableCompound::Edit> MutableCompound::Plan(uint32_t index, Child child, MassUpdate mass) const {
    Edit edit{index, std::move(child), {}, {}, mass_, relativeMass_};
    if (edit.child.shape) edit.sum = CompoundSums::Of(edit.child, BoundsOf(edit.child));
    edit.total = sums_.TotalWith(index, edit.sum);
    if (mass == MassUpdate::Keep) return edit;
    const Result<MassProperties> after = MassOf(edit.total);
    if (!after) return after.GetError();
    edit.mass = after.Value();
    edit.relativeMass = edit.total.mass;
    return edit;
}

Result<MutableCompound::Edit> MutableCompound::PlanAdd(const ChildSettings& child, MassUpdate mass) const {
    const DefaultFloats floats;
    const Result<Child> posed = Posed(child, "child");
    if (!posed) return posed.GetError();
    return Plan(free_.empty() ? static_cast<uint32_t>(children_.size()) : free_.back(), posed.Value(), mass);
}

Result<MutableCompound::Edit> MutableCompound::PlanSet(ChildId id, const ChildSettings& child, MassUpdate mass) const {
    const DefaultFloats floats;
    if (const Status status = CheckId(id); !status) return status.GetError();
    const Result<Child> posed = Posed(child, "child");
    if (!posed) return posed.GetError();
    return Plan(id.index, posed.Value(), mass);
}

Result<MutableCompound::Edit> MutableCompound::PlanMove(ChildId id, const Vector3& position, const Quaternion& rotation,
                                                        MassUpdate mass) const {
    const DefaultFloats floats;
    if (const Status status = CheckId(id); !status) return status.GetError();
    const Child& child = children_[id.index];
    return PlanSet(id, {.shape = child.shape, .position = position, .rotation = rotation, .density = child.density},
                   mass);
}

Result<MutableCompound::Edit> MutableCompound::PlanRemove(ChildId id, MassUpdate mass) const {
    const DefaultFloats floats;
    if (const Status status = CheckId(id); !status) return status.GetError();
    if (count_ == 1) return Error{ErrorCode::Degenerate, "child is the last one: a compound needs at least one"};
    return Plan(id.index, {}, mass);
}

// ---- Edits

// A child's data, without the mass of the whole.
void MutableCompound::Place(uint32_t index, const Child& child, const CompoundSum& sum) {
    if (index == children_.size()) children_.emplace_back();
    const bool was = children_[index].shape != nullptr, is = child.shape != nullptr;
    children_[index] = child;
    sums_.Set(index, sum);
    if (was && is) tree_.Update(index, sum.bounds);
    else if (is) tree_.Insert(index, sum.bounds);
    else if (was) tree_.Remove(index);
    count_ += is ? (was ? 0 : 1) : (was ? ~0u : 0);
}

// Bounds and radii, from the children and the center of mass.
void MutableCompound::Refresh(const CompoundSum& total) {
    bounds_ = RoundedOutwards(total.bounds.lower.cast<double>() - mass_.centerOfMass.cast<double>(),
                              total.bounds.upper.cast<double>() - mass_.centerOfMass.cast<double>());
    outerRadius_ = Length(Vector3(bounds_.lower.cwiseAbs().cwiseMax(bounds_.upper.cwiseAbs()))) * 1.000001f;
    innerRadius_ = total.innerRadius;
}

void MutableCompound::Reserve(const Edit& edit) {
    const size_t room = std::bit_ceil(std::max(children_.size(), size_t{edit.index} + 1));
    generations_.reserve(room);
    free_.reserve(room);
    children_.reserve(room);
    sums_.Reserve(room);
    tree_.Reserve(room);
}

ChildId MutableCompound::Commit(const Edit& edit) {
    const DefaultFloats floats;
    Reserve(edit);
    const uint32_t index = edit.index;
    const bool isNew = index >= children_.size() || !children_[index].shape;
    if (index == children_.size()) {
        generations_.push_back(0);
    } else if (isNew) {
        FULCRUM_ASSERT(free_.back() == index);
        free_.pop_back();
    } else if (!edit.child.shape) {
        ++generations_[index];
        free_.push_back(index);
    }
    Place(index, edit.child, edit.sum);
    tree_.Optimize();
    mass_ = edit.mass;
    relativeMass_ = edit.relativeMass;
    Refresh(edit.total);
    NoteEdit();
    return {index, generations_[index]};
}

Result<ChildId> MutableCompound::Add(const ChildSettings& child, MassUpdate mass) {
    const DefaultFloats floats;
    const Result<Edit> edit = PlanAdd(child, mass);
    if (!edit) return edit.GetError();
    return Commit(edit.Value());
}

Status MutableCompound::Set(ChildId id, const ChildSettings& child, MassUpdate mass) {
    const DefaultFloats floats;
    const Result<Edit> edit = PlanSet(id, child, mass);
    if (edit) Commit(edit.Value());
    return Forget(edit);
}

Status MutableCompound::Move(ChildId id, const Vector3& position, const Quaternion& rotation, MassUpdate mass) {
    const DefaultFloats floats;
    const Result<Edit> edit = PlanMove(id, position, rotation, mass);
    if (edit) Commit(edit.Value());
    return Forget(edit);
}

Status MutableCompound::Remove(ChildId id, MassUpdate mass) {
    const DefaultFloats floats;
    const Result<Edit> edit = PlanRemove(id, mass);
    if (edit) Commit(edit.Value());
    return Forget(edit);
}

Status MutableCompound::UpdateMass() {
    const DefaultFloats floats;
    const Status status = ComputeMass();
    if (status) NoteEdit();
    return status;
}

Status MutableCompound::ComputeMass() {
    const CompoundSum total = sums_.Total();
    const Result<MassProperties> mass = MassOf(total);
    if (!mass) return mass.GetError();
    mass_ = mass.Value();
    relativeMass_ = total.mass;
    Refresh(total);
    return Done{};
}

}  // namespace fulcrum
