#include <Fulcrum/Physics/BodyBatch.h>

#include <Fulcrum/Physics/Joints/JointChecks.h>
#include <Fulcrum/Physics/Validation.h>

namespace fulcrum {

JointSettings& CommonOf(BodyBatch::Joint& joint) {
    return std::visit([](auto& settings) -> JointSettings& { return settings; }, joint);
}
const JointSettings& CommonOf(const BodyBatch::Joint& joint) {
    return std::visit([](const auto& settings) -> const JointSettings& { return settings; }, joint);
}

Result<BodyBatch> BodyBatch::Prepare(std::vector<BodySettings> bodies, std::vector<Joint> joints) {
    for (size_t i = 0; i < bodies.size(); ++i)
        if (MaybeError e = Check(bodies[i])) return Error{e->code, "bodies[" + std::to_string(i) + "]: " + e->message};
    // Whether a body of the world exists and is dynamic is known when the batch is added.
    const auto motionOf = [&](BodyId id) -> std::optional<MotionType> {
        if (id == kWorldBody) return MotionType::Static;
        if (!IsBody(id)) return MotionType::Dynamic;
        if (IndexOf(id) >= bodies.size()) return std::nullopt;
        return bodies[IndexOf(id)].motion;
    };
    for (size_t i = 0; i < joints.size(); ++i) {
        const MaybeError e = FirstOf(CheckJointBodies(CommonOf(joints[i]), motionOf),
                                     std::visit([](const auto& settings) { return Check(settings); }, joints[i]));
        if (e) return Error{e->code, "joints[" + std::to_string(i) + "]: " + e->message};
    }
    return BodyBatch(std::move(bodies), std::move(joints));
}

}  // namespace fulcrum
