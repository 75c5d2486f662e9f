// In place of Libccd.cpp in builds without libccd (FULCRUM_LIBCCD=OFF): NarrowPhaseMethod::Libccd is refused by the
// check of the settings, and queries whose own EPA fails do without a second opinion.
#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>

namespace fulcrum {

bool HasLibccd() { return false; }

LibccdResult LibccdPenetration(const ConvexShape&, const ConvexShape&, const RelativePose&, double, LibccdAlgorithm) {
    return {LibccdResult::Status::Failed, Position::Zero(), 0, Position::Zero()};
}

std::optional<KnownContact> FindLibccdContact(const SupportPair&, const RelativePose&, float, CollideCounters&) {
    return std::nullopt;
}

LibccdVerdict AskLibccd(const SupportPair&, const RelativePose&, float) { return {true, Vector3(0, 1, 0)}; }

void CollideLibccd(const PairQuery&, Manifold& manifold) { manifold = {}; }

void CollideWithPlaneByLibccd(const Plane&, const ConvexShape&, const RelativePose&, const CollideSettings&, PairCache&,
                              Manifold& manifold, CollideCounters&) {
    manifold = {};
}

}  // namespace fulcrum
