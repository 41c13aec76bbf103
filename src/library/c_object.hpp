// What the functions of almesh.h share: the meshes behind their handles, the refusal of wrong use, codes and sentences.
#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>

#include "almesh.h"
#include "base/error.hpp"
#include "library/session.hpp"

namespace almesh::c {

using Numbers = std::vector<double>;
using Time = std::chrono::steady_clock;

inline constexpr std::string_view by_setting = "command line";  // where the parser has settings

// An error whose code the program does not have.
struct Refused : std::runtime_error {
    int code;
    Refused(int of, const char* why) : std::runtime_error(why), code(of) {}
};

struct Object {
    Session session;
    std::atomic<bool> is_busy = false;
    std::map<std::string, Numbers> numbers;  // asked for since the last run
    std::string text;                        // asked for last
    almesh_callback callback = nullptr;
    void* user = nullptr;
    bool is_cancelled = false;
    almesh_progress last{};
    Time::time_point told{};

    explicit Object(const std::function<Session()>& read) : session(read()) {}

    void tell(const Progress& now) {
        last = {now.iteration, now.newton_step, now.energy, now.gradient_norm, now.step_length, now.constraint_norm};
        tell_last();
    }
    void tell_last() {
        told = Time::now();
        is_cancelled = is_cancelled || callback(user, &last) != 0;
    }
    bool stops() {
        constexpr std::chrono::milliseconds silence(100);
        if (Time::now() - told >= silence) tell_last();
        return is_cancelled;
    }
};

// Handles are numbers that are used once, so that one of a mesh that was freed is known as such.
inline std::mutex of_objects;
inline std::map<const almesh_mesh*, std::shared_ptr<Object>> objects;
inline std::uintptr_t handles = 0;

inline thread_local std::string last_sentence;
inline thread_local int last_code = ALMESH_OK;

inline int failed(int code, std::string_view why) {
    last_sentence = why;
    return last_code = code;
}

template <class Body>
int guarded(const Body& body) try {
    body();
    return last_code = ALMESH_OK;
} catch (const Error& error) {
    const std::string_view text = error.what();
    const bool is_setting = text.starts_with(concat(by_setting, ": "));
    return failed(static_cast<int>(error.exit_code), text.substr(is_setting ? by_setting.size() + 2 : 0));
} catch (const Refused& error) {
    return failed(error.code, error.what());
} catch (const std::bad_alloc&) {
    return failed(ALMESH_MEMORY, "out of memory; a coarser mesh takes less");
} catch (const std::exception& error) {
    return failed(ALMESH_INTERNAL, error.what());
} catch (...) {
    return failed(ALMESH_INTERNAL, "the callback has thrown an exception");
}

template <class Body>
int with(const almesh_mesh* mesh, const Body& body) {
    return guarded([&] {
        std::unique_lock lock(of_objects);
        const auto found = objects.find(mesh);
        if (found == objects.end())
            throw Refused(ALMESH_HANDLE, mesh ? "the mesh was freed, or is none" : "the mesh is null");
        const std::shared_ptr<Object> object = found->second;
        lock.unlock();
        if (object->is_busy.exchange(true)) throw Refused(ALMESH_BUSY, "another call for this mesh has not returned");
        const auto release = [](std::atomic<bool>* is_busy) { *is_busy = false; };
        const std::unique_ptr<std::atomic<bool>, decltype(release)> busy(&object->is_busy, release);
        body(*object);
    });
}

// What `find` returns, a pointer; null on error.
template <class Find>
auto pointer(const almesh_mesh* mesh, const Find& find) {
    decltype(find(std::declval<Object&>())) found = nullptr;
    with(mesh, [&](Object& object) { found = find(object); });
    return found;
}

template <class Pointer>
Pointer needed(Pointer pointer, const char* name) {
    return pointer ? pointer : throw UsageError(name, " is null");
}

template <class Value>
void put(Value* place, const Value& value) {
    if (place) *place = value;
}

template <class Rows>
const auto& row_of(const Rows& rows, int index) {
    if (index < 0 || index >= std::ssize(rows)) throw UsageError("index ", index, ", of ", rows.size());
    return rows[index];
}

inline void check_numbers(const double* x, std::size_t count, std::size_t expected) {
    needed(x, "the array");
    if (count != expected) throw UsageError(count, " numbers given, but the mesh has ", expected, ": nodes x dim");
    const auto bad = std::find_if_not(x, x + count, [](double v) { return std::isfinite(v); }) - x;
    if (bad < static_cast<std::ptrdiff_t>(count)) throw UsageError("number ", bad, " is not finite");
}

inline void check_has_run(const Session& session) {
    if (!session.problem) throw Refused(ALMESH_ORDER, "no results: nothing has been moved or improved");
}

}  // namespace almesh::c
