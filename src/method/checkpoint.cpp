#include "method/checkpoint.hpp"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <type_traits>

#include "base/bytes.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "method/functional.hpp"

namespace almesh {
namespace {

namespace fs = std::filesystem;

constexpr const char* suffix = ".state";
constexpr std::size_t hash_length = 16;  // of hash_of()

struct Writer {
    std::string text;

    template <class Number>
    void number(const Number& value) {
        append_bytes(text, value, std::endian::little);
    }
    void words(const std::string& value) { number(std::uint64_t(value.size())), text += value; }
    template <class List>
    void size(List& list) {
        number(std::uint64_t(list.size()));
    }
};

struct Damaged {};

struct Reader {
    std::string_view text;

    const char* take(std::uint64_t bytes) {
        if (bytes > text.size()) throw Damaged();
        const char* const at = text.data();
        text.remove_prefix(bytes);
        return at;
    }
    template <class Number>
    void number(Number& value) {
        value = from_bytes<Number>(take(sizeof value), std::endian::little);
    }
    std::uint64_t count() {
        std::uint64_t value = 0;
        number(value);
        if (value > text.size()) throw Damaged();
        return value;
    }
    void words(std::string& value) {
        const std::uint64_t length = count();
        value.assign(take(length), length);
    }
    template <class List>
    void size(List& list) {
        list.resize(count());
    }
};

// The same fields in the same order, written or read.
template <class Archive, class Field>
void visit(Archive& archive, Field& field);

template <class Archive, class... Fields>
void visit_all(Archive& archive, Fields&... fields) {
    (visit(archive, fields), ...);
}

template <class Archive>
void visit(Archive& archive, NewtonResult& r) {
    visit_all(archive, r.status, r.iterations, r.linear_iterations, r.local_steps, r.energy, r.gradient_norm, r.omega);
}

template <class Archive>
void visit(Archive& archive, NewtonStep& s) {
    bool fell_back = s.fallback.has_value();
    SolveStatus fallback = s.fallback.value_or(SolveStatus::success);
    visit_all(archive, s.iteration, s.energy, s.gradient_norm, s.step_length, s.cuts_inverted, s.cuts_decrease,
              s.hessian, s.local.nodes, s.local.steps, s.linear_iterations, s.solver, s.preconditioner, s.ilu_shift,
              fell_back, fallback);
    s.fallback = fell_back ? std::optional(fallback) : std::nullopt;
}

template <class Archive>
void visit(Archive& archive, Inversion& inversion) {
    visit_all(archive, inversion.element, inversion.ratio);
    for (double& coordinate : inversion.at) visit_all(archive, coordinate);
}

template <class Archive, class Item>
void visit(Archive& archive, std::vector<Item>& list) {
    archive.size(list);
    for (Item& item : list) visit(archive, item);
}

template <class Archive>
void visit(Archive& archive, NewtonMemory& m) {
    visit_all(archive, m.steps, m.damping.factor, m.filtering.kept, m.elimination.was_hard, m.elimination.is_hard,
              m.elimination.work_of_newton, m.elimination.work, m.solver.failures, m.solver.failed_iterations,
              m.solver.iterative, m.solver.direct);
}

template <class Archive>
void visit(Archive& archive, Minimised& m) {
    archive.words(m.start);
    visit_all(archive, m.result, m.memory, m.quadrature.refinements, m.quadrature.inversions, m.x, m.steps);
}

template <class Archive, class Field>
void visit(Archive& archive, Field& field) {
    static_assert(std::is_arithmetic_v<Field> || std::is_enum_v<Field>);
    archive.number(field);
}

std::string hash_of_numbers(const std::vector<double>& numbers) {
    return hash_of({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

std::string header(const std::string& run) { return "almesh checkpoint 4\n" + run + "\n"; }

}  // namespace

Checkpoint::Checkpoint(std::string folder, std::string run, double seconds, bool resume, Tell tell)
    : folder_(std::move(folder)), run_(std::move(run)), seconds_(seconds), tell_(std::move(tell)) {
    std::error_code error;
    while (resume && fs::exists(path(last_ + 1), error)) ++last_;
    if (last_ == 0) return;
    const std::string first = read_file(path(1)), expected = header(run_);
    if (!first.starts_with(expected))
        throw UsageError("cannot resume: ", folder_, " has the state of another run or program; without resume=1 this ",
                         "run starts from the beginning and removes it");
}

std::optional<Minimised> Checkpoint::next(const std::string& start) {
    if (++number_ > last_) return std::nullopt;
    std::optional<Minimised> saved = read(number_);
    if (saved && saved->start == start) return saved;
    tell_(concat(path(number_), saved ? " was saved with other numbers, as on another machine" : " is damaged",
                 ": the run computes anew from here"));
    last_ = 0;
    return std::nullopt;
}

void Checkpoint::save(Minimised minimised) {
    unwritten_.emplace_back(number_, std::move(minimised));
    if (std::chrono::duration<double>(Clock::now() - written_).count() >= seconds_) write();
}

void Checkpoint::write() {
    if (unwritten_.empty()) return;
    written_ = Clock::now();
    try {
        make_folder(folder_);
        for (; !unwritten_.empty(); unwritten_.erase(unwritten_.begin()))
            write_file(path(unwritten_.front().first), contents(unwritten_.front().second));
    } catch (const InputError& failed) {
        if (!has_failed_) tell_(concat("the state of the run cannot be saved: ", failed.what()));
        has_failed_ = true;
    }
}

std::string Checkpoint::contents(Minimised& minimised) const {
    Writer file{header(run_)};
    visit(file, minimised);
    return file.text + hash_of(file.text);
}

std::optional<Minimised> Checkpoint::read(int number) const try {
    const std::string file = read_file(path(number)), before = header(run_);
    if (!file.starts_with(before) || file.size() < before.size() + hash_length) return std::nullopt;
    Reader rest{std::string_view(file).substr(0, file.size() - hash_length)};
    if (hash_of(rest.text) != file.substr(rest.text.size())) return std::nullopt;
    rest.take(before.size());
    Minimised minimised;
    visit(rest, minimised);
    return minimised;
} catch (const Damaged&) {
    return std::nullopt;
} catch (const InputError&) {
    return std::nullopt;
}

std::string Checkpoint::path(int number) const {
    char digits[16];
    std::snprintf(digits, sizeof digits, "%04d", number);
    return concat(folder_, "/", digits, suffix);
}

void Checkpoint::remove(const std::string& folder) {
    std::error_code error;
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().filename().string().find(suffix) != std::string::npos) files.push_back(entry.path().string());
    for (const std::string& file : files) remove_file(file);
    fs::remove(folder, error);
}

NewtonResult minimise_or_recall(Checkpoint* checkpoint, Newton& newton, const AugmentedFunctional& E,
                                const NewtonParams& params, std::vector<double>& x, const NewtonObserver& observe) {
    if (checkpoint && interrupted()) checkpoint->write();  // what follows is no part of the run
    if (!checkpoint || interrupted()) return newton.minimise(E, params, x, observe);
    Minimised minimised;
    minimised.start = concat(hash_of_numbers(x), " ", hash_of_numbers(E.lambda), " ", E.energy(x));
    if (const std::optional<Minimised> saved = checkpoint->next(minimised.start)) {
        x = saved->x;
        newton.recall(saved->memory);
        E.distortion.set_quadrature(saved->quadrature);
        for (const NewtonStep& step : saved->steps)
            if (observe) observe(step);
        return saved->result;
    }
    minimised.result = newton.minimise(E, params, x, [&](const NewtonStep& step) {
        minimised.steps.push_back(step);
        if (observe) observe(step);
    });
    const NewtonResult result = minimised.result;
    minimised.memory = newton.memory();
    minimised.quadrature = E.distortion.quadrature();
    minimised.x = x;
    if (result.status != Status::interrupted) checkpoint->save(std::move(minimised));
    if (interrupted()) checkpoint->write();
    return result;
}

}  // namespace almesh
