// GJK and EPA against the exhaustive search through all separating axes.
#include "NarrowPhaseTesting.h"

#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/Gjk.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

TEST(Epa, FindsTheDepthThatTheSearchThroughAllAxesFinds) {
    const std::vector<NamedShape> shapes = {{"box", MakeBox(Vector3(0.5f, 0.4f, 0.7f))},
                                            {"capsule", MakeCapsule(0.5f, 0.25f)},
                                            {"hull", MakeRoundHull(32, 0.6f)},
                                            {"prism", MakePrism(8, 0.5f, 0.4f)}};
    RandomPoses random(2);
    int overlapping = 0, gaveUp = 0;
    for (const NamedShape& a : shapes) {
        for (const NamedShape& b : shapes) {
            if (a.name == "capsule" && b.name == "capsule") continue;  // two segments have no volume between them
            PolyhedronStorage storageA, storageB;
            const Polyhedron coreA = CoreOf(*a.shape, storageA), coreB = CoreOf(*b.shape, storageB);
            for (int i = 0; i < 1000; ++i) {
                RelativePose pose{random.InCube(), i % 3 == 0 ? random.QuarterTurns() : random.Rotation()};
                const PolyhedronPair pair(coreA, coreB, pose);
                const GjkResult<MinkowskiVertex> gjk = Gjk(pair, Normalized(pose.position), 0.02f);
                const FoundAxis search = SearchAllAxes(pair);
                if (gjk.status != GjkStatus::Overlapping) {
                    // The face and edge axes find no more than the distance, which GJK finds.
                    EXPECT_GT(gjk.separation, -1e-5f);
                    EXPECT_GE(gjk.separation, std::min(search.separation, 0.02f) - 1e-5f) << a.name << " " << b.name << " " << i;
                    continue;
                }
                ++overlapping;
                EXPECT_LE(search.separation, 1e-5f);
                const EpaResult epa = Epa(pair, gjk.simplex);
                if (epa.status != EpaResult::Status::Found) {
                    ++gaveUp;
                    continue;
                }
                // Both to a few roundings of positions of about 2 m.
                EXPECT_NEAR(epa.separation, search.separation, 2e-5f) << a.name << " " << b.name << " " << i;
            }
        }
    }
    EXPECT_GT(overlapping, 3000);
    // Where it gives up the search takes over, 100 times slower.
    EXPECT_LE(gaveUp, overlapping / 50);
    RecordProperty("overlapping", overlapping);
    RecordProperty("gaveUp", gaveUp);
    std::printf("  EPA gave up in %d of %d overlaps\n", gaveUp, overlapping);
}

}  // namespace
}  // namespace fulcrum::testing
