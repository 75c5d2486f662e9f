// Removes ghost collisions at seams between static bodies. A body that slides from one static body onto the next, flush
// with it, must not feel the seam. The narrow phase only sees pairs: to it the next body has an edge, or a side hidden
// by the first one, and both give sideways normals. Such a contact loses its points if its shape lies entirely below
// the plane of another contact on which the body rests, so that there is nothing to collide with.
#include <Fulcrum/Collision/NarrowPhase/ContactTolerances.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

using Kind = ConstraintColoring::Kind;

constexpr float kSameDirection = 0.9998f;  // 1 degree

// A contact in the center frame of its body A.
struct Support {
    uint32_t pair;
    float separation;  // m, of the deepest point
    Vector3 normal;    // towards B
    Vector3 deepest;   // on B
};

class SeamRemover {
public:
    SeamRemover(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, Array<uint32_t>& seams)
        : bodies_(bodies), colliders_(colliders), pairs_(pairs), seams_(seams) {}

    Support Describe(uint32_t index) const {
        const PairView view = View(index);
        const ContactRecord& record = pairs_.RecordOf(view.pair);
        Support support{index, std::numeric_limits<float>::infinity(),
                        Vector3(record.normal[0], record.normal[1], record.normal[2]), Vector3::Zero()};
        for (int i = 0; i < view.pair.pointCount; ++i) {
            const ContactRecord::Point& p = record.points[i];
            const Vector3 onB = view.bodyBInA.Transform(Vector3(p.onB[0], p.onB[1], p.onB[2]));
            const float separation = Dot(support.normal, Vector3(onB - Vector3(p.onA[0], p.onA[1], p.onA[2])));
            if (separation >= support.separation) continue;
            support.separation = separation;
            support.deepest = onB;
        }
        return support;
    }

    // Processes the contacts of one body with static and kinematic ones. Of two that hide each other the deeper one is
    // kept.
    void RemoveAmong(std::span<Support> supports) {
        std::sort(supports.begin(), supports.end(), [](const Support& a, const Support& b) {
            return a.separation < b.separation || (a.separation == b.separation && a.pair < b.pair);
        });
        for (size_t i = 0; i < supports.size(); ++i) {
            for (size_t j = 0; j < supports.size(); ++j) {
                if (i == j || pairs_.RecordOf(pairs_.pairs[supports[j].pair]).pointCount <= 0 ||
                    !Hides(supports[j], supports[i]))
                    continue;
                if (i < j && Hides(supports[i], supports[j])) continue;
                RemovePoints(supports[i].pair);
                break;
            }
        }
    }

private:
    PairView View(uint32_t index) const { return ViewPair(bodies_, colliders_, pairs_, index); }

    // Height of the pair's shape B, or the touching triangle of a surface, above a point in A's frame.
    float HeightOf(uint32_t index, const Vector3& point, const Vector3& up) const {
        const PairView view = View(index);
        const RelativePose pose = view.bodyBInA * LocalOf(bodies_, colliders_, view.pair.colliderB);
        const Vector3 upInB = InverseRotate(pose.rotation, up);
        const Shape& shape = view.shapes.b;
        float height = std::numeric_limits<float>::infinity();
        if (view.pair.surface) {
            const TriangleView triangle =
                static_cast<const SurfaceShape&>(shape).GetTriangle(pairs_.contacts[view.pair.contact].triangle);
            height = -height;
            for (const Vector3& vertex : triangle.vertices) height = std::max(height, Dot(upInB, vertex));
        } else if (shape.IsConvex()) {
            height = Dot(upInB, static_cast<const ConvexShape&>(shape).Support(upInB));
        }
        return height + Dot(up, Vector3(pose.position - point));
    }

    void RemovePoints(uint32_t index) {
        ContactRecord& record = pairs_.RecordOf(pairs_.pairs[index]);
        record.pointCount = 0;
        record.ForgetImpulses();
        pairs_.pairs[index].onSeam = true;
        seams_.push_back(index);
    }

    // Whether a body that rests on `bearing` cannot collide with the shape of `other`.
    bool Hides(const Support& bearing, const Support& other) const {
        const Pair& first = pairs_.pairs[bearing.pair];
        const Pair& second = pairs_.pairs[other.pair];
        if (first.colliderA != second.colliderA || first.colliderB == second.colliderB) return false;
        const float flush = FlushHeight(ShapesOf(colliders_, first).a.OuterRadius());
        return bearing.separation < flush && Dot(bearing.normal, other.normal) < kSameDirection &&
               HeightOf(other.pair, bearing.deepest, Vector3(-bearing.normal)) < flush;
    }

    const BodyStore& bodies_;
    const ColliderStore& colliders_;
    PairStore& pairs_;
    Array<uint32_t>& seams_;
};

template <class Visit>
void VisitFixed(const ConstraintColoring& coloring, int from, int to, Visit&& visit) {
    for (int c = from; c <= to; ++c)
        for (const ConstraintColoring::Entry& entry : coloring.At(c).Of(Kind::Fixed)) visit(entry);
}

}  // namespace

void RemoveSeamContacts(const BodyStore& bodies, const ColliderStore& colliders, const ConstraintColoring& coloring,
                        PairStore& pairs, Array<uint32_t>& seams, ScratchArena& scratch) {
    for (uint32_t index : seams) {
        Pair& pair = pairs.pairs[index];
        pair.onSeam = false;
        if (pair.contact != PairStore::kNone) pairs.RecordOf(pair).pointCount = pair.pointCount;
    }
    seams.clear();
    // Contacts with static and kinematic bodies take the highest free color: few bodies have one in any other.
    constexpr int kHighest = ConstraintColoring::kColors - 1;
    size_t others = coloring.At(ConstraintColoring::kOverflow).Of(Kind::Fixed).size();
    for (int c = 0; c < kHighest; ++c) others += coloring.At(c).Of(Kind::Fixed).size();
    if (others == 0) return;
    std::span<uint8_t> several = scratch.Allocate<uint8_t>(bodies.Size());
    std::fill(several.begin(), several.end(), uint8_t(0));
    VisitFixed(coloring, 0, kHighest - 1, [&](const auto& entry) { several[entry.bodyA] = 1; });
    VisitFixed(coloring, ConstraintColoring::kOverflow, ConstraintColoring::kOverflow,
               [&](const auto& entry) { several[entry.bodyA] = 1; });
    std::span<uint64_t> contacts = scratch.Allocate<uint64_t>(others + coloring.At(kHighest).Of(Kind::Fixed).size());
    size_t count = 0;
    VisitFixed(coloring, 0, ConstraintColoring::kOverflow, [&](const auto& entry) {
        if (several[entry.bodyA])
            contacts[count++] = uint64_t(entry.bodyA) << 32 | pairs.contacts[entry.constraint].pair;
    });
    contacts = contacts.first(count);
    std::sort(contacts.begin(), contacts.end());
    SeamRemover remover(bodies, colliders, pairs, seams);
    std::span<Support> supports = scratch.Allocate<Support>(count);
    for (size_t begin = 0; begin < count;) {
        size_t end = begin + 1;
        while (end < count && contacts[end] >> 32 == contacts[begin] >> 32) ++end;
        if (end - begin > 1) {
            for (size_t i = begin; i < end; ++i) supports[i] = remover.Describe(static_cast<uint32_t>(contacts[i]));
            remover.RemoveAmong(supports.subspan(begin, end - begin));
        }
        begin = end;
    }
}

}  // namespace fulcrum
