// The dependencies of the architecture, read from the includes: an upward edge, a foreign library or an intrinsic where
// it does not belong fails here. The check itself is tried on small trees that break one rule each.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

// What each folder may include of the others, besides itself.
const std::map<std::string, std::vector<std::string>> kAllowedFolders = {
    {"Math", {}},
    {"Jobs", {"Math"}},
    {"Collision", {"Math"}},
    {"Constraints", {"Math", "Jobs"}},
    {"Physics", {"Math", "Collision", "Constraints", "Jobs"}},
    {"Assets", {"Math", "Collision", "Constraints", "Jobs", "Physics"}},
    {"Samples", {"Math", "Collision", "Constraints", "Jobs", "Physics", "Assets"}},
    {"Web", {"Math", "Collision", "Constraints", "Jobs", "Physics", "Assets", "Samples"}},
    {"PerformanceTest", {"Math", "Collision", "Constraints", "Jobs", "Physics", "Assets", "Samples", "UnitTests"}},
    {"UnitTests", {"Math", "Collision", "Constraints", "Jobs", "Physics", "Assets", "Samples", "PerformanceTest"}},
};

// The same among the parts of Physics: the folders in it, and the files beside these, which are its interfaces. Every
// folder stands here.
const std::map<std::string, std::vector<std::string>> kAllowedPartsOfPhysics = {
    {"Physics/Files", {}},
    {"Physics/World", {}},
    {"Physics/Joints", {}},
    {"Physics/Stages", {"Physics/World"}},
    {"Physics/Queries", {"Physics/World"}},
    {"Physics/Snapshots", {"Physics/Files", "Physics/World", "Physics/Joints", "Physics/Stages"}},
    {"Physics", {"Physics/World", "Physics/Joints", "Physics/Stages", "Physics/Queries", "Physics/Snapshots"}},
    {"Physics/Ragdoll", {"Physics", "Physics/Joints"}},
    {"Physics/Fields", {"Physics"}},
    {"Physics/Drawing", {"Physics"}},
    {"Physics/Recording", {"Physics", "Physics/Joints", "Physics/Files"}},
};
// Headers that the parts below may include, too: plain data, what users derive from, checks of what they pass in. They
// include nothing else of Physics.
const std::array<std::string, 13> kSharedHeaders = {
    "Physics/Settings.h",     "Physics/JointSettings.h", "Physics/GroupFilter.h", "Physics/ContactListener.h",
    "Physics/SensorEvent.h",  "Physics/StepEvents.h",    "Physics/StepReport.h",  "Physics/QueryTypes.h",
    "Physics/Misuse.h",       "Physics/Validation.h",    "Physics/Snapshot.h",    "Physics/StepObserver.h",
    "Physics/CallObserver.h",
};

const std::array<std::string, 5> kLibraryFolders = {"Math", "Jobs", "Collision", "Constraints", "Physics"};

// These may test the architecture beside Math/Wide.h: a spin loop needs the processor's pause hint, and each processor
// has its own register of the floating-point environment.
const std::array<std::string, 2> kArchitectureFiles = {"Jobs/Spin.h", "Math/FloatEnvironment.h"};
// The one place of dense matrices; no public header needs it.
const std::string kEigenFile = "Physics/Stages/DirectIsland.cpp";

bool IsArchitectureName(const std::string& word) {
    return word == "__x86_64__" || word == "__i386__" || word == "__aarch64__";
}

template <class Range>
bool Contains(const Range& range, const std::string& value) {
    return std::find(range.begin(), range.end(), value) != range.end();
}

// Without the rest of a line after //: comments may name what code must not.
Lines ReadLinesWithoutComments(const fs::path& file) {
    Lines lines;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) lines.push_back(line.substr(0, line.find("//")));
    return lines;
}

std::vector<fs::path> SourcesBelow(const fs::path& folder) {
    std::vector<fs::path> files;
    if (!fs::exists(folder)) return files;
    for (auto entry = fs::recursive_directory_iterator(folder); entry != fs::recursive_directory_iterator(); ++entry) {
        if (entry->path().filename() == "node_modules") entry.disable_recursion_pending();
        const std::string extension = entry->path().extension().string();
        if (extension == ".h" || extension == ".cpp") files.push_back(entry->path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

// Of a file of Physics: its folder, or Physics where it stands beside the folders.
std::string PartOfPhysics(const std::string& file) {
    const size_t end = file.find('/', std::string("Physics/").size());
    return end == std::string::npos ? "Physics" : file.substr(0, end);
}

// Collects the broken rules of a tree, one line each: "file:line: what".
class LayeringCheck {
public:
    explicit LayeringCheck(fs::path root) : root_(std::move(root)) {
        for (const auto& [folder, allowed] : kAllowedFolders)
            for (const fs::path& file : SourcesBelow(root_ / folder)) CheckFile(folder, file);
        if (ccdFiles_.size() > 1)
            for (const std::string& file : ccdFiles_) violations_.push_back(file + ": libccd in more than one file");
    }
    const Lines& Violations() const { return violations_; }
    int FilesRead() const { return filesRead_; }

private:
    void CheckFile(const std::string& folder, const fs::path& file) {
        static const std::regex includePattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
        ++filesRead_;
        const std::string name = fs::relative(file, root_).generic_string();
        bool includesCcd = false;
        int number = 0;
        for (const std::string& line : ReadLinesWithoutComments(file)) {
            const std::string place = name + ":" + std::to_string(++number) + ": ";
            std::smatch match;
            if (std::regex_search(line, match, includePattern)) {
                const std::string header = match[2];
                includesCcd |= header.starts_with("ccd/");
                CheckInclude(folder, name, header, match[1] == "\"", place);
            }
            CheckIntrinsics(folder, name, line, place);
        }
        if (includesCcd && Contains(kLibraryFolders, folder)) ccdFiles_.push_back(name);
    }

    void CheckInclude(const std::string& folder, const std::string& name, const std::string& header, bool quoted,
                      const std::string& place) {
        const bool library = Contains(kLibraryFolders, folder);
        if (quoted && library) violations_.push_back(place + "\"" + header + "\": write <Fulcrum/Folder/File.h>");

        if (header.starts_with("Fulcrum/")) {
            const std::string target = header.substr(8, header.find('/', 8) - 8);
            // Of the two headers beside the folders the version is everybody's, the other one the programs'.
            const bool isOfTheRoot = header.find('/', 8) == std::string::npos;
            if (isOfTheRoot && (target == "Version.h" || (target == "Fulcrum.h" && !library))) return;
            if (target != folder && !Contains(kAllowedFolders.at(folder), target))
                violations_.push_back(place + folder + " must not include " + target);
            if (target == "Physics" && folder == "Physics") CheckInsidePhysics(name, header.substr(8), place);
        } else if (library && header.starts_with("ccd/")) {
            if (!name.starts_with("Collision/NarrowPhase/") || !name.ends_with(".cpp"))
                violations_.push_back(place + "libccd belongs in one .cpp file of Collision/NarrowPhase");
        } else if (library && header.starts_with("Eigen/")) {
            if (name != kEigenFile) violations_.push_back(place + "Eigen belongs in " + kEigenFile);
        } else if (library && name != "Math/Wide.h" && header.find_first_of("./") != std::string::npos) {
            violations_.push_back(place + "<" + header + "> is neither standard C++ nor Eigen");
        }
    }

    void CheckInsidePhysics(const std::string& name, const std::string& header, const std::string& place) {
        const std::string part = PartOfPhysics(name), target = PartOfPhysics(header);
        const bool isShared = Contains(kSharedHeaders, header);
        if (Contains(kSharedHeaders, name)) {
            if (!isShared) violations_.push_back(place + "a shared header must not include " + header);
        } else if (!kAllowedPartsOfPhysics.contains(part)) {
            violations_.push_back(place + part + " has no place in the order");
        } else if (target != part && !isShared && !Contains(kAllowedPartsOfPhysics.at(part), target)) {
            violations_.push_back(place + part + " must not include " + header);
        }
    }

    void CheckIntrinsics(const std::string& folder, const std::string& name, const std::string& line,
                         const std::string& place) {
        static const std::regex pattern(
            R"(\w*mmintrin\.h|arm_neon\.h|__(AVX|SSE|ARM_NEON|FMA|x86_64|i386|aarch64|wasm)\w*|\b_mm\w*_)");
        if (name == "Math/Wide.h" || folder == "UnitTests") return;
        std::smatch match;
        if (std::regex_search(line, match, pattern) &&
            !(Contains(kArchitectureFiles, name) && IsArchitectureName(match.str())))
            violations_.push_back(place + match.str() + " outside Math/Wide.h");
    }

    fs::path root_;
    Lines violations_;
    Lines ccdFiles_;
    int filesRead_ = 0;
};

std::string Join(const Lines& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

// A tree in a temporary folder, given as file name and content.
class Layering : public testing::Test {
protected:
    Layering() : root_(fs::temp_directory_path() / ("fulcrum-layering-" + std::to_string(getpid()))) {}
    ~Layering() override { fs::remove_all(root_); }

    Lines CheckTree(const std::map<std::string, std::string>& files) {
        fs::remove_all(root_);
        for (const auto& [name, content] : files) {
            fs::create_directories((root_ / name).parent_path());
            std::ofstream(root_ / name) << content;
        }
        return LayeringCheck(root_).Violations();
    }

    fs::path root_;
};

TEST_F(Layering, HoldsInThisTree) {
    const LayeringCheck check(FULCRUM_SOURCE_DIR);
    EXPECT_EQ(Join(check.Violations()), "");
    EXPECT_GT(check.FilesRead(), 10);
}

TEST_F(Layering, AcceptsATreeThatKeepsTheRules) {
    EXPECT_EQ(
        Join(CheckTree({
            {"Math/Wide.h", "#include <immintrin.h>\n#ifdef __AVX2__\n#endif\n"},
            {"Physics/Stages/DirectIsland.cpp", "#include <Eigen/Core>\n"},
            {"Math/Vector.h", "#include <cmath>\n// not the __SSE2__ of <immintrin.h>\n"},
            {"Jobs/ThreadPool.cpp", "#include <Fulcrum/Jobs/ThreadPool.h>\n#include <thread>\n"},
            {"Collision/NarrowPhase/Ccd.cpp", "#include <Fulcrum/Math/Vector.h>\n#include <ccd/ccd.h>\n"},
            {"Physics/World/A.h", "#include <Fulcrum/Collision/A.h>\n#include <Fulcrum/Constraints/B.h>\n"},
            {"Physics/World/B.h", "#include <Fulcrum/Physics/World/A.h>\n#include <Fulcrum/Physics/Settings.h>\n"},
            {"Physics/Settings.h", "#include <Fulcrum/Physics/GroupFilter.h>\n"},
            {"Physics/Stages/A.cpp", "#include <Fulcrum/Physics/World/A.h>\n#include <Fulcrum/Physics/StepReport.h>\n"},
            {"Physics/Queries/A.h", "#include <Fulcrum/Physics/World/A.h>\n#include <Fulcrum/Physics/QueryTypes.h>\n"},
            {"Physics/A.cpp", "#include <Fulcrum/Physics/Stages/A.h>\n#include <Fulcrum/Physics/Queries/A.h>\n"},
            {"Physics/Ragdoll/A.h", "#include <Fulcrum/Physics/A.h>\n"},
            {"Samples/Runner/Main.cpp", "#include <CLI/CLI.hpp>\n#include <Fulcrum/Physics/A.h>\n"},
            {"UnitTests/Collision/CcdTest.cpp", "#include <ccd/ccd.h>\n#include <unistd.h>\n"},
        })),
        "");
}

TEST_F(Layering, NamesEveryUpwardEdge) {
    const std::map<std::string, std::vector<std::string>> forbidden = {
        {"Math", {"Jobs", "Collision", "Constraints", "Physics", "Samples"}},
        {"Jobs", {"Collision", "Constraints", "Physics", "Samples"}},
        {"Collision", {"Jobs", "Constraints", "Physics", "Samples"}},
        {"Constraints", {"Collision", "Physics", "Samples"}},
        {"Physics", {"Samples", "UnitTests", "PerformanceTest"}},
        {"Samples", {"UnitTests", "PerformanceTest"}},
    };
    for (const auto& [folder, targets] : forbidden)
        for (const std::string& target : targets)
            EXPECT_EQ(Join(CheckTree({{folder + "/Sub/File.h", "\n#include <Fulcrum/" + target + "/X.h>\n"}})),
                      folder + "/Sub/File.h:2: " + folder + " must not include " + target + "\n");
}

TEST_F(Layering, NamesEveryUpwardEdgeInsidePhysics) {
    const std::map<std::string, std::vector<std::string>> forbidden = {
        {"World", {"Joints/A.h", "Stages/A.h", "Queries/A.h", "Ragdoll/A.h", "A.h", "PhysicsSystem.h"}},
        {"Joints", {"World/A.h", "Stages/A.h", "Ragdoll/A.h", "JointInterface.h"}},
        {"Stages", {"Queries/A.h", "Ragdoll/A.h", "A.h", "BodyInterface.h"}},
        {"Queries", {"Stages/A.h", "Ragdoll/A.h", "A.h", "QueryInterface.h"}},
        {"Ragdoll", {"World/A.h", "Stages/A.h", "Queries/A.h"}},
    };
    for (const auto& [folder, targets] : forbidden)
        for (const std::string& target : targets)
            for (const std::string& file : {"Physics/" + folder + "/A.h", "Physics/" + folder + "/A.cpp"})
                EXPECT_EQ(Join(CheckTree({{file, "\n#include <Fulcrum/Physics/" + target + ">\n"}})),
                          file + ":2: Physics/" + folder + " must not include Physics/" + target + "\n");
    EXPECT_EQ(Join(CheckTree({{"Physics/A.cpp", "#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>\n"}})),
              "Physics/A.cpp:1: Physics must not include Physics/Ragdoll/Ragdoll.h\n");
}

TEST_F(Layering, KeepsSharedHeadersOfPhysicsApart) {
    const std::vector<std::string> others = {"World/WorldState.h", "BodyInterface.h", "Stages/Stages.h"};
    for (const std::string& target : others)
        EXPECT_EQ(Join(CheckTree({{"Physics/Settings.h", "#include <Fulcrum/Physics/" + target + ">\n"}})),
                  "Physics/Settings.h:1: a shared header must not include Physics/" + target + "\n");
    for (const std::string& header : kSharedHeaders)
        EXPECT_EQ(Join(CheckTree({{"Physics/World/A.h", "#include <Fulcrum/" + header + ">\n"}})), "");
}

TEST_F(Layering, GivesEveryFolderOfPhysicsItsPlace) {
    EXPECT_EQ(Join(CheckTree({{"Physics/Soft/A.h", "#include <Fulcrum/Physics/World/A.h>\n"}})),
              "Physics/Soft/A.h:1: Physics/Soft has no place in the order\n");
    EXPECT_EQ(CheckTree({{"Physics/World/A.h", "#include <Fulcrum/Physics/Soft/A.h>\n"}}).size(), 1u);
}

TEST_F(Layering, LeavesTheHeaderOfAllHeadersToPrograms) {
    const std::string all = "#include <Fulcrum/Fulcrum.h>\n";
    EXPECT_EQ(
        CheckTree({{"UnitTests/A.cpp", all}, {"Samples/A.cpp", all}, {"Math/A.h", "#include <Fulcrum/Version.h>\n"}})
            .size(),
        0u);
    for (const std::string& folder : kLibraryFolders)
        EXPECT_EQ(CheckTree({{folder + "/A.h", all}}).size(), 1u) << folder;
    EXPECT_EQ(CheckTree({{"Samples/A.cpp", "#include <Fulcrum/Other.h>\n"}}).size(), 1u);
}

TEST_F(Layering, RejectsForeignLibraries) {
    EXPECT_EQ(CheckTree({{"Physics/A.cpp", "#include <nlohmann/json.hpp>\n"}}).size(), 1u);
    EXPECT_EQ(CheckTree({{"Jobs/A.cpp", "#include <pthread.h>\n"}}).size(), 1u);
    EXPECT_EQ(CheckTree({{"Collision/A.cpp", "#  include \"Local.h\"\n"}}).size(), 2u);  // quoted, and not standard
}

TEST_F(Layering, KeepsEigenInOneFile) {
    const std::string eigen = "#include <Eigen/Core>\n";
    EXPECT_EQ(
        CheckTree({{"Math/Vector.h", eigen}, {"Physics/PhysicsSystem.h", eigen}, {"Constraints/Joints/A.cpp", eigen}})
            .size(),
        3u);
    EXPECT_EQ(CheckTree({{"UnitTests/A.cpp", eigen}, {"Samples/A.cpp", eigen}}).size(), 0u);
}

TEST_F(Layering, KeepsLibccdInOneSourceFileOfTheNarrowPhase) {
    const std::string ccd = "#include <ccd/ccd.h>\n";
    EXPECT_EQ(CheckTree({{"Collision/NarrowPhase/Ccd.h", ccd}}).size(), 1u);
    EXPECT_EQ(CheckTree({{"Collision/BroadPhase/Ccd.cpp", ccd}}).size(), 1u);
    EXPECT_EQ(CheckTree({{"Physics/Ccd.cpp", ccd}}).size(), 1u);
    EXPECT_EQ(CheckTree({{"Collision/NarrowPhase/A.cpp", ccd}, {"Collision/NarrowPhase/B.cpp", ccd}}).size(), 2u);
}

TEST_F(Layering, KeepsIntrinsicsInOneFile) {
    for (const char* line : {"#include <immintrin.h>", "#include <arm_neon.h>", "#include <xmmintrin.h>"})
        EXPECT_GE(CheckTree({{"Jobs/A.cpp", line}}).size(), 1u) << line;
    for (const char* line : {"#if defined(__AVX2__)", "#ifdef __SSE4_1__", "#ifdef __ARM_NEON", "#ifdef __x86_64__",
                             "auto x = _mm256_add_ps(a, b);", "_mm_pause();"})
        EXPECT_EQ(CheckTree({{"Constraints/A.h", line}}).size(), 1u) << line;
    EXPECT_EQ(CheckTree({{"Samples/Runner/A.cpp", "#ifdef __AVX2__"}}).size(), 1u);
    EXPECT_EQ(CheckTree({{"Jobs/Spin.h", "#if defined(__x86_64__)\n_mm_pause();\n#endif"}}).size(), 1u);
}

}  // namespace
