#include <Fulcrum/Collision/Shapes/Quickhull.h>

#include <Fulcrum/Collision/Shapes/Message.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {
namespace {

__extension__ typedef __int128 Int128;

struct Integer3 {
    Int128 x, y, z;
};

Integer3 Difference(const Position& a, const Position& b) {
    const auto whole = [](double v) { return Int128{static_cast<int64_t>(v)}; };
    return {whole(a.x()) - whole(b.x()), whole(a.y()) - whole(b.y()), whole(a.z()) - whole(b.z())};
}

// Differences have 42 bits, components of the product 84, the determinant with a third difference 128 less sign.
Integer3 IntegerCross(const Integer3& a, const Integer3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Distances below this many grid steps are decided in integers. Rounding of a distance in double: the unit normal, the
// products and the sums lose at most 8 units of 2^-53 of |p - a| <= sqrt(3) 2^41 steps, 0.004 steps.
constexpr double kUncertain = 0.01;
constexpr int kNoIndex = -1;

class Builder {
public:
    Builder(std::span<const Position> points, const QuickhullSettings& settings) : settings_(settings) {
        Rasterize(points);
    }

    Result<TriangleHull> Build() {
        if (hull_.gridPoints.size() < 4) {
            return Error{ErrorCode::Degenerate,
                         Message("%zu points: a hull needs at least 4 that span a volume", hull_.gridPoints.size())};
        }
        if (const Status status = StartWithTetrahedron(); !status) return status.GetError();
        do {
            while (static_cast<int>(hull_.vertices.size()) < settings_.maxVertices && Grow()) {}
        } while (static_cast<int>(hull_.vertices.size()) < settings_.maxVertices && FindForgottenPoints());
        Finish();
        return std::move(hull_);
    }

private:
    struct Face {
        TriangleHull::Triangle triangle;
        int firstPoint = kNoIndex;  // linked list of points outside this face, by nextPoint_
        int farthestPoint = kNoIndex;
        bool alive = false;
        bool visible = false;  // from the point that is being added
    };
    struct HorizonEdge {
        int from, to, outside;  // `outside` is the face that stays
    };

    void Rasterize(std::span<const Position> points) {
        Position lower = Position::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
        Position largest = Position::Zero();
        for (const Position& p : points) {
            lower = lower.cwiseMin(p);
            upper = upper.cwiseMax(p);
            largest = largest.cwiseMax(p.cwiseAbs());
        }
        if (points.empty()) return;
        const Position extent = upper - lower, center = lower + extent * 0.5;
        // frexp and ldexp are exact: the scale is a power of two with extent * scale <= 2^41.
        int exponent = 0;
        std::frexp(extent.maxCoeff(), &exponent);
        const double scale = std::ldexp(1.0, 41 - exponent);
        hull_.gridStep = 1 / scale;
        noise_ = 4 * settings_.inputRounding * (largest.x() + largest.y() + largest.z()) * scale;
        hull_.gridPoints.reserve(points.size());
        for (const Position& p : points) {
            const Position g = (p - center) * scale;
            hull_.gridPoints.push_back(
                Position(std::floor(g.x() + 0.5), std::floor(g.y() + 0.5), std::floor(g.z() + 0.5)));
        }
        nextPoint_.assign(points.size(), kNoIndex);
        newFaceFrom_.assign(points.size(), kNoIndex);
    }

    const Position& Point(int i) const { return hull_.gridPoints[i]; }
    double Distance(const Face& face, int point) const {
        return Dot<double>(face.triangle.normal, Point(point) - Point(face.triangle.corner[0]));
    }
    bool Sees(int point, const Face& face) const {
        const double distance = Distance(face, point);
        if (std::fabs(distance) > kUncertain) return distance > 0;
        const int* c = face.triangle.corner;
        return ExactOrientation(Point(c[0]), Point(c[1]), Point(c[2]), Point(point)) > 0;
    }

    // The point where measure is largest, the first of equals.
    template <class Measure>
    int Farthest(Measure measure, double& largest) const {
        int best = 0;
        largest = -1;
        for (int i = 0; i < static_cast<int>(hull_.gridPoints.size()); ++i) {
            const double m = measure(Point(i));
            if (m > largest) {
                largest = m;
                best = i;
            }
        }
        return best;
    }

    // Two far points, the point farthest from their line, the point farthest from their plane.
    Status StartWithTetrahedron();
    int AddFace(int a, int b, int c);
    void Offer(int point, std::span<const int> faces);
    bool Grow();
    void CollectVisible(int face, int eye);
    bool FindForgottenPoints();
    void Finish();

    QuickhullSettings settings_;
    TriangleHull hull_;
    double noise_ = 0;      // grid steps: by how much the input's rounding may move a point
    double tolerance_ = 0;  // grid steps
    std::vector<Face> faces_;
    std::vector<double> farthestDistance_;  // of each face; apart, because all are scanned for each new vertex
    std::vector<int> freeFaces_, nextPoint_, newFaceFrom_, visible_, newFaces_;
    std::vector<HorizonEdge> horizon_;
};

Status Builder::StartWithTetrahedron() {
    const double meters = hull_.gridStep, least = std::max(noise_, 4.0);
    const size_t count = hull_.gridPoints.size();
    // Of the extreme points along the axes, the two that lie farthest apart.
    int extremes[6], a = 0, b = 0;
    double length = -1, unused;
    for (int axis = 0; axis < 3; ++axis) {
        // Offset by 2^41, so that the measure is positive.
        extremes[2 * axis] = Farthest([axis](const Position& p) { return 0x1p41 + p[axis]; }, unused);
        extremes[2 * axis + 1] = Farthest([axis](const Position& p) { return 0x1p41 - p[axis]; }, unused);
    }
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < i; ++j) {
            const Position d = Point(extremes[i]) - Point(extremes[j]);
            const double squared = Dot<double>(d, d);
            if (squared > length) {
                length = squared;
                a = extremes[j];
                b = extremes[i];
            }
        }
    }
    length = std::sqrt(length);
    if (!(length > least)) {
        return Error{ErrorCode::Degenerate, Message("the %zu points coincide: they span %g m, at least %g m is needed",
                                                    count, length * meters, least * meters)};
    }

    const Position origin = Point(a), along = (Point(b) - origin) * (1 / length);
    double width;
    const int c = Farthest(
        [&](const Position& p) {
            const Position cross = Cross<double>(along, p - origin);
            return Dot<double>(cross, cross);
        },
        width);
    width = std::sqrt(width);
    if (!(width > least)) {
        return Error{ErrorCode::Degenerate,
                     Message("the %zu points are collinear: within %g m of a line, at least %g m is needed", count,
                             width * meters, least * meters)};
    }

    const Position cross = ExactNormal(origin, Point(b), Point(c));
    const Position normal = cross * (1 / std::sqrt(Dot<double>(cross, cross)));
    double height;
    const int d = Farthest([&](const Position& p) { return std::fabs(Dot<double>(normal, p - origin)); }, height);
    if (!(height > least)) {
        return Error{ErrorCode::Degenerate,
                     Message("the %zu points are coplanar: within %g m of a plane, at least %g m is needed", count,
                             height * meters, least * meters)};
    }

    // Never below a grid step, so that points farther out are outside beyond doubt.
    tolerance_ = std::max(std::min(0.75 * noise_, 1e-3 * height), 1.0);
    hull_.thickness = height * meters;
    const bool above = ExactOrientation(origin, Point(b), Point(c), Point(d)) > 0;
    const int v[4] = {a, above ? c : b, above ? b : c, d};  // v[3] below the plane of v[0], v[1], v[2]
    hull_.vertices.assign(v, v + 4);
    const int start[4] = {AddFace(v[0], v[1], v[2]), AddFace(v[0], v[3], v[1]), AddFace(v[1], v[3], v[2]),
                          AddFace(v[2], v[3], v[0])};
    const int neighbors[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
    for (int f = 0; f < 4; ++f)
        for (int e = 0; e < 3; ++e) faces_[start[f]].triangle.neighbor[e] = start[neighbors[f][e]];
    for (int i = 0; i < static_cast<int>(count); ++i) Offer(i, start);
    return Done{};
}

int Builder::AddFace(int a, int b, int c) {
    int slot = static_cast<int>(faces_.size());
    if (!freeFaces_.empty()) {
        slot = freeFaces_.back();
        freeFaces_.pop_back();
    } else {
        faces_.emplace_back();
        farthestDistance_.push_back(0);
    }
    const Position normal = ExactNormal(Point(a), Point(b), Point(c));
    const double area = std::sqrt(Dot<double>(normal, normal));
    FULCRUM_ASSERT(area > 0);
    Face& face = faces_[slot];
    face = Face{};
    face.triangle = {{a, b, c}, {kNoIndex, kNoIndex, kNoIndex}, normal * (1 / area), area};
    face.alive = true;
    farthestDistance_[slot] = 0;
    return slot;
}

// Puts the point on the list of the face that it lies farthest outside of; drops it where it is outside of none.
void Builder::Offer(int point, std::span<const int> faces) {
    double distance = tolerance_;
    int best = kNoIndex;
    for (int f : faces) {
        const double d = Distance(faces_[f], point);
        if (d > distance) {
            distance = d;
            best = f;
        }
    }
    if (best == kNoIndex) return;
    Face& face = faces_[best];
    nextPoint_[point] = face.firstPoint;
    face.firstPoint = point;
    if (distance > farthestDistance_[best]) {
        farthestDistance_[best] = distance;
        face.farthestPoint = point;
    }
}

// The faces that `eye` sees, from one of them, and the loop of edges around them. They are one disc: the polytope is
// convex and its planes are exact, so the visible normals at any vertex are neighbors of one another.
void Builder::CollectVisible(int face, int eye) {
    visible_.assign(1, face);
    horizon_.clear();
    faces_[face].visible = true;
    for (size_t i = 0; i < visible_.size(); ++i) {
        const TriangleHull::Triangle& triangle = faces_[visible_[i]].triangle;
        for (int e = 0; e < 3; ++e) {
            const int other = triangle.neighbor[e];
            if (faces_[other].visible) continue;
            if (Sees(eye, faces_[other])) {
                faces_[other].visible = true;
                visible_.push_back(other);
            } else {
                horizon_.push_back({triangle.corner[e], triangle.corner[(e + 1) % 3], other});
            }
        }
    }
}

// Adds the point that lies farthest outside. False where none does.
bool Builder::Grow() {
    const auto farthest = std::max_element(farthestDistance_.begin(), farthestDistance_.end());
    if (*farthest <= 0) return false;
    const int face = static_cast<int>(farthest - farthestDistance_.begin());
    const int eye = faces_[face].farthestPoint;
    CollectVisible(face, eye);
    hull_.vertices.push_back(eye);

    newFaces_.clear();
    for (const HorizonEdge& edge : horizon_) {
        const int added = AddFace(edge.from, edge.to, eye);
        newFaces_.push_back(added);
        newFaceFrom_[edge.from] = added;
        faces_[added].triangle.neighbor[0] = edge.outside;
        TriangleHull::Triangle& outside = faces_[edge.outside].triangle;
        for (int e = 0; e < 3; ++e)
            if (outside.corner[e] == edge.to && outside.corner[(e + 1) % 3] == edge.from) outside.neighbor[e] = added;
    }
    for (int added : newFaces_) {
        TriangleHull::Triangle& triangle = faces_[added].triangle;
        const int next = newFaceFrom_[triangle.corner[1]];
        triangle.neighbor[1] = next;
        faces_[next].triangle.neighbor[2] = added;
    }
    for (int gone : visible_) {
        faces_[gone].alive = false;
        farthestDistance_[gone] = 0;
        for (int point = faces_[gone].firstPoint; point != kNoIndex;) {
            const int next = nextPoint_[point];
            if (point != eye) Offer(point, newFaces_);
            point = next;
        }
    }
    freeFaces_.insert(freeFaces_.end(), visible_.begin(), visible_.end());
    return true;
}

// A point that was within the tolerance of all faces, and dropped, may be outside a face that was added later. Finds
// such points. Terminates, because each round adds a vertex.
bool Builder::FindForgottenPoints() {
    newFaces_.clear();
    for (int f = 0; f < static_cast<int>(faces_.size()); ++f)
        if (faces_[f].alive) newFaces_.push_back(f);
    for (int i = 0; i < static_cast<int>(hull_.gridPoints.size()); ++i) Offer(i, newFaces_);
    return *std::max_element(farthestDistance_.begin(), farthestDistance_.end()) > 0;
}

void Builder::Finish() {
    std::vector<int> newIndex(faces_.size(), kNoIndex);
    for (size_t f = 0; f < faces_.size(); ++f) {
        if (!faces_[f].alive) continue;
        newIndex[f] = static_cast<int>(hull_.triangles.size());
        hull_.triangles.push_back(faces_[f].triangle);
    }
    for (TriangleHull::Triangle& triangle : hull_.triangles)
        for (int& neighbor : triangle.neighbor) neighbor = newIndex[neighbor];
    hull_.tolerance = tolerance_ * hull_.gridStep;
}

}  // namespace

int ExactOrientation(const Position& a, const Position& b, const Position& c, const Position& d) {
    const Integer3 normal = IntegerCross(Difference(b, a), Difference(c, a)), e = Difference(d, a);
    const Int128 determinant = normal.x * e.x + normal.y * e.y + normal.z * e.z;
    return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
}

Position ExactNormal(const Position& a, const Position& b, const Position& c) {
    const Integer3 normal = IntegerCross(Difference(b, a), Difference(c, a));
    return Position(static_cast<double>(normal.x), static_cast<double>(normal.y), static_cast<double>(normal.z));
}

Result<TriangleHull> Quickhull(std::span<const Position> points, const QuickhullSettings& settings) {
    return Builder(points, settings).Build();
}

}  // namespace fulcrum
