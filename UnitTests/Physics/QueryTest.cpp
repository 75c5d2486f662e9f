// Queries of the world against a loop over all bodies, one by one, and what makes them fit for games: filters, early
// ends, batches, threads, bodies that have moved since the trees last heard of them.
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Queries/Distance.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace fulcrum::testing {
namespace {

std::vector<ShapePtr> Shapes() {
    return {SphereOf(0.4f),
            BoxOf(0.5f, 0.3f, 0.7f),
            CapsuleOf(0.4f, 0.3f),
            Box::Create(Vector3(0.5f, 0.4f, 0.3f), 0.1f).Value(),
            HullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}),
            CompoundOf({{SphereOf(0.3f), Vector3(0.6f, 0, 0), {}, 1},
                        {BoxOf(0.2f, 0.6f, 0.2f), Vector3(-0.3f, 0.2f, 0), {}, 1}})};
}

SystemSettings Weightless() {
    SystemSettings settings;
    settings.gravity.setZero();
    return settings;
}

// 300 bodies of all shapes and kinds of motion about `origin`, gravity off.
struct Crowd {
    TestWorld world;
    Position origin;
    std::vector<BodyId> ids;
    std::vector<ShapePtr> shapes = Shapes();

    explicit Crowd(const Position& where = Position::Zero(), uint32_t threads = 1, float speed = 0, int count = 300)
        : world(Weightless(), threads), origin(where) {
        RandomPoses random(1);
        for (int i = 0; i < count; ++i) {
            BodySettings s;
            s.shape = shapes[static_cast<size_t>(i) % shapes.size()];
            s.motion = i % 3 == 0 ? MotionType::Static : i % 3 == 1 ? MotionType::Kinematic : MotionType::Dynamic;
            s.position = origin + random.InCube().cast<double>() * 10;
            s.rotation = random.Rotation();
            if (s.motion != MotionType::Static) s.linearVelocity = random.InCube() * speed;
            s.layer = static_cast<uint8_t>(i % 5);
            ids.push_back(world.Bodies().Create(s).Value());
        }
    }
    const QueryInterface& Queries() { return world.System().Queries(); }
    Pose CenterPose(BodyId id) { return {world.Bodies().GetCenterOfMass(id), world.Bodies().GetPose(id).rotation}; }
    Ray RandomRay(RandomPoses& random) const {
        const Vector3 from = random.InCube() * 12, to = random.InCube() * 12;
        return {origin + from.cast<double>(), to - from};
    }
    MovingShape RandomMove(RandomPoses& random, bool turns) const {
        const Shape& shape = *shapes[static_cast<size_t>(random.Between(0, 4.99f))];
        const Vector3 from = random.InCube() * 12, to = random.InCube() * 12;
        return {static_cast<const ConvexShape*>(&shape),
                {origin + from.cast<double>(), random.Rotation()},
                (to - from) * 0.5f,
                turns ? Vector3(random.InCube() * 2) : Vector3(Vector3::Zero())};
    }
};

TEST(Query, RaysHitWhatALoopOverAllBodiesHits) {
    Crowd crowd(Position::Zero(), 1, 0, 150);
    RandomPoses random(2);
    int hits = 0;
    std::vector<WorldRayHit> all;
    const WorldLock::Shared held = crowd.Queries().Hold();
    const int cases = Cases(100000);
    for (int i = 0; i < cases; ++i) {
        const Ray ray = crowd.RandomRay(random);
        const RayCaster caster(ray);
        RayHit best;
        BodyId bestBody;
        size_t count = 0;
        for (BodyId id : crowd.ids) {
            RayHit here;
            const Shape& shape = *crowd.world.Bodies().GetShape(id);
            caster.CastAll(shape, crowd.CenterPose(id), {}, [&](const RayHit&) { return ++count, true; });
            if (!caster.CastClosest(shape, crowd.CenterPose(id), {}, here)) continue;
            if (bestBody != BodyId{} && here.fraction >= best.fraction) continue;
            best = here;
            bestBody = id;
        }
        WorldRayHit hit;
        ASSERT_EQ(crowd.Queries().CastRay(ray, hit), bestBody != BodyId{}) << i;
        ASSERT_EQ(crowd.Queries().IsHit(ray), bestBody != BodyId{}) << i;
        crowd.Queries().CastRayAll(ray, all);
        EXPECT_EQ(all.size(), count) << i;
        if (bestBody == BodyId{}) continue;
        ++hits;
        EXPECT_EQ(hit.body, bestBody) << i;
        EXPECT_EQ(hit.subShape, best.subShape);
        EXPECT_EQ(hit.fraction, best.fraction);
        EXPECT_EQ(hit.normal, best.normal);
        ASSERT_FALSE(all.empty());
        EXPECT_EQ(all.front().body, hit.body);
        EXPECT_TRUE(std::is_sorted(all.begin(), all.end(),
                                   [](const auto& a, const auto& b) { return a.fraction < b.fraction; }));
    }
    EXPECT_GT(hits, cases / 8);
}

TEST(Query, ShapesHitOverlapAndAreClosestAsALoopOverAllBodiesSays) {
    Crowd crowd;
    RandomPoses random(3);
    int hits = 0, overlaps = 0;
    std::vector<OverlapHit> found;
    std::vector<WorldShapeHit> all;
    for (int i = 0; i < 2000; ++i) {
        const MovingShape move = crowd.RandomMove(random, i % 4 == 0);
        const Pose center{move.pose.Transform(move.shape->Mass().centerOfMass), move.pose.rotation};
        const ShapeCaster caster(*move.shape, {center, move.displacement, move.turn});
        float best = 2, closest = 1e9f;
        size_t count = 0, expectedOverlaps = 0;
        for (BodyId id : crowd.ids) {
            ShapeHit here;
            const Shape& shape = *crowd.world.Bodies().GetShape(id);
            const Pose pose = crowd.CenterPose(id);
            caster.CastAll(shape, pose, {}, [&](const ShapeHit&) { return ++count, true; });
            if (caster.CastClosest(shape, pose, {}, here)) best = std::min(best, here.fraction);
            ClosestPoints points;
            if (FindClosestPoints(shape, *move.shape, Relative(pose, center), 1000, points))
                closest = std::min(closest, points.distance);
            if (shape.IsConvex()) {
                expectedOverlaps += Overlap(shape, *move.shape, Relative(pose, center));
            } else {
                for (const Compound::Child& child : static_cast<const Compound&>(shape).Children())
                    expectedOverlaps += Overlap(*child.shape, *move.shape, Relative(pose * child.pose, center));
            }
        }
        WorldShapeHit hit;
        ASSERT_EQ(crowd.Queries().CastShape(move, hit), best < 2) << i;
        ASSERT_EQ(crowd.Queries().IsHit(move), best < 2) << i;
        crowd.Queries().CastShapeAll(move, all);
        EXPECT_EQ(all.size(), count) << i;
        if (best < 2) {
            ++hits;
            // A child's pose is made in one step here, in two there.
            EXPECT_NEAR(hit.fraction, best, 1e-5f) << i;
            EXPECT_EQ(all.front().body, hit.body);
        }
        WorldClosest nearest;
        ASSERT_TRUE(crowd.Queries().FindClosest(PlacedShape{move.shape, move.pose}, 1000, nearest));
        EXPECT_NEAR(nearest.distance, closest, 1e-4f) << i;
        EXPECT_FALSE(crowd.Queries().FindClosest(PlacedShape{move.shape, move.pose}, 0.9f * closest - 0.01f, nearest) &&
                     closest > 0.02f);
        crowd.Queries().FindOverlaps({move.shape, move.pose}, found);
        EXPECT_EQ(found.size(), expectedOverlaps) << i;
        EXPECT_EQ(crowd.Queries().IsOverlapping({move.shape, move.pose}), expectedOverlaps > 0);
        overlaps += expectedOverlaps > 0;
        // What overlaps is among what the broad phase says.
        std::vector<OverlapHit> box;
        const Vector3 reach = Vector3::Constant(move.shape->OuterRadius());
        crowd.Queries().FindInBox(center.position - reach.cast<double>(), center.position + reach.cast<double>(), box);
        EXPECT_TRUE(std::includes(box.begin(), box.end(), found.begin(), found.end()));
        crowd.Queries().FindOnSweep(center.position - reach.cast<double>(), center.position + reach.cast<double>(),
                                    move.displacement, box);
        for (const WorldShapeHit& h : all)
            EXPECT_TRUE(std::binary_search(box.begin(), box.end(), OverlapHit{h.body, h.subShape.child})) << i;
    }
    EXPECT_GT(hits, 300);
    EXPECT_GT(overlaps, 100);
}

TEST(Query, PointsInside) {
    Crowd crowd;
    std::vector<OverlapHit> found;
    for (BodyId id : crowd.ids) {
        const Compound* compound = dynamic_cast<const Compound*>(crowd.world.Bodies().GetShape(id).get());
        if (compound) continue;
        crowd.Queries().FindBodiesAt(crowd.world.Bodies().GetCenterOfMass(id), found);
        EXPECT_TRUE(std::find(found.begin(), found.end(), OverlapHit{id, 0}) != found.end());
    }
    crowd.Queries().FindBodiesAt(Position(100, 0, 0), found);
    EXPECT_TRUE(found.empty());
}

// 10^7 m away a double is exact to 2e-9 m, and poses are the same to that; so are all answers to a rounding of a float.
TEST(Query, ResultsFarAwayAreThoseAtTheOrigin) {
    Crowd here, far(Position(1e7, -1e7, 1e7));
    RandomPoses randomHere(4), randomFar(4);
    for (int i = 0; i < 3000; ++i) {
        const Ray rayHere = here.RandomRay(randomHere), rayFar = far.RandomRay(randomFar);
        WorldRayHit a, b;
        ASSERT_EQ(here.Queries().CastRay(rayHere, a), far.Queries().CastRay(rayFar, b)) << i;
        EXPECT_NEAR(a.fraction, b.fraction, 1e-6f);
        EXPECT_EQ(a.body, b.body);
        if (a.body != BodyId{}) {
            EXPECT_LT((b.position - far.origin - a.position).norm(), 1e-5);
        }
        const MovingShape moveHere = here.RandomMove(randomHere, i % 5 == 0),
                          moveFar = far.RandomMove(randomFar, i % 5 == 0);
        WorldShapeHit c, d;
        ASSERT_EQ(here.Queries().CastShape(moveHere, c), far.Queries().CastShape(moveFar, d)) << i;
        EXPECT_EQ(c.body, d.body) << i;
        EXPECT_NEAR(c.fraction, d.fraction, 1e-5f) << i;
    }
}

TEST(Query, BodiesAreFoundWhereTheyAreNow) {
    // Fast ones leave their bounds in every step; what the trees know is where they were, and where they were bound
    // for.
    Crowd crowd(Position::Zero(), 1, 60);
    RandomPoses random(5);
    std::vector<WorldRayHit> hits;
    for (int step = 0; step < 20; ++step) {
        for (size_t i = 2; i < crowd.ids.size(); i += 3) {
            // A force is no part of what the bounds are stretched by.
            ASSERT_TRUE(crowd.world.Bodies().AddForce(crowd.ids[i], random.InCube() * 1e6f));
        }
        ASSERT_TRUE(crowd.world.System().Update(kStep));
        for (BodyId id : crowd.ids) {
            const Position at = crowd.world.Bodies().GetCenterOfMass(id);
            const Shape& shape = *crowd.world.Bodies().GetShape(id);
            if (!shape.IsConvex()) continue;
            crowd.Queries().CastRayAll({at - Position(3, 0, 0), Vector3(6, 0, 0)}, hits);
            EXPECT_TRUE(std::any_of(hits.begin(), hits.end(), [&](const auto& h) { return h.body == id; })) << step;
            EXPECT_EQ(std::count_if(hits.begin(), hits.end(), [&](const auto& h) { return h.body == id; }), 1);
        }
        // Moved by hand, put to sleep, or gone since the step.
        const BodyId moved = crowd.ids[static_cast<size_t>(step * 3 + 2)];
        ASSERT_TRUE(crowd.world.Bodies().SetPose(moved, Position(0, 500, step), {}));
        WorldRayHit hit;
        if (crowd.world.Bodies().GetShape(moved)->IsConvex()) {
            const Position center = crowd.world.Bodies().GetCenterOfMass(moved);
            ASSERT_TRUE(crowd.Queries().CastRay({center + Position(0, 9, 0), Vector3(0, -9, 0)}, hit));
            EXPECT_EQ(hit.body, moved);
        }
        const BodyId asleep = crowd.ids[static_cast<size_t>(step * 3 + 65)];
        ASSERT_TRUE(crowd.world.Bodies().Sleep(asleep));
        crowd.Queries().CastRayAll({crowd.world.Bodies().GetCenterOfMass(asleep) - Position(3, 0, 0), Vector3(6, 0, 0)},
                                   hits);
        EXPECT_TRUE(std::any_of(hits.begin(), hits.end(), [&](const auto& h) { return h.body == asleep; }) ||
                    !crowd.world.Bodies().GetShape(asleep)->IsConvex());
    }
    const BodyId removed = crowd.ids[5];
    const Position at = crowd.world.Bodies().GetCenterOfMass(removed);
    ASSERT_TRUE(crowd.world.Bodies().Remove(removed));
    crowd.Queries().CastRayAll({at - Position(3, 0, 0), Vector3(6, 0, 0)}, hits);
    EXPECT_TRUE(std::none_of(hits.begin(), hits.end(), [&](const auto& h) { return h.body == removed; }));
}

TEST(Query, FiltersAndEarlyEnds) {
    Crowd crowd;
    RandomPoses random(6);
    std::vector<WorldRayHit> all, some;
    for (int i = 0; i < 2000; ++i) {
        const Ray ray = crowd.RandomRay(random);
        crowd.Queries().CastRayAll(ray, all);
        if (all.size() < 3) continue;
        // Without the first two bodies; the third's is then the first.
        const BodyId ignored[] = {all[0].body, all[1].body};
        const auto third = std::find_if(all.begin(), all.end(),
                                        [&](const auto& h) { return h.body != ignored[0] && h.body != ignored[1]; });
        WorldRayHit hit;
        const bool found = crowd.Queries().CastRay(ray, hit, {}, {.ignore = ignored});
        ASSERT_EQ(found, third != all.end());
        if (found) {
            EXPECT_EQ(hit.body, third->body);
        }
        const auto isWanted = [](BodyId id) { return id.index % 2 == 0; };
        crowd.Queries().CastRayAll(ray, some, {}, {.accepts = isWanted});
        EXPECT_EQ(some.size(), static_cast<size_t>(std::count_if(all.begin(), all.end(),
                                                                 [&](const auto& h) { return isWanted(h.body); })));
        const auto isFirst = [](BodyId, uint32_t child) { return child == 0; };
        crowd.Queries().CastRayAll(ray, some, {}, {.acceptsChild = isFirst});
        EXPECT_EQ(some.size(), static_cast<size_t>(std::count_if(all.begin(), all.end(),
                                                                 [](const auto& h) { return h.subShape.child == 0; })));
        // Body i is of layer i % 5.
        crowd.Queries().CastRayAll(ray, some, {}, {.layers = 0b01010});
        EXPECT_EQ(some.size(), static_cast<size_t>(std::count_if(all.begin(), all.end(), [](const auto& h) {
                      return h.body.index % 5 == 1 || h.body.index % 5 == 3;
                  })));
        int calls = 0;
        crowd.Queries().VisitRay(ray, [&](const WorldRayHit&) { return ++calls, -1.0f; });
        EXPECT_EQ(calls, 1);
        // A visitor that asks for ever closer hits ends with the closest.
        WorldRayHit last;
        crowd.Queries().VisitRay(ray, [&](const WorldRayHit& h) { return last = h, h.fraction; });
        EXPECT_EQ(last.fraction, all[0].fraction);
        // Queries inside of queries.
        crowd.Queries().VisitRay(ray, [&](const WorldRayHit& h) {
            WorldRayHit inner;
            EXPECT_TRUE(crowd.Queries().CastRay(ray, inner));
            EXPECT_LE(inner.fraction, h.fraction);
            return 1.0f;
        });
    }
}

TEST(Query, BatchesAnswerAsSingleQueriesDoOnAnyNumberOfThreads) {
    Crowd crowd(Position::Zero(), 4);
    RandomPoses random(7);
    std::vector<Ray> rays;
    std::vector<MovingShape> moves;
    std::vector<PlacedShape> placed;
    std::vector<Position> points;
    for (int i = 0; i < 2000; ++i) {
        rays.push_back(crowd.RandomRay(random));
        if (i >= 300) continue;
        moves.push_back(crowd.RandomMove(random, i % 2 == 0));
        placed.push_back({moves.back().shape, moves.back().pose});
        points.push_back(rays.back().origin);
    }
    const QueryInterface& queries = crowd.Queries();
    std::vector<WorldRayHit> rayHits(rays.size());
    std::vector<uint8_t> any(rays.size());
    std::vector<std::vector<WorldRayHit>> allRays;
    queries.CastRays(rays, rayHits);
    queries.AreHit(rays, any);
    queries.CastRaysAll(rays, allRays);
    std::vector<WorldRayHit> all;
    for (size_t i = 0; i < rays.size(); ++i) {
        WorldRayHit hit;
        queries.CastRay(rays[i], hit);
        EXPECT_EQ(hit.body, rayHits[i].body);
        EXPECT_EQ(hit.fraction, rayHits[i].fraction);
        EXPECT_EQ(hit.normal, rayHits[i].normal);
        EXPECT_EQ(any[i] != 0, hit.body != BodyId{});
        queries.CastRayAll(rays[i], all);
        ASSERT_EQ(all.size(), allRays[i].size());
        for (size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k].fraction, allRays[i][k].fraction);
    }
    std::vector<WorldShapeHit> shapeHits(moves.size());
    std::vector<WorldClosest> closest(moves.size()), closestToPoints(points.size());
    std::vector<std::vector<OverlapHit>> overlaps, inside;
    queries.CastShapes(moves, shapeHits);
    queries.FindClosest(std::span<const PlacedShape>(placed), 5, closest);
    queries.FindClosest(std::span<const Position>(points), 5, closestToPoints);
    queries.FindOverlaps(placed, overlaps);
    queries.FindBodiesAt(points, inside);
    for (size_t i = 0; i < moves.size(); ++i) {
        WorldShapeHit hit;
        queries.CastShape(moves[i], hit);
        EXPECT_EQ(hit.body, shapeHits[i].body);
        EXPECT_EQ(hit.fraction, shapeHits[i].fraction);
        WorldClosest nearest;
        queries.FindClosest(placed[i], 5, nearest);
        EXPECT_EQ(nearest.body, closest[i].body);
        EXPECT_EQ(nearest.distance, closest[i].distance);
        std::vector<OverlapHit> found;
        queries.FindOverlaps(placed[i], found);
        EXPECT_EQ(found, overlaps[i]);
        queries.FindBodiesAt(points[i], found);
        EXPECT_EQ(found, inside[i]);
    }
}

TEST(Query, AnyThreadAsksWhileAnotherChangesAndSteps) {
    Crowd crowd(Position::Zero(), 2, 5, 150);
    std::atomic<bool> stop{false};
    std::atomic<int> asked{0};
    std::vector<std::thread> threads;
    for (uint32_t t = 0; t < 3; ++t) {
        threads.emplace_back([&, t] {
            RandomPoses random(10 + t);
            std::vector<WorldRayHit> all, batch(64);
            std::vector<Ray> rays(64);
            while (!stop) {
                WorldRayHit hit;
                crowd.Queries().CastRay(crowd.RandomRay(random), hit);
                crowd.Queries().CastRayAll(crowd.RandomRay(random), all);
                for (Ray& ray : rays) ray = crowd.RandomRay(random);
                crowd.Queries().CastRays(rays, batch);
                WorldShapeHit shapeHit;
                crowd.Queries().CastShape(crowd.RandomMove(random, true), shapeHit);
                const WorldLock::Shared held = crowd.Queries().Hold();
                if (crowd.Queries().CastRay(crowd.RandomRay(random), hit)) {
                    // Still there: nothing changes while it is held.
                    if (!crowd.world.Bodies().Exists(hit.body)) stop = true;
                    EXPECT_TRUE(crowd.world.Bodies().Exists(hit.body));
                }
                ++asked;
            }
        });
    }
    RandomPoses random(99);
    for (int step = 0; step < 60 || asked < 30; ++step) {
        ASSERT_TRUE(crowd.world.System().Update(kStep));
        const size_t at = static_cast<size_t>(random.Between(0, 149.9f));
        const Position place = random.InCube().cast<double>() * 10;
        ASSERT_TRUE(crowd.world.Bodies().SetPose(crowd.ids[at], place, random.Rotation()));
        if (step % 7 == 0) {
            ASSERT_TRUE(crowd.world.Bodies().Remove(crowd.ids[at]));
            crowd.ids[at] =
                crowd.world.Bodies().Create({.shape = crowd.shapes[1], .linearVelocity = Vector3(1, 2, 3)}).Value();
        }
    }
    stop = true;
    for (std::thread& thread : threads) thread.join();
}

TEST(Query, NonFiniteInputFindsNothing) {
    Crowd crowd;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const double nanPosition = std::numeric_limits<double>::quiet_NaN();
    WorldRayHit hit;
    EXPECT_FALSE(crowd.Queries().CastRay({Position(0, 0, 0), Vector3(nan, 0, 0)}, hit));
    EXPECT_FALSE(crowd.Queries().CastRay({Position(nanPosition, 0, 0), Vector3(1, 0, 0)}, hit));
    EXPECT_FALSE(crowd.Queries().CastRay({Position::Zero(), Vector3::Zero()}, hit));
    const ConvexShape& ball = static_cast<const ConvexShape&>(*crowd.shapes[0]);
    WorldShapeHit shapeHit;
    EXPECT_FALSE(crowd.Queries().CastShape({&ball, {}, Vector3(0, nan, 0)}, shapeHit));
    EXPECT_FALSE(crowd.Queries().CastShape({&ball, {Position(0, nanPosition, 0), {}}, Vector3(0, 1, 0)}, shapeHit));
    EXPECT_FALSE(crowd.Queries().IsOverlapping({&ball, {Position(0, nanPosition, 0), {}}}));
    WorldClosest closest;
    EXPECT_FALSE(crowd.Queries().FindClosest(Position(nanPosition, 0, 0), 10, closest));
    EXPECT_FALSE(crowd.Queries().FindClosest(Position::Zero(), nan, closest));
    std::vector<OverlapHit> found;
    crowd.Queries().FindInBox(Position(nanPosition, 0, 0), Position(1, 1, 1), found);
    EXPECT_TRUE(found.empty());
    crowd.Queries().FindBodiesAt(Position(nanPosition, 0, 0), found);
    EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace fulcrum::testing
