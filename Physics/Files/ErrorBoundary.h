// Where exceptions end: functions that return a Result and call what may throw (the standard library, JSON, meshes) do
// so within this. No state, any thread.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <exception>
#include <new>
#include <string>

namespace fulcrum {

// What the function returns, a Result; or, where it throws, an Error whose message begins with `what`: OutOfRange where
// memory is short, Unsupported otherwise.
template <class Call>
auto WithErrors(const std::string& what, Call&& call) -> decltype(call()) {
    const std::string begin = what.empty() ? what : what + ": ";
    try {
        return call();
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfRange, begin + "there is not enough memory for it"};
    } catch (const std::exception& error) {
        return Error{ErrorCode::Unsupported, begin + error.what()};
    }
}

}  // namespace fulcrum
