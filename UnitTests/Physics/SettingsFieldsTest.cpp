// What scene files and recordings of calls have of settings: every member that the headers declare.
#include <Fulcrum/Physics/SettingsFields.h>
#include <Fulcrum/UnitTests/Physics/BadInput/Spoiler.h>
#include <Fulcrum/UnitTests/Support/FieldNames.h>

#include <gtest/gtest.h>

#include <set>

namespace fulcrum::testing {
namespace {

template <class T>
void ExpectAllMembers() {
    FieldNames fields;
    T settings{};
    DescribeWhole(fields, settings);
    std::set<std::string> members;
    for (const auto& [name, comment] : CommentsOf(kSettingsHeader<T>)) members.insert(name);
    if constexpr (std::is_base_of_v<JointSettings, T>)
        for (const auto& [name, comment] : CommentsOf({"Physics/JointSettings.h", "JointSettings"}))
            members.insert(name);
    if constexpr (std::is_same_v<T, SixDofJointSettings>) {  // axes, one by one
        EXPECT_EQ(members.erase("axes"), 1u);
        for (const char* axis : {"linearX", "linearY", "linearZ", "angularX", "angularY", "angularZ"})
            members.insert(axis);
    }
    members.erase("make");  // of CustomJointSettings: code
    EXPECT_FALSE(members.empty());
    EXPECT_EQ(fields.names, members) << kSettingsHeader<T>.type;
}

TEST(SettingsFields, NameEveryMember) {
    ExpectAllMembers<BodySettings>();
    ExpectAllMembers<Material>();
    ExpectAllMembers<SystemSettings>();
    ExpectAllMembers<SolverSettings>();
    ExpectAllMembers<AccuracyTarget>();
    ExpectAllMembers<SleepSettings>();
    ExpectAllMembers<EventSettings>();
    ExpectAllMembers<JointAnchor>();
    ExpectAllMembers<SpringSettings>();
    ExpectAllMembers<JointLimits>();
    ExpectAllMembers<JointMotor>();
    ExpectAllMembers<AxisControl>();
#define FULCRUM_EXPECT_ALL(kind) ExpectAllMembers<kind##JointSettings>();
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_EXPECT_ALL)
#undef FULCRUM_EXPECT_ALL
}

}  // namespace
}  // namespace fulcrum::testing
