// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace verglas {

// As std::allocator, but elements that are made without a value get none.
template <typename Value>
struct UnfilledAllocator : std::allocator<Value> {
    template <typename Other>
    struct rebind {
        using other = UnfilledAllocator<Other>;
    };
    using std::allocator<Value>::allocator;

    template <typename Element>
    void construct(Element* element) {
        ::new (static_cast<void*>(element)) Element;
    }
    template <typename Element, typename... Arguments>
    void construct(Element* element, Arguments&&... arguments) {
        std::construct_at(element, std::forward<Arguments>(arguments)...);
    }
};

// A vector whose resize() leaves new elements of plain types without values, for those who write all of them
// anyway, and by many threads.
template <typename Value>
using Unfilled = std::vector<Value, UnfilledAllocator<Value>>;

}  // namespace verglas
