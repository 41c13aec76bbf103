// Arrays of many megabytes, their values anything. The system hands out memory page by page, clears each page when it
// is first written to, and the processor remembers where only some thousand pages are: on Linux large arrays ask for
// pages of 2 MB instead of 4 kB, which is 512 times less to do and to remember. All threads together touch these pages
// at once, so that none has to wait later while another one has its own cleared.
#pragma once
#include <cstddef>
#include <memory>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace almesh {

struct FreeArray {
    std::align_val_t alignment{};
    void operator()(double* array) const { ::operator delete[](array, alignment); }
};
using LargeArray = std::unique_ptr<double[], FreeArray>;

// Where there is not so much memory: as `new`.
inline LargeArray large_array(std::size_t size) {
    constexpr std::size_t huge_page = std::size_t{1} << 21, cache_line = 64;
    const std::size_t alignment = size * sizeof(double) < huge_page ? cache_line : huge_page;
    const std::size_t bytes = (size * sizeof(double) + alignment - 1) / alignment * alignment;
    const FreeArray free{std::align_val_t{alignment}};
    LargeArray array(static_cast<double*>(::operator new[](bytes, free.alignment)), free);
#ifdef MADV_HUGEPAGE
    if (alignment == huge_page) madvise(array.get(), bytes, MADV_HUGEPAGE);  // if it refuses nothing else changes
#endif
    constexpr std::size_t small_page = 4096 / sizeof(double), chunk = huge_page / sizeof(double);
#pragma omp parallel for schedule(dynamic, 1) if (size > chunk)
    for (std::size_t k = 0; k < size / chunk; ++k)
        for (std::size_t i = 0; i < chunk; i += small_page) array[k * chunk + i] = 0;
    return array;
}

}  // namespace almesh
