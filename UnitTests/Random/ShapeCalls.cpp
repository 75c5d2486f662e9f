#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/UnitTests/Random/Calls.h>
#include <Fulcrum/UnitTests/Random/QueryChecks.h>
#include <Fulcrum/UnitTests/Random/RandomShapes.h>

#include <cfloat>

namespace fulcrum::testing {

namespace {

// Saved shapes are loaded with the same bits.
void SaveAndLoad(Twin&, Values& values, const CallTargets&, Outcome& outcome) {
    const ShapePtr shape = RandomShape(values);
    if (!shape) return;
    const Result<std::vector<uint8_t>> saved = SaveShape(*shape);
    outcome.answer.Add(static_cast<bool>(saved));
    if (!saved) return;
    const Result<ShapePtr> loaded = LoadShape(saved.Value());
    if (!loaded) {
        outcome.failure = std::string("a ") + ShapeTypeName(shape->Type()) +
                          " was saved and is not loaded: " + loaded.GetError().message;
        return;
    }
    const Result<std::vector<uint8_t>> again = SaveShape(*loaded.Value());
    if (!again || again.Value() != saved.Value()) outcome.failure = "a shape was saved and loaded with other bits";
}

void MeasureDistance(Twin&, Values& values, const CallTargets&, Outcome& outcome) {
    const ShapePtr a = RandomConvex(values), b = RandomConvex(values);
    if (!a || !b) return;
    const float reach = a->OuterRadius() + b->OuterRadius();
    if (!(reach <= 1e18f)) return;  // a user's own shape may be anything
    const RelativePose pose{values.Random().InBox(values.Chance(0.1f) ? reach * 10 : reach), values.Rotation()};
    if (!(std::abs(LengthSquared(pose.rotation) - 1) < 1e-3f)) return;
    ClosestPoints closest;
    if (!FindClosestPoints(*a, *b, pose, FLT_MAX, closest)) {
        const Quaternion& q = pose.rotation;
        outcome.failure = Text("no closest points of a ", ShapeTypeName(a->Type()), " of ", a->OuterRadius(), " and a ",
                               ShapeTypeName(b->Type()), " of ", b->OuterRadius(), " at ", pose.position, " turned by ",
                               q.x, " ", q.y, " ", q.z, " ", q.w);
        return;
    }
    outcome.failure =
        CheckClosest(static_cast<const ConvexShape&>(*a), static_cast<const ConvexShape&>(*b), pose, closest);
    outcome.answer.Add(closest.distance);
    outcome.answer.Add(closest.normal);
    const bool overlap = Overlap(*a, *b, pose);
    const float unsure = 1e-4f * (reach + Length(pose.position));
    if (outcome.failure.empty() && std::abs(closest.distance) > unsure && overlap != (closest.distance < 0))
        outcome.failure = "whether two shapes overlap differs from their distance";
}

// A single body, without the world's trees: the shapes touch at the hit of a cast, and not before it.
void CastAtShape(Twin&, Values& values, const CallTargets&, Outcome& outcome) {
    const ShapePtr moving = RandomConvex(values), rest = RandomShape(values);
    if (!moving || !rest) return;
    const float reach = moving->OuterRadius() + std::min(rest->OuterRadius(), 1e6f);
    const BodyShape body{
        {0, 0}, rest, {Position(values.Random().InBox(reach).cast<double>()), values.Random().Rotation()}};
    MovingShape motion{static_cast<const ConvexShape*>(moving.get()),
                       {Position(values.Random().InBox(2 * reach).cast<double>()), values.Random().Rotation()}};
    motion.displacement = values.Random().InBox(3 * reach);
    if (values.Chance(0.4f)) motion.turn = values.Random().InBox(2);
    ShapeHit hit;
    const Position center = motion.pose.Transform(moving->Mass().centerOfMass);
    const ShapeCaster caster(*motion.shape, {{center, motion.pose.rotation}, motion.displacement, motion.turn});
    if (!caster.CastClosest(*rest, body.pose, {}, hit)) return;
    outcome.answer.Add(hit.fraction);
    outcome.failure = CheckShapeHit(
        {body}, motion, {body.id, hit.subShape, hit.fraction, hit.normal, hit.position, hit.depth, hit.isEarly});
}

constexpr CallKind kCalls[] = {
    {"SaveAndLoad", 1, SaveAndLoad},
    {"MeasureDistance", 3, MeasureDistance},
    {"CastAtShape", 2, CastAtShape},
};

}  // namespace

std::span<const CallKind> ShapeCalls() { return kCalls; }

}  // namespace fulcrum::testing
