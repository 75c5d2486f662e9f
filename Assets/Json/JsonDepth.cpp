#include <Fulcrum/Assets/Json/JsonDepth.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace fulcrum {

namespace {

constexpr int kMostLevels = 100;

Error TooDeep() {
    return {ErrorCode::OutOfRange,
            "it is nested deeper than the " + std::to_string(kMostLevels) + " levels that are read"};
}

// Goes through the items of a document (RFC 8949).
class CborWalk {
public:
    explicit CborWalk(std::string_view bytes) : bytes_(bytes) {}

    // Skips an item; stops at the end of the bytes.
    void Item(int level) {
        if (level > kMostLevels) Stop(TooDeep());
        if (bytes_.empty()) return;
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
            for (uint64_t i = 0; i < number && !bytes_.empty(); ++i)
                for (int part = 0; part < kind - 3; ++part) Item(level + 1);
    }
    const MaybeError& GetError() const { return error_; }

private:
    void IndefiniteItem(int kind, int level) {
        if (kind == 2 || kind == 3) Stop({ErrorCode::Unsupported, "it has strings of unknown length"});
        if (kind != 4 && kind != 5) return;
        while (!bytes_.empty() && bytes_.front() != '\xff') Item(level + 1);
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
    MaybeError error_;
};

}  // namespace

MaybeError CheckDepthOfJson(std::string_view text) {
    int level = 0;
    bool isInString = false;
    for (size_t i = 0; i < text.size(); ++i) {
        if (isInString) {
            if (text[i] == '\\') ++i;
            else isInString = text[i] != '"';
            continue;
        }
        isInString = text[i] == '"';
        if (text[i] == '[' || text[i] == '{') ++level;
        if (text[i] == ']' || text[i] == '}') --level;
        if (level > kMostLevels) return TooDeep();
    }
    return {};
}

MaybeError CheckDepthOfCbor(std::string_view bytes) {
    CborWalk walk(bytes);
    walk.Item(0);
    return walk.GetError();
}

}  // namespace fulcrum
