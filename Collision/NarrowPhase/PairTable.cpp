// The pair table: which function serves which two shapes.
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>

#include <array>
#include <iterator>

namespace fulcrum {

namespace {

// Serves (a, b) with a function written for (b, a): the same contact seen from the other side. The cache is always used
// the same way round, so that it needs no flip.
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

using PairRow = std::array<PairFunction, kConvexShapeTypes>;

template <PairFunction... Functions>
constexpr PairRow Row() {
    static_assert(sizeof...(Functions) == kConvexShapeTypes, "every convex shape needs a column in the pair table");
    return {Functions...};
}

constexpr PairFunction kFlipped = Flip<CollidePolyhedra>;

constexpr PairFunction kPolyhedra = CollidePolyhedra, kConvex = CollideConvex, kTurned = Flip<CollideConvex>;

// By the type of A down and of B across. CollideConvex serves any two shapes; a pair is always passed to it
// the same way round, so that it makes no difference which shape is A.
// clang-format off
constexpr PairRow kPairTable[] = {
    //                    Sphere, Box, Capsule, ConvexHull, Triangle, then those with curved cores:
    //                    TaperedCapsule, Cylinder, Custom
    /* Sphere         */ Row<CollideSphereSphere, Flip<CollideBoxSphere>, Flip<CollideCapsuleSphere>, kFlipped, kFlipped,
                             kConvex, kConvex, kConvex>(),
    /* Box            */ Row<CollideBoxSphere, CollideBoxBox, kPolyhedra, kFlipped, kPolyhedra,
                             kConvex, kConvex, kConvex>(),
    /* Capsule        */ Row<CollideCapsuleSphere, kFlipped, CollideCapsuleCapsule, kFlipped, kFlipped,
                             kConvex, kConvex, kConvex>(),
    /* ConvexHull     */ Row<kPolyhedra, kPolyhedra, kPolyhedra, kPolyhedra, kPolyhedra,
                             kConvex, kConvex, kConvex>(),
    /* Triangle       */ Row<kPolyhedra, kPolyhedra, kPolyhedra, kPolyhedra, kPolyhedra,
                             kConvex, kConvex, kConvex>(),
    /* TaperedCapsule */ Row<kTurned, kTurned, kTurned, kTurned, kTurned, kConvex, kConvex, kConvex>(),
    /* Cylinder       */ Row<kTurned, kTurned, kTurned, kTurned, kTurned, kTurned, kConvex, kConvex>(),
    /* Custom         */ Row<kTurned, kTurned, kTurned, kTurned, kTurned, kTurned, kTurned, kConvex>(),
};
// clang-format on
static_assert(std::size(kPairTable) == kConvexShapeTypes, "every convex shape needs a row in the pair table");

}  // namespace

void Collide(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters) {
    const PairFunction function = settings.method == NarrowPhaseMethod::Libccd
                                      ? CollideLibccd
                                      : kPairTable[static_cast<int>(a.Type())][static_cast<int>(b.Type())];
    function({a, b, bInA, settings, cache, counters}, manifold);
}

}  // namespace fulcrum
