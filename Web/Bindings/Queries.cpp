// Queries: rays, moving shapes, overlaps, closest bodies. Their answers are JSON.
#include <Fulcrum/Web/Bindings/Exchange.h>

namespace fulcrum::web {

namespace {

// What every query may be given, and what some take.
struct QueryInput {
    Position origin = Position::Zero(), position = Position::Zero();
    Vector3 displacement = Vector3::Zero(), turn = Vector3::Zero();
    Quaternion rotation;
    ShapePtr shape;
    double maxDistance = 1e3;
    uint32_t layers = 0xFFFFFFFFu;
    bool sensors = false;
    std::vector<std::array<uint32_t, 2>> ignore;
    std::vector<BodyId> ignored;

    QueryFilter Filter() {
        for (const auto& [index, generation] : ignore) ignored.push_back({index, generation});
        return {.layers = layers, .ignore = ignored, .sensors = sensors};
    }
};

bool Read(QueryInput& input, std::initializer_list<const char*> needed) {
    return ReadInput("query", [&](JsonReader& fields) {
        for (const char* name : needed)
            if (!fields.Find(name) && !fields.Document().error)
                fields.Document().error = WrongAt(name, "it is missing");
        fields.Field("origin", input.origin);
        fields.Field("position", input.position);
        fields.Field("displacement", input.displacement);
        fields.Field("turn", input.turn);
        fields.Field("rotation", input.rotation);
        fields.Field("shape", input.shape);
        fields.Field("maxDistance", input.maxDistance);
        fields.Field("layers", input.layers);
        fields.Field("sensors", input.sensors);
        fields.Field("ignore", input.ignore);
    });
}

// A convex shape; null, with an error, if it is none.
const ConvexShape* ConvexOf(const ShapePtr& shape) {
    const auto* convex = dynamic_cast<const ConvexShape*>(shape.get());
    if (!convex) Fail(WrongAt("shape", "it must be convex"));
    return convex;
}

Json Written(const WorldRayHit& hit) {
    return {{"body", IdOf(hit.body)},        {"child", hit.subShape.child},       {"fraction", hit.fraction},
            {"normal", ListOf3(hit.normal)}, {"position", ListOf3(hit.position)}, {"isBackFace", hit.isBackFace}};
}

}  // namespace

// Of all queries. Input: origin, displacement. The answer is a hit or null.
FULCRUM_FOR_JAVASCRIPT int fulcrum_castRay(World* world) {
    QueryInput input;
    WorldRayHit hit;
    if (!Read(input, {"origin", "displacement"})) return 0;
    if (!world->System().Queries().CastRay({input.origin, input.displacement}, hit, {}, input.Filter()))
        return Answer(nullptr);
    return Answer(Written(hit));
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_castRayAll(World* world) {
    QueryInput input;
    std::vector<WorldRayHit> hits;
    if (!Read(input, {"origin", "displacement"})) return 0;
    world->System().Queries().CastRayAll({input.origin, input.displacement}, hits, {}, input.Filter());
    Json list = Json::array();
    for (const WorldRayHit& hit : hits) list.push_back(Written(hit));
    return Answer(list);
}
// Input: shape, position, rotation, displacement, turn.
FULCRUM_FOR_JAVASCRIPT int fulcrum_castShape(World* world) {
    QueryInput input;
    WorldShapeHit hit;
    if (!Read(input, {"shape", "displacement"})) return 0;
    const ConvexShape* shape = ConvexOf(input.shape);
    if (!shape) return 0;
    const MovingShape moving = {shape, {input.position, input.rotation}, input.displacement, input.turn};
    if (!world->System().Queries().CastShape(moving, hit, {}, input.Filter())) return Answer(nullptr);
    return Answer({{"body", IdOf(hit.body)},
                   {"child", hit.subShape.child},
                   {"fraction", hit.fraction},
                   {"normal", ListOf3(hit.normal)},
                   {"position", ListOf3(hit.position)},
                   {"depth", hit.depth}});
}
// Input: shape, position, rotation.
FULCRUM_FOR_JAVASCRIPT int fulcrum_findOverlaps(World* world) {
    QueryInput input;
    std::vector<OverlapHit> hits;
    if (!Read(input, {"shape"})) return 0;
    world->System().Queries().FindOverlaps({input.shape.get(), {input.position, input.rotation}}, hits, input.Filter());
    Json list = Json::array();
    for (const OverlapHit& hit : hits) list.push_back({{"body", IdOf(hit.body)}, {"child", hit.child}});
    return Answer(list);
}
// Input: position, maxDistance.
FULCRUM_FOR_JAVASCRIPT int fulcrum_findClosest(World* world) {
    QueryInput input;
    WorldClosest closest;
    if (!Read(input, {"position"})) return 0;
    if (!world->System().Queries().FindClosest(input.position, static_cast<float>(input.maxDistance), closest,
                                               input.Filter()))
        return Answer(nullptr);
    return Answer({{"body", IdOf(closest.body)},
                   {"distance", closest.distance},
                   {"normal", ListOf3(closest.normal)},
                   {"position", ListOf3(closest.onBody)}});
}

}  // namespace fulcrum::web
