// almesh.h: each function finds its mesh, refuses wrong use, and turns what is thrown into a code and a sentence.
#include "almesh.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>

#include "base/version.hpp"
#include "check/quality.hpp"
#include "check/scaled_jacobian.hpp"
#include "io/mesh_format.hpp"
#include "library/mesh_arrays.hpp"
#include "library/session.hpp"
#include "report/results.hpp"

using namespace almesh;

namespace {

using Numbers = std::vector<double>;
using Time = std::chrono::steady_clock;

constexpr std::string_view by_setting = "command line";  // where the parser has settings

struct Refused : std::runtime_error {
    int code;  // that the program does not have
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
std::mutex of_objects;
std::map<const almesh_mesh*, std::shared_ptr<Object>> objects;
std::uintptr_t handles = 0;

thread_local std::string last_sentence;
thread_local int last_code = ALMESH_OK;

int failed(int code, std::string_view why) {
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

int named(const std::vector<Named>& rows, int index, const char** name, const char** meaning) {
    return guarded([&] {
        put(name, row_of(rows, index).name);
        put(meaning, rows[index].meaning);
    });
}

void check_numbers(const double* x, std::size_t count, std::size_t expected) {
    needed(x, "the array");
    if (count != expected) throw UsageError(count, " numbers given, but the mesh has ", expected, ": nodes x dim");
    const auto bad = std::find_if_not(x, x + count, [](double v) { return std::isfinite(v); }) - x;
    if (bad < static_cast<std::ptrdiff_t>(count)) throw UsageError("number ", bad, " is not finite");
}

int make(almesh_mesh** mesh, const std::function<Session()>& read) {
    if (mesh) *mesh = nullptr;
    return guarded([&] {
        needed(mesh, "the address of the mesh");
        auto object = std::make_shared<Object>(read);
        const std::lock_guard lock(of_objects);
        *mesh = reinterpret_cast<almesh_mesh*>(++handles);
        objects[*mesh] = std::move(object);
    });
}

template <class Run>
int run(almesh_mesh* mesh, const Run& one) {
    int code = ALMESH_OK;
    const int refused = with(mesh, [&](Object& object) {
        object.is_cancelled = false;
        object.told = Time::now();
        code = static_cast<int>(one(object.session));
        object.numbers.clear();
        if (object.is_cancelled && object.session.solution.al.status == Status::interrupted) code = ALMESH_CANCELLED;
        if (code) last_sentence = object.session.ending;
    });
    return refused ? refused : last_code = code;
}

// Changes the settings, or nothing where they cannot be read then.
template <class Change>
int change(almesh_mesh* mesh, const Change& body) {
    return with(mesh, [&](Object& object) {
        const SessionSettings before = object.session.settings;
        try {
            body(object.session.settings);
            object.session.deck();
        } catch (...) {
            object.session.settings = before;
            throw;
        }
    });
}

// A line that is there keeps its place, which decides at nodes of several boundaries.
void set(SessionSettings& settings, const std::string& key, const char* value) {
    const auto is_old = [&](const auto& line) { return line.first == key; };
    const auto old = std::find_if(settings.lines.begin(), settings.lines.end(), is_old);
    if (!value) std::erase_if(settings.lines, is_old);
    else if (old != settings.lines.end()) old->second = value;
    else settings.lines.emplace_back(key, value);
}

// kind: "boundary " or "volume ".
int set_motion(almesh_mesh* mesh, const char* kind, const char* name, const char* motion) {
    return change(mesh, [&](SessionSettings& settings) {
        set(settings, kind + with_quotes(needed(name, "the name")), motion);
        if (kind == std::string_view("boundary ")) settings.motions.erase(name);
    });
}

void check_has_run(const Session& session) {
    if (!session.problem) throw Refused(ALMESH_ORDER, "no results: nothing has been moved or improved");
}

const std::string& value_of(const Object& object, const char* name) {
    const std::vector<Named> known = summary_quantities();
    if (!find_row(known, needed(name, "the name")))
        throw UsageError("there is no quantity ", in_backquotes(name), did_you_mean(name, names_of(known)));
    check_has_run(object.session);
    return find_row(object.session.summary, name)->text;
}

// In the mesh's order.
Numbers element_values(const Session& session, const std::string& name) {
    const Mesh& mesh = session.mesh();
    const Numbers x = session.positions();
    if (name == "scaled_jacobian") return corner_jacobians(mesh, x);
    if (name == "quality") return mesh_quality(mesh, x).quality;
    if (name == "certified_bound") return session.certify(x).first.certified_bound;
    if (name != "distortion")
        throw UsageError("elements have no ", in_backquotes(name),
                         did_you_mean(name, {"scaled_jacobian", "quality", "certified_bound", "distortion"}));
    check_has_run(session);
    return session.solution.al.distortion.element_max;
}

Numbers multipliers(const Session& session) {
    check_has_run(session);
    const MeshView& view = session.view;
    const Constraint& constraint = *session.problem->level->constraint;
    Numbers field = constraint.multiplier_field(session.solution.al.lambda), result(view.x.size(), 0.0);
    for (double& value : field) value *= Units{view.dim, session.problem->frame.length}.multiplier(1);
    std::vector<int> place;
    for (const int node : constraint.nodes()) place.push_back(view.node[node]);
    MeshView::put(field, view.dim, place, result);
    return result;
}

int differentiate(almesh_mesh* mesh, bool adjoint, const double* in, std::size_t numbers, double* out) {
    return with(mesh, [&](Object& object) {
        check_has_run(object.session);
        if (!object.session.is_at_solution) throw Refused(ALMESH_ORDER, "no derivative: the last frame was refused");
        check_numbers(in, numbers, object.session.view.x.size());
        needed(out, "the array of the result");
        const Numbers result = object.session.differentiate(adjoint, in);
        object.numbers.clear();
        std::copy(result.begin(), result.end(), out);
    });
}

almesh_cells cells_of(const CellList& cells) {
    return {static_cast<int>(cells.type.size()), cells.type.data(), cells.offset.data(), cells.node.data()};
}

MeshArrays arrays_of(int dim, int degree, int nodes, const double* x, int blocks, const almesh_block* block) {
    MeshArrays arrays{dim, degree, {}, {}, {}};
    if (nodes < 1 || blocks < 1) throw UsageError(nodes, " nodes and ", blocks, " blocks: a mesh has some");
    check_form(arrays);
    arrays.x.assign(needed(x, "x"), x + static_cast<std::size_t>(nodes) * dim);
    for (const almesh_block& of : std::span(needed(block, "block"), blocks)) {
        if (of.count < 0 || of.type < ALMESH_LINE || of.type > ALMESH_PYRAMID)
            throw UsageError("a block of ", of.count, " cells of type ", of.type);
        const CellType& type = type_of(static_cast<Cell>(of.type));
        const std::size_t numbers = static_cast<std::size_t>(of.count) * type.node_count(degree);
        Cells cells{static_cast<Cell>(of.type), {}, of.group ? of.group : ""};
        if (numbers) cells.nodes.assign(needed(of.nodes, "nodes of a block"), of.nodes + numbers);
        if (type.dim == dim) arrays.elements.push_back(cells);
        else arrays.faces.push_back({needed(of.group, "group of faces"), cells});
    }
    return arrays;
}

}  // namespace

const char* almesh_version() {
    static const std::string text = version().substr(version().find(' ') + 1);
    return text.c_str();
}
const char* almesh_error() { return last_sentence.c_str(); }
int almesh_error_code() { return last_code; }

int almesh_key(int index, const char** name, const char** legal, const char** value, const char** meaning) {
    return guarded([&] {
        static const std::map<std::string, std::string> defaults = [] {
            std::map<std::string, std::string> texts;
            for (const DeckKey& key : deck_keys()) texts[key.name] = key.value.text(Deck());
            return texts;
        }();
        const DeckKey& key = row_of(deck_keys(), index);
        put(name, key.name.c_str());
        put(legal, key.value.legal.c_str());
        put(value, defaults.at(key.name).c_str());
        put(meaning, key.meaning.c_str());
    });
}
int almesh_motion(int index, const char** form, const char** meaning) {
    return named(motion_forms(), index, form, meaning);
}
int almesh_quantity(int index, const char** name, const char** meaning) {
    return named(summary_quantities(), index, name, meaning);
}

int almesh_read(const char* path, almesh_mesh** mesh) {
    return make(mesh, [&] {
        Deck deck;
        deck.mesh = needed(path, "the path");
        deck.given["mesh"] = by_setting;
        return Session(read_source(deck), deck.mesh);
    });
}
int almesh_read_deck(const char* path, almesh_mesh** mesh) {
    return make(mesh, [&] { return Session::of_deck(needed(path, "the path")); });
}
int almesh_from_arrays(int dim, int degree, int nodes, const double* x, int blocks, const almesh_block* block,
                       almesh_mesh** mesh) {
    return make(mesh, [&] {
        return Session(source_of(arrays_of(dim, degree, nodes, x, blocks, block)), arrays_name);
    });
}

int almesh_free(almesh_mesh* mesh) {
    std::shared_ptr<Object> last;  // freed where the lock is not held
    return !mesh ? ALMESH_OK : with(mesh, [&](Object&) {
        const std::lock_guard lock(of_objects);
        last = std::move(objects.extract(mesh).mapped());
    });
}

int almesh_set_deck(almesh_mesh* mesh, const char* text) {
    return change(mesh, [&](SessionSettings& settings) { settings = {needed(text, "the text"), "deck", {}, {}}; });
}

int almesh_set(almesh_mesh* mesh, const char* key, const char* value) {
    return change(mesh, [&](SessionSettings& settings) {
        const std::string_view name = needed(key, "the key");
        if (name.empty() || trim(name) != name || name.find_first_of("=#") != name.npos || name == "mesh")
            throw UsageError(in_backquotes(name), " is no key that can be set");
        set(settings, key, value);
    });
}

const char* almesh_get(almesh_mesh* mesh, const char* key) {
    return pointer(mesh, [&](Object& object) {
        const DeckKey* const row = find_row(deck_keys(), needed(key, "the key"));
        if (!row) throw UsageError("unknown key ", in_backquotes(key), did_you_mean(key, names_of(deck_keys())));
        object.text = row->value.text(object.session.deck());
        return object.text.c_str();
    });
}

int almesh_set_boundary(almesh_mesh* mesh, const char* name, const char* motion) {
    return set_motion(mesh, "boundary ", name, motion);
}
int almesh_set_volume(almesh_mesh* mesh, const char* name, const char* motion) {
    return set_motion(mesh, "volume ", name, motion);
}

int almesh_set_boundary_positions(almesh_mesh* mesh, const char* name, const double* x, size_t numbers) {
    return with(mesh, [&](Object& object) {
        const Session& session = object.session;
        check_numbers(x, numbers, session.source.raw.nodes.size() * session.base.dim);
        const std::string boundary = needed(name, "the name");
        set(object.session.settings, "boundary " + with_quotes(boundary), nullptr);
        const MeshView first(session.base, session.source.raw, session.base, session.base.x);
        const Motion motion = given_by(first.to_mesh(x));
        object.session.settings.motions[boundary] = [motion](double) { return motion; };
    });
}

int almesh_on_progress(almesh_mesh* mesh, almesh_callback callback, void* user) {
    return with(mesh, [&](Object& object) {
        object.callback = callback;
        object.user = user;
        object.session.observe = nullptr;
        object.session.stops = nullptr;
        if (!callback) return;
        object.session.observe = [&object](const Progress& progress) { object.tell(progress); };
        object.session.stops = [&object] { return object.stops(); };
    });
}

int almesh_move(almesh_mesh* mesh) {
    return run(mesh, [](Session& session) { return session.move(session.deck()); });
}
int almesh_frame(almesh_mesh* mesh, double t) {
    return run(mesh, [t](Session& session) {
        return std::isfinite(t) ? session.frame(t) : throw UsageError("the time is not finite");
    });
}
int almesh_improve(almesh_mesh* mesh) {
    return run(mesh, [](Session& session) { return session.move(session.deck(1, improvement_lines)); });
}

int almesh_certify(almesh_mesh* mesh, const double* x, size_t numbers) {
    std::string reason;
    const int refused = with(mesh, [&](Object& object) {
        const Session& session = object.session;
        if (x || numbers) check_numbers(x, numbers, session.view.x.size());
        const auto found = session.certify(session.view.to_mesh(x ? x : session.view.x.data()));
        reason = session.reason(found.first, found.second);
    });
    return refused || reason.empty() ? refused : failed(ALMESH_NOT_CERTIFIED, reason);
}

int almesh_adjoint(almesh_mesh* mesh, const double* dJ_dx, size_t numbers, double* dJ_dg) {
    return differentiate(mesh, true, dJ_dx, numbers, dJ_dg);
}
int almesh_tangent(almesh_mesh* mesh, const double* dg, size_t numbers, double* dx) {
    return differentiate(mesh, false, dg, numbers, dx);
}

int almesh_sizes_of(almesh_mesh* mesh, almesh_sizes* sizes) {
    return with(mesh, [&](Object& object) {
        const MeshView& view = object.session.view;
        const auto count = [](const auto& rows) { return static_cast<int>(rows.size()); };
        *needed(sizes, "sizes") = {view.dim, view.degree, count(view.node_id), count(view.element_id),
                                   count(view.boundaries), count(view.volumes)};
    });
}

const double* almesh_positions(almesh_mesh* mesh) {
    return pointer(mesh, [](const Object& object) { return object.session.view.x.data(); });
}
const double* almesh_first_positions(almesh_mesh* mesh) {
    return pointer(mesh, [](const Object& object) { return object.session.view.first.data(); });
}
const long long* almesh_node_ids(almesh_mesh* mesh) {
    return pointer(mesh, [](const Object& object) { return object.session.view.node_id.data(); });
}
const long long* almesh_element_ids(almesh_mesh* mesh) {
    return pointer(mesh, [](const Object& object) { return object.session.view.element_id.data(); });
}
const char* almesh_notes(almesh_mesh* mesh) {
    return pointer(mesh, [](const Object& object) { return object.session.notes.c_str(); });
}

int almesh_elements(almesh_mesh* mesh, almesh_cells* cells) {
    return with(mesh, [&](Object& object) { *needed(cells, "cells") = cells_of(object.session.view.elements); });
}

int almesh_boundary(almesh_mesh* mesh, int index, const char** name, almesh_cells* faces) {
    return with(mesh, [&](Object& object) {
        put(faces, cells_of(row_of(object.session.view.boundaries, index)));
        put(name, object.session.view.boundary_names[index].c_str());
    });
}

int almesh_volume(almesh_mesh* mesh, int index, const char** name, const int** elements, int* count) {
    return with(mesh, [&](Object& object) {
        const GroupCells& volume = row_of(object.session.view.volumes, index);
        put(name, volume.name.c_str());
        put<const int*>(elements, volume.cells.data());
        put(count, static_cast<int>(volume.cells.size()));
    });
}

const double* almesh_element_values(almesh_mesh* mesh, const char* name) {
    return pointer(mesh, [&](Object& object) {
        Numbers& result = object.numbers[needed(name, "the name")];
        if (result.empty()) {
            const Numbers values = element_values(object.session, name);
            result.resize(values.size());
            MeshView::put(values, 1, object.session.view.element, result);
        }
        return result.data();
    });
}

const double* almesh_multipliers(almesh_mesh* mesh) {
    return pointer(mesh, [](Object& object) {
        Numbers& result = object.numbers["multipliers"];
        if (result.empty()) result = multipliers(object.session);
        return result.data();
    });
}

int almesh_number(almesh_mesh* mesh, const char* name, double* value) {
    return with(mesh, [&](Object& object) {
        const std::string& text = value_of(object, name);
        const auto number = parse_double(text);
        *needed(value, "value") = number ? *number : throw UsageError(name, " is no number: ", text);
    });
}
const char* almesh_word(almesh_mesh* mesh, const char* name) {
    return pointer(mesh, [&](const Object& object) { return value_of(object, name).c_str(); });
}

int almesh_save(almesh_mesh* mesh, const char* path) {
    return with(mesh, [&](Object& object) {
        const Session& session = object.session;
        const Mesh& now = session.mesh();
        const std::string to = needed(path, "the path");
        const bool is_own = now.file.can_be_patched() && to.ends_with(now.file.format.ending);
        if (!is_own && !to.ends_with(".msh") && !to.ends_with(".su2"))
            throw UsageError(to, ": a mesh is written as .msh, .su2, or as the file that it comes from");
        FileFormat anew;
        if (to.ends_with(".su2")) anew.ending = ".su2";
        write_mesh_as(is_own ? now.file.format : anew, to, now, session.source.text, session.positions());
    });
}
