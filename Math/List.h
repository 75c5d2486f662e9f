// A read-only list as a member of a struct of settings, where a std::span would dangle: elements of a temporary, which
// is gone when the settings are used, are kept.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace fulcrum {

// Refers to the elements of a container that lives on, of a span, or at an address: they must live as long as the list
// and its copies. Owns those of a temporary container or in braces; copies share them. Up to 32 bytes of them take no
// memory from the heap.
template <class T>
class List {
public:
    List() = default;
    List(const T* first, size_t count) : first_(first), count_(count) {}
    List(std::initializer_list<T> elements) { Keep(elements.begin(), elements.size()); }
    template <class Range>
    requires(!std::is_same_v<std::remove_cvref_t<Range>, List> && std::is_convertible_v<Range&&, std::span<const T>>)
        List(Range&& range) {
        const std::span<const T> elements(range);
        using Container = std::remove_cvref_t<Range>;
        if constexpr (std::is_lvalue_reference_v<Range> || std::ranges::enable_borrowed_range<Container>) {
            first_ = elements.data();
            count_ = elements.size();
        } else if (elements.size() <= kRoom || !std::is_same_v<Range, std::vector<T>>) {
            Keep(elements.data(), elements.size());
        } else if constexpr (std::is_same_v<Range, std::vector<T>>) {
            KeepAll(std::move(range));
        }
    }

    const T* data() const { return count_ > 0 && !first_ ? room_ : first_; }
    size_t size() const { return count_; }
    bool empty() const { return count_ == 0; }
    const T* begin() const { return data(); }
    const T* end() const { return data() + count_; }
    const T& operator[](size_t i) const { return data()[i]; }

private:
    static constexpr size_t kRoom = std::is_trivially_copyable_v<T> ? 32 / sizeof(T) : 0;

    void Keep(const T* elements, size_t count) {
        if (count > kRoom) return KeepAll(std::vector<T>(elements, elements + count));
        count_ = count;
        for (size_t i = 0; i < count; ++i) room_[i] = elements[i];
    }
    void KeepAll(std::vector<T> elements) {
        const auto owned = std::make_shared<const std::vector<T>>(std::move(elements));
        first_ = owned->data();
        count_ = owned->size();
        owner_ = owned;
    }

    const T* first_ = nullptr;  // null: in room_
    size_t count_ = 0;
    std::shared_ptr<const void> owner_;
    T room_[kRoom > 0 ? kRoom : 1] = {};
};

}  // namespace fulcrum
