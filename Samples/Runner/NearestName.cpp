#include <Fulcrum/Samples/Runner/NearestName.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace fulcrum {
namespace {

std::string Plain(std::string_view name) {
    std::string plain(name);
    for (char& c : plain) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        if (c == '_') c = '-';
    }
    return plain;
}

}  // namespace

int EditDistance(std::string_view a, std::string_view b) {
    // Three rows of the table of distances between prefixes: two before, one before, and the current one.
    std::vector<int> beforeLast(b.size() + 1), last(b.size() + 1), current(b.size() + 1);
    for (size_t j = 0; j <= b.size(); ++j) current[j] = static_cast<int>(j);
    for (size_t i = 1; i <= a.size(); ++i) {
        beforeLast.swap(last);
        last.swap(current);
        current[0] = static_cast<int>(i);
        for (size_t j = 1; j <= b.size(); ++j) {
            const int replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            current[j] = std::min({last[j] + 1, current[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                current[j] = std::min(current[j], beforeLast[j - 2] + 1);
        }
    }
    return current[b.size()];
}

std::string NearestName(std::string_view name, std::span<const std::string> names) {
    std::string nearest;
    int least = std::numeric_limits<int>::max();
    for (const std::string& candidate : names) {
        const int distance = EditDistance(Plain(name), Plain(candidate));
        if (distance < least) {
            least = distance;
            nearest = candidate;
        }
    }
    return nearest;
}

}  // namespace fulcrum
