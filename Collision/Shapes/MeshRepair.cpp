#include <Fulcrum/Collision/Shapes/MeshRepair.h>

#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/SurfaceLimits.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace fulcrum {
namespace {

constexpr uint32_t kNone = ~0u;

uint64_t Mixed(uint64_t h, uint64_t x) {
    h = (h ^ x) * 0x9E3779B97F4A7C15u;
    return h ^ h >> 29;
}

// Hash table of ids with chaining; each chain from the latest to the first.
class HashChains {
public:
    explicit HashChains(size_t count)
        : heads_(std::bit_ceil(std::max<size_t>(count, 16)), kNone), next_(count, kNone), mask_(heads_.size() - 1) {}
    uint32_t First(uint64_t hash) const { return heads_[hash >> 20 & mask_]; }
    uint32_t Next(uint32_t id) const { return next_[id]; }
    void Insert(uint64_t hash, uint32_t id) {
        uint32_t& head = heads_[hash >> 20 & mask_];
        next_[id] = head;
        head = id;
    }

private:
    std::vector<uint32_t> heads_, next_;
    uint64_t mask_;
};

// Finds the earliest kept vertex within a distance. Kept vertices are farther apart than that, so that a cell of the
// hash grid, 16 distances wide, holds a bounded number of them whatever the input.
class Welder {
public:
    Welder(std::span<const Vector3> vertices, float distance)
        : vertices_(vertices),
          distance_(distance),
          cell_(std::max(16.0 * distance_, 1e-300)),
          chains_(vertices.size()) {}

    uint32_t FindOrInsert(uint32_t id) {
        const Position p = vertices_[id].cast<double>();
        double low[3], high[3];
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::floor((p[axis] - distance_) / cell_);
            high[axis] = std::floor((p[axis] + distance_) / cell_);
        }
        uint32_t found = kNone;
        for (int corner = 0; corner < 8; ++corner) {
            double cell[3];
            bool isNew = true;
            for (int axis = 0; axis < 3; ++axis) {
                const bool upper = (corner >> axis & 1) != 0;
                cell[axis] = upper ? high[axis] : low[axis];
                isNew &= !upper || high[axis] != low[axis];
            }
            if (isNew) found = std::min(found, FirstNear(p, Hash(cell)));
        }
        if (found != kNone) return found;
        const double own[3] = {std::floor(p.x() / cell_), std::floor(p.y() / cell_), std::floor(p.z() / cell_)};
        chains_.Insert(Hash(own), id);
        return id;
    }

private:
    static uint64_t Hash(const double (&cell)[3]) {
        uint64_t h = 1;
        for (const double c : cell) h = Mixed(h, std::bit_cast<uint64_t>(c + 0.0));  // of both zeros
        return h;
    }
    uint32_t FirstNear(const Position& p, uint64_t hash) const {
        uint32_t found = kNone;
        for (uint32_t i = chains_.First(hash); i != kNone; i = chains_.Next(i)) {
            const Position d = vertices_[i].cast<double>() - p;
            if (Dot(d, d) <= distance_ * distance_) found = std::min(found, i);
        }
        return found;
    }

    std::span<const Vector3> vertices_;
    double distance_, cell_;
    HashChains chains_;
};

Status CheckInput(std::span<const Vector3> vertices, std::span<const uint32_t> indices) {
    if (indices.size() % 3 != 0) {
        return Error{ErrorCode::Degenerate,
                     Message("%zu indices: their number must be a multiple of 3", indices.size())};
    }
    if (vertices.size() >= kNone || indices.size() / 3 > kMostTriangles) {
        return Error{ErrorCode::OutOfRange, Message("%zu vertices and %zu triangles: at most 2^27 triangles",
                                                    vertices.size(), indices.size() / 3)};
    }
    for (size_t i = 0; i < vertices.size(); ++i) {
        const Vector3& v = vertices[i];
        if (!IsFinite(v)) {
            return Error{ErrorCode::NonFinite, Message("vertex %zu is (%g, %g, %g): it must be finite", i,
                                                       double{v.x()}, double{v.y()}, double{v.z()})};
        }
        if (!(v.cwiseAbs().maxCoeff() <= kLargestCoordinate)) {
            return Error{ErrorCode::OutOfRange, Message("vertex %zu is (%g, %g, %g): at most %g m", i, double{v.x()},
                                                        double{v.y()}, double{v.z()}, double{kLargestCoordinate})};
        }
    }
    for (size_t i = 0; i < indices.size(); ++i) {
        if (indices[i] < vertices.size()) continue;
        return Error{ErrorCode::OutOfRange,
                     Message("index %u of triangle %zu: there are %zu vertices", indices[i], i / 3, vertices.size())};
    }
    return Done{};
}

// The corners rotated so that the smallest comes first: equal for equal triangles of the same orientation.
struct Corners {
    uint32_t a, b, c;
    bool operator==(const Corners&) const = default;
};
Corners Canonical(const uint32_t* t) {
    const int first = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
    return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

}  // namespace

bool HasArea(const Vector3& a, const Vector3& b, const Vector3& c, double weldDistance) {
    const DefaultFloats floats;
    const Position p = a.cast<double>(), u = b.cast<double>() - p, v = c.cast<double>() - p, w = v - u;
    const Position cross = Cross(u, v);
    const double longest = std::sqrt(std::max({Dot(u, u), Dot(v, v), Dot(w, w)}));
    return std::sqrt(Dot(cross, cross)) > longest * std::max(weldDistance, kThinnestTriangle * longest);
}

Result<RepairedMesh> RepairMesh(std::span<const Vector3> vertices, std::span<const uint32_t> indices,
                                float weldDistance, MeshReport& report) {
    const DefaultFloats floats;
    report = {};
    if (const Status status = CheckInput(vertices, indices); !status) return status.GetError();

    std::vector<uint32_t> kept(vertices.size());
    Welder welder(vertices, weldDistance);
    for (uint32_t i = 0; i < vertices.size(); ++i) {
        kept[i] = welder.FindOrInsert(i);
        if (kept[i] != i) report.weldedVertices.Add(i);
    }

    RepairedMesh mesh;
    const uint32_t count = static_cast<uint32_t>(indices.size() / 3);
    mesh.indices.reserve(indices.size());
    mesh.sources.reserve(count);
    HashChains chains(count);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t t[3] = {kept[indices[3 * i]], kept[indices[3 * i + 1]], kept[indices[3 * i + 2]]};
        if (!HasArea(vertices[t[0]], vertices[t[1]], vertices[t[2]], double{weldDistance})) {
            report.degenerateTriangles.Add(i);
            continue;
        }
        const Corners corners = Canonical(t);
        const uint64_t hash = Mixed(Mixed(Mixed(1, corners.a), corners.b), corners.c);
        uint32_t other = chains.First(hash);
        while (other != kNone && Canonical(&mesh.indices[3 * other]) != corners) other = chains.Next(other);
        if (other != kNone) {
            report.duplicateTriangles.Add(i);
            continue;
        }
        chains.Insert(hash, static_cast<uint32_t>(mesh.sources.size()));
        mesh.indices.insert(mesh.indices.end(), t, t + 3);
        mesh.sources.push_back(i);
    }
    if (mesh.sources.empty()) {
        return Error{ErrorCode::Degenerate,
                     Message("no triangle is left of %u: %u have no area", count, report.degenerateTriangles.count)};
    }

    std::vector<uint32_t> newIds(vertices.size(), kNone);
    for (const uint32_t i : mesh.indices) newIds[i] = 0;
    for (uint32_t i = 0; i < vertices.size(); ++i) {
        if (newIds[i] == kNone) {
            if (kept[i] == i) report.unusedVertices.Add(i);
            continue;
        }
        newIds[i] = static_cast<uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(vertices[i] + Vector3::Zero());  // no negative zeros
    }
    for (uint32_t& i : mesh.indices) i = newIds[i];
    return mesh;
}

}  // namespace fulcrum
