// Bodies and joints that are created together: checked beforehand, on a loader thread while the world steps, say, and
// then added by one call. A plain value without a world: to abort is to drop it. Different threads may use different
// batches.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/Physics/Settings.h>

#include <span>
#include <variant>
#include <vector>

namespace fulcrum {

namespace detail {

template <class First, class... Kinds>
struct JointVariant {
    using Type = std::variant<Kinds...>;
};
#define FULCRUM_SETTINGS_OF(kind) , kind##JointSettings
using AnyKindOfJoint = JointVariant<void FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_SETTINGS_OF)>::Type;
#undef FULCRUM_SETTINGS_OF

}  // namespace detail

// What a batch has created, in its order.
struct BatchIds {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    friend bool operator==(const BatchIds&, const BatchIds&) = default;
};

class BodyBatch {
public:
    using Joint = detail::AnyKindOfJoint;  // the settings of any kind in Joints/JointKinds.h

    // The bodies of `joints` may be those of the batch, Body(0), Body(1), ..., bodies of the world that is to have it,
    // and kWorldBody. Errors: those of BodyInterface::Create and JointInterface::Create for the first settings that are
    // wrong, named as `bodies[3]: ...`, `joints[2]: ...`.
    static Result<BodyBatch> Prepare(std::vector<BodySettings> bodies, std::vector<Joint> joints = {});

    // Stands for the body of this index in the batch, < 2^31 - 1, in the settings of its joints. No world has such an
    // id.
    static constexpr BodyId Body(uint32_t index) { return {kFirst + index, 0xFFFFFFFFu}; }
    static constexpr bool IsBody(BodyId id) {
        return id.index >= kFirst && id.generation == 0xFFFFFFFFu && id != kWorldBody;
    }
    static constexpr uint32_t IndexOf(BodyId id) { return id.index - kFirst; }  // of one for which IsBody holds

    std::span<const BodySettings> Bodies() const { return bodies_; }
    std::span<const Joint> Joints() const { return joints_; }

private:
    static constexpr uint32_t kFirst = 0x80000000u;  // no world has as many bodies

    BodyBatch(std::vector<BodySettings> bodies, std::vector<Joint> joints)
        : bodies_(std::move(bodies)), joints_(std::move(joints)) {}
    std::vector<BodySettings> bodies_;
    std::vector<Joint> joints_;
};

// The error of an element of Bodies() or Joints(): "joints[2]: ...".
Error InList(const char* list, size_t index, const Error& error);

// The settings shared by all kinds.
JointSettings& CommonOf(BodyBatch::Joint& joint);
const JointSettings& CommonOf(const BodyBatch::Joint& joint);

}  // namespace fulcrum
