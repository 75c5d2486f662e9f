// The output of --json: a file, or standard output, which then has nothing else.
#include <Fulcrum/Samples/Runner/Commands.h>
#include <Fulcrum/Samples/Runner/JsonOutput.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace fulcrum {
namespace {

std::string Content(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

// What is printed while it lives goes to two files.
class Printed {
public:
    Printed() : base_(std::filesystem::temp_directory_path() / ("fulcrum-json-" + std::to_string(getpid()))) {
        std::fflush(stdout);
        std::fflush(stderr);
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
            before_[stream - 1] = dup(stream);
            std::FILE* file = std::fopen(FileOf(stream).c_str(), "w");
            dup2(fileno(file), stream);
            std::fclose(file);
        }
    }
    ~Printed() { Restore(); }
    void Restore() {
        std::fflush(stdout);
        std::fflush(stderr);
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
            if (before_[stream - 1] < 0) continue;
            dup2(before_[stream - 1], stream);
            close(before_[stream - 1]);
            before_[stream - 1] = -1;
            texts_[stream - 1] = Content(FileOf(stream));
            std::filesystem::remove(FileOf(stream));
        }
    }
    std::string Output() { return Restore(), texts_[0]; }
    std::string Errors() { return Restore(), texts_[1]; }

private:
    std::string FileOf(int stream) const { return base_.string() + "-" + std::to_string(stream); }

    std::filesystem::path base_;
    int before_[2] = {-1, -1};
    std::string texts_[2];
};

TEST(JsonOutput, DashIsStandardOutputAndAllElseGoesToStandardError) {
    Printed printed;
    {
        const JsonOutput json("-");
        EXPECT_EQ(json.Check(), "");
        std::printf("a table\n");
        EXPECT_EQ(json.Write({{"steps", 7}}), "");
        std::printf("more\n");
    }
    std::printf("after\n");
    EXPECT_EQ(printed.Output(), "{\n  \"steps\": 7\n}\nafter\n");
    EXPECT_EQ(printed.Errors(), "a table\nmore\n");
}

TEST(JsonOutput, AFileIsNamedOnStandardOutput) {
    const std::string file =
        (std::filesystem::temp_directory_path() / ("fulcrum-" + std::to_string(getpid()) + ".json")).string();
    Printed printed;
    const JsonOutput json(file);
    EXPECT_TRUE(json.IsWanted());
    EXPECT_EQ(json.Check(), "");
    EXPECT_EQ(json.Write({{"steps", 7}}), "");
    EXPECT_EQ(printed.Output(), "Wrote " + file + "\n");
    EXPECT_EQ(Content(file), "{\n  \"steps\": 7\n}\n");
    std::filesystem::remove(file);
}

TEST(JsonOutput, SaysBeforehandThatTheFolderIsNotThere) {
    EXPECT_EQ(JsonOutput("/nowhere/a.json").Check(), "--json /nowhere/a.json: there is no folder /nowhere");
    EXPECT_FALSE(JsonOutput("").IsWanted());
}

TEST(JsonOutput, ARunWithADashPrintsJsonAlone) {
    const auto command =
        ParseRunnerCommand({"run", "tower", "--steps", "2", "--threads", "1", "--record", "none", "--json", "-"});
    ASSERT_TRUE(command) << command.GetError().message;
    Printed printed;
    const int status = Execute(command.Value());
    const std::string output = printed.Output();
    EXPECT_EQ(status, 0);
    const auto json = nlohmann::json::parse(output, nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << output;
    EXPECT_EQ(json["scene"], "tower");
    EXPECT_EQ(json["steps"], 2);
    EXPECT_NE(printed.Errors().find("pose hash"), std::string::npos);
}

}  // namespace
}  // namespace fulcrum
