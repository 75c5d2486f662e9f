#include <Fulcrum/UnitTests/Support/PublicHeaders.h>

#include <gtest/gtest.h>

#include <fstream>
#include <regex>

namespace fulcrum::testing {

namespace {

// A header without comments and preprocessor lines.
std::string CodeOf(const std::string& header) {
    std::ifstream stream(std::string(FULCRUM_SOURCE_DIR) + "/" + header);
    std::string code;
    for (std::string line; std::getline(stream, line);)
        if (line.empty() || line[0] != '#') code += line.substr(0, line.find("//")) + "\n";
    return code;
}

// What stands between the braces after `class type` or `struct type`.
std::string BodyOf(const std::string& header, const std::string& type) {
    const std::string code = CodeOf(header);
    std::smatch match;
    if (!std::regex_search(code, match, std::regex("(class|struct) " + type + "( final)?( : [^{;]*)? \\{"))) {
        ADD_FAILURE() << header << " has no " << type;
        return {};
    }
    const size_t begin = static_cast<size_t>(match.position() + match.length());
    size_t end = begin;
    for (int depth = 1; end < code.size(); ++end) {
        depth += (code[end] == '{') - (code[end] == '}');
        if (depth == 0) break;
    }
    const std::string body = code.substr(begin, end - begin);
    return match[1] == "class" ? "private:" + body : "public:" + body;
}

// The public declarations, each in one line, without what stands in braces (bodies, initializers, nested types).
std::vector<std::string> Declarations(const std::string& body) {
    std::vector<std::string> declarations;
    std::string text;
    bool isPublic = false;
    int braces = 0, parentheses = 0;
    const auto end = [&] {
        text = std::regex_replace(text, std::regex("\\s+"), " ");
        text = std::regex_replace(text, std::regex("^ | $"), "");
        if (isPublic && !text.empty()) declarations.push_back(text);
        text.clear();
    };
    for (size_t i = 0; i < body.size(); ++i) {
        const char c = body[i];
        if (c == '{') ++braces;
        if (braces == 0) {
            parentheses += (c == '(') - (c == ')');
            if (c == ';') end();
            else text += c;
            for (const bool says : {true, false}) {
                const std::string word = says ? "public:" : "private:";
                if (!text.ends_with(word)) continue;
                isPublic = says;
                text.clear();
            }
        }
        if (c == '}') {
            --braces;
            // A body ends a function; an initializer is followed by a semicolon, a comma or a parenthesis.
            const size_t next = body.find_first_not_of(" \n", i + 1);
            const bool goesOn =
                next != std::string::npos && (body[next] == ';' || body[next] == ',' || body[next] == ')');
            if (braces == 0 && parentheses == 0 && !goesOn) end();
        }
    }
    return declarations;
}

}  // namespace

std::vector<std::string> PublicFunction::ParameterNames() const {
    std::vector<std::string> names;
    std::string parameter;
    int depth = 0;
    const auto end = [&] {
        static const std::regex kName(R"((\w+)( = .*)?$)");
        std::smatch match;
        if (std::regex_search(parameter, match, kName)) names.push_back(match[1]);
        parameter.clear();
    };
    for (const char c : parameters) {
        depth += (c == '<' || c == '(') - (c == '>' || c == ')');
        if (c == ',' && depth == 0) end();
        else parameter += c;
    }
    end();
    return names;
}

std::vector<PublicFunction> PublicFunctionsOf(const std::string& header, const std::string& type) {
    static const std::regex kFunction(R"(^([^(]*[ &*>])(\w+)\((.*)\)( const)?( override| final| = 0)*$)");
    std::vector<PublicFunction> functions;
    for (const std::string& text : Declarations(BodyOf(header, type))) {
        std::smatch match;
        if (!std::regex_match(text, match, kFunction)) continue;
        const std::string before = match[1], name = match[2];
        if (name == type || text.find("operator") != std::string::npos || text.find("friend ") == 0 ||
            text.find("explicit ") == 0 || text.find("using ") == 0 || text.find('~') < text.find('('))
            continue;
        functions.push_back({name, before, match[3], match[4].matched, before.find("static ") == 0});
    }
    return functions;
}

std::vector<PublicMember> MembersOf(const std::string& header, const std::string& type) {
    std::ifstream stream(std::string(FULCRUM_SOURCE_DIR) + "/" + header);
    const std::regex begin("struct " + type + "( : [^{]*)? \\{.*");
    const std::regex name(R"((\w+)(\{[^{}]*\}| = .*)?$)");
    std::vector<PublicMember> members;
    std::string above, code, beside, line;
    bool isInside = false, isFound = false;
    while (std::getline(stream, line)) {
        if (!isInside) {
            isInside = std::regex_match(line, begin);
            isFound |= isInside;
            continue;
        }
        if (line == "};") break;
        const size_t comment = line.find("//");
        const std::string text = std::regex_replace(line.substr(0, comment), std::regex("^ +| +$"), "");
        const std::string said = comment == std::string::npos ? "" : " " + line.substr(comment + 2);
        if (text.empty()) {
            above += said;
            if (said.empty()) above.clear();
            continue;
        }
        code += (code.empty() ? "" : " ") + text;
        beside += said;
        if (code.ends_with(") {")) {  // a function's body
            while (std::getline(stream, line) && line != "    }") continue;
            above.clear(), beside.clear(), code.clear();
            continue;
        }
        if (!code.ends_with(';') && !code.ends_with('}')) continue;
        const size_t bracket = code.find('('), equals = code.find('=');
        const bool isFunction = bracket < equals || code.find("friend ") == 0 || code.find("static ") == 0;
        // Two of one type: `float linearDamping = 0, angularDamping = 0;`.
        std::vector<std::string> parts{""};
        int depth = 0;
        for (const char c : code.substr(0, code.find(';'))) {
            depth += (c == '{' || c == '<' || c == '(') - (c == '}' || c == '>' || c == ')');
            if (c == ',' && depth == 0) parts.emplace_back();
            else parts.back() += c;
        }
        std::smatch match;
        for (const std::string& part : parts)
            if (!isFunction && std::regex_search(part, match, name))
                members.push_back({match[1], above + beside + " default" + match[2].str()});
        above.clear(), beside.clear(), code.clear();
    }
    EXPECT_TRUE(isFound) << header << " has no " << type;
    return members;
}

}  // namespace fulcrum::testing
