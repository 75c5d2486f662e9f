// What a recording has beside shapes and motion: the first view, what bodies look like, and the figures of the curves.
#include <Fulcrum/Samples/Runner/Recorder.h>
#include <Fulcrum/Samples/Scenes/SpringEnergy.h>

#include <algorithm>

namespace fulcrum {

void Recorder::NoteView() {
    const SceneView& view = world_.Definition().view;
    const Position& origin = recording.origin;
    static constexpr const char* kColors[] = {"plain", "island", "speed", "awake"};
    RecordedView& recorded = recording.view;
    recorded.color = kColors[static_cast<size_t>(view.color)];
    recorded.from = view.from;
    recorded.picture = view.picture;
    recorded.showsJoints = view.showsJoints;
    if (view.lower != view.upper) {
        recorded.lower = PlaceFrom(view.lower, origin);
        recorded.upper = PlaceFrom(view.upper, origin);
    }
    if (view.waterLower != view.waterUpper) {
        recorded.waterLower = PlaceFrom(view.waterLower, origin);
        recorded.waterUpper = PlaceFrom(view.waterUpper, origin);
    }
    recording.hasFigures = true;
    for (int stage = 0; stage < kStageCount; ++stage) recording.stageNames.push_back(StageName(stage));
}

void Recorder::NoteLooks(BodyId id, uint32_t body) {
    RecordedBody& recorded = recording.bodies[body];
    const int follows = world_.Definition().view.follows;
    if (follows >= 0 && world_.watched.at(static_cast<size_t>(follows)) == id)
        recording.view.follows = static_cast<int>(body);
    for (const auto& [owner, look] : world_.looks) {
        if (owner != id) continue;
        recorded.name = look.label;
        recorded.look = {.look = static_cast<uint8_t>(look.look),
                         .teeth = look.teeth,
                         .toothAngle = look.toothAngle,
                         .beltVelocity = look.beltVelocity,
                         .beltTurning = look.beltTurning,
                         .beltPivot = PlaceFrom(look.beltPivot, recording.origin)};
    }
}

// Turns the materials of its triangles into looks.
void Recorder::PutLooks(BodyId user, RecordedShape& shape) const {
    for (const auto& [owner, looks] : world_.surfaceLooks) {
        if (owner != user) continue;
        for (uint8_t& look : shape.looks)
            look = static_cast<uint8_t>(look < looks.size() ? looks[look] : Look::Default);
        return;
    }
    shape.looks.clear();
}

// Of a step. The stages' times are summed until CollectFigures makes means of them.
void Recorder::NoteStep() {
    const StepReport& report = world_.System().Report();
    figures_.stageMs.resize(kStageCount);
    for (size_t stage = 0; stage < kStageCount; ++stage)
        figures_.stageMs[stage] += static_cast<float>(report.stageMs[stage]);
    ++stepsOfFigures_;
    if (report.largestPenetration <= figures_.penetration) return;
    const auto a = RecordedBodyOf(report.deepestA), b = RecordedBodyOf(report.deepestB);
    if (!a || !b) return;
    figures_.penetration = report.largestPenetration;
    figures_.deepestA = *a;
    figures_.deepestB = *b;
}

void Recorder::CollectFigures() {
    for (float& ms : figures_.stageMs) ms /= static_cast<float>(std::max(1, stepsOfFigures_));
    const BodyInterface& bodies = world_.Bodies();
    Position momentum = Position::Zero(), angular = Position::Zero();
    world_.System().VisitBodies([&](BodyId id) {
        if (bodies.GetMotionType(id) != MotionType::Dynamic || !bodies.IsAwake(id)) return;
        ++figures_.awake;
        figures_.kinetic += bodies.GetKineticEnergy(id);
        const Position push = bodies.GetLinearVelocity(id).cast<double>() * double{bodies.GetMass(id)};
        momentum += push;
        angular += bodies.GetAngularMomentum(id).cast<double>() +
                   Cross<double>(Position(bodies.GetCenterOfMass(id) - recording.origin), push);
    });
    figures_.potential = world_.System().GetEnergy() - figures_.kinetic;
    figures_.springs = SpringEnergy(world_.System());
    figures_.momentum = momentum.norm();
    figures_.angularMomentum = angular.norm();
    figures_.contacts = world_.System().Report().contacts;
}

}  // namespace fulcrum
