#include <Fulcrum/Collision/Shapes/MeshEdges.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

// An edge of a triangle, stored with the smaller of its vertices.
struct EdgeEntry {
    uint32_t other;  // the larger vertex
    uint32_t triangle;
    uint8_t edge;    // 0 .. 2
    bool isUpwards;  // runs from the smaller vertex to the larger

    bool operator<(const EdgeEntry& e) const {
        return other != e.other ? other < e.other : triangle != e.triangle ? triangle < e.triangle : edge < e.edge;
    }
};

class EdgeFinder {
public:
    EdgeFinder(const MeshTree& tree, const Vector3& scale, float cosine, bool isTwoSided)
        : tree_(tree),
          scale_(scale.cast<double>()),
          cosine_(cosine),
          isTwoSided_(isTwoSided),
          isMirrored_((scale.x() < 0) != ((scale.y() < 0) != (scale.z() < 0))) {}

    MeshEdges Find() {
        result_.active.assign(tree_.triangleCount, 0);
        FileEdges();
        for (size_t vertex = 0; vertex + 1 < starts_.size(); ++vertex) {
            const auto begin = entries_.begin() + starts_[vertex], end = entries_.begin() + starts_[vertex + 1];
            std::sort(begin, end);
            for (auto first = begin; first != end;) {
                auto last = first + 1;
                while (last != end && last->other == first->other) ++last;
                Judge({&*first, static_cast<size_t>(last - first)});
                first = last;
            }
        }
        return std::move(result_);
    }

private:
    void Corners(uint32_t triangle, uint32_t (&ids)[3]) const {
        tree_.CornersOf(triangle, ids);
        if (isMirrored_) std::swap(ids[1], ids[2]);
    }

    // Sorts all edges by their smaller vertex, by counting.
    void FileEdges() {
        starts_.assign(size_t{tree_.VertexCount()} + 1, 0);
        entries_.resize(3 * size_t{tree_.triangleCount});
        uint32_t ids[3];
        for (int pass = 0; pass < 2; ++pass) {
            for (uint32_t t = 0; t < tree_.triangleCount; ++t) {
                Corners(t, ids);
                for (int i = 0; i < 3; ++i) {
                    const uint32_t a = ids[i], b = ids[(i + 1) % 3];
                    if (pass == 0) ++starts_[std::min(a, b)];
                    else entries_[--starts_[std::min(a, b)]] = {std::max(a, b), t, static_cast<uint8_t>(i), a < b};
                }
            }
            if (pass == 1) break;
            uint32_t sum = 0;
            for (uint32_t& start : starts_) start = sum += start;  // ends, which pass 1 moves to the beginnings
        }
    }

    Position At(uint32_t vertex) const { return tree_.vertices[vertex].cast<double>().cwiseProduct(scale_); }

    void Judge(std::span<const EdgeEntry> edge) {
        if (edge.size() == 1) ++result_.boundaryEdges;
        else if (edge.size() > 2 || edge[0].isUpwards == edge[1].isUpwards) ++result_.irregularEdges;
        else if (!IsActive(edge[0], edge[1])) return;
        for (const EdgeEntry& e : edge) result_.active[e.triangle] |= static_cast<uint8_t>(1u << e.edge);
    }

    bool IsActive(const EdgeEntry& a, const EdgeEntry& b) const {
        uint32_t idsA[3], idsB[3];
        Corners(a.triangle, idsA);
        Corners(b.triangle, idsB);
        const Position normalA = Normal(idsA), normalB = Normal(idsB);
        const double lengths = std::sqrt(Dot(normalA, normalA) * Dot(normalB, normalB));
        if (!(Dot(normalA, normalB) < double{cosine_} * lengths)) return false;
        // Convex where the far corner of b lies behind a; or in its plane, folded back.
        const Position across = At(idsB[(b.edge + 2) % 3]) - At(idsA[a.edge]);
        return isTwoSided_ || Dot(normalA, across) <= 0;
    }

    Position Normal(const uint32_t (&ids)[3]) const {
        const Position a = At(ids[0]);
        return Cross<double>(At(ids[1]) - a, At(ids[2]) - a);
    }

    const MeshTree& tree_;
    Position scale_;
    float cosine_;
    bool isTwoSided_, isMirrored_;
    std::vector<uint32_t> starts_;
    std::vector<EdgeEntry> entries_;
    MeshEdges result_;
};

}  // namespace

MeshEdges FindActiveEdges(const MeshTree& tree, const Vector3& scale, float cosine, bool isTwoSided) {
    return EdgeFinder(tree, scale, cosine, isTwoSided).Find();
}

}  // namespace fulcrum
