// A compound whose children are added, removed and moved at run time. An edit takes time proportional to the children
// edited, times the logarithm of their total number. Bodies get a copy of their own, which BodyInterface edits
// (AddChild, MoveChild, ...). Like a container: one thread writes, or any number read.
#pragma once

#include <Fulcrum/Collision/Shapes/CompoundSums.h>

namespace fulcrum {

// Identifies a child. Ids of removed children are never valid again: an index is reused with another generation.
// Queries return the index (SubShape::child), from which MutableCompound::IdOf makes the id.
struct ChildId {
    uint32_t index = 0xFFFFFFFFu;
    uint32_t generation = 0;
    friend auto operator<=>(const ChildId&, const ChildId&) = default;
};

// Whether an edit recomputes mass, inertia and center of mass, or keeps them until the next edit that does.
enum class MassUpdate : uint8_t { Update, Keep };

class MutableCompound final : public CompoundShape {
public:
    ~MutableCompound() override;

    // Mass and errors as for Compound::Create. The children's ids have the indices 0, 1, ... and the generation 0. When
    // children move, their masses stay the same (density times volume, in a unit fixed at creation). OuterRadius is
    // that of the box around the children: up to 1.7 times as much as needed. The center frame moves with the center of
    // mass.
    static Result<std::shared_ptr<MutableCompound>> Create(std::span<const ChildSettings> children);
    // A copy with the same ids.
    std::shared_ptr<MutableCompound> Copy() const;

    uint32_t Count() const { return count_; }  // of children; indices may be larger
    bool Exists(ChildId id) const;
    // The id of the child with this index; invalid if there is none.
    ChildId IdOf(uint32_t index) const;
    // The sum of density times volume over the children, as of the last update of the mass.
    double RelativeMass() const { return relativeMass_; }

    // Errors, which leave the compound unchanged: those of Create about `child`, UnknownId, Degenerate (the last child
    // cannot be removed).
    Result<ChildId> Add(const ChildSettings& child, MassUpdate mass = MassUpdate::Update);
    Status Set(ChildId id, const ChildSettings& child, MassUpdate mass = MassUpdate::Update);  // all of it
    Status Move(ChildId id, const Vector3& position, const Quaternion& rotation, MassUpdate mass = MassUpdate::Update);
    Status Remove(ChildId id, MassUpdate mass = MassUpdate::Update);
    Status UpdateMass();

    // The same in two steps, for callers that need the effect of an edit beforehand. A plan is valid until the next
    // edit.
    struct Edit {
        uint32_t index;
        Child child;             // null shape: to be removed
        CompoundSum sum, total;  // of the child, and of all with it
        MassProperties mass;     // after the edit
        double relativeMass;     // after the edit
    };
    Result<Edit> PlanAdd(const ChildSettings& child, MassUpdate mass) const;
    Result<Edit> PlanSet(ChildId id, const ChildSettings& child, MassUpdate mass) const;
    Result<Edit> PlanMove(ChildId id, const Vector3& position, const Quaternion& rotation, MassUpdate mass) const;
    Result<Edit> PlanRemove(ChildId id, MassUpdate mass) const;
    ChildId Commit(const Edit& edit);
    void Reserve(const Edit& edit);  // so that Commit of it asks for no memory; it begins with this

private:
    friend struct ShapeFileAccess;
    MutableCompound();
    MutableCompound(const MutableCompound&);

    // Checked, in the children's frame.
    static Result<Child> Posed(const ChildSettings& child, const char* name);
    Status CheckId(ChildId id) const;
    Result<Edit> Plan(uint32_t index, Child child, MassUpdate mass) const;
    void Place(uint32_t index, const Child& child, const CompoundSum& sum);
    void Refresh(const CompoundSum& total);
    Status ComputeMass();

    std::vector<uint32_t> generations_;  // by index; grows when the child is removed
    std::vector<uint32_t> free_;         // indices without a child; the last one is used next
    CompoundSums sums_;
    uint32_t count_ = 0;
    double relativeMass_ = 0;
};

}  // namespace fulcrum
