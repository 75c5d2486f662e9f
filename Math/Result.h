// The answer to a call whose input may be wrong: a value, or an Error that says what is wrong and where.
// Nothing has been created or changed where an Error is returned.
#pragma once

#include <Fulcrum/Math/Assert.h>

#include <string>
#include <utility>
#include <variant>

namespace fulcrum {

enum class ErrorCode {
    NonFinite,           // a number is NaN or infinite
    NonPositive,         // a size, mass or duration must be larger than zero
    Negative,            // must be zero or more
    OutOfRange,          // outside the range named in the message
    Unnormalized,        // a rotation or a direction is not of length 1
    Degenerate,          // points without volume, an empty compound and the like
    UnknownId,           // no such body, or it was removed
    Unsupported,         // valid, but not for this kind of body or shape
};

struct Error {
    ErrorCode code;
    std::string message;  // names the field, its value and what would be valid
};

template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : content_(std::move(value)) {}
    Result(Error error) : content_(std::move(error)) {}

    explicit operator bool() const { return content_.index() == 0; }
    // Only where the result is true.
    T& Value() {
        FULCRUM_ASSERT(content_.index() == 0);
        return *std::get_if<0>(&content_);
    }
    const T& Value() const {
        FULCRUM_ASSERT(content_.index() == 0);
        return *std::get_if<0>(&content_);
    }
    // Only where the result is false.
    const Error& GetError() const {
        FULCRUM_ASSERT(content_.index() == 1);
        return *std::get_if<1>(&content_);
    }

private:
    std::variant<T, Error> content_;
};

// A Result without a value: true means done.
struct Done {};
using Status = Result<Done>;

}  // namespace fulcrum
