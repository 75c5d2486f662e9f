#include <Fulcrum/Collision/Shapes/HullBuilder.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fulcrum {
namespace {

constexpr int kNoIndex = -1;

// Merges the triangles of a hull into polygons for one tolerance. The result is checked: if it is no proper polyhedron
// the caller lowers the tolerance. At zero only exactly coplanar triangles are merged, which gives the exact polytope.
class Merger {
public:
    Merger(std::span<const Position> points, const TriangleHull& hull, double tolerance)
        : points_(points), hull_(hull), tolerance_(tolerance) {
        groupOf_.resize(hull.triangles.size());
        for (size_t t = 0; t < hull.triangles.size(); ++t) {
            groupOf_[t] = static_cast<int>(t);
            groups_.push_back({{static_cast<int>(t)}, hull.triangles[t].normal * hull.triangles[t].area});
        }
        MergeCoplanar();
        if (tolerance > 0) MergeNearlyCoplanar();
    }

    // False where the groups make no proper polyhedron.
    bool Trace(HullMesh& mesh);

private:
    struct Group {
        std::vector<int> triangles;
        Position areaNormal;
    };
    struct Seam {  // an edge between two triangles
        double height;
        int triangle, other;
    };
    using Loop = std::vector<int>;  // points, counter-clockwise

    void Merge(int a, int b);
    void MergeCoplanar();
    void MergeNearlyCoplanar();
    bool IsFlat(const Group& a, const Group& b) const;
    Loop Boundary(int group) const;
    bool IsConvex(const Loop& loop, const Position& normal) const;
    int Opposite(int triangle, int other) const;  // the corner of `other` that `triangle` does not have

    std::span<const Position> points_;
    const TriangleHull& hull_;
    double tolerance_;
    std::vector<int> groupOf_;
    std::vector<Group> groups_;
};

int Merger::Opposite(int triangle, int other) const {
    const TriangleHull::Triangle& t = hull_.triangles[other];
    for (int e = 0; e < 3; ++e)
        if (t.neighbor[e] == triangle) return t.corner[(e + 2) % 3];
    return kNoIndex;
}

void Merger::Merge(int a, int b) {
    if (a == b) return;
    if (groups_[a].triangles.size() < groups_[b].triangles.size()) std::swap(a, b);
    for (int t : groups_[b].triangles) groupOf_[t] = a;
    groups_[a].triangles.insert(groups_[a].triangles.end(), groups_[b].triangles.begin(), groups_[b].triangles.end());
    groups_[a].areaNormal += groups_[b].areaNormal;
    groups_[b].triangles.clear();
}

void Merger::MergeCoplanar() {
    const std::vector<Position>& grid = hull_.gridPoints;
    for (int t = 0; t < static_cast<int>(hull_.triangles.size()); ++t) {
        const TriangleHull::Triangle& triangle = hull_.triangles[t];
        for (int other : triangle.neighbor) {
            if (other < t) continue;
            const int* c = triangle.corner;
            if (ExactOrientation(grid[c[0]], grid[c[1]], grid[c[2]], grid[Opposite(t, other)]) == 0) {
                Merge(groupOf_[t], groupOf_[other]);
            }
        }
    }
}

// Flattest edges first, so that a face's large triangles merge before the slivers at its boundary.
void Merger::MergeNearlyCoplanar() {
    std::vector<Seam> seams;
    const auto height = [this](int t, int other) {
        const TriangleHull::Triangle& triangle = hull_.triangles[t];
        const Position d = hull_.gridPoints[Opposite(t, other)] - hull_.gridPoints[triangle.corner[0]];
        return std::fabs(Dot<double>(triangle.normal, d)) * hull_.gridStep;
    };
    for (int t = 0; t < static_cast<int>(hull_.triangles.size()); ++t) {
        for (int other : hull_.triangles[t].neighbor) {
            if (other < t || groupOf_[t] == groupOf_[other]) continue;
            // The smaller of both: a sliver's plane is no measure for the large triangle beside it.
            const double smaller = std::min(height(t, other), height(other, t));
            if (smaller <= tolerance_) seams.push_back({smaller, t, other});
        }
    }
    std::sort(seams.begin(), seams.end(), [](const Seam& a, const Seam& b) {
        if (a.height != b.height) return a.height < b.height;
        return a.triangle != b.triangle ? a.triangle < b.triangle : a.other < b.other;
    });
    for (const Seam& seam : seams) {
        const int a = groupOf_[seam.triangle], b = groupOf_[seam.other];
        if (a != b && IsFlat(groups_[a], groups_[b])) Merge(a, b);
    }
}

// Whether all corners of both groups lie within the tolerance of the plane that would support the hull there.
bool Merger::IsFlat(const Group& a, const Group& b) const {
    const Position sum = a.areaNormal + b.areaNormal;
    const Position normal = sum * (1 / std::sqrt(Dot<double>(sum, sum)));
    const Position origin = hull_.gridPoints[hull_.triangles[a.triangles[0]].corner[0]];
    const auto height = [&](int point) {
        return Dot<double>(normal, hull_.gridPoints[point] - origin) * hull_.gridStep;
    };
    double top = 0;
    for (int v : hull_.vertices) top = std::max(top, height(v));
    for (const Group* group : {&a, &b})
        for (int t : group->triangles)
            for (int corner : hull_.triangles[t].corner)
                if (!(top - height(corner) <= tolerance_)) return false;
    return true;
}

// The loop around a group; empty where there is more than one or it touches itself.
Merger::Loop Merger::Boundary(int group) const {
    std::vector<std::pair<int, int>> edges;
    for (int t : groups_[group].triangles) {
        const TriangleHull::Triangle& triangle = hull_.triangles[t];
        for (int e = 0; e < 3; ++e) {
            if (groupOf_[triangle.neighbor[e]] == group) continue;
            edges.emplace_back(triangle.corner[e], triangle.corner[(e + 1) % 3]);
        }
    }
    std::sort(edges.begin(), edges.end());
    for (size_t i = 1; i < edges.size(); ++i)
        if (edges[i].first == edges[i - 1].first) return {};
    Loop loop;
    if (edges.empty()) return loop;
    int at = edges[0].first;
    do {
        loop.push_back(at);
        at = std::lower_bound(edges.begin(), edges.end(), std::pair<int, int>(at, kNoIndex))->second;
    } while (at != edges[0].first);
    if (loop.size() != edges.size()) loop.clear();
    return loop;
}

// Whether no corner lies deeper than the tolerance inside the line of its neighbors.
bool Merger::IsConvex(const Loop& loop, const Position& normal) const {
    const size_t count = loop.size();
    for (size_t i = 0; i < count; ++i) {
        const Position& a = points_[loop[i]];
        const Position& b = points_[loop[(i + 1) % count]];
        const Position chord = points_[loop[(i + 2) % count]] - a;
        const double length = std::sqrt(Dot<double>(chord, chord));
        if (Dot<double>(normal, Cross<double>(b - a, chord)) < -tolerance_ * length) return false;
    }
    return true;
}

bool Merger::Trace(HullMesh& mesh) {
    std::vector<std::pair<Position, Loop>> loops;
    std::vector<int> degree(points_.size(), 0), newIndex(points_.size(), kNoIndex);
    for (size_t g = 0; g < groups_.size(); ++g) {
        if (groups_[g].triangles.empty()) continue;
        const Position& sum = groups_[g].areaNormal;
        loops.emplace_back(sum * (1 / std::sqrt(Dot<double>(sum, sum))), Boundary(static_cast<int>(g)));
        if (loops.back().second.empty()) return false;
        for (int v : loops.back().second) ++degree[v];
    }

    // A vertex of one group lies inside it, one of two groups on their common edge.
    for (int v : hull_.vertices) {
        if (degree[v] < 3) continue;
        newIndex[v] = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(points_[v]);
        mesh.sources.push_back(v);
    }
    for (auto& [normal, loop] : loops) {
        std::erase_if(loop, [&](int v) { return degree[v] < 3; });
        if (loop.size() < 3 || (tolerance_ > 0 && !IsConvex(loop, normal))) return false;
        HullMesh::Face face{{static_cast<int>(mesh.indices.size()), static_cast<int>(loop.size())},
                            normal,
                            -std::numeric_limits<double>::infinity()};
        for (const Position& v : mesh.vertices) face.offset = std::max(face.offset, Dot<double>(normal, v));
        for (int v : loop) mesh.indices.push_back(newIndex[v]);
        mesh.faces.push_back(face);
    }
    mesh.tolerance = hull_.tolerance;
    return IsClosedPolyhedron(mesh);
}

// The best polygons of a triangulated hull. Exactly coplanar groups always trace, so the loop ends with a mesh.
HullMesh MergedMesh(std::span<const Position> points, const TriangleHull& hull) {
    for (const double fraction : {1.0, 1.0 / 8, 1.0 / 64, 1.0 / 512, 0.0}) {
        HullMesh mesh;
        if (Merger(points, hull, hull.tolerance * fraction).Trace(mesh)) return mesh;
        FULCRUM_ASSERT(fraction > 0);
    }
    return {};
}

}  // namespace

SolidMass HullMesh::Mass() const {
    std::vector<PolygonRange> polygons;
    for (const Face& face : faces) polygons.push_back(face.corners);
    return PolyhedronMass(vertices, polygons, indices);
}

Result<HullMesh> BuildHull(std::span<const Position> points, const HullLimits& limits) {
    int maxVertices = limits.maxVertices;
    for (;;) {
        const Result<TriangleHull> hull = Quickhull(points, {maxVertices, limits.inputRounding});
        if (!hull) return hull.GetError();
        HullMesh mesh = MergedMesh(points, hull.Value());
        const int excess = static_cast<int>(mesh.faces.size()) - limits.maxFaces;
        if (excess <= 0) return mesh;
        // Each vertex adds at most two triangles. Terminates: 4 vertices have 4 faces.
        maxVertices = std::max(4, static_cast<int>(hull.Value().vertices.size()) - (excess + 1) / 2);
    }
}

bool IsClosedPolyhedron(const HullMesh& mesh) {
    struct HalfEdge {
        int low, high;  // vertices
        bool upwards;   // from low to high
        int left;       // face
    };
    std::vector<HalfEdge> halves;
    std::vector<int> degree(mesh.vertices.size(), 0);
    for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
        const PolygonRange& range = mesh.faces[f].corners;
        if (range.cornerCount < 3) return false;
        for (int i = 0; i < range.cornerCount; ++i) {
            const int from = mesh.indices[range.firstIndex + i];
            const int to = mesh.indices[range.firstIndex + (i + 1) % range.cornerCount];
            ++degree[from];
            halves.push_back({std::min(from, to), std::max(from, to), from < to, f});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
        if (a.low != b.low) return a.low < b.low;
        if (a.high != b.high) return a.high < b.high;
        return a.upwards != b.upwards ? a.upwards : a.left < b.left;
    });
    // An edge is two half edges, one each way.
    std::vector<std::pair<int, int>> facePairs;
    if (halves.size() % 2 != 0) return false;
    for (size_t i = 0; i < halves.size(); i += 2) {
        const HalfEdge &a = halves[i], &b = halves[i + 1];
        if (a.low != b.low || a.high != b.high || !a.upwards || b.upwards || a.left == b.left) return false;
        if (i >= 2 && halves[i - 2].low == a.low && halves[i - 2].high == a.high) return false;
        facePairs.emplace_back(std::min(a.left, b.left), std::max(a.left, b.left));
    }
    std::sort(facePairs.begin(), facePairs.end());
    if (std::adjacent_find(facePairs.begin(), facePairs.end()) != facePairs.end()) return false;
    return std::all_of(degree.begin(), degree.end(), [](int d) { return d >= 3; }) &&
           mesh.vertices.size() + mesh.faces.size() == facePairs.size() + 2;
}

}  // namespace fulcrum
