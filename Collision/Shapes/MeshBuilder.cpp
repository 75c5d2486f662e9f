#include <Fulcrum/Collision/Shapes/MeshBuilder.h>

#include <Fulcrum/Collision/Shapes/MeshSplit.h>

#include <algorithm>

namespace fulcrum {
namespace {

constexpr uint32_t kNoNode = ~0u;
constexpr int kWidth = MeshNode::kWidth;
constexpr uint32_t kLeaf = MeshNode::kMaxLeaf;
constexpr uint32_t kBottom = kWidth * kLeaf;  // triangles that fit a node whose children are leaves
constexpr uint32_t kTask = 4096;              // subtrees of fewer triangles are one job
constexpr int kFreeDepth = 18;                // deeper sets are halved, which bounds the depth

struct DraftNode {
    struct Child {
        BoxSet set;
        uint32_t node = kNoNode;  // in the same list; none: a leaf, or the root of a task's list
        uint32_t task = kNoNode;
    };
    Child children[kWidth];
    int childCount = 0;
};
using DraftNodes = std::vector<DraftNode>;

struct Task {
    BoxSet set;
    int depth;
    DraftNodes nodes;
};

class Builder {
public:
    Builder(const RepairedMesh& mesh, std::span<const uint8_t> materials, bool keepSources,
            const ParallelLoop& parallel)
        : mesh_(mesh), materials_(materials), keepSources_(keepSources), parallel_(parallel) {}

    MeshTree Build() {
        FillBoxes();
        const uint32_t count = static_cast<uint32_t>(boxes_.size());
        DraftNodes top;
        DraftBelow(top, {0, count, UnionOf(boxes_, parallel_)}, 0, &tasks_);
        RunLoop(parallel_, static_cast<uint32_t>(tasks_.size()),
                [&](uint32_t i) { DraftBelow(tasks_[i].nodes, tasks_[i].set, tasks_[i].depth, nullptr); });
        size_t nodes = top.size();
        for (const Task& task : tasks_) nodes += task.nodes.size();
        tree_.nodes.reserve(nodes);
        tree_.nodes.emplace_back();
        order_.reserve(count);
        WriteNode(top, 0, 0);
        WriteTriangles();
        return std::move(tree_);
    }

private:
    void FillBoxes() {
        constexpr uint32_t kChunk = 16384;
        const uint32_t count = static_cast<uint32_t>(mesh_.sources.size());
        boxes_.resize(count);
        RunLoop(parallel_, (count + kChunk - 1) / kChunk, [&](uint32_t chunk) {
            for (uint32_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
                Bounds bounds;
                for (int k = 0; k < 3; ++k)
                    bounds.Include(mesh_.vertices[mesh_.indices[3 * i + static_cast<uint32_t>(k)]]);
                TriangleBox& box = boxes_[i];
                for (int axis = 0; axis < 3; ++axis) {
                    box.lane[axis] = bounds.lower[axis];
                    box.lane[4 + axis] = -bounds.upper[axis];
                }
                box.lane[3] = std::bit_cast<float>(i);
                box.lane[7] = 0;
            }
        });
    }

    // Drafts the subtree of a set; with `tasks`, defers smaller sets to them. Returns the number of its root in
    // `nodes`.
    uint32_t DraftBelow(DraftNodes& nodes, const BoxSet& set, int depth, std::vector<Task>* tasks) {
        const uint32_t index = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        DraftNode draft;
        draft.children[0].set = set;
        draft.childCount = 1;
        if (set.Count() <= kBottom) SplitIntoLeaves(draft);
        else SplitIntoNodes(draft, depth, tasks ? parallel_ : ParallelLoop{});
        for (int i = 0; i < draft.childCount; ++i) {
            DraftNode::Child& child = draft.children[i];
            if (child.set.Count() <= kLeaf) continue;
            if (tasks && child.set.Count() <= kTask) {
                child.task = static_cast<uint32_t>(tasks->size());
                tasks->push_back({child.set, depth + 1, {}});
            } else {
                child.node = DraftBelow(nodes, child.set, depth + 1, tasks);
            }
        }
        nodes[index] = draft;
        return index;
    }

    // Splits child i; the right half becomes the next free child.
    void SplitChild(DraftNode& draft, int i, const SplitRules& rules, const ParallelLoop& parallel) {
        BoxSet left, right;
        Split(boxes_, draft.children[i].set, rules, parallel, left, right);
        draft.children[i].set = left;
        draft.children[draft.childCount++].set = right;
    }

    // Splits a set of at most kBottom into up to eight leaves: first sets that are too large for a leaf, then the most
    // expensive ones while there are free children.
    void SplitIntoLeaves(DraftNode& draft) {
        constexpr uint32_t kSmallest = 3;  // a leaf this small is not split
        while (draft.childCount < kWidth) {
            int pick = -1;
            float most = -1;
            uint32_t leaves = 0;
            bool mustSplit = false;
            for (int i = 0; i < draft.childCount; ++i) {
                const BoxSet& set = draft.children[i].set;
                leaves += (set.Count() + kLeaf - 1) / kLeaf;
                const bool tooLarge = set.Count() > kLeaf;
                if (set.Count() <= kSmallest || (mustSplit && !tooLarge)) continue;
                const float cost = set.box.HalfArea() * static_cast<float>(set.Count());
                if (cost > most || (tooLarge && !mustSplit)) pick = i, most = cost;
                mustSplit |= tooLarge;
            }
            if (pick < 0) return;
            const uint32_t own = (draft.children[pick].set.Count() + kLeaf - 1) / kLeaf;
            SplitChild(draft, pick, {.smallest = 1, .leaf = kLeaf, .mostLeaves = kWidth - leaves + own}, {});
        }
    }

    // Splits a larger set into up to eight nodes, the most expensive first.
    void SplitIntoNodes(DraftNode& draft, int depth, const ParallelLoop& parallel) {
        const bool byCount = depth >= kFreeDepth;
        while (draft.childCount < kWidth) {
            int pick = -1;
            float most = -1;
            for (int i = 0; i < draft.childCount; ++i) {
                const BoxSet& set = draft.children[i].set;
                if (set.Count() <= kBottom) continue;
                const float cost = static_cast<float>(set.Count()) * (byCount ? 1.0f : set.box.HalfArea());
                if (cost > most) pick = i, most = cost;
            }
            if (pick < 0) return;
            const uint32_t smallest = std::max(1u, draft.children[pick].set.Count() / 8);
            SplitChild(draft, pick, {.smallest = smallest, .byCount = byCount}, parallel);
        }
    }

    const DraftNodes& ListOf(const DraftNodes& nodes, const DraftNode::Child& child) const {
        return child.task == kNoNode ? nodes : tasks_[child.task].nodes;
    }

    // Writes a node, numbers the triangles of its leaves, and recurses into its child nodes.
    void WriteNode(const DraftNodes& nodes, uint32_t from, uint32_t to) {
        const DraftNode& draft = nodes[from];
        const DraftNode::Child* children[kWidth];
        int nodeCount = 0, count = 0;
        for (int pass = 0; pass < 2; ++pass) {  // nodes first
            for (int i = 0; i < draft.childCount; ++i) {
                const bool isLeaf = draft.children[i].node == kNoNode && draft.children[i].task == kNoNode;
                if (isLeaf == (pass == 1)) children[count++] = &draft.children[i];
            }
            if (pass == 0) nodeCount = count;
        }
        MeshNode node{};
        node.counts = static_cast<uint8_t>(nodeCount + 16 * count);
        node.firstChild = static_cast<uint32_t>(tree_.nodes.size());
        node.firstTriangle = static_cast<uint32_t>(order_.size());
        Bounds boxes[kWidth];
        for (int i = 0; i < count; ++i) boxes[i] = children[i]->set.box.ToBounds();
        SetBoxes(node, {boxes, static_cast<size_t>(count)});
        for (int i = nodeCount; i < kWidth; ++i) {
            if (i < count)
                for (uint32_t k = children[i]->set.begin; k < children[i]->set.end; ++k)
                    order_.push_back(boxes_[k].Id());
            node.leafEnd[i] = static_cast<uint8_t>(order_.size() - node.firstTriangle);
        }
        tree_.nodes[to] = node;
        tree_.nodes.resize(tree_.nodes.size() + static_cast<size_t>(nodeCount));
        for (int i = 0; i < nodeCount; ++i) {
            const uint32_t first = children[i]->task == kNoNode ? children[i]->node : 0;
            WriteNode(ListOf(nodes, *children[i]), first, node.firstChild + static_cast<uint32_t>(i));
        }
    }

    // Numbers the vertices in the order of their first use, and packs the indices.
    void WriteTriangles() {
        const uint32_t count = static_cast<uint32_t>(order_.size());
        std::vector<uint32_t> newIds(mesh_.vertices.size(), kNoNode), corners;
        corners.reserve(3 * count);
        tree_.vertices.reserve(mesh_.vertices.size() + 1);
        for (const uint32_t triangle : order_) {
            for (uint32_t k = 0; k < 3; ++k) {
                const uint32_t old = mesh_.indices[3 * triangle + k];
                if (newIds[old] == kNoNode) {
                    newIds[old] = static_cast<uint32_t>(tree_.vertices.size());
                    tree_.vertices.push_back(mesh_.vertices[old]);
                }
                corners.push_back(newIds[old]);
            }
        }
        tree_.vertices.push_back(Vector3::Zero());
        PackIndices(tree_, corners);
        for (const uint32_t triangle : order_) {
            if (!materials_.empty()) tree_.materials.push_back(materials_[triangle]);
            if (keepSources_) tree_.sources.push_back(mesh_.sources[triangle]);
        }
        tree_.materials.shrink_to_fit();
        tree_.sources.shrink_to_fit();
    }

    const RepairedMesh& mesh_;
    std::span<const uint8_t> materials_;
    bool keepSources_;
    const ParallelLoop& parallel_;
    std::vector<TriangleBox> boxes_;
    std::vector<Task> tasks_;
    std::vector<uint32_t> order_;  // the repaired mesh's number of each triangle of the tree
    MeshTree tree_;
};

}  // namespace

MeshTree BuildMeshTree(const RepairedMesh& mesh, std::span<const uint8_t> materials, bool keepSources,
                       const ParallelLoop& parallel) {
    return Builder(mesh, materials, keepSources, parallel).Build();
}

}  // namespace fulcrum
