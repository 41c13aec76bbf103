// The memory of the machine, and what this program has taken of it.
#pragma once
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace almesh {

// Bytes.
inline double physical_memory() {
    static const double bytes =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return bytes;
}

// The number behind this name in a file of /proc, which is in kB; 0: not on Linux.
inline double bytes_in(const char* path, const char* name) {
    double kilobytes = 0;
    if (std::FILE* const file = std::fopen(path, "r")) {
        char line[256];
        while (kilobytes == 0 && std::fgets(line, sizeof line, file))
            if (std::strncmp(line, name, std::strlen(name)) == 0)
                kilobytes = std::strtod(line + std::strlen(name), nullptr);
        std::fclose(file);
    }
    return 1024 * kilobytes;
}

// What other programs leave of it, bytes: elsewhere than on Linux all of it.
inline double available_memory() {
    const double bytes = bytes_in("/proc/meminfo", "MemAvailable:");
    return bytes > 0 ? bytes : physical_memory();
}

// The most that the program has had in memory at once, bytes. On Linux from VmHWM: ru_maxrss begins there with what the
// process had that started the program.
inline double peak_memory() {
    if (const double bytes = bytes_in("/proc/self/status", "VmHWM:"); bytes > 0) return bytes;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
    return static_cast<double>(usage.ru_maxrss);
#else
    return 1024 * static_cast<double>(usage.ru_maxrss);
#endif
}

}  // namespace almesh
