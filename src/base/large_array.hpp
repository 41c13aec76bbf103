// Arrays of many megabytes. Elements are default-initialised: resize() leaves numbers undefined instead of passing over
// them. On Linux large arrays ask for huge pages of 2 MB instead of 4 kB, which spares page faults and TLB misses. All
// threads touch the pages of a new array at once, so that none waits later while another one faults its own in.
#pragma once
#include <cstddef>
#include <new>
#include <utility>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace almesh {

template <class T>
struct LargeAllocator {
    using value_type = T;

    LargeAllocator() = default;
    template <class Other>
    LargeAllocator(const LargeAllocator<Other>&) {}

    // Throws std::bad_alloc.
    T* allocate(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        if (bytes < huge_page) return static_cast<T*>(::operator new(bytes, std::align_val_t{cache_line}));
        const std::size_t pages = (bytes + huge_page - 1) / huge_page;
        void* const memory = ::operator new(pages * huge_page, std::align_val_t{huge_page});
        touch(static_cast<char*>(memory), pages);
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) {
        ::operator delete(memory, std::align_val_t{count * sizeof(T) < huge_page ? cache_line : huge_page});
    }

    // Without values: default-initialisation.
    template <class Element, class... Values>
    void construct(Element* element, Values&&... values) {
        if constexpr (sizeof...(values) == 0) ::new (static_cast<void*>(element)) Element;
        else ::new (static_cast<void*>(element)) Element(std::forward<Values>(values)...);
    }

    bool operator==(const LargeAllocator&) const = default;

private:
    static constexpr std::size_t huge_page = std::size_t{1} << 21, small_page = 4096, cache_line = 64;

    static void touch(char* memory, std::size_t pages) {
#ifdef MADV_HUGEPAGE
        madvise(memory, pages * huge_page, MADV_HUGEPAGE);  // if it refuses nothing else changes
#endif
#pragma omp parallel for schedule(dynamic, 1) if (pages > 1)
        for (std::size_t page = 0; page < pages; ++page)
            for (std::size_t at = 0; at < huge_page; at += small_page) memory[page * huge_page + at] = 0;
    }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace almesh
