#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>

#include <algorithm>

namespace fulcrum {

// Source: C. Ericson, Real-Time Collision Detection, 3.4.
Position ClosestWeights(const Simplex<SupportVertex>& s) {
    if (s.count == 1) return Position(1, 0, 0);
    const Position p = -s.vertices[0].w, e = s.vertices[1].w - s.vertices[0].w;
    const double ee = Dot<double>(e, e), pe = Dot<double>(p, e);
    if (s.count == 2) {
        const double along = ee > 0 ? std::min(std::max(pe / ee, 0.0), 1.0) : 0;
        return Position(1 - along, along, 0);
    }
    const Position f = s.vertices[2].w - s.vertices[0].w;
    const double ef = Dot<double>(e, f), ff = Dot<double>(f, f), pf = Dot<double>(p, f),
                 determinant = ee * ff - ef * ef;
    if (!(determinant > 0)) return Position(1, 0, 0);
    const double alongE = std::min(std::max((ff * pe - ef * pf) / determinant, 0.0), 1.0);
    const double alongF = std::min(std::max((ee * pf - ef * pe) / determinant, 0.0), 1 - alongE);
    return Position(1 - alongE - alongF, alongE, alongF);
}

ConvexGjkResult ConvexGjk(const SupportPair& pair, const Vector3& start, float reach) {
    const GjkResult<SupportVertex> found = Gjk(pair, start, reach);
    ConvexGjkResult result{found.status, found.axis, found.separation, Vector3::Zero(), Vector3::Zero(), found.simplex};
    if (found.status == GjkStatus::Apart) {
        const Position weights = ClosestWeights(found.simplex);
        for (int i = 0; i < found.simplex.count; ++i) {
            result.onA += found.simplex.vertices[i].onA * static_cast<float>(weights[i]);
            result.onB += found.simplex.vertices[i].onB * static_cast<float>(weights[i]);
        }
    }
    return result;
}

}  // namespace fulcrum
