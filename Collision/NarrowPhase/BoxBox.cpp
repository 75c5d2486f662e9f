#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
namespace fulcrum {
void CollideBoxBox(const PairQuery& query, Manifold& manifold) { CollidePolyhedra(query, manifold); }
}
