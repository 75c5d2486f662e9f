// The only interface to libccd, which finds by support functions, in double, whether two convex shapes overlap and how
// deep. Used for NarrowPhaseMethod::Libccd (contacts and queries), by tests that compare the engine's own functions
// with it, and as the last resort of queries if their own EPA fails. libccd allocates in EPA; thread-safe.
//
// Workarounds for its limitations:
// - It computes no distances. Shapes are rounded by a radius, so that shapes up to this far apart overlap, too.
// - It reports shapes as separated if its GJK degenerates. Only a separating axis counts as a proof; without one it is
//   asked again from another start.
// - Its EPA treats some deep overlaps as touching, or ends with a polytope that misses a part of the difference. Then
//   the depth it reports is less than that of its own direction, and it is asked again from another start. Where the
//   overlap is next to nothing, it may end with the opposite side: then another axis overlaps less.
// - Normals of rounded and curved shapes are those of flat facets: they are polished (ConvexContact.h), and the
//   separation is measured along them with the support functions; for overlapping shapes that is an upper bound of the
//   translation that separates them.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>

#include <optional>

namespace fulcrum {

enum class LibccdAlgorithm : uint8_t { Epa, Mpr };

struct LibccdResult {
    enum class Status { Apart, Found, Failed };
    Status status;
    Position normal;    // unit, from A towards B, in A's frame
    double separation;  // m along the normal, of the rounded shapes, <= margin
    Position position;  // m, a point in the contact region
};

// A single call of libccd, without workarounds. Each shape is its core, rounded by its convex radius and half of
// `margin` (m, >= 0): shapes up to `margin` apart then overlap, and margin less the depth is their separation.
LibccdResult LibccdPenetration(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, double margin,
                               LibccdAlgorithm algorithm);

// The contact of two shapes; none if the rounded shapes are farther apart than `reach` (m, >= 0, may be infinite).
// `bInA` is the pair's pose.
std::optional<KnownContact> FindLibccdContact(const SupportPair& pair, const RelativePose& bInA, float reach,
                                              CollideCounters& counters);

// Whether the rounded shapes are farther apart than `margin` (m, >= 0), and an axis that proves it. Allocates only if
// libccd's results are inconsistent.
struct LibccdVerdict {
    bool apart;
    Vector3 axis;  // unit, from A towards B; if apart
};
LibccdVerdict AskLibccd(const SupportPair& pair, const RelativePose& bInA, float margin);

}  // namespace fulcrum
