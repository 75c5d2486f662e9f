#include <Fulcrum/Assets/Json/JsonLimits.h>

#include <algorithm>
#include <string>
#include <vector>

namespace fulcrum {

namespace {

// What has been found so far.
class Counts {
public:
    explicit Counts(const DocumentLimits& limits) : limits_(limits) {}

    MaybeError CheckLevel(int level) const {
        return level > limits_.levels ? TooMany("is nested deeper than the", limits_.levels, "levels") : std::nullopt;
    }
    MaybeError AddValue() {
        return ++values_ > limits_.values ? TooMany("has more than the", limits_.values, "values") : std::nullopt;
    }
    // A name of an object that has so many already.
    MaybeError AddName(uint64_t others) {
        comparisons_ += others;
        if (comparisons_ <= limits_.comparisons) return {};
        return TooMany("has objects of too many names, which need more than the", limits_.comparisons, "comparisons");
    }

private:
    template <class Number>
    static MaybeError TooMany(const std::string& how, Number most, const char* what) {
        return Error{ErrorCode::OutOfRange, "it " + how + " " + std::to_string(most) + " " + what + " that are read"};
    }

    DocumentLimits limits_;
    uint64_t values_ = 0, comparisons_ = 0;
};

// Goes through the items of a document (RFC 8949).
class CborWalk {
public:
    CborWalk(std::string_view bytes, const DocumentLimits& limits) : bytes_(bytes), counts_(limits) {}

    // Skips an item; stops at the end of the bytes.
    void Item(int level) {
        if (const MaybeError e = counts_.CheckLevel(level)) Stop(*e);
        if (bytes_.empty()) return;
        if (const MaybeError e = counts_.AddValue()) return Stop(*e);
        const int head = Take(), kind = head >> 5, length = head & 31;
        if (length == 31) return IndefiniteItem(kind, level);
        uint64_t number = static_cast<uint64_t>(length);
        if (length >= 24) {
            number = 0;
            for (int left = 1 << ((length - 24) & 3); left > 0; --left) number = number << 8 | Take();
        }
        if (kind == 2 || kind == 3) bytes_.remove_prefix(std::min<uint64_t>(number, bytes_.size()));
        if (kind == 6) Stop({ErrorCode::Unsupported, "it has tags of CBOR"});
        if (kind == 4 || kind == 5)
            for (uint64_t i = 0; i < number && !bytes_.empty(); ++i) Element(kind, level, i);
    }
    const MaybeError& GetError() const { return error_; }

private:
    // Of an array, or a name and a value of a map.
    void Element(int kind, int level, uint64_t before) {
        if (kind == 5) {
            if (const MaybeError e = counts_.AddName(before)) return Stop(*e);
            Item(level + 1);
        }
        Item(level + 1);
    }
    void IndefiniteItem(int kind, int level) {
        if (kind == 2 || kind == 3) Stop({ErrorCode::Unsupported, "it has strings of unknown length"});
        if (kind != 4 && kind != 5) return;
        for (uint64_t i = 0; !bytes_.empty() && bytes_.front() != '\xff'; ++i) Element(kind, level, i);
        if (!bytes_.empty()) Take();
    }
    uint8_t Take() {
        if (bytes_.empty()) return 0;
        const auto byte = static_cast<uint8_t>(bytes_.front());
        bytes_.remove_prefix(1);
        return byte;
    }
    void Stop(const Error& error) {
        if (!error_) error_ = error;
        bytes_ = {};
    }

    std::string_view bytes_;
    Counts counts_;
    MaybeError error_;
};

}  // namespace

MaybeError CheckLimitsOfJson(std::string_view text, const DocumentLimits& limits) {
    Counts counts(limits);
    std::vector<uint64_t> names(static_cast<size_t>(limits.levels) + 1);  // of the open object of each level
    int level = 0;
    bool isInString = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (isInString) {
            if (c == '\\') ++i;
            else isInString = c != '"';
            continue;
        }
        isInString = c == '"';
        if (c == '[' || c == '{') {
            if (const MaybeError e = counts.CheckLevel(++level)) return e;
            if (level > 0) names[static_cast<size_t>(level)] = 0;
        }
        if (c == ']' || c == '}') --level;
        // Each value but the first one follows one of these; so many may be missing in what is not valid.
        if (c == '[' || c == '{' || c == ',')
            if (const MaybeError e = counts.AddValue()) return e;
        if (c == ':' && level > 0)
            if (const MaybeError e = counts.AddName(names[static_cast<size_t>(level)]++)) return e;
    }
    return {};
}

MaybeError CheckLimitsOfCbor(std::string_view bytes, const DocumentLimits& limits) {
    CborWalk walk(bytes, limits);
    walk.Item(0);
    return walk.GetError();
}

MaybeError TakeFrom(uint64_t& left, uint64_t count, uint64_t most, const char* what) {
    if (count > left)
        return Error{ErrorCode::OutOfRange,
                     "it has more than the " + std::to_string(most) + " " + what + " that are read"};
    left -= count;
    return {};
}

}  // namespace fulcrum
