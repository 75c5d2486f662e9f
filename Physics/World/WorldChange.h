// Exclusive access to the world, in the default floating-point environment, for a call of the public interface, which
// the observer of calls then sees. The first line of each function that changes the world:
//     const WorldChange<&BodyInterface::SetLayer> change(world_, id, layer);
//     if (change.Refusal()) return *change.Refusal();
// Calls made of other public calls have none: the observer sees those. Edits of shapes since the last call come before
// it: so what follows from them does not depend on whether the state was saved or hashed between.
#pragma once

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/CallObserver.h>
#include <Fulcrum/Physics/World/ShapeEdits.h>

#include <exception>
#include <type_traits>

namespace fulcrum {

template <auto kFunction>
class WorldChange : public WorldLock::Exclusive {
public:
    template <class... Arguments>
    explicit WorldChange(WorldState& world, const Arguments&... arguments)
        : Exclusive(world.lock), observer_(world.callObserver) {
        static_assert(std::is_same_v<CallArguments<kFunction>, std::tuple<Arguments...>>,
                      "all arguments of the call, in their order");
        if (Refusal()) return;
        HeedShapeEdits(world);
        if (!observer_) [[likely]]
            return;
        const void* const addresses[] = {&arguments...};
        observer_->BeginCall(&kCallTag<kFunction>, addresses);
        exceptions_ = std::uncaught_exceptions();
    }
    ~WorldChange() {
        if (exceptions_ >= 0 && std::uncaught_exceptions() > exceptions_) [[unlikely]]
            observer_->CancelCall();
    }
    // For what the call creates, on the way to the caller.
    template <class Value>
    Result<Value> Created(Result<Value> result) const {
        static_assert(std::is_same_v<Value, CallResult<kFunction>>);
        if (observer_ && result) [[unlikely]]
            observer_->NoteCreated(&result.Value());
        return result;
    }

private:
    const DefaultFloats floats_;
    CallObserver* observer_;
    int exceptions_ = -1;  // in flight when the observer was told of the call; -1: it was not
};

}  // namespace fulcrum
