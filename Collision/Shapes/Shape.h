// The base of all shapes. A shape is immutable once created and may be shared by any number of bodies and threads,
// except two: a HeightField can be edited in place, for all that share it, and a MutableCompound, of which each body
// has a copy. Each edit gives the shape another version. Geometry is expressed in the center frame: axes of the
// frame in which the user described it, origin at the center of mass of its volume. So a body's internal pose is that
// of its center of mass, and no kernel adds an offset.
#pragma once

#include <Fulcrum/Math/Bounds.h>
#include <Fulcrum/Math/Pose.h>
#include <Fulcrum/Math/Result.h>

#include <cstdint>
#include <memory>

namespace fulcrum {

// A new shape needs a line here and one in NarrowPhase/PairTable.cpp.
enum class ShapeType : uint8_t {
    Sphere,
    Box,
    Capsule,
    ConvexHull,
    Triangle,
    TaperedCapsule,
    Cylinder,  // tapered ones and cones, too
    Custom,    // classes that users derive from CustomConvex
    Compound,
    MutableCompound,
    TriangleMesh,
    HeightField,
    Plane,
    Empty,  // no geometry at all
};
inline constexpr int kConvexShapeTypes = static_cast<int>(ShapeType::Compound);  // those before it
const char* ShapeTypeName(ShapeType type);

// Mass properties of a solid of density 1 kg/m3, about its center of mass. All zero for shapes with no volume or an
// infinite one.
struct MassProperties {
    float volume = 0;                            // m3
    Vector3 centerOfMass = Vector3::Zero();      // m, in the user's frame
    Vector3 principalInertia = Vector3::Zero();  // kg m2 at density 1, along the principal axes
    Quaternion principalAxes;                    // rotation from the principal frame to the shape's frame
};

// Cached result of ContentHash (ShapeHash.h); 0: none yet. Copies start without, because they may be changed.
class CachedHash {
public:
    CachedHash() = default;
    CachedHash(const CachedHash&) {}
    CachedHash& operator=(const CachedHash&) { return *this; }
    uint64_t Get() const { return __atomic_load_n(&hash_, __ATOMIC_RELAXED); }
    // Threads that compute it concurrently get the same value.
    void Set(uint64_t hash) const { __atomic_store_n(&hash_, hash, __ATOMIC_RELAXED); }
    void Forget() { Set(0); }  // the content has changed

private:
    mutable uint64_t hash_ = 0;
};

class Shape {
public:
    virtual ~Shape() = default;

    ShapeType Type() const { return type_; }
    bool IsConvex() const { return type_ < ShapeType::Compound; }
    // Made of convex shapes: a CompoundShape.
    bool IsCompound() const { return type_ == ShapeType::Compound || type_ == ShapeType::MutableCompound; }
    // Made of triangles: a SurfaceShape.
    bool IsSurface() const { return type_ == ShapeType::TriangleMesh || type_ == ShapeType::HeightField; }
    const MassProperties& Mass() const { return mass_; }
    // In the center frame.
    const Bounds& LocalBounds() const { return bounds_; }
    // Radius of the largest sphere about the center of mass that fits inside. Continuous collision is for motions
    // longer than this per step.
    float InnerRadius() const { return innerRadius_; }
    // Distance of the farthest point from the center of mass.
    float OuterRadius() const { return outerRadius_; }
    // 0 until the first edit. Each edit gives a number that no shape of this process had before: it says that the
    // content is another one, and nothing about which; for that see ContentHash.
    uint64_t Version() const { return version_; }

protected:
    friend uint64_t ContentHash(const Shape& shape);
    // Called by each edit, when the content has changed.
    void NoteEdit();
    explicit Shape(ShapeType type) : type_(type) {}

    ShapeType type_;
    MassProperties mass_;
    Bounds bounds_;
    float innerRadius_ = 0;
    float outerRadius_ = 0;
    uint64_t version_ = 0;
    CachedHash hash_;
};

// The latest version that any shape of the process has got; 0 if none was edited. Who has seen it knows that nothing
// was edited since, without a look at the shapes.
uint64_t LatestShapeVersion();

struct SupportingFace;

using ShapePtr = std::shared_ptr<const Shape>;

// A shape that has a support function. `convexRadius` is the part of it that is rounding: the shape is the Minkowski
// sum of its core and a sphere of that radius (a sphere's core is a point, a capsule's a segment).
class ConvexShape : public Shape {
public:
    float ConvexRadius() const { return convexRadius_; }
    // The point of the core that lies farthest along `direction` (any length > 0), in the center frame.
    virtual Vector3 SupportCore(const Vector3& direction) const = 0;
    // The point of the whole shape that lies farthest along `direction`.
    Vector3 Support(const Vector3& direction) const {
        return SupportCore(direction) + Normalized(direction) * convexRadius_;
    }
    // The flat face, straight edge or point of the core whose normal is closest to the unit vector `direction`;
    // contacts are clipped from it (SupportingFace.h). The default probes the support function around the direction.
    virtual void FindSupportingFace(const Vector3& direction, SupportingFace& face) const;

protected:
    using Shape::Shape;
    float convexRadius_ = 0;
};

}  // namespace fulcrum
