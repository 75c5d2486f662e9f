// The result of a call whose input may be invalid: a value, or an Error that tells what is wrong and where. A call that
// returns an Error has no effect.
#pragma once

#include <Fulcrum/Math/Assert.h>
#include <Fulcrum/Math/Log.h>

#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

namespace fulcrum {

enum class ErrorCode {
    NonFinite,       // a number is NaN or infinite
    NonPositive,     // a size, mass or duration must be larger than zero
    Negative,        // must be zero or more
    OutOfRange,      // outside the range named in the message
    Unnormalized,    // a rotation or a direction is not of length 1
    Degenerate,      // points without volume, an empty compound, etc.
    UnknownId,       // no such body, or it was removed
    Unsupported,     // valid, but not for this kind of body or shape
    NotAllowedHere,  // a call from a callback of the engine, or under Queries().Hold(), that would have to wait for
                     // itself
    BrokenWorld,  // an earlier step or call was cut short by an exception, as when memory ran out: the world can only
                  // be destroyed, or restored from a snapshot
};

struct Error {
    ErrorCode code;
    std::string message;  // names the field, its value and what would be valid
};

using MaybeError = std::optional<Error>;

// Logs the message (Log.h: to standard error by default) and aborts: for Value() of an error and GetError() of a value.
[[noreturn, gnu::cold, gnu::noinline]] inline void AbortWith(const char* what, const std::string& message) {
    Log(LogLevel::Fatal, (what + message).c_str());
    std::abort();
}

template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : hasValue_(true) { std::construct_at(&value_, std::move(value)); }
    Result(Error error) : hasValue_(false) { std::construct_at(&error_, std::move(error)); }
    Result(Result&& other) noexcept : hasValue_(other.hasValue_) { Construct(std::move(other)); }
    Result(const Result& other) requires std::is_copy_constructible_v<T> : hasValue_(other.hasValue_) {
        Construct(other);
    }
    Result& operator=(Result other) noexcept {
        Destroy();
        hasValue_ = other.hasValue_;
        Construct(std::move(other));
        return *this;
    }
    ~Result() { Destroy(); }

    explicit operator bool() const { return hasValue_; }
    // Only if the result is true. Otherwise prints the error's message and aborts, in every build.
    T& Value() & {
        if (!hasValue_) [[unlikely]]
            AbortWith("Value() of an error: ", error_.message);
        return value_;
    }
    const T& Value() const& {
        if (!hasValue_) [[unlikely]]
            AbortWith("Value() of an error: ", error_.message);
        return value_;
    }
    // Of a temporary: the value itself, so that `auto& body = bodies.Create(settings).Value()` does not compile, and
    // `const auto& body = ...` names what lives on.
    T Value() && {
        if (!hasValue_) [[unlikely]]
            AbortWith("Value() of an error: ", error_.message);
        return std::move(value_);
    }
    // Only if the result is false. Otherwise aborts.
    const Error& GetError() const {
        if (hasValue_) [[unlikely]]
            AbortWith("GetError() of a result without an error", "");
        return error_;
    }

private:
    template <class Other>
    void Construct(Other&& other) {
        if (hasValue_) std::construct_at(&value_, std::forward<Other>(other).value_);
        else std::construct_at(&error_, std::forward<Other>(other).error_);
    }
    void Destroy() {
        if (hasValue_) std::destroy_at(&value_);
        else std::destroy_at(&error_);
    }

    // Not std::variant, which takes much longer to compile.
    union {
        T value_;
        Error error_;
    };
    bool hasValue_;
};

// A Result without a value: true means done.
struct Done {};
using Status = Result<Done>;

}  // namespace fulcrum
