#include <Fulcrum/Physics/Queries/RaySearch.h>

#include <Fulcrum/Physics/Queries/RayBounds.h>

namespace fulcrum {
namespace {

constexpr int kMost = RayCaster::kMostRays;
// Number of colliders per ray that the box may find although no ray of the packet hits them; with more, single rays are
// faster.
constexpr int kMostInVain = 2;

// The valid rays of a packet, and a swept box that contains all of them, in the coordinates of the trees.
struct Packet {
    RayCaster casters[kMost];
    uint32_t numbers[kMost];
    int count = 0;
    TreeRays inTree;

    Packet(const ColliderSearch& search, std::span<const Ray> rays, std::span<const uint32_t> which,
           float maxFraction) {
        for (const uint32_t number : which) {
            casters[count] = RayCaster(rays[number]);
            if (!casters[count].IsValid()) continue;
            inTree.Add(TreeRay(rays[number].origin - search.Origin(), rays[number].displacement), maxFraction);
            numbers[count++] = number;
        }
    }
};

// A swept box that contains all rays within the bounds, in the coordinates of the trees. Expanded for rounding errors:
// 2^-50 of positions, and 2^-18 of the displacement, because the tree computes hit fractions in float.
TreeRay SweptBox(const ColliderSearch& search, const RayBounds& bounds) {
    const Position center = (bounds.low + bounds.high) * 0.5;
    const Vector3 way = bounds.displacements.lower.cwiseAbs().cwiseMax(bounds.displacements.upper.cwiseAbs());
    const Position far = (bounds.low.cwiseAbs() + bounds.high.cwiseAbs() + search.Origin().cwiseAbs()) * 0x1p-50;
    return TreeRay(center - search.Origin(), bounds.displacements.Center(),
                   (bounds.Reach() + far.cast<float>()) * (1 + 0x1p-20f) + way * 0x1p-18f);
}

// Returns false, and does nothing, if the rays are not close enough together.
bool CastTogether(const ColliderSearch& search, std::span<const Ray> rays, std::span<const uint32_t> which,
                  const RayCastSettings& settings, std::span<WorldRayHit> hits) {
    const RayBounds bounds = RayBounds::Of(which.size(), [&](size_t i) -> const Ray& { return rays[which[i]]; });
    if (which.size() < 4 || !(settings.maxFraction <= 1) || !bounds.IsTight()) return false;
    Packet packet(search, rays, which, settings.maxFraction);
    TreeRays& inTree = packet.inTree;
    ClosestCollider best[kMost];
    float limit = settings.maxFraction;
    uint32_t met = 0;
    int inVain = 0;
    const auto meet = [&](uint32_t collider) {
        const Shape& shape = search.ShapeOf(collider);
        const Pose pose = search.PoseOf(collider);
        const auto take = [&](int i, const RayHit& found) {
            float lower = inTree.Limits()[i];
            best[i].Take(search, collider, found, lower);
            inTree.SetLimit(i, lower);
        };
        if (shape.IsSurface()) {
            RayHit found[kMost];
            for (uint32_t hit = RayCaster::CastClosest(packet.casters, met, static_cast<const SurfaceShape&>(shape),
                                                       pose, settings, inTree.Limits(), found);
                 hit != 0; hit &= hit - 1) {
                const int i = std::countr_zero(hit);
                take(i, found[i]);
            }
        } else {
            for (; met != 0; met &= met - 1) {
                const int i = std::countr_zero(met);
                RayHit found;
                if (packet.casters[i].CastClosest(shape, pose, settings, inTree.Limits()[i], found)) take(i, found);
            }
        }
        limit = inTree.LargestLimit();
    };
    const TreeRay swept = SweptBox(search, bounds);
    search.Run(
        [&](const BoundsTree& tree, const auto& visit) {
            tree.CastRay(swept, limit, [&](uint32_t collider) {
                met = inTree.Intersecting(tree.GetBounds(collider));
                if (met != 0) {
                    visit(collider);
                } else if (++inVain > kMostInVain * packet.count) {
                    limit = -1;
                }
            });
        },
        meet);
    if (inVain > kMostInVain * packet.count) return false;
    if (packet.count < static_cast<int>(which.size()))
        for (const uint32_t number : which) hits[number] = {};
    for (int i = 0; i < packet.count; ++i) {
        const uint32_t number = packet.numbers[i];
        const bool isHit = best[i].collider != ClosestCollider::kNone;
        hits[number] = isHit ? ToWorld(search, best[i].collider, rays[number], best[i].hit) : WorldRayHit{};
    }
    return true;
}

}  // namespace

bool CastClosest(const ColliderSearch& search, const Ray& ray, const RayCastSettings& settings, WorldRayHit& hit) {
    const RayCaster caster(ray);
    if (!caster.IsValid()) return false;
    float limit = settings.maxFraction;
    ClosestCollider best;
    AlongRay(search, TreeRay(ray.origin - search.Origin(), ray.displacement), limit, [&](uint32_t collider) {
        RayHit found;
        if (caster.CastClosest(search.ShapeOf(collider), search.PoseOf(collider), settings, limit, found))
            best.Take(search, collider, found, limit);
    });
    if (best.collider == ClosestCollider::kNone) return false;
    hit = ToWorld(search, best.collider, ray, best.hit);
    return true;
}

void CastClosest(const ColliderSearch& search, std::span<const Ray> rays, std::span<const uint32_t> which,
                 const RayCastSettings& settings, std::span<WorldRayHit> hits) {
    if (CastTogether(search, rays, which, settings, hits)) return;
    for (const uint32_t number : which)
        if (!CastClosest(search, rays[number], settings, hits[number])) hits[number] = {};
}

}  // namespace fulcrum
