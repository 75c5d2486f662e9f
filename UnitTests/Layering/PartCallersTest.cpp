// Every public function of the constraint parts is called by the engine, not by tests alone. The check itself is tried
// on a header with a function that nothing calls.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// A source without comments, but for those that end a namespace.
std::string ReadCode(const fs::path& file) {
    std::ifstream stream(file);
    std::string code;
    for (std::string line; std::getline(stream, line);)
        code += (line.starts_with("}  // namespace") ? line : line.substr(0, line.find("//"))) + "\n";
    return code;
}

// Names of the functions that a header offers: members of classes that are public, and free functions outside
// `namespace detail`, found by their indentation of one level at most, as clang-format writes it. Conversions have no
// name to be called by.
std::set<std::string> PublicFunctions(const std::string& code) {
    static const std::regex kDeclaration(
        R"(^( {4})?(?!return|if |for |else|using|static_assert|template|operator )[A-Za-z_][^;={}()]*?[ *&]([A-Z]\w*)\()");
    std::set<std::string> names;
    std::istringstream lines(code);
    bool isPublic = true, isDetail = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("namespace detail")) isDetail = true;
        if (line.starts_with("}  // namespace detail")) isDetail = false;
        if (line.starts_with("};")) isPublic = true;
        if (line.starts_with("class ")) isPublic = false;
        if (line.starts_with("struct ")) isPublic = true;
        if (line.starts_with("public:")) isPublic = true;
        if (line.starts_with("private:") || line.starts_with("protected:")) isPublic = false;
        std::smatch match;
        if (!isDetail && isPublic && std::regex_search(line, match, kDeclaration)) names.insert(match[2]);
    }
    return names;
}

// A header without the lines that declare its functions: what is left are calls among them.
std::string WithoutDeclarations(const std::string& code) {
    std::istringstream lines(code);
    std::string calls;
    for (std::string line; std::getline(lines, line);)
        if (PublicFunctions(line + "\n").empty()) calls += line + "\n";
    return calls;
}

// Names of `functions` that none of the other sources calls.
std::vector<std::string> Uncalled(const std::set<std::string>& functions, const std::vector<std::string>& others) {
    std::vector<std::string> uncalled;
    for (const std::string& name : functions) {
        const std::regex call("\\b" + name + "\\s*(<[^;{}]*>)?\\(");
        bool isCalled = false;
        for (const std::string& code : others) isCalled = isCalled || std::regex_search(code, call);
        if (!isCalled) uncalled.push_back(name);
    }
    return uncalled;
}

TEST(PartCallers, TheCheckFindsWhatNothingCalls) {
    const std::string header =
        "namespace fulcrum {\n\nnamespace detail {\n\ninline int Helper(int a) {\n    return a;\n}\n\n}  // namespace "
        "detail\n\n"
        "template <class Real>\ninline Real Free(const Real& x) {\n    return x;\n}\n\nclass Part {\npublic:\n"
        "    void Called(int a);\n    template <int N>\n    bool Uncalled() const { return true; }\n\nprivate:\n"
        "    void Own();\n};\n\n}  // namespace fulcrum\n";
    EXPECT_EQ(PublicFunctions(header), (std::set<std::string>{"Called", "Free", "Uncalled"}));
    const std::vector<std::string> engine{"void F(Part& part) { part.Called(1); Free<float>(2.0f); NotUncalled(3); }"};
    EXPECT_EQ(Uncalled(PublicFunctions(header), engine), std::vector<std::string>{"Uncalled"});
}

TEST(PartCallers, EveryPublicFunctionOfAPartHasOneInTheEngine) {
    const fs::path root = FULCRUM_SOURCE_DIR;
    std::map<fs::path, std::string> sources;
    for (const char* folder : {"Constraints", "Physics"})
        for (const auto& entry : fs::recursive_directory_iterator(root / folder))
            if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
                sources[entry.path()] = ReadCode(entry.path());
    int functions = 0;
    for (const auto& [header, code] : sources) {
        if (header.parent_path().filename() != "Parts") continue;
        std::vector<std::string> others{WithoutDeclarations(code)};
        for (const auto& [file, text] : sources)
            if (file != header) others.push_back(text);
        const std::set<std::string> names = PublicFunctions(code);
        functions += static_cast<int>(names.size());
        for (const std::string& name : Uncalled(names, others))
            ADD_FAILURE() << header.filename().string() << ": nothing in the engine calls " << name;
    }
    EXPECT_GT(functions, 60);
}

}  // namespace
