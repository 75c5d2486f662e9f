#include <Fulcrum/UnitTests/Physics/BadInput/Spoiler.h>

#include <cstdio>
#include <limits>
#include <regex>

namespace fulcrum::testing {

namespace {

struct Range {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    bool isLowOut = false;  // low itself is excluded
    bool isZeroIn = false;  // zero has a meaning of its own: `> 0; 0: as the system's`
};

Range RangeOf(const std::string& comment) {
    static const std::string kNumber = R"((-?\d[\d.]*(?:e-?\d+)?))";
    static const std::regex kZero(R"(\b0: )"), kBoth(kNumber + R"(\.\.)" + kNumber), kLeast("(?:^|, | )>= " + kNumber),
        kMore("(?:^|, | )> " + kNumber), kMost("(?:^|, | )<= " + kNumber),
        kAtMost(", at most " + kNumber + "(,|:|;| per|$)");
    Range range;
    std::smatch match;
    if (comment.find('|') != std::string::npos) return range;  // of an absolute value
    range.isZeroIn = std::regex_search(comment, kZero);
    if (std::regex_search(comment, match, kBoth)) {
        range.low = std::stod(match[1]);
        range.high = std::stod(match[2]);
        return range;
    }
    if (std::regex_search(comment, match, kLeast)) range.low = std::stod(match[1]);
    if (std::regex_search(comment, match, kMore)) range.low = std::stod(match[1]), range.isLowOut = true;
    if (std::regex_search(comment, match, kMost)) range.high = std::stod(match[1]);
    if (std::regex_search(comment, match, kAtMost)) range.high = std::stod(match[1]);
    return range;
}

}  // namespace

bool IsExcluded(const std::string& comment, double value) {
    static std::map<std::string, Range> known;
    const auto [found, isNew] = known.try_emplace(comment);
    if (isNew) found->second = RangeOf(comment);
    const Range& range = found->second;
    if (value == 0 && range.isZeroIn) return false;
    return value < range.low || value > range.high || (range.isLowOut && value == range.low);
}

std::string NumberText(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

const MemberComments& CommentsOf(const SettingsHeader& header) {
    static std::map<std::string, MemberComments> known;
    const auto [found, isNew] = known.try_emplace(header.type ? header.type : "");
    if (isNew && header.file)
        for (const PublicMember& member : MembersOf(header.file, header.type))
            found->second[member.name] = member.comment;
    return found->second;
}

}  // namespace fulcrum::testing
