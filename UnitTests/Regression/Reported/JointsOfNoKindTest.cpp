// The settings that all kinds of joints share are those of no kind: they once compiled and did not link.
#include <Fulcrum/Physics/JointInterface.h>

namespace fulcrum::testing {
namespace {

template <class Settings>
concept CanCreate = requires(JointInterface& joints, const Settings& settings) {
    joints.Create(settings);
};
static_assert(CanCreate<HingeJointSettings> && CanCreate<CustomJointSettings>);
static_assert(!CanCreate<JointSettings> && !CanCreate<TargetJointSettings> && !CanCreate<int>);

}  // namespace
}  // namespace fulcrum::testing
