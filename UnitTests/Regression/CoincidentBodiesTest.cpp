// Bodies with their centers at one point were all pushed the same way: a column of spheres, hundreds of meters high,
// and some through the floor. Thousands at one point made millions of pairs and took minutes.
#include <Fulcrum/Physics/Stages/CrowdPlaces.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <set>

namespace fulcrum::testing {
namespace {

// The result for bodies that start at one point.
struct Burst {
    TestWorld world;
    std::vector<BodyId> ids;
    double fastest = 0, lowest = 1e300, farthest = 0;  // m/s; m, of all steps
    size_t mostMemory = 0;

    Burst(const SystemSettings& settings, uint32_t threads) : world(settings, threads) {}
    void Add(int count, const Position& at, const std::function<BodySettings(int)>& settings) {
        for (int i = 0; i < count; ++i) {
            BodySettings each = settings(i);
            each.position = at;
            ids.push_back(world.Add(each));
        }
    }
    void Run(double seconds, double dt = kStep) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / dt)); ++i) {
            world.Step(dt);
            for (const BodyId id : ids) {
                fastest = std::max<double>(fastest, Length(world.VelocityOf(id)));
                const Position p = world.PositionOf(id);
                lowest = std::min(lowest, p.y());
                farthest = std::max(farthest, p.norm());
            }
            mostMemory = std::max(mostMemory, world.System().MemoryUsed());
        }
    }
    // The nearest two centers.
    double LeastDistance() {
        std::vector<Position> at;
        for (const BodyId id : ids) at.push_back(world.PositionOf(id));
        std::sort(at.begin(), at.end(), [](const Position& a, const Position& b) { return a.x() < b.x(); });
        double least = 1e300;
        for (size_t i = 0; i < at.size(); ++i)
            for (size_t j = i + 1; j < at.size() && at[j].x() - at[i].x() < least; ++j)
                least = std::min(least, (at[i] - at[j]).norm());
        return least;
    }
};

TEST(CoincidentBodies, PointsOfAllIndicesFillTheBall) {
    constexpr uint32_t kCount = 20000;
    Position sum = Position::Zero();
    double squares = 0;
    int octants[8] = {};
    for (uint32_t i = 0; i < kCount; ++i) {
        const Vector3 place = PointInBall(i);
        ASSERT_LE(Length(place), 1);
        sum += place.cast<double>();
        squares += double(LengthSquared(place));
        ++octants[(place.x() > 0) + 2 * (place.y() > 0) + 4 * (place.z() > 0)];
    }
    // Uniform in a ball: the mean of r^2 is 3/5; five standard deviations of each mean.
    EXPECT_NEAR(squares / kCount, 0.6, 5 * 0.262 / std::sqrt(kCount));
    EXPECT_LT((sum / kCount).cwiseAbs().maxCoeff(), 5 * 0.447 / std::sqrt(kCount));
    for (const int count : octants) EXPECT_NEAR(count, kCount / 8, 5 * std::sqrt(kCount * 7 / 64.0));
}

// Two equal bodies of any shape separate, in the same way whichever was created first.
TEST(CoincidentBodies, TwoEqualBodiesSeparate) {
    const ShapePtr shapes[] = {
        SphereOf(0.5f), CubeOf(0.5f), CapsuleOf(0.5f, 0.3f), HullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
        CompoundOf({{.shape = CubeOf(0.3f), .position = {0.3f, 0, 0}}, {.shape = SphereOf(0.4f)}})};
    for (const ShapePtr& shape : shapes) {
        for (const bool turned : {false, true}) {
            Burst burst(NoGravity(), 1);
            burst.Add(2, Position::Zero(), [&](int i) {
                return BodySettings{
                    .shape = shape,
                    .rotation = turned && i ? RotationAbout(Vector3(0.6f, 0, 0.8f), 1.2) : Quaternion{}};
            });
            burst.Run(3);
            EXPECT_LT(burst.world.Report().largestPenetration, 0.01f) << ShapeTypeName(shape->Type());
            EXPECT_LT(burst.fastest, 5) << ShapeTypeName(shape->Type());
            const double moved = (burst.world.Bodies().GetCenterOfMass(burst.ids[0]) -
                                  burst.world.Bodies().GetCenterOfMass(burst.ids[1]))
                                     .norm();
            EXPECT_GT(moved, 0.1) << ShapeTypeName(shape->Type());
        }
    }
}

// Within so many seconds all of them are apart.
void ExpectApart(int count, float radius, bool isSphere, bool hasFloor, double seconds) {
    SystemSettings settings;
    if (!hasFloor) settings.gravity.setZero();
    Burst burst(settings, 2);
    if (hasFloor) burst.world.AddFloor();
    const ShapePtr shape = isSphere ? SphereOf(radius) : CubeOf(radius);
    burst.Add(count, hasFloor ? Position(0, 2 * radius, 0) : Position(Position::Zero()),
              [&](int) { return BodySettings{.shape = shape}; });
    burst.Run(seconds);
    EXPECT_LT(burst.world.Report().largestPenetration, 0.1f * radius);
    EXPECT_GT(burst.LeastDistance(), 1.8 * radius);
    // Bodies that fall from the top of the heap are as fast as free fall makes them.
    const double height = 2 * radius * std::cbrt(count) * 1.2, fall = hasFloor ? std::sqrt(2 * kGravity * height) : 0;
    EXPECT_LT(burst.fastest, std::max(5.0, fall));
    EXPECT_GT(burst.lowest, hasFloor ? 0.5 * radius : -5 * seconds);
    EXPECT_LT(burst.farthest, 5 * seconds);
    // A kilobyte for each of fifty contacts that a body may have.
    EXPECT_LT(burst.mostMemory, 1024.0 * 50 * count + 4e6);
    EXPECT_TRUE(burst.world.AllFinite());
}

TEST(CoincidentBodies, HundredSpheresInSpace) { ExpectApart(128, 0.5f, true, false, 4); }
TEST(CoincidentBodies, HundredSpheresOnAFloor) { ExpectApart(128, 0.5f, true, true, 4); }
TEST(CoincidentBodies, HundredBoxesInSpace) { ExpectApart(128, 0.5f, false, false, 4); }
TEST(CoincidentBodies, HundredBoxesOnAFloor) { ExpectApart(128, 0.5f, false, true, 4); }
TEST(CoincidentBodies, FiveHundredSpheresInSpace) { ExpectApart(512, 0.5f, true, false, 4); }
TEST(CoincidentBodies, FiveHundredSpheresOnAFloor) { ExpectApart(512, 0.25f, true, true, 4); }

// Thousands of any shape, within a part of their radius of each other: all bodies overlap all others deeply at first.
// Memory and time grow with their number: a pile of the same bodies has as many contacts.
void ExpectThousandsApart(const std::function<BodySettings(int)>& settings, double spread, bool hasFloor) {
#ifdef FULCRUM_ASSERTIONS
    constexpr int kCount = 512;
#else
    constexpr int kCount = 4096;
#endif
    SystemSettings system;
    if (!hasFloor) system.gravity.setZero();
    uint64_t hashes[2];
    for (const uint32_t threads : {1u, 2u}) {
        Burst burst(system, threads);
        if (hasFloor) burst.world.AddFloor();
        burst.Add(kCount, Position::Zero(), settings);
        for (int i = 0; i < kCount; ++i) {
            const Position at = PointInBall(static_cast<uint32_t>(i)).cast<double>() * spread +
                                Position(0, hasFloor ? 1 + spread : 0, 0);
            ASSERT_TRUE(burst.world.Bodies().SetPose(burst.ids[static_cast<size_t>(i)], at, {}));
        }
        burst.Run(4);
        EXPECT_TRUE(burst.world.AllFinite());
        EXPECT_LT(burst.world.Report().largestPenetration, 0.05f);
        EXPECT_GT(burst.LeastDistance(), 0.9);
        // A heap as high as it came to be falls together.
        EXPECT_LT(burst.fastest, hasFloor ? std::sqrt(2 * kGravity * burst.farthest) : 5.0);
        EXPECT_LT(burst.farthest, 5 * 4.0);
        EXPECT_GT(burst.lowest, hasFloor ? 0.4 : -5 * 4.0);
        EXPECT_LT(burst.mostMemory, 10e3 * kCount + 4e6);
        hashes[threads - 1] = burst.world.System().HashPoses();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

BodySettings OfShape(const ShapePtr& shape) { return {.shape = shape}; }

TEST(CoincidentBodies, ThousandsOfSpheresInSpace) {
    ExpectThousandsApart([shape = SphereOf(0.5f)](int) { return OfShape(shape); }, 0, false);
}
TEST(CoincidentBodies, ThousandsOfSpheresOnAFloor) {
    ExpectThousandsApart([shape = SphereOf(0.5f)](int) { return OfShape(shape); }, 0, true);
}
TEST(CoincidentBodies, ThousandsOfSpheresWithinAMillimeter) {
    ExpectThousandsApart([shape = SphereOf(0.5f)](int) { return OfShape(shape); }, 1e-3, false);
}
TEST(CoincidentBodies, ThousandsOfSpheresWithinARadius) {
    ExpectThousandsApart([shape = SphereOf(0.5f)](int) { return OfShape(shape); }, 0.5, false);
}
TEST(CoincidentBodies, ThousandsOfBoxesInSpace) {
    ExpectThousandsApart([shape = CubeOf(0.5f)](int) { return OfShape(shape); }, 0, false);
}
TEST(CoincidentBodies, ThousandsOfShapesInSpace) {
    const ShapePtr shapes[] = {SphereOf(0.6f), CubeOf(0.5f), CapsuleOf(0.3f, 0.5f), CubeOf(0.55f)};
    ExpectThousandsApart([&](int i) { return OfShape(shapes[i % 4]); }, 0, false);
}

TEST(CoincidentBodies, PlacesInTheBallAreApart) {
    for (const uint32_t count : {1u, 32u, 500u}) {
        const PlaceLimit floor{Vector3(0, 1, 0), -0.1f};
        for (const std::span<const PlaceLimit> limits : {std::span<const PlaceLimit>(), std::span(&floor, 1)}) {
            const auto places = PlacesInBall(count, limits);
            ASSERT_EQ(places.size(), count);
            // The nearest of a face-centered lattice with a unit ball's volume for so many, packed to sqrt(1/2) pi/3.
            const float nearest = 2 * static_cast<float>(std::cbrt(std::sqrt(0.5) * kPi / 3 / count));
            for (size_t i = 0; i < places.size(); ++i) {
                EXPECT_GE(places[i].y(), limits.empty() ? -1.001f : -0.1f);
                for (size_t j = i + 1; j < places.size(); ++j)
                    EXPECT_GT(Length(Vector3(places[i] - places[j])), 0.99f * nearest);
            }
        }
    }
}

// Bodies that disperse do not search among those that move, so that a kinematic body searches for them, too: a pair
// that both have found is one pair.
TEST(CoincidentBodies, HaveOneContactEachWithAKinematicBody) {
    TestWorld world(NoGravity());
    const ShapePtr ball = SphereOf(0.3f);
    for (int i = 0; i < 1500; ++i) world.Add({.shape = ball});
    const BodyId box = world.Add({.shape = CubeOf(0.5f),
                                  .motion = MotionType::Kinematic,
                                  .position = {1.5, 0, 0},
                                  .linearVelocity = {-3, 0, 0}});
    size_t contacts = 0;
    for (int step = 0; step < 40; ++step) {
        world.Step();
        std::set<BodyId> touching;
        world.System().VisitContactsOf(box, [&](const ContactView& contact) {
            ++contacts;
            EXPECT_TRUE(touching.insert(contact.bodyA).second) << contact.bodyA.index << " in step " << step;
        });
    }
    EXPECT_GT(contacts, 1000u);
}

TEST(CoincidentBodies, AreTheSameForAnyNumberOfThreads) {
    uint64_t hash = 0;
    for (const uint32_t threads : {1u, 2u, 4u}) {
        TestWorld world({}, threads);
        world.AddFloor();
        for (int i = 0; i < 300; ++i)
            world.Add({.shape = i % 3 ? SphereOf(0.3f) : CubeOf(0.3f), .position = {0, 2, 0}});
        world.Steps(60);
        if (threads == 1) hash = world.System().HashPoses();
        EXPECT_EQ(world.System().HashPoses(), hash);
    }
}

}  // namespace
}  // namespace fulcrum::testing
