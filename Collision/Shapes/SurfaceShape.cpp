#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <cmath>

namespace fulcrum {

SurfaceShape::~SurfaceShape() = default;

std::span<const SurfaceMaterial> SurfaceShape::Materials() const { return materials_; }

uint32_t SurfaceShape::FindTriangles(const Bounds& box, std::span<uint32_t> ids) const {
    const DefaultFloats floats;
    uint32_t count = 0;
    VisitTriangles(box, [&](uint32_t id) {
        if (count < ids.size()) ids[count] = id;
        ++count;
    });
    return count;
}

uint32_t SurfaceShape::CastRays(std::span<const SurfaceRay> rays, SurfaceHit* hits, const float* maxFractions) const {
    uint32_t hit = 0;
    for (size_t i = 0; i < rays.size(); ++i) hit |= (CastRay(rays[i], hits[i], maxFractions[i]) ? 1u : 0u) << i;
    return hit;
}

Status SurfaceShape::CheckMaterials(std::span<const SurfaceMaterial> materials) {
    if (materials.size() > 255) {
        return Error{ErrorCode::OutOfRange, Message("%zu materials: at most 255", materials.size())};
    }
    for (size_t i = 0; i < materials.size(); ++i) {
        const SurfaceMaterial& m = materials[i];
        if (!std::isfinite(m.friction) || !std::isfinite(m.restitution)) {
            return Error{ErrorCode::NonFinite, Message("friction %g or restitution %g of material %zu is not finite",
                                                       double{m.friction}, double{m.restitution}, i)};
        }
        if (m.friction < 0 || m.restitution < 0) {
            return Error{ErrorCode::Negative, Message("friction %g or restitution %g of material %zu is negative",
                                                      double{m.friction}, double{m.restitution}, i)};
        }
        if (m.restitution > 1) {
            return Error{ErrorCode::OutOfRange,
                         Message("restitution of material %zu is %g: it must be 0 to 1", i, double{m.restitution})};
        }
    }
    return Done{};
}

}  // namespace fulcrum
