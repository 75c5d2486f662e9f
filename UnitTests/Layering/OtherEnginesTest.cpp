// Docs/OtherEngines.md names calls of this library in the last column of its table: each exists in a public header, in
// the class that is named, as a file or as a command of ./fulcrum. The check itself is tried on names that do not
// exist.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

std::string ReadText(const fs::path& file) {
    std::ifstream stream(file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

// Calls found(match) for all matches.
template <class Found>
void ForEachMatch(const std::string& text, const std::regex& pattern, const Found& found) {
    for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) found(*at);
}

std::set<std::string> WordsOf(const std::string& code) {
    static const std::regex kWord(R"([A-Za-z_]\w*)");
    std::set<std::string> words;
    ForEachMatch(code, kWord, [&](const std::smatch& match) { words.insert(match.str()); });
    return words;
}

// The headers that Fulcrum.h includes, directly or not, without comments.
class PublicHeaders {
public:
    explicit PublicHeaders(const fs::path& root) : root_(root) { Read("Fulcrum.h"); }

    size_t Count() const { return headers_.size(); }
    bool Has(const std::string& word) const {
        for (const Header& header : headers_)
            if (header.words.contains(word)) return true;
        return false;
    }
    // Whether a header that defines this class has the word.
    bool HasMember(const std::string& type, const std::string& word) const {
        const std::regex definition("(class|struct|enum class) " + type + "\\b[^;]*\\{");
        for (const Header& header : headers_)
            if (header.words.contains(type) && header.words.contains(word) &&
                std::regex_search(header.code, definition))
                return true;
        return false;
    }
    // The class of what PhysicsSystem's function without arguments returns; empty if there is none.
    std::string TypeOf(const std::string& function) const {
        const std::regex declaration("(\\w+)& " + function + "\\(\\)");
        std::smatch match;
        for (const Header& header : headers_)
            if (header.words.contains(function) && std::regex_search(header.code, match, declaration)) return match[1];
        return "";
    }

private:
    struct Header {
        std::string code;
        std::set<std::string> words;
    };

    void Read(const std::string& name) {
        if (!seen_.insert(name).second) return;
        static const std::regex kComment("//[^\n]*"), kInclude(R"(#include <Fulcrum/([^>]+)>)");
        const std::string code = std::regex_replace(ReadText(root_ / name), kComment, "");
        headers_.push_back({code, WordsOf(code)});
        ForEachMatch(code, kInclude, [&](const std::smatch& match) { Read(match[1]); });
    }

    fs::path root_;
    std::set<std::string> seen_;
    std::vector<Header> headers_;
};

// What a code span in the table names that does not exist.
Strings MissingNames(const fs::path& root, const PublicHeaders& headers, const std::string& span) {
    static const std::regex kCommand(R"(\./fulcrum (\w+))"), kMember(R"((\w+)(\(\))?(::|\.)(\w+))");
    std::smatch match;
    if (std::regex_match(span, match, kCommand)) {
        const std::string script = ReadText(root / "fulcrum");
        const bool isThere = std::regex_search(script, std::regex("verbs=\\([^)]*\\b" + match.str(1) + "\\b"));
        return isThere ? Strings{} : Strings{span};
    }
    if (span.find('/') != std::string::npos) return fs::exists(root / span) ? Strings{} : Strings{span};
    Strings missing;
    for (const std::string& word : WordsOf(span))
        if (!headers.Has(word)) missing.push_back(word);
    ForEachMatch(span, kMember, [&](const std::smatch& member) {
        const std::string owner = member[2].matched ? headers.TypeOf(member[1]) : member.str(1);
        // Members of a value, such as events.bodies, are words of the headers; its class is not written there.
        if (member[3] == "." && !member[2].matched) return;
        if (!headers.HasMember(owner, member[4])) missing.push_back(member.str());
    });
    return missing;
}

// The code spans in the last column of a page's tables, without those of headings.
Strings LastColumn(const std::string& page) {
    static const std::regex kSpan("`([^`]+)`");
    Strings spans;
    std::istringstream lines(page);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("| ") || !line.ends_with(" |")) continue;
        const std::string cell = line.substr(line.rfind(" | ", line.size() - 3) + 3);
        ForEachMatch(cell, kSpan, [&](const std::smatch& match) { spans.push_back(match[1]); });
    }
    return spans;
}

TEST(OtherEngines, NamesOfTheLastColumnExist) {
    const fs::path root = FULCRUM_SOURCE_DIR;
    const PublicHeaders headers(root);
    EXPECT_GT(headers.Count(), 30u);
    const Strings spans = LastColumn(ReadText(root / "Docs/OtherEngines.md"));
    EXPECT_GT(spans.size(), 70u);
    for (const std::string& span : spans)
        for (const std::string& name : MissingNames(root, headers, span)) ADD_FAILURE() << "`" << span << "`: " << name;
}

TEST(OtherEngines, TheCheckFindsNamesThatDoNotExist) {
    const fs::path root = FULCRUM_SOURCE_DIR;
    const PublicHeaders headers(root);
    const Strings wrong = LastColumn(
        "| a | `Ignored` | `Bodies().Fabricate`, `PhysicsSystem::Hold`, `BodyBatch::Prepare` |\n"
        "| b | `Ignored` | `./fulcrum invent`, `Samples/Embedding/Nothing.h`, `fabricate = 1` |\n");
    ASSERT_EQ(wrong.size(), 6u);
    for (const std::string& span : wrong)
        EXPECT_EQ(MissingNames(root, headers, span).empty(), span == "BodyBatch::Prepare") << span;
}

}  // namespace
