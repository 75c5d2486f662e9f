#include <Fulcrum/Samples/Scenes/Drawing.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Trigonometry.h>

namespace fulcrum {
namespace {

constexpr int kSilhouetteCorners = 32;

// Visits the edges of a box of the half extents given: corners differ in one bit.
template <class Visit>
void VisitBoxEdges(const Vector3& half, const Visit& visit) {
    const auto corner = [&](int bits) {
        return Vector3(bits & 1 ? half.x() : -half.x(), bits & 2 ? half.y() : -half.y(),
                       bits & 4 ? half.z() : -half.z());
    };
    for (int bits = 0; bits < 8; ++bits)
        for (int axis = 1; axis < 8; axis *= 2)
            if (!(bits & axis)) visit(corner(bits), corner(bits | axis));
}

}  // namespace

void Drawing::Box(const Position& lower, const Position& upper, Ink ink) {
    if (!isOn_) return;
    const Position center = 0.5 * (lower + upper);
    VisitBoxEdges((0.5 * (upper - lower)).cast<float>(), [&](const Vector3& from, const Vector3& to) {
        Line(center + from.cast<double>(), center + to.cast<double>(), ink);
    });
}

void Drawing::Outline(const ConvexShape& shape, const Pose& pose, Ink ink) {
    if (!isOn_) return;
    const Vector3 center = shape.Mass().centerOfMass;
    const auto line = [&](const Vector3& from, const Vector3& to) {
        Line(pose.Transform(center + from), pose.Transform(center + to), ink);
    };
    if (const auto* box = dynamic_cast<const fulcrum::Box*>(&shape)) {
        VisitBoxEdges(box->HalfExtents(), line);
    } else if (const auto* hull = dynamic_cast<const ConvexHull*>(&shape)) {
        for (const ConvexHull::Edge& edge : hull->Edges()) line(hull->Vertices()[edge.from], hull->Vertices()[edge.to]);
    } else {
        for (int axis = 0; axis < 3; ++axis) {
            const auto corner = [&](int i) {
                const double angle = 2 * 3.14159265358979323846 * i / kSilhouetteCorners;
                Vector3 direction = Vector3::Zero();
                direction[(axis + 1) % 3] = static_cast<float>(Cos(angle));
                direction[(axis + 2) % 3] = static_cast<float>(Sin(angle));
                return shape.Support(direction);
            };
            Vector3 last = corner(0);
            for (int i = 1; i <= kSilhouetteCorners; ++i) {
                const Vector3 next = corner(i);
                line(last, next);
                last = next;
            }
        }
    }
}

}  // namespace fulcrum
