// A callable as a member or argument of public headers. Stands in for std::function, whose header takes long to
// compile.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace fulcrum {

// An owned callable, or none. Small ones, such as lambdas that capture up to four pointers, are held in place, others
// on the heap. Copies share a callable that can change when it is called.
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
        if constexpr (FitsRoom<Callable>()) {
            ::new (static_cast<void*>(room_)) Callable(std::move(callable));
            call_ = [](const Function& self, Args... args) -> R {
                return (*std::launder(reinterpret_cast<const Callable*>(self.room_)))(std::forward<Args>(args)...);
            };
        } else {
            object_ = std::make_shared<Callable>(std::move(callable));
            call_ = [](const Function& self, Args... args) -> R {
                return (*static_cast<Callable*>(self.object_.get()))(std::forward<Args>(args)...);
            };
        }
    }

    // The callable object at an address, which must live as long.
    template <class F>
    requires(std::is_class_v<F>&& std::is_invocable_r_v<R, F&, Args...>) Function(F* f) {
        if (f) *this = [f](Args... args) -> R { return (*f)(std::forward<Args>(args)...); };
    }

    explicit operator bool() const { return call_ != nullptr; }
    // Only if it is not empty.
    R operator()(Args... args) const { return call_(*this, std::forward<Args>(args)...); }

private:
    static constexpr size_t kRoom = 4 * sizeof(void*);
    // Whether its bytes may be copied, and copies are alike because calls do not change them.
    template <class Callable>
    static constexpr bool FitsRoom() {
        return sizeof(Callable) <= kRoom && alignof(Callable) <= alignof(void*) &&
               std::is_trivially_copyable_v<Callable> && std::is_invocable_r_v<R, const Callable&, Args...>;
    }

    std::shared_ptr<void> object_;
    R (*call_)(const Function& self, Args...) = nullptr;
    alignas(void*) std::byte room_[kRoom] = {};
};

}  // namespace fulcrum
