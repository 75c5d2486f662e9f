// A callable as a member or argument of public headers. Stands in for std::function, whose header takes long to
// compile.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace fulcrum {

// An owned callable, or none. Copies share it.
template <class Signature>
class Function;
template <class R, class... Args>
class Function<R(Args...)> {
public:
    Function() = default;
    Function(std::nullptr_t) {}
    template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, Function> && std::is_invocable_r_v<R, std::decay_t<F>&, Args...>)
        Function(F&& f) {
        using Callable = std::decay_t<F>;
        Callable callable(std::forward<F>(f));
        if constexpr (requires { callable == nullptr; })
            if (callable == nullptr) return;  // a function pointer or std::function that is empty itself
        object_ = std::make_shared<Callable>(std::move(callable));
        call_ = [](void* o, Args... args) -> R { return (*static_cast<Callable*>(o))(std::forward<Args>(args)...); };
    }

    explicit operator bool() const { return call_ != nullptr; }
    // Only if it is not empty.
    R operator()(Args... args) const { return call_(object_.get(), std::forward<Args>(args)...); }

private:
    std::shared_ptr<void> object_;
    R (*call_)(void*, Args...) = nullptr;
};

}  // namespace fulcrum
