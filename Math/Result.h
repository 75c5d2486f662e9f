// The result of a call whose input may be invalid: a value, or an Error that says what is wrong and where. A call that
// returns an Error has created and changed nothing.
#pragma once

#include <Fulcrum/Math/Assert.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <variant>

namespace fulcrum {

enum class ErrorCode {
    NonFinite,       // a number is NaN or infinite
    NonPositive,     // a size, mass or duration must be larger than zero
    Negative,        // must be zero or more
    OutOfRange,      // outside the range named in the message
    Unnormalized,    // a rotation or a direction is not of length 1
    Degenerate,      // points without volume, an empty compound and the like
    UnknownId,       // no such body, or it was removed
    Unsupported,     // valid, but not for this kind of body or shape
    NotAllowedHere,  // a call in what the engine calls back, or under Queries().Hold(), that would have to wait for
                     // itself
};

struct Error {
    ErrorCode code;
    std::string message;  // names the field, its value and what would be valid
};

// Prints the message to standard error and aborts: for Value() of an error and GetError() of a value.
[[noreturn, gnu::cold, gnu::noinline]] inline void AbortWith(const char* what, const std::string& message) {
    std::fprintf(stderr, "fulcrum: %s%s\n", what, message.c_str());
    std::abort();
}

template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : content_(std::move(value)) {}
    Result(Error error) : content_(std::move(error)) {}

    explicit operator bool() const { return content_.index() == 0; }
    // Only if the result is true. Otherwise prints the error's message and aborts, in every build.
    T& Value() {
        if (content_.index() != 0) [[unlikely]]
            AbortWith("Value() of an error: ", GetError().message);
        return *std::get_if<0>(&content_);
    }
    const T& Value() const {
        if (content_.index() != 0) [[unlikely]]
            AbortWith("Value() of an error: ", GetError().message);
        return *std::get_if<0>(&content_);
    }
    // Only if the result is false. Otherwise aborts.
    const Error& GetError() const {
        if (content_.index() != 1) [[unlikely]]
            AbortWith("GetError() of a result without an error", "");
        return *std::get_if<1>(&content_);
    }

private:
    std::variant<T, Error> content_;
};

// A Result without a value: true means done.
struct Done {};
using Status = Result<Done>;

}  // namespace fulcrum
