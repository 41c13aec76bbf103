// almesh.h: the mesh as it is, and the results of the last run.
#include "check/injectivity.hpp"
#include "check/quality.hpp"
#include "check/scaled_jacobian.hpp"
#include "io/mesh_format.hpp"
#include "io/proof_file.hpp"
#include "library/c_object.hpp"
#include "report/results.hpp"

using namespace almesh;
using namespace almesh::c;

namespace {

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

almesh_cells cells_of(const CellList& cells) {
    return {static_cast<int>(cells.type.size()), cells.type.data(), cells.offset.data(), cells.node.data()};
}

void save(const Session& session, const std::string& to) {
    const Mesh& now = session.mesh();
    const bool is_own = now.file.can_be_patched() && to.ends_with(now.file.format.ending);
    if (!is_own && !to.ends_with(".msh") && !to.ends_with(".su2"))
        throw UsageError(to, ": a mesh is written as .msh, .su2, or as the file that it comes from");
    FileFormat anew;
    if (to.ends_with(".su2")) anew.ending = ".su2";
    write_mesh_as(is_own ? now.file.format : anew, to, now, session.source.text, session.positions());
}

}  // namespace

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
    return with(mesh, [&](Object& object) { save(object.session, needed(path, "the path")); });
}

int almesh_save_proof(almesh_mesh* mesh, const char* path, const char* proof) {
    return with(mesh, [&](Object& object) {
        const std::string to = needed(path, "the path"), of = needed(proof, "the path of the proof");
        save(object.session, to);
        std::vector<std::string> notes;
        const Mesh written = read_as_it_is(to, notes);
        const Certificate certificate = certify(written, written.x);
        if (!certificate.valid || !certify_injective(written, written.x, certificate).certified)
            throw ErrorOf<ExitCode::not_certified>(to, ": not certified valid and injective, so there is no proof");
        const ProofFile file = write_proof(written, to, of);
        if (!file.is_written) throw ErrorOf<ExitCode::not_certified>(to, ": ", file.told);
    });
}
