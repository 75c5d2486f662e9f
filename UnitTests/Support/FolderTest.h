// The base of tests that write files: each has an empty folder, which is removed with all that is in it.
#pragma once

#include <gtest/gtest.h>

#include <stdlib.h>

#include <filesystem>
#include <string>

namespace fulcrum::testing {

class FolderTest : public ::testing::Test {
protected:
    FolderTest() {
        std::string name = (std::filesystem::temp_directory_path() / "fulcrum-test-XXXXXX").string();
        if (mkdtemp(name.data())) folder_ = name;
    }
    ~FolderTest() override {
        if (!folder_.empty()) std::filesystem::remove_all(folder_);
    }
    void SetUp() override { ASSERT_FALSE(folder_.empty()) << "no folder for files of tests"; }

    std::filesystem::path folder_;
};

}  // namespace fulcrum::testing
