// Compounds and triangles in shape files.
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>

#include <cmath>

namespace fulcrum {
namespace {

bool IsNear(const Vector3& v) { return IsFinite(v) && v.cwiseAbs().maxCoeff() < kFarthestPlace; }

void WriteChild(const CompoundShape::Child& child, ByteWriter& out, const ShapeFileScope& scope) {
    out.Write(child.pose.position);
    out.Write(child.pose.rotation);
    out.Write(child.density);
    WriteShape(*child.shape, out, scope);
}

Result<CompoundShape::Child> ReadChild(ByteReader& in, const ShapeFileScope& scope) {
    CompoundShape::Child child;
    in.Read(child.pose.position);
    in.Read(child.pose.rotation);
    child.density = in.Get<float>();
    const ShapeResult shape = ReadShape(in, {scope.custom, scope.depth + 1});
    if (in.HasFailed()) return Damaged("a compound breaks off");
    if (!shape) return shape.GetError();
    const bool isPose = IsNear(child.pose.position) && IsFinite(child.pose.rotation) &&
                        IsUnit(double{LengthSquared(child.pose.rotation)});
    const bool isDensity = std::isnormal(child.density) && child.density > 0;
    if (!isPose || !isDensity || !shape.Value()->IsConvex()) return Damaged("a child of a compound or its pose");
    child.shape = std::static_pointer_cast<const ConvexShape>(shape.Value());
    return child;
}

}  // namespace

void WriteCompound(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope) {
    const auto& compound = static_cast<const Compound&>(shape);
    WriteMass(compound.Mass(), out);
    out.Write(static_cast<uint32_t>(compound.Children().size()));
    for (const Compound::Child& child : compound.Children()) WriteChild(child, out, scope);
}

ShapeResult ReadCompound(ByteReader& in, const ShapeFileScope& scope) {
    const MassProperties mass = ReadMass(in);
    const uint32_t count = in.Get<uint32_t>();
    std::vector<Compound::Child> children;
    for (uint32_t i = 0; i < count; ++i) {
        Result<Compound::Child> child = ReadChild(in, scope);
        if (!child) return child.GetError();
        children.push_back(std::move(child.Value()));
    }
    if (in.HasFailed() || children.empty() || !IsPlausible(mass)) return Damaged("a compound or its mass");
    return ShapeFileAccess::MakeCompound(std::move(children), mass);
}

// With its ids and its free list, so that later edits give the same ids as for the original.
void ShapeFileAccess::WriteMutableCompound(const MutableCompound& compound, ByteWriter& out,
                                           const ShapeFileScope& scope) {
    WriteMass(compound.Mass(), out);
    out.Write(std::bit_cast<uint64_t>(compound.relativeMass_));
    out.Write(static_cast<uint32_t>(compound.children_.size()));
    for (size_t i = 0; i < compound.children_.size(); ++i) {
        const MutableCompound::Child& child = compound.children_[i];
        out.Write(compound.generations_[i]);
        out.Write(static_cast<uint8_t>(child.shape != nullptr));
        if (child.shape) WriteChild(child, out, scope);
    }
    out.WriteAll(std::span<const uint32_t>(compound.free_));
}

ShapeResult ShapeFileAccess::ReadMutableCompound(ByteReader& in, const ShapeFileScope& scope) {
    const std::shared_ptr<MutableCompound> compound(new MutableCompound);
    compound->mass_ = ReadMass(in);
    compound->relativeMass_ = std::bit_cast<double>(in.Get<uint64_t>());
    const bool isMass = IsPlausible(compound->mass_) && IsNear(compound->mass_.centerOfMass) &&
                        std::isnormal(compound->relativeMass_) && compound->relativeMass_ > 0;
    const uint32_t count = in.Get<uint32_t>();
    for (uint32_t i = 0; i < count; ++i) {
        compound->generations_.push_back(in.Get<uint32_t>());
        const uint8_t isThere = in.Get<uint8_t>();
        if (in.HasFailed() || isThere > 1) return Damaged("a compound breaks off");
        CompoundShape::Child child;
        if (isThere) {
            Result<CompoundShape::Child> read = ReadChild(in, scope);
            if (!read) return read.GetError();
            child = std::move(read.Value());
        }
        compound->Place(i, child,
                        child.shape ? CompoundSums::Of(child, MutableCompound::BoundsOf(child)) : CompoundSum{});
    }
    in.ReadAll(compound->free_, count - compound->count_);
    if (in.HasFailed() || compound->count_ == 0 || !isMass) return Damaged("a mutable compound or its mass");
    std::vector<bool> isFree(count, false);
    for (const uint32_t index : compound->free_) {
        if (index >= count || compound->children_[index].shape || isFree[index])
            return Damaged("the free places of a compound");
        isFree[index] = true;
    }
    compound->tree_.Rebuild();
    compound->Refresh(compound->sums_.Total());
    return ShapePtr(compound);
}

void ShapeFileAccess::WriteTriangle(const Triangle& triangle, ByteWriter& out) {
    WriteMass(triangle.Mass(), out);
    for (const Vector3& corner : triangle.corners_) out.Write(corner);
    out.Write(triangle.normal_);
    out.Write(triangle.convexRadius_);
}

ShapeResult ShapeFileAccess::ReadTriangle(ByteReader& in) {
    const std::shared_ptr<Triangle> triangle(new Triangle);
    triangle->mass_ = ReadMass(in);
    for (Vector3& corner : triangle->corners_) in.Read(corner);
    in.Read(triangle->normal_);
    const float radius = in.Get<float>();
    const Vector3 &a = triangle->corners_[0], &b = triangle->corners_[1], &c = triangle->corners_[2],
                  &n = triangle->normal_;
    if (in.HasFailed() || !IsPlausible(triangle->mass_) || !IsNear(triangle->mass_.centerOfMass) || !IsNear(a) ||
        !IsNear(b) || !IsNear(c) || !(std::isfinite(radius) && radius >= 0 && radius < kFarthestPlace))
        return Damaged("a triangle, or its mass");
    // Whether the corners are about their centroid, not collinear, and match the normal, to within rounding.
    const Position ab = (b - a).cast<double>(), ac = (c - a).cast<double>(), cross = Cross<double>(ab, ac);
    const double twiceArea = std::sqrt(Dot<double>(cross, cross));
    const double longest = std::max(Dot<double>(ab, ab), Dot<double>(ac, ac));
    const bool isCentered = double{Vector3(a + b + c).cwiseAbs().maxCoeff()} <= 1e-5 * std::sqrt(longest);
    const bool isNormal =
        IsFinite(n) && IsUnit(double{LengthSquared(n)}) && Dot<double>(cross, n.cast<double>()) >= 0.99 * twiceArea;
    if (!isCentered || !isNormal || !(twiceArea > 1e-6 * longest)) return Damaged("the corners of a triangle");
    triangle->Complete(radius);
    return ShapePtr(triangle);
}

}  // namespace fulcrum
