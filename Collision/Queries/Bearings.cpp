#include <Fulcrum/Collision/Queries/Bearings.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace fulcrum {

namespace {

// Planes in the same cell count as one: those of the triangles of one floor, which differ by rounding.
constexpr float kNormalCell = 1e-5f, kHeightCell = 1e-5f;  // of unit length; m

template <class Plane>
auto CellOf(const Plane& plane) {
    const auto cell = [](float x, float size) { return std::floor(double{x} / double{size} + 0.5); };
    return std::tuple(cell(plane.normal.x(), kNormalCell), cell(plane.normal.y(), kNormalCell),
                      cell(plane.normal.z(), kNormalCell), cell(plane.height, kHeightCell));
}

template <class Planes>
Planes& Kept() {
    thread_local Planes planes;
    return planes;
}

}  // namespace

// Moved out while in use, because callbacks of a query may run queries, too.
Bearings::Bearings() : planes_(std::move(Kept<std::vector<Plane>>())) { planes_.clear(); }
Bearings::~Bearings() { Kept<std::vector<Plane>>() = std::move(planes_); }

void Bearings::Add(const Vector3& normal, float height) { planes_.push_back({normal, height}); }

void Bearings::Merge() {
    const auto keyOf = [](const Plane& p) {
        return std::tuple(CellOf(p), p.height, p.normal.x(), p.normal.y(), p.normal.z());
    };
    std::sort(planes_.begin(), planes_.end(), [&](const Plane& a, const Plane& b) { return keyOf(b) < keyOf(a); });
    planes_.erase(std::unique(planes_.begin(), planes_.end(),
                              [](const Plane& a, const Plane& b) { return CellOf(a) == CellOf(b); }),
                  planes_.end());
}

bool Bearings::Hide(const ConvexShape& shape, const Pose& pose, float flush) const {
    return std::any_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
        const Vector3 along = InverseRotate(pose.rotation, plane.normal);
        const double height = Dot<double>(plane.normal.cast<double>(), pose.position) +
                              double{Dot(along, shape.Support(along))} - double{plane.height};
        return height <= double{flush};
    });
}

}  // namespace fulcrum
