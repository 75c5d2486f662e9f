// Files that cannot be read or written are errors, and leave what was there.
#include <Fulcrum/Physics/Files/ErrorBoundary.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/UnitTests/Support/FolderTest.h>
#include <Fulcrum/UnitTests/Support/FullDisk.h>

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <stdexcept>

namespace fulcrum::testing {
namespace {

namespace fs = std::filesystem;

class WholeFile : public FolderTest {
protected:
    std::string Content() const { return ReadWholeFile(file_).Value(); }
    // Files in the folder, so that what was written beside is found.
    size_t Count() const {
        return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }

    const fs::path file_ = folder_ / "file";
};

TEST_F(WholeFile, IsReadAsItWasWritten) {
    std::string all(100'000, '\0');
    for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<char>(i * 7919 >> 3);
    ASSERT_TRUE(WriteWholeFile(file_, {"first ", "", all}));
    EXPECT_EQ(Content(), "first " + all);
    ASSERT_TRUE(WriteWholeFile(file_, {}));
    EXPECT_EQ(Content(), "");
    EXPECT_EQ(Count(), 1u);
}

TEST_F(WholeFile, IsReadUpToItsLimit) {
    ASSERT_TRUE(WriteWholeFile(file_, {"12345"}));
    EXPECT_TRUE(ReadWholeFile(file_, 5));
    const auto larger = ReadWholeFile(file_, 4);
    ASSERT_FALSE(larger);
    EXPECT_EQ(larger.GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(larger.GetError().message, file_.string() + ": it has more than the 4 bytes that are read");
    // Its size is said to be 0.
    EXPECT_FALSE(ReadWholeFile("/proc/self/status", 100));
    EXPECT_GT(ReadWholeFile("/proc/self/status").Value().size(), 100u);
    // A file of nothing takes no place, but would take memory.
    ASSERT_EQ(truncate(file_.c_str(), off_t{1} << 40), 0);
    EXPECT_EQ(ReadWholeFile(file_).GetError().code, ErrorCode::OutOfRange);
}

TEST_F(WholeFile, IsNoFolderDeviceOrPipe) {
    ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    for (const fs::path& file : {folder_, folder_ / "none", fs::path("/dev/zero"), folder_ / "pipe", fs::path()}) {
        const auto read = ReadWholeFile(file);
        ASSERT_FALSE(read) << file;
        EXPECT_EQ(read.GetError().code, ErrorCode::Unsupported);
        EXPECT_TRUE(read.GetError().message.starts_with(file.string() + ": ")) << read.GetError().message;
    }
}

TEST_F(WholeFile, RemainsWhenTheDiskIsFull) {
    ASSERT_TRUE(WriteWholeFile(file_, {"what was there"}));
    const std::string more(1 << 20, 'x');
    for (const rlim_t space : {0, 4096, 100'000}) {
        const FullDisk disk(space);
        const Status written = WriteWholeFile(file_, {more});
        ASSERT_FALSE(written) << space;
        EXPECT_EQ(written.GetError().code, ErrorCode::OutOfRange);
        EXPECT_TRUE(written.GetError().message.starts_with("cannot write " + file_.string() + ": "));
    }
    EXPECT_EQ(Content(), "what was there");
    EXPECT_EQ(Count(), 1u) << "what was written beside it remains";
    const Status device = WriteWholeFile("/dev/full", {"x"});
    ASSERT_FALSE(device);
    EXPECT_NE(device.GetError().message.find("No space left"), std::string::npos) << device.GetError().message;
}

TEST_F(WholeFile, IsNotWrittenWhereThereIsNoPlace) {
    ASSERT_TRUE(WriteWholeFile(file_, {"x"}));
    for (const fs::path& file : {folder_, folder_ / "none" / "file", file_ / "file", fs::path()}) {
        EXPECT_FALSE(CheckWritable(file)) << file;
        const Status written = WriteWholeFile(file, {"y"});
        ASSERT_FALSE(written) << file;
        EXPECT_EQ(written.GetError().code, ErrorCode::OutOfRange);
    }
    EXPECT_TRUE(CheckWritable(file_));
    EXPECT_TRUE(CheckWritable(folder_ / "new"));
    EXPECT_EQ(Count(), 1u);
    EXPECT_FALSE(WriteWholeFile(file_ / "a" / "file", {"y"}, MissingFolders::AreCreated));
    EXPECT_TRUE(WriteWholeFile(folder_ / "a" / "b" / "file", {"y"}, MissingFolders::AreCreated));
    EXPECT_EQ(Content(), "x");
}

// The superuser may do everything, so as one without rights.
TEST_F(WholeFile, IsNotWrittenWithoutPermission) {
    constexpr uid_t kNobody = 65534;
    const uid_t user = geteuid();
    ASSERT_TRUE(WriteWholeFile(file_, {"x"}));
    ASSERT_EQ(chmod(file_.c_str(), 0444), 0);
    ASSERT_EQ(chmod(folder_.c_str(), 0555), 0);
    if (user == 0) {
        ASSERT_EQ(seteuid(kNobody), 0);
    }
    EXPECT_FALSE(CheckWritable(file_));
    EXPECT_FALSE(WriteWholeFile(file_, {"y"}));
    EXPECT_FALSE(WriteWholeFile(folder_ / "new", {"y"}));
    EXPECT_EQ(seteuid(user), 0);
    ASSERT_EQ(chmod(folder_.c_str(), 0700), 0);
    EXPECT_EQ(Content(), "x");
    EXPECT_EQ(Count(), 1u);
}

TEST_F(WholeFile, KeepsLinksPermissionsAndDevices) {
    ASSERT_TRUE(WriteWholeFile(file_, {"x"}));
    ASSERT_EQ(chmod(file_.c_str(), 0640), 0);
    fs::create_symlink("file", folder_ / "link");
    fs::create_symlink("later", folder_ / "ahead");
    ASSERT_TRUE(WriteWholeFile(folder_ / "link", {"y"}));
    ASSERT_TRUE(WriteWholeFile(folder_ / "ahead", {"z"}));
    EXPECT_EQ(Content(), "y");
    EXPECT_EQ(ReadWholeFile(folder_ / "later").Value(), "z");
    EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
    struct stat status {};
    ASSERT_EQ(stat(file_.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777u, 0640u);
    ASSERT_TRUE(WriteWholeFile("/dev/null", {"x"}));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    // Names may have 255 bytes, and the one beside it must not have more.
    const fs::path longest = folder_ / std::string(255, 'n');
    ASSERT_TRUE(WriteWholeFile(longest, {"x"}));
    EXPECT_EQ(ReadWholeFile(longest).Value(), "x");
}

TEST_F(WholeFile, IsWrittenFromItsReplacementOn) {
    ASSERT_TRUE(WriteWholeFile(file_, {"old"}));
    {
        FileReplacement replacement = FileReplacement::Open(file_).Value();
        ASSERT_TRUE(replacement.Write("new"));
        ASSERT_TRUE(replacement.Flush());
        EXPECT_EQ(Content(), "old");
    }
    EXPECT_EQ(Count(), 1u);
    FileReplacement replacement = FileReplacement::Open(file_).Value();
    ASSERT_TRUE(replacement.Write("new"));
    ASSERT_TRUE(replacement.Replace());
    EXPECT_EQ(Content(), "new");
    ASSERT_TRUE(replacement.Write(", and more"));
    ASSERT_TRUE(replacement.Flush());
    EXPECT_EQ(Content(), "new, and more");
    EXPECT_EQ(Count(), 1u);
}

TEST(ErrorBoundary, ReturnsWhatIsThrown) {
    EXPECT_TRUE(WithErrors("a", []() -> Status { return Done{}; }));
    EXPECT_EQ(WithErrors("a", []() -> Status { throw std::runtime_error("b"); }).GetError().message, "a: b");
    EXPECT_EQ(WithErrors("", []() -> Status { throw std::length_error("b"); }).GetError().message, "b");
    EXPECT_EQ(WithErrors("a", []() -> Status { throw std::bad_alloc(); }).GetError().code, ErrorCode::OutOfRange);
}

}  // namespace
}  // namespace fulcrum::testing
