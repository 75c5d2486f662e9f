#include <Fulcrum/Physics/BodyBatch.h>

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>
#include <Fulcrum/Physics/Validation.h>

namespace fulcrum {

JointSettings& CommonOf(BodyBatch::Joint& joint) {
    return std::visit([](auto& settings) -> JointSettings& { return settings; }, joint);
}
const JointSettings& CommonOf(const BodyBatch::Joint& joint) {
    return std::visit([](const auto& settings) -> const JointSettings& { return settings; }, joint);
}

Error InList(const char* list, size_t index, const Error& error) {
    return {error.code, std::string(list) + "[" + std::to_string(index) + "]: " + error.message};
}

Result<BodyBatch> BodyBatch::Prepare(std::vector<BodySettings> bodies, std::vector<Joint> joints) {
    const DefaultFloats floats;
    for (size_t i = 0; i < bodies.size(); ++i)
        if (MaybeError error = Check(bodies[i])) return InList("bodies", i, *error);
    // Whether a body of the world exists and is dynamic is known when the batch is added.
    const auto motionOf = [&](BodyId id) -> std::optional<MotionType> {
        if (id == kWorldBody) return MotionType::Static;
        if (!IsBody(id)) return MotionType::Dynamic;
        if (IndexOf(id) >= bodies.size()) return std::nullopt;
        return bodies[IndexOf(id)].motion;
    };
    for (size_t i = 0; i < joints.size(); ++i) {
        const MaybeError error = FirstOf(std::visit([](const auto& settings) { return Check(settings); }, joints[i]),
                                         CheckJointBodies(CommonOf(joints[i]), motionOf));
        if (error) return InList("joints", i, *error);
    }
    return BodyBatch(std::move(bodies), std::move(joints));
}

}  // namespace fulcrum
