// Reported of bodies at rest elsewhere: large bodies on a small block are gone after an hour, sharp hulls jitter and
// jump; and what is static, however much of it, is no work for what moves elsewhere.
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

// Not by 0.1 m in 3000 s: by less than 0.7 mm in 20 s, after two of settling.
TEST(AtRest, LargeBodiesOnASmallBlockDoNotCreep) {
    struct Case {
        ShapePtr shape;
        double x;
        Quaternion rotation;
    };
    const Case cases[] = {{CapsuleOf(5, 5), 1, RotationAbout({0, 0, 1}, kPi / 2)},
                          {CubeOf(5), 7, {}},
                          {Cylinder::Create(5, 5).Value(), 1, RotationAbout({1, 0, 0}, kPi / 2)}};
    for (const Case& each : cases) {
        TestWorld world(NoSleep());
        world.Add({.shape = BoxOf(10, 1, 10), .motion = MotionType::Static, .position = {0, -1, 0}});
        const BodyId body =
            world.Add({.shape = each.shape, .position = {each.x, 5, 0}, .rotation = each.rotation, .mass = 1});
        world.Run(2);
        const Position before = world.PositionOf(body);
        world.Run(20);
        EXPECT_LT((world.PositionOf(body) - before).norm(), 0.1 / 3000 * 20) << ShapeTypeName(each.shape->Type());
    }
}

// Tetrahedra and spikes fall, come to rest and sleep. Tetrahedra gain no energy but rounding on the way: less than 2 mm
// of their height.
TEST(AtRest, SharpHullsComeToRest) {
    for (const bool isSpike : {false, true}) {
        RandomPoses random(11);
        TestWorld world;
        world.AddFloor();
        std::vector<BodyId> bodies;
        double weight = 0;
        for (int i = 0; i < 20; ++i) {
            std::vector<Vector3> points;
            if (isSpike) {
                for (int k = 0; k < 6; ++k)
                    points.push_back(
                        {0.2f * std::cos(static_cast<float>(k)), 0, 0.2f * std::sin(static_cast<float>(k))});
                points.push_back({0, 2, 0});
                points.push_back({0, -0.3f, 0});
            } else {
                for (int k = 0; k < 4; ++k) points.push_back(random.InCube());
            }
            const auto hull = ConvexHull::Create(points);
            ASSERT_TRUE(hull);
            bodies.push_back(world.Add({.shape = hull.Value(),
                                        .position = {4.0 * (i % 5), 1.5, 4.0 * (i / 5)},
                                        .rotation = random.Rotation()}));
            weight += world.Bodies().GetMass(bodies.back()) * kGravity;
        }
        double least = world.System().GetEnergy(), rise = 0;
        for (int step = 0; step < 600; ++step) {
            world.Step();
            const double energy = world.System().GetEnergy();
            rise = std::max(rise, energy - least);
            least = std::min(least, energy);
        }
        if (!isSpike) {
            EXPECT_LT(rise / weight, 0.002);
        }
        for (const BodyId body : bodies) EXPECT_FALSE(world.Bodies().IsAwake(body)) << isSpike;
    }
}

// Its pairs are those of the balls with the floor, wherever the static bodies are: beside them, or all in one place.
TEST(AtRest, StaticBodiesElsewhereAreNoWork) {
    for (const bool isHeap : {false, true}) {
        RandomPoses random(1);
        TestWorld world;
        for (int i = 0; i < 5000; ++i) {
            const Vector3 in = random.InCube();
            world.Add({.shape = CubeOf(1),
                       .motion = MotionType::Static,
                       .position = isHeap ? Position(500 + in.x(), in.y(), in.z())
                                          : Position(3.0 * (i % 71) - 100, -4, 3.0 * (i / 71) - 100)});
        }
        world.AddFloor();
        for (int i = 0; i < 20; ++i)
            world.Add({.shape = SphereOf(0.3f), .position = {i % 5 * 2.0, 1, i / 5 * 2.0}, .allowSleep = false});
        for (int step = 0; step < 100; ++step) {
            world.Step();
            EXPECT_LE(world.Report().pairs, 20u);
        }
        EXPECT_EQ(world.Report().contacts, 20u);
    }
}

}  // namespace
}  // namespace fulcrum::testing
