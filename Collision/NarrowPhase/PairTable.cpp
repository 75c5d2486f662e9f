// The pair table: which function serves which two shapes.
#include <Fulcrum/Collision/NarrowPhase/BoxPart.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
#include <Fulcrum/Collision/NarrowPhase/PlaneContact.h>
#include <Fulcrum/Math/FloatEnvironment.h>

namespace fulcrum {

namespace {

// Serves (a, b) with a function written for (b, a): the same contact seen from the other side. The cache is always used
// in this order, so it needs no swap.
template <PairFunction Function>
void Flip(const PairQuery& query, Manifold& manifold) {
    const RelativePose aInB = Inverse(query.bInA);
    Function({query.b, query.a, aInB, query.settings, query.cache, query.counters}, manifold);
    const Matrix3 rotation = ToMatrix(query.bInA.rotation);
    for (int i = 0; i < manifold.pointCount; ++i) {
        ManifoldPoint& point = manifold.points[i];
        const Vector3 onOther = point.positionOnA + manifold.normal * point.separation;
        point.positionOnA = rotation * onOther + query.bInA.position;
        // Vertices of A and of B are the features of kinds 1 and 2.
        const uint32_t kind = point.feature >> 30;
        if (kind == 1 || kind == 2) point.feature ^= 3u << 30;
    }
    manifold.normal = -(rotation * manifold.normal);
}

// Entry for two different types: one function serves both orders.
struct PairEntry {
    PairFunction inOrder;  // the type that comes first in ShapeType is A
    PairFunction turned;   // it is B
};
// A function that takes the type that comes first as A, or as B; or one that takes any two shapes as they come.
template <PairFunction Function>
constexpr PairEntry kFirstIsA{Function, Flip<Function>};
template <PairFunction Function>
constexpr PairEntry kFirstIsB{Flip<Function>, Function};
template <PairFunction Function>
constexpr PairEntry kAnyOrder{Function, Function};

class PairTable {
public:
    // Adds the next type: its entries with each type before it, and with itself.
    template <ShapeType Type, class... Entries>
    constexpr PairTable& Column(const Entries&... entries) {
        constexpr int type = static_cast<int>(Type);
        static_assert(sizeof...(entries) == type + 1, "a shape meets each shape before it in ShapeType, and its like");
        hasLine_[type] = true;
        int before = 0;
        for (const PairEntry& entry : {entries...}) {
            functions_[before][type] = entry.inOrder;
            functions_[type][before++] = entry.turned;
        }
        return *this;
    }
    constexpr bool IsComplete() const {
        for (const bool hasLine : hasLine_)
            if (!hasLine) return false;
        return true;
    }
    constexpr PairFunction Of(ShapeType a, ShapeType b) const {
        return functions_[static_cast<int>(a)][static_cast<int>(b)];
    }

private:
    PairFunction functions_[kConvexShapeTypes][kConvexShapeTypes]{};
    bool hasLine_[kConvexShapeTypes]{};
};

// Polyhedra: CollidePolyhedra works for both orders, but the bits of the result depend on the order.
constexpr PairEntry kPolyhedra = kFirstIsA<CollidePolyhedra>, kPolyhedraTurned = kFirstIsB<CollidePolyhedra>;
// CollideConvex serves any two shapes; a pair is always passed to it in the same order, so it makes no difference which
// shape is A.
constexpr PairEntry kConvex = kFirstIsA<CollideConvex>;

// Each shape is one line: its functions with Sphere, Box, Capsule, ConvexHull, Triangle, TaperedCapsule, Cylinder,
// Custom, up to itself. The other order is derived.
// clang-format off
constexpr PairTable kPairTable = PairTable()
    .Column<ShapeType::Sphere>(kAnyOrder<CollideSphereSphere>)
    .Column<ShapeType::Box>(kFirstIsB<CollideBoxSphere>, kAnyOrder<CollideBoxBox>)
    .Column<ShapeType::Capsule>(kFirstIsB<CollideCapsuleSphere>, kPolyhedra, kAnyOrder<CollideCapsuleCapsule>)
    .Column<ShapeType::ConvexHull>(kPolyhedraTurned, kPolyhedraTurned, kPolyhedraTurned, kAnyOrder<CollidePolyhedra>)
    .Column<ShapeType::Triangle>(kPolyhedraTurned, kAnyOrder<CollidePolyhedra>, kPolyhedraTurned,
                                 kAnyOrder<CollidePolyhedra>, kAnyOrder<CollidePolyhedra>)
    .Column<ShapeType::TaperedCapsule>(kConvex, kConvex, kConvex, kConvex, kConvex, kAnyOrder<CollideConvex>)
    .Column<ShapeType::Cylinder>(kConvex, kConvex, kConvex, kConvex, kConvex, kConvex, kAnyOrder<CollideConvex>)
    .Column<ShapeType::Custom>(kConvex, kConvex, kConvex, kConvex, kConvex, kConvex, kConvex,
                               kAnyOrder<CollideConvex>);
// clang-format on
static_assert(kPairTable.IsComplete(), "every convex shape needs a line in the pair table");

// If one of the two is a box far larger than the other, it is replaced by its part near the other. Not for two boxes,
// whose separating axes are known. False: nothing is done.
bool CollidePart(PairFunction function, const PairQuery& query, Manifold& manifold) {
    const bool isA = query.a.Type() == ShapeType::Box;
    if (isA == (query.b.Type() == ShapeType::Box)) return false;
    const float reach = query.settings.speculativeDistance;
    BoxPart part;
    if (isA) {
        const Vector3& center = query.bInA.position;
        if (!part.Cut(static_cast<const Box&>(query.a), center, query.b.OuterRadius(), reach)) return false;
        const RelativePose bInPart{center - part.Offset(), query.bInA.rotation};
        function({part.Shape(), query.b, bInPart, query.settings, query.cache, query.counters}, manifold);
        for (int i = 0; i < manifold.pointCount; ++i) manifold.points[i].positionOnA += part.Offset();
        return true;
    }
    const Vector3 center = -InverseRotate(query.bInA.rotation, query.bInA.position);
    if (!part.Cut(static_cast<const Box&>(query.b), center, query.a.OuterRadius(), reach)) return false;
    const RelativePose partInA{Rotate(query.bInA.rotation, Vector3(part.Offset() - center)), query.bInA.rotation};
    function({query.a, part.Shape(), partInA, query.settings, query.cache, query.counters}, manifold);
    return true;
}

}  // namespace

void Collide(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters) {
    const DefaultFloats floats;
    const PairFunction function =
        settings.method == NarrowPhaseMethod::Libccd ? CollideLibccd : kPairTable.Of(a.Type(), b.Type());
    const PairQuery query{a, b, bInA, settings, cache, counters};
    if (!CollidePart(function, query, manifold)) function(query, manifold);
}

void Collide(const ConvexShape& a, const Plane& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters) {
    const DefaultFloats floats;
    if (settings.method == NarrowPhaseMethod::Libccd)
        CollideWithPlaneByLibccd(b, a, bInA, settings, cache, manifold, counters);
    else CollideWithPlane(b, a, bInA, settings, manifold);
}

}  // namespace fulcrum
