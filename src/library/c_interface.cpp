// almesh.h: the library, meshes, settings and runs.
#include "base/version.hpp"
#include "library/c_object.hpp"
#include "library/mesh_arrays.hpp"

using namespace almesh;
using namespace almesh::c;

namespace {

int named(const std::vector<Named>& rows, int index, const char** name, const char** meaning) {
    return guarded([&] {
        put(name, row_of(rows, index).name);
        put(meaning, rows[index].meaning);
    });
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
