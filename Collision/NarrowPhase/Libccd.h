// The only interface to libccd, which finds by support functions, in double, whether two convex shapes overlap and how
// deep. It serves NarrowPhaseMethod::Libccd, contacts and queries; the tests compare the engine's own functions with
// it; and the queries ask it last where their own EPA gives up. libccd allocates in EPA; thread-safe.
//
// What it can not do is made good here:
// - It computes no distances. Shapes are given a rounding, so that those up to as far apart overlap, too.
// - It calls shapes apart where its GJK degenerates. Only an axis that separates them counts as a proof; without one it
//   is asked again from another start.
// - Its EPA takes some deep overlaps for touching ones, or ends with a polytope that misses a part of the difference.
//   Then the depth it reports is less than that of its own direction, and it is asked again from another start. Where
//   the overlap is next to nothing, it may end with the opposite side: then another axis overlaps less.
// - The normals of rounded and curved shapes are those of flat facets: they are polished (ConvexContact.h), and the
//   separation is measured along them by the supports, which for overlapping shapes is a bound: no more is needed to
//   part the two.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>

#include <optional>

namespace fulcrum {

enum class LibccdAlgorithm : uint8_t { Epa, Mpr };

struct LibccdResult {
    enum class Status { Apart, Found, Failed };
    Status status;
    Position normal;    // unit, from A towards B, in A's frame
    double separation;  // m along the normal, of the whole shapes, <= margin
    Position position;  // m, somewhere where they touch
};

// libccd's own answer, once and as it is. Each shape is its core, rounded by its convex radius and half of `margin` (m,
// >= 0): shapes up to `margin` apart then overlap, and margin less the depth is their separation.
LibccdResult LibccdPenetration(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, double margin,
                               LibccdAlgorithm algorithm);

// Where two shapes touch; none: the whole shapes are farther apart than `reach` (m, >= 0, may be infinite). `bInA` is
// the pair's pose.
std::optional<KnownContact> FindLibccdContact(const SupportPair& pair, const RelativePose& bInA, float reach,
                                              CollideCounters& counters);

// Whether the whole shapes are farther apart than `margin` (m, >= 0), and an axis that proves it. Allocates nothing
// but where libccd contradicts itself.
struct LibccdVerdict {
    bool apart;
    Vector3 axis;  // unit, from A towards B; where apart
};
LibccdVerdict AskLibccd(const SupportPair& pair, const RelativePose& bInA, float margin);

}  // namespace fulcrum
