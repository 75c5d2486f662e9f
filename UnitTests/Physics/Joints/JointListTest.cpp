// The one list of the kinds of joints has every file of a kind, and no other.
#include <Fulcrum/Physics/Joints/JointKinds.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

namespace fulcrum::testing {
namespace {

TEST(JointList, HasEveryKindThatHasAFile) {
    std::set<std::string> listed, found;
#define FULCRUM_INSERT(kind) listed.insert(#kind "Joint.h");
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_INSERT)
#undef FULCRUM_INSERT
    for (const auto& file : std::filesystem::directory_iterator(FULCRUM_SOURCE_DIR "/Physics/Joints")) {
        const std::string name = file.path().filename().string();
        if (name.ends_with("Joint.h")) found.insert(name);
    }
    EXPECT_EQ(found, listed);
}

}  // namespace
}  // namespace fulcrum::testing
