// Callback for recorders of calls: derive from CallObserver and pass it to PhysicsSystem::SetCallObserver. It sees
// every call that changes the world, with its arguments; calls that are made of others are seen as those. Without one a
// call only tests a pointer. Recording/CallRecorder.h is the one that comes with the engine.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <cstdint>
#include <span>
#include <tuple>

namespace fulcrum {

// Its address identifies a member function of the interfaces: &kCallTag<&BodyInterface::Remove>.
template <auto kFunction>
inline constexpr char kCallTag = 0;

namespace detail {

template <class Returned, class Class, class... Parameters>
std::tuple<std::remove_cvref_t<Parameters>...> ArgumentsOf(Returned (Class::*)(Parameters...));
template <class Value, class Class, class... Parameters>
Value ResultOf(Result<Value> (Class::*)(Parameters...));
template <class Class, class... Parameters>
Done ResultOf(void (Class::*)(Parameters...));

}  // namespace detail

// The types of a function's arguments, a tuple, and of the value of its Result.
template <auto kFunction>
using CallArguments = decltype(detail::ArgumentsOf(kFunction));
template <auto kFunction>
using CallResult = decltype(detail::ResultOf(kFunction));

// Of several functions with one name, the one with these parameters.
template <class... Parameters>
struct Overload {
    template <class Returned, class Class>
    static constexpr auto Of(Returned (Class::*function)(Parameters...)) {
        return function;
    }
};

// All are called by the thread that makes the call, under the world's lock: the interfaces' getters may be read,
// queries and changes are refused.
class CallObserver {
public:
    virtual ~CallObserver() = default;

    // Before the call has any effect. arguments: the addresses of its arguments, in their order, of the parameters'
    // types without const and reference. The call may still be refused, and then changes nothing.
    virtual void BeginCall(const void* function, std::span<const void* const> arguments) = 0;
    // What a call has created: the address of the value of its Result, a BodyId for BodyInterface::Create.
    virtual void NoteCreated(const void* value) = 0;
    // The call was cut short by an exception, as when memory ran out: it has had no effect, or the world is broken now,
    // as after a step (Docs/Embedding.md). Must not throw.
    virtual void CancelCall() {}
    // After a step. stateHash: PhysicsSystem::HashState, which cannot be called now.
    virtual void EndStep(uint64_t stateHash) = 0;
};

}  // namespace fulcrum
