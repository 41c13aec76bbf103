// Answers run in a process of their own, which only sends values back. The process that judges them never loads them:
// whatever an answer prints, writes or ends, its verdict comes from the judge.
//
//     const std::string bytes = from_child([&](std::string& to) { put(to, eta_3d(F)); });
//
// Values are what C++ can copy byte by byte, and vectors, arrays, pairs and plain structs of them.
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "base/text.hpp"
#include "lessons/each.hpp"
#include "lessons/registry.hpp"

namespace almesh::lessons {

// How a child ended without an answer: "ended -11", a signal with its sign or an exit code; "late 0.3", with the
// seconds of processor time that it used; "absent 2", the number of a function that does not compile; "missing eta_3d".
// answers.py has the sentences.
struct Ended : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// In a child: what it has to say against the answer goes to the judge at once, so that no answer can catch it. In the
// judge: an exception, Unmet.
[[noreturn]] void refuse(const std::string& message);

// Whether this is a child. There calls of answers are plain calls.
bool is_child();

// The address of an answer, for a child; ends it where there is none.
void* address_of(const char* name);

// What `compute` has appended in a child. Ended, or Unmet where it has refused or thrown.
std::string from_child(const std::function<void(std::string&)>& compute);

// The shared object with the answers, and what they may use: seconds of processor time for an exercise, MB of memory
// above what the judge has.
struct Limits {
    int seconds = 30, memory = 2048;
};
void take_answers(const std::string& file, const Limits& limits);

// From now on children take no more than `seconds` of processor time each; one that does is refused with `late`.
// "": no such limit any more.
void expect_each_within(int seconds, const std::string& late);

// ------------------------------------------------------------------------------------------------- values as bytes

namespace detail {

struct Anything {
    template <class T>
    operator T() const;
};
template <class T, class... Fields>
constexpr int count_fields() {
    if constexpr (requires { T{Fields{}..., Anything{}}; }) return count_fields<T, Fields..., Anything>();
    else return sizeof...(Fields);
}

// body(each member of a plain struct)
template <class T, class Body>
void with_fields(T& value, const Body& body) {
    constexpr int count = count_fields<std::remove_const_t<T>>();
    static_assert(count >= 1 && count <= 7, "a struct with so many members is not sent");
    if constexpr (count == 1) { auto& [a] = value; body(a); }
    if constexpr (count == 2) { auto& [a, b] = value; body(a, b); }
    if constexpr (count == 3) { auto& [a, b, c] = value; body(a, b, c); }
    if constexpr (count == 4) { auto& [a, b, c, d] = value; body(a, b, c, d); }
    if constexpr (count == 5) { auto& [a, b, c, d, e] = value; body(a, b, c, d, e); }
    if constexpr (count == 6) { auto& [a, b, c, d, e, f] = value; body(a, b, c, d, e, f); }
    if constexpr (count == 7) { auto& [a, b, c, d, e, f, g] = value; body(a, b, c, d, e, f, g); }
}

template <class T>
constexpr bool is_sequence = requires(T value) { value.resize(1); };
template <class T>
constexpr bool is_tuple = requires { std::tuple_size<T>::value; };
template <class T>
constexpr bool is_shared_pointer = requires(T value) { value.use_count(); };  // what it points to stays as it is

}  // namespace detail

template <class T>
void put(std::string& bytes, const T& value) {
    const auto all = [&bytes](const auto&... parts) { (put(bytes, parts), ...); };
    if constexpr (detail::is_shared_pointer<T>) return;
    else if constexpr (std::is_trivially_copyable_v<T>) {
        static_assert(!std::is_pointer_v<T>, "an address means nothing to another process");
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else if constexpr (detail::is_sequence<T>) {
        put(bytes, value.size());
        for (const auto& entry : value) put(bytes, entry);
    } else if constexpr (detail::is_tuple<T>) std::apply(all, value);
    else detail::with_fields(value, all);
}

// Takes values from the front of `bytes`; Unmet where they end too soon.
template <class T>
void take(std::string_view& bytes, T& value) {
    const auto all = [&bytes](auto&... parts) { (take(bytes, parts), ...); };
    if constexpr (detail::is_shared_pointer<T>) return;
    else if constexpr (std::is_trivially_copyable_v<T>) {
        if (bytes.size() < sizeof value) refuse("the answer sends less than a whole result");
        std::memcpy(static_cast<void*>(&value), bytes.data(), sizeof value);
        bytes.remove_prefix(sizeof value);
    } else if constexpr (detail::is_sequence<T>) {
        std::size_t size = 0;
        take(bytes, size);
        if (size > bytes.size()) refuse("the answer sends less than a whole result");
        value.clear();
        for (std::size_t i = 0; i < size; ++i) {
            typename T::value_type entry{};
            take(bytes, entry);
            value.push_back(std::move(entry));
        }
    } else if constexpr (detail::is_tuple<T>) std::apply(all, value);
    else detail::with_fields(value, all);
}

// ------------------------------------------------------------------------------------------------- calls

// body(), in a child, which can call answers as often as it likes; the result, a value, is the judge's.
template <class Body>
auto in_child(const Body& body) {
    auto result = decltype(body()){};
    const std::string bytes = from_child([&](std::string& to) { put(to, body()); });
    std::string_view rest = bytes;
    take(rest, result);
    return result;
}

// An answer, to be called like the function: in a child, to which the arguments are known. What it returns comes back,
// and what it has made of arguments that are references to what is not const.
template <class Function>
class Answer;

template <class Result, class... Arguments>
class Answer<Result(Arguments...)> {
public:
    explicit constexpr Answer(const char* name) : name_(name) {}

    Result operator()(Arguments... arguments) const {
        const auto call = [&]() -> Result {
            return reinterpret_cast<Result (*)(Arguments...)>(address_of(name_))(arguments...);
        };
        if (is_child()) return call();
        const std::string bytes = from_child([&](std::string& to) {
            if constexpr (std::is_void_v<Result>) call();
            else put(to, call());
            (each<Arguments>(arguments, [&to](auto& argument) { put(to, argument); }), ...);
        });
        std::string_view rest = bytes;
        const auto change = [&rest](auto& argument) { take(rest, argument); };
        if constexpr (std::is_void_v<Result>) (each<Arguments>(arguments, change), ...);
        else {
            Result result{};
            take(rest, result);
            (each<Arguments>(arguments, change), ...);
            return result;
        }
    }

private:
    template <class Argument, class Body>
    static void each(auto& argument, const Body& body) {
        if constexpr (std::is_lvalue_reference_v<Argument> && !std::is_const_v<std::remove_reference_t<Argument>>)
            body(argument);
    }
    const char* name_;
};

// A number that callbacks can count in although they run in a child: memory that judge and children share.
template <class T>
class Shared {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    Shared(T value = T())
        : memory_(mmap(nullptr, sizeof(T), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
        if (memory_ == MAP_FAILED) throw std::bad_alloc();
        new (memory_) T(value);
    }
    ~Shared() { munmap(memory_, sizeof(T)); }
    Shared(const Shared&) = delete;

    T& operator=(const T& value) { return *static_cast<T*>(memory_) = value; }
    operator T&() { return *static_cast<T*>(memory_); }
    operator const T&() const { return *static_cast<const T*>(memory_); }
    friend std::string& operator+=(std::string& text, const Shared& shared) {  // for concat()
        return text += concat(static_cast<const T&>(shared));
    }

private:
    void* memory_;
};

// ANSWERS(eta_3d, level_set): from here on these names are answers, which run in children.
#define ALMESH_ANSWER_(name) [[maybe_unused]] constexpr Answer<decltype(lessons::name)> name{#name};
#define ANSWERS(...) ALMESH_FOR_EACH(ALMESH_ANSWER_, __VA_ARGS__) static_assert(true)

// MEMBER_ANSWERS(Density, f, f1): so are these, of type double (double) const. Outside of unnamed namespaces.
#define ALMESH_MEMBER_(type, name) \
    double type::name(double x) const { return Answer<double(const type&, double)>(#type "::" #name)(*this, x); }
#define MEMBER_ANSWERS(type, ...) ALMESH_FOR_EACH_OF(ALMESH_MEMBER_, type, __VA_ARGS__)

}  // namespace almesh::lessons
