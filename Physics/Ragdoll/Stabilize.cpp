#include <Fulcrum/Physics/Ragdoll/Stabilize.h>

#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>

namespace fulcrum {

namespace {

bool IsDynamic(const RagdollPart& part) { return part.body.motion == MotionType::Dynamic; }

// Its parent if both are dynamic, else null.
const RagdollPart* MovingParentOf(const RagdollSettings& settings, const RagdollPart& part) {
    if (part.parent == RagdollPart::kNoParent || !IsDynamic(part)) return nullptr;
    const RagdollPart& parent = settings.parts[static_cast<size_t>(part.parent)];
    return IsDynamic(parent) ? &parent : nullptr;
}

}  // namespace

float MassOf(const BodySettings& body) {
    const DefaultFloats floats;
    return body.mass > 0.0f ? body.mass : body.density * body.shape->Mass().volume;
}

Vector3 InertiaOf(const BodySettings& body) {
    const DefaultFloats floats;
    if (!body.inertia.isZero(0)) return body.inertia;
    const MassProperties& shape = body.shape->Mass();
    return shape.principalInertia * (MassOf(body) / shape.volume);
}

Status StabilizeMasses(RagdollSettings& settings, const MassRule& rule) {
    const DefaultFloats floats;
    if (MaybeError e =
            FirstOf(Check(settings), CheckPositive("smallest", rule.smallest), CheckPositive("largest", rule.largest),
                    CheckRange("smallest", rule.smallest, 0.0, rule.largest)))
        return *e;
    std::vector<float> masses;
    double before = 0, after = 0;
    for (const RagdollPart& part : settings.parts) {
        const float own = MassOf(part.body);
        float mass = own;
        if (MovingParentOf(settings, part)) {
            const float ofParent = masses[static_cast<size_t>(part.parent)];
            mass = std::clamp(mass, rule.smallest * ofParent, rule.largest * ofParent);
        }
        masses.push_back(mass);
        if (!IsDynamic(part)) continue;
        before += own;
        after += mass;
    }
    RagdollSettings changed = settings;
    for (size_t i = 0; i < masses.size(); ++i) {
        BodySettings& body = changed.parts[i].body;
        if (body.motion != MotionType::Dynamic) continue;
        const float mass = static_cast<float>(masses[i] * (before / after));
        body.inertia *= mass / MassOf(body);  // zero means the shape's own inertia, which scales by itself
        body.mass = mass;
    }
    // Products of extreme values may overflow a float.
    if (MaybeError e = Check(changed)) return *e;
    settings = std::move(changed);
    return Done{};
}

Status StabilizeInertia(RagdollSettings& settings, const InertiaRule& rule) {
    const DefaultFloats floats;
    if (MaybeError e = FirstOf(Check(settings), CheckPositive("principalRatio", rule.principalRatio),
                               CheckPositive("childRatio", rule.childRatio)))
        return *e;
    if (rule.principalRatio < 1.0f)
        return Error{ErrorCode::OutOfRange,
                     "principalRatio is " + std::to_string(rule.principalRatio) + "; it must be 1 or more"};
    RagdollSettings changed = settings;
    std::vector<float> floors(settings.parts.size(), 0.0f);  // lower bounds of the moments, from the children
    for (size_t i = settings.parts.size(); i-- > 0;) {
        RagdollPart& part = changed.parts[i];
        if (!IsDynamic(part)) continue;
        const Vector3 own = InertiaOf(part.body);
        const Vector3 raised = own.cwiseMax(std::max(floors[i], own.maxCoeff() / rule.principalRatio));
        if (!(raised == own)) part.body.inertia = raised;
        if (MovingParentOf(changed, part)) {
            float& ofParent = floors[static_cast<size_t>(part.parent)];
            ofParent = std::max(ofParent, raised.maxCoeff() / rule.childRatio);
        }
    }
    if (MaybeError e = Check(changed)) return *e;
    settings = std::move(changed);
    return Done{};
}

}  // namespace fulcrum
