#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>

#include <array>
#include <cstdio>
#include <cstdlib>

namespace fulcrum::testing {

std::span<const FuzzTarget> FuzzTargets() {
    static const std::array kTargets = {
        kShapeFileTarget, kHullTarget, kMeshTarget,    kSnapshotTarget, kSnapshotDeltaTarget, kRecordingTarget,
#ifdef FULCRUM_HAS_ASSETS
        kSceneTarget,     kCborTarget, kRagdollTarget,
#endif
        kProgramTarget,
    };
    return kTargets;
}

void Promise(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
}

}  // namespace fulcrum::testing
