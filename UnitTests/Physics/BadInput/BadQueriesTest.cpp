// Every query, with one number or shape at a time that is not a number, infinite, zero, negative, huge or null: it
// finds nothing where it must, what it finds is finite, it returns, and no bit of the world has changed. The list is
// held to the headers.
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/UnitTests/Physics/BadInput/Room.h>

#include <cmath>
#include <functional>
#include <set>

namespace fulcrum::testing {

// ---- What queries are given, with the fields of each structure.

struct QueryArguments {
    Ray ray{{0, 5, 0}, {0, -10, 0}};
    RayCastSettings raySettings;
    MovingShape moving;
    ShapeCastSettings castSettings;
    PlacedShape placed;
    Position point{0.1, 0.4, 0}, lower{-1, 0, -1}, upper{1, 1, 1};
    Vector3 displacement{1, 0, 0};
    float distance = 2;
};

template <class Archive>
void Describe(Archive& archive, Ray& ray) {
    archive.Field("origin", ray.origin);
    archive.Field("displacement", ray.displacement);
}
template <class Archive>
void Describe(Archive& archive, RayCastSettings& settings) {
    archive.Field("maxFraction", settings.maxFraction);
}
template <class Archive>
void Describe(Archive& archive, MovingShape& moving) {
    archive.Field("pose", moving.pose);
    archive.Field("displacement", moving.displacement);
    archive.Field("turn", moving.turn);
}
template <class Archive>
void Describe(Archive& archive, ShapeCastSettings& settings) {
    archive.Field("maxFraction", settings.maxFraction);
    archive.Field("separation", settings.separation);
    archive.Field("tolerance", settings.tolerance);
}
template <class Archive>
void Describe(Archive& archive, PlacedShape& placed) {
    archive.Field("pose", placed.pose);
}
namespace {

// ---- Queries

struct Found {
    size_t count = 0;
    bool isFinite = true;

    void Add(const WorldRayHit& hit) {
        count += hit.body != BodyId{};
        isFinite &= std::isfinite(hit.fraction) && IsFinite(hit.normal) && IsFinite(hit.position);
    }
    void Add(const WorldShapeHit& hit) {
        count += hit.body != BodyId{};
        isFinite &=
            std::isfinite(hit.fraction) && IsFinite(hit.normal) && IsFinite(hit.position) && std::isfinite(hit.depth);
    }
    void Add(const WorldClosest& hit) {
        count += hit.body != BodyId{};
        isFinite &=
            std::isfinite(hit.distance) && IsFinite(hit.normal) && IsFinite(hit.onBody) && IsFinite(hit.onQuery);
    }
    void Add(const WorldContact& contact) {
        ++count;
        isFinite &= IsFinite(contact.normal);
        for (const WorldContact::Point& point : contact.Points())
            isFinite &= IsFinite(point.onBody) && IsFinite(point.onQuery) && std::isfinite(point.separation);
    }
    void Add(const OverlapHit&) { ++count; }
    void Add(uint8_t hit) { count += hit != 0; }
    template <class T>
    void Add(const std::vector<T>& hits) {
        for (const T& hit : hits) Add(hit);
    }
};

struct Query {
    const char* name;  // function, and which overload
    const char* uses;  // the arguments whose values matter, see QueryArguments
    void (*ask)(const QueryInterface& queries, const QueryArguments& a, Found& found);
};

#define FULCRUM_QUERY(...) \
    [](const QueryInterface& q, [[maybe_unused]] const QueryArguments& a, Found& found) { __VA_ARGS__ }
const Query kQueries[] = {
    {"CastRay", "ray raySettings",
     FULCRUM_QUERY(WorldRayHit hit; if (q.CastRay(a.ray, hit, a.raySettings)) found.Add(hit);)},
    {"IsHit", "ray raySettings", FULCRUM_QUERY(found.Add(uint8_t{q.IsHit(a.ray, a.raySettings)});)},
    {"CastRayAll", "ray raySettings",
     FULCRUM_QUERY(std::vector<WorldRayHit> hits; q.CastRayAll(a.ray, hits, a.raySettings); found.Add(hits);)},
    {"VisitRay", "ray raySettings", FULCRUM_QUERY(q.VisitRay(
                                        a.ray,
                                        [&](const WorldRayHit& hit) {
                                            found.Add(hit);
                                            return 1.0f;
                                        },
                                        a.raySettings);)},
    {"CastShape", "moving castSettings",
     FULCRUM_QUERY(WorldShapeHit hit; if (q.CastShape(a.moving, hit, a.castSettings)) found.Add(hit);)},
    {"IsHit of a shape", "moving castSettings", FULCRUM_QUERY(found.Add(uint8_t{q.IsHit(a.moving, a.castSettings)});)},
    {"CastShapeAll", "moving castSettings",
     FULCRUM_QUERY(std::vector<WorldShapeHit> hits; q.CastShapeAll(a.moving, hits, a.castSettings); found.Add(hits);)},
    {"VisitShape", "moving castSettings", FULCRUM_QUERY(q.VisitShape(
                                              a.moving,
                                              [&](const WorldShapeHit& hit) {
                                                  found.Add(hit);
                                                  return 1.0f;
                                              },
                                              a.castSettings);)},
    {"IsOverlapping", "placed", FULCRUM_QUERY(found.Add(uint8_t{q.IsOverlapping(a.placed)});)},
    {"FindOverlaps", "placed",
     FULCRUM_QUERY(std::vector<OverlapHit> hits; q.FindOverlaps(a.placed, hits); found.Add(hits);)},
    {"VisitOverlaps", "placed", FULCRUM_QUERY(q.VisitOverlaps(a.placed, [&](const OverlapHit& hit) {
         found.Add(hit);
         return true;
     });)},
    {"CollideShape", "placed distance",
     FULCRUM_QUERY(std::vector<WorldContact> hits; q.CollideShape(a.placed, a.distance, hits); found.Add(hits);)},
    {"FindBodiesAt", "point",
     FULCRUM_QUERY(std::vector<OverlapHit> hits; q.FindBodiesAt(a.point, hits); found.Add(hits);)},
    {"FindClosest", "point distance",
     FULCRUM_QUERY(WorldClosest hit; if (q.FindClosest(a.point, a.distance, hit)) found.Add(hit);)},
    {"FindClosest to a shape", "placed distance",
     FULCRUM_QUERY(WorldClosest hit; if (q.FindClosest(a.placed, a.distance, hit)) found.Add(hit);)},
    {"FindInBox", "lower upper",
     FULCRUM_QUERY(std::vector<OverlapHit> hits; q.FindInBox(a.lower, a.upper, hits); found.Add(hits);)},
    {"FindOnRay", "ray", FULCRUM_QUERY(std::vector<OverlapHit> hits; q.FindOnRay(a.ray, hits); found.Add(hits);)},
    {"FindOnSweep", "lower upper displacement",
     FULCRUM_QUERY(std::vector<OverlapHit> hits; q.FindOnSweep(a.lower, a.upper, a.displacement, hits);
                   found.Add(hits);)},
    {"CastRays", "ray raySettings", FULCRUM_QUERY(std::vector<WorldRayHit> hits(2); const Ray rays[] = {a.ray, a.ray};
                                                  q.CastRays(rays, hits, a.raySettings); found.Add(hits);)},
    {"AreHit", "ray raySettings", FULCRUM_QUERY(std::vector<uint8_t> hits(2); const Ray rays[] = {a.ray, a.ray};
                                                q.AreHit(rays, hits, a.raySettings); found.Add(hits);)},
    {"CastRaysAll", "ray raySettings",
     FULCRUM_QUERY(std::vector<std::vector<WorldRayHit>> hits; const Ray rays[] = {a.ray, a.ray};
                   q.CastRaysAll(rays, hits, a.raySettings); found.Add(hits);)},
    {"CastShapes", "moving castSettings",
     FULCRUM_QUERY(std::vector<WorldShapeHit> hits(2); const MovingShape shapes[] = {a.moving, a.moving};
                   q.CastShapes(shapes, hits, a.castSettings); found.Add(hits);)},
    {"AreHit of shapes", "moving castSettings",
     FULCRUM_QUERY(std::vector<uint8_t> hits(2); const MovingShape shapes[] = {a.moving, a.moving};
                   q.AreHit(shapes, hits, a.castSettings); found.Add(hits);)},
    {"CastShapesAll", "moving castSettings",
     FULCRUM_QUERY(std::vector<std::vector<WorldShapeHit>> hits; const MovingShape shapes[] = {a.moving, a.moving};
                   q.CastShapesAll(shapes, hits, a.castSettings); found.Add(hits);)},
    {"AreOverlapping", "placed",
     FULCRUM_QUERY(std::vector<uint8_t> hits(2); const PlacedShape shapes[] = {a.placed, a.placed};
                   q.AreOverlapping(shapes, hits); found.Add(hits);)},
    {"FindOverlaps of shapes", "placed",
     FULCRUM_QUERY(std::vector<std::vector<OverlapHit>> hits; const PlacedShape shapes[] = {a.placed, a.placed};
                   q.FindOverlaps(shapes, hits); found.Add(hits);)},
    {"FindBodiesAt of points", "point",
     FULCRUM_QUERY(std::vector<std::vector<OverlapHit>> hits; const Position points[] = {a.point, a.point};
                   q.FindBodiesAt(points, hits); found.Add(hits);)},
    {"FindClosest to points", "point distance",
     FULCRUM_QUERY(std::vector<WorldClosest> hits(2); const Position points[] = {a.point, a.point};
                   q.FindClosest(points, a.distance, hits); found.Add(hits);)},
    {"FindClosest to shapes", "placed distance",
     FULCRUM_QUERY(std::vector<WorldClosest> hits(2); const PlacedShape shapes[] = {a.placed, a.placed};
                   q.FindClosest(shapes, a.distance, hits); found.Add(hits);)},
};
#undef FULCRUM_QUERY

TEST(BadQueries, AreAllInTheList) {
    std::multiset<std::string> listed, declared;
    for (const Query& query : kQueries)
        listed.insert(std::string(query.name).substr(0, std::string(query.name).find(' ')));
    for (const PublicFunction& function : PublicFunctionsOf("Physics/QueryInterface.h", "QueryInterface"))
        if (function.name != "Hold" && function.name != "MayCollide") declared.insert(function.name);
    EXPECT_EQ(listed, declared);
    EXPECT_GE(declared.size(), 28u);
}

int misuses = 0;

QueryArguments GoodArguments(const Room& room) {
    QueryArguments arguments;
    arguments.moving = {static_cast<const ConvexShape*>(room.ball.get()), {{-3, 0.5, 0}, {}}, {6, 0, 0}, {0, 1, 0}};
    arguments.placed = {room.ball.get(), {{0.1, 0.4, 0}, {}}};
    return arguments;
}

// The number of values tried with a query.
int TryQuery(const Room& room, const Query& query) {
    SCOPED_TRACE(query.name);
    const auto ask = [&](const QueryArguments& arguments) {
        Found found;
        query.ask(room.system.Queries(), arguments, found);
        return found;
    };
    const QueryArguments good = GoodArguments(room);
    const Found usual = ask(good);
    EXPECT_GT(usual.count, 0u) << "with good arguments";
    EXPECT_TRUE(usual.isFinite);
    const std::string uses = std::string(" ") + query.uses + " ";
    int values = 0;
    for (size_t which = 0;; ++which) {
        QueryArguments bad = good;
        Spoiler spoiler(which, room.bad);
        const auto spoil = [&](const char* name, auto& value) {
            if (uses.find(std::string(" ") + name + " ") != std::string::npos) spoiler.Argument(name, value);
        };
        spoil("ray", bad.ray);
        spoil("raySettings", bad.raySettings);
        spoil("moving", bad.moving);
        spoil("castSettings", bad.castSettings);
        spoil("placed", bad.placed);
        spoil("point", bad.point);
        spoil("lower", bad.lower);
        spoil("upper", bad.upper);
        spoil("displacement", bad.displacement);
        spoil("distance", bad.distance);
        if (!spoiler.Done()) break;
        ++values;
        const Spoiled& spoiled = *spoiler.Done();
        const Found found = ask(bad);
        EXPECT_TRUE(found.isFinite) << spoiled.path << " = " << spoiled.value;
        const bool isPose = spoiled.path.find("pose") != std::string::npos;
        const bool findsNothing = spoiled.value == "NaN" || (isPose && spoiled.value.ends_with("inf"));
        EXPECT_TRUE(found.count == 0 || !findsNothing) << spoiled.path << " = " << spoiled.value;
    }
    // Without a shape.
    if (uses.find("moving") == std::string::npos && uses.find("placed") == std::string::npos) return values;
    QueryArguments none = good;
    none.moving.shape = nullptr;
    none.placed.shape = nullptr;
    misuses = 0;
    EXPECT_EQ(ask(none).count, 0u) << "without a shape";
    EXPECT_GE(misuses, 1) << "without a shape";
    return values + 1;
}

TEST(BadQueries, FindNothingAndChangeNothing) {
    Room room;
    SetMisuseHandler([](const Error&) { ++misuses; });
    int values = 0;
    for (const Query& query : kQueries) values += TryQuery(room, query);
    SetMisuseHandler(nullptr);
    EXPECT_GT(values, 1000);
    EXPECT_EQ(room.system.HashState(), room.Hash());
}

}  // namespace
}  // namespace fulcrum::testing
