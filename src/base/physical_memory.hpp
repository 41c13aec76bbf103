// The memory of the machine, and what this program has taken of it.
#pragma once
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>

namespace almesh {

// Bytes.
inline double physical_memory() {
    static const double bytes =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return bytes;
}

// What other programs leave of it, bytes: on Linux MemAvailable, in kB, elsewhere all of it.
inline double available_memory() {
    double kilobytes = 0;
    if (std::FILE* const info = std::fopen("/proc/meminfo", "r")) {
        char line[256];
        while (std::fgets(line, sizeof line, info) && std::sscanf(line, "MemAvailable: %lf", &kilobytes) != 1) {}
        std::fclose(info);
    }
    return kilobytes > 0 ? 1024 * kilobytes : physical_memory();
}

// The most that the program has had in memory at once, bytes. On Linux from VmHWM, in kB: ru_maxrss begins there with
// what the process had that started the program.
inline double peak_memory() {
    double kilobytes = 0;
    if (std::FILE* const status = std::fopen("/proc/self/status", "r")) {
        char line[256];
        while (std::fgets(line, sizeof line, status) && std::sscanf(line, "VmHWM: %lf", &kilobytes) != 1) {}
        std::fclose(status);
    }
    if (kilobytes > 0) return 1024 * kilobytes;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
    return static_cast<double>(usage.ru_maxrss);
#else
    return 1024 * static_cast<double>(usage.ru_maxrss);
#endif
}

}  // namespace almesh
