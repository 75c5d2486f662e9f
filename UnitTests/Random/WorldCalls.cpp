#include <Fulcrum/UnitTests/Random/Calls.h>

#include <Fulcrum/Physics/Fields/Fields.h>

namespace fulcrum::testing {

namespace {

void Step(Twin& twin, Values& values, const CallTargets&, Outcome& outcome) {
    constexpr double kLengths[] = {1.0 / 60, 1.0 / 60, 1.0 / 60, 1.0 / 240, 1.0 / 30, 0.1, 0, 1e-10};
    const double dt = values.IsOdd() ? double{values.Extreme()} : kLengths[values.Below(8)];
    Note(twin.system->Update(dt), outcome);
    outcome.answer.Add(twin.system->Report().contacts);
    outcome.answer.Add(twin.system->Report().contactPoints);
    outcome.answer.Add(twin.system->Report().largestPenetration);
    for (const SensorEvent& event : twin.system->SensorEvents()) outcome.answer.Add(event.body);
    if (outcome.isRefused) return;  // events are those of the last step, which snapshots do not have
    const StepEvents& events = twin.system->Events();
    for (const ContactEvent& event : events.contacts) {
        outcome.answer.Add(event.bodyA);
        outcome.answer.Add(static_cast<uint32_t>(event.kind));
        outcome.answer.Add(event.NormalImpulse());
    }
    for (const std::span<const BodyId> ids : {events.moved, events.woke, events.fellAsleep})
        for (const BodyId id : ids) outcome.answer.Add(id);
}

void SetSettings(Twin& twin, Values& values, const CallTargets&, Outcome& outcome) {
    if (!values.Style().changeSettings) return;
    SystemSettings settings = twin.system->Settings();
    const auto mostly = [&](float& field, float low, float high) {
        if (values.Chance(0.15f)) field = values.Setting(low, high);
    };
    if (values.Chance(0.3f)) settings.gravity = Vector3(0, values.Setting(-20, 5), 0);
    if (values.Chance(0.3f)) settings.solver.substeps = values.Integer(1, 10);
    if (values.Chance(0.2f)) settings.solver.velocityIterations = values.Integer(1, 4);
    if (values.Chance(0.2f)) settings.solver.positionIterations = values.Integer(0, 2);
    if (values.Chance(0.2f)) settings.solver.positionCorrection = static_cast<PositionCorrection>(values.Integer(0, 1));
    settings.sleep.enabled = values.Chance(0.8f);
    mostly(settings.sleep.seconds, 0, 1);
    mostly(settings.sleep.linearSpeed, 0, 0.1f);
    mostly(settings.speculativeDistance, 0.001f, 0.05f);
    mostly(settings.penetrationSlop, 0, 0.01f);
    mostly(settings.contactFrequency, 10, 100);
    mostly(settings.contactDampingRatio, 0.5f, 2);
    mostly(settings.contactPushSpeed, 1, 10);
    mostly(settings.exactJointLoad, 1, 100);
    mostly(settings.jointPushSpeed, 5, 40);
    mostly(settings.restitutionSpeed, 0, 2);
    mostly(settings.boundsMargin, 0.01f, 0.2f);
    if (values.Chance(0.3f)) {
        const uint32_t i = values.Below(3), j = values.Below(3);
        settings.layerCollides[i] ^= 1u << j;
        if (i != j) settings.layerCollides[j] ^= 1u << i;
    }
    if (values.Chance(0.1f)) settings.narrowPhase = values.One<NarrowPhaseMethod>(2);
    mostly(settings.accuracy.penetration, 0.001f, 0.1f);
    if (values.Chance(0.1f)) settings.accuracy.jointError = values.Setting(0.0005f, 0.1f);
    settings.measuresErrors = settings.sleep.enabled;
    if (values.Chance(0.3f))
        settings.events = {
            .contacts = values.Chance(0.7f), .stays = values.Chance(0.5f), .bodies = values.Chance(0.5f)};
    Note(twin.system->SetSettings(settings), outcome);
}

// Pure functions of the ids and the geometry, one for each kind of answer.
class Ghosts final : public ContactListener {
    bool ShouldCollide(BodyId a, BodyId b) const override { return (a.index + b.index) % 5 != 0; }
};
class Belts final : public ContactListener {
    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        if (contact.bodyA.index % 3 == 0) change.surfaceVelocity = Vector3(1, 0, 0);
        if (contact.bodyA.index % 5 == 0) change.ignore = contact.normal.y() > 0;
        if (contact.bodyA.index % 7 == 0) change.isSensor = contact.normal.x() > 0;
        if (contact.bodyA.index % 4 == 0) change.friction = 0;
        if (contact.bodyB.index % 4 == 0) change.restitution = 1;
    }
};
class Nonsense final : public ContactListener {
    void ModifyContact(const ContactView&, ContactChange& change) const override {
        change.friction = -3e38f;
        change.restitution = std::numeric_limits<float>::quiet_NaN();
        change.surfaceVelocity = Vector3(std::numeric_limits<float>::infinity(), 0, 0);
        change.surfaceAngularVelocity = Vector3(0, std::numeric_limits<float>::quiet_NaN(), 0);
        change.massOverride = {.inverseMassScaleA = -1, .inverseMassScaleB = std::numeric_limits<float>::infinity()};
    }
};
class Heavier final : public ContactListener {
    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        change.ScaleInverseMass(contact, contact.bodyA, static_cast<float>(contact.bodyA.index % 4) * 0.25f);
        if (contact.bodyB.index % 3 == 0) change.ScaleInverseMass(contact, contact.bodyB, 1.5f);
    }
};

void SetContactListener(Twin& twin, Values& values, const CallTargets&, Outcome&) {
    static const Ghosts kGhosts;
    static const Belts kBelts;
    static const Heavier kHeavier;
    static const Nonsense kNonsense;
    const ContactListener* const listeners[] = {nullptr, &kGhosts, &kBelts, &kHeavier, &kNonsense};
    const ContactListener* const chosen = listeners[values.Below(values.Style().extremeSettings ? 5 : 4)];
    twin.system->SetContactListener(chosen);
    twin.scalesMasses = chosen == &kHeavier || chosen == &kNonsense;
}

void ApplyFields(Twin& twin, Values& values, const CallTargets&, Outcome& outcome) {
    Fields fields;
    fields.waters.push_back({.level = values.Setting(-2, 2), .drag = values.Setting(0, 10)});
    fields.winds.push_back({.velocity = values.Speeds(20)});
    Note(fields.Apply(*twin.system, 1.0 / 60), outcome);
}

constexpr CallKind kCalls[] = {
    {"Step", 40, Step},
    {"ApplyFields", 2, ApplyFields},
    {"SetSettings", 2, SetSettings},
    {"SetContactListener", 1, SetContactListener},
};

}  // namespace

std::span<const CallKind> WorldCalls() { return kCalls; }

}  // namespace fulcrum::testing
