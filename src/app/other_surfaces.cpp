#include "app/other_surfaces.hpp"

#include <algorithm>
#include <map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "io/mesh_format.hpp"

namespace almesh {
namespace {

std::shared_ptr<const Mesh> read(const std::string& path, int dim, std::vector<std::string>& notes) {
    std::vector<std::string> of_file;
    const auto mesh =
        std::make_shared<const Mesh>(build_base_mesh(read_mesh(path), IdealKind::automatic, {}, of_file).mesh);
    if (mesh->dim != dim)
        throw InputError(path, ": a mesh in ", mesh->dim, " dimensions, the one that moves has ", dim);
    for (const std::string& note : of_file) notes.push_back(path + ": " + note);
    return mesh;
}

std::vector<char> boundaries_of(const Mesh& other, const MotionStep& step, const std::string& own_name) {
    const bool only_one = step.boundary.empty() && other.boundaries.size() == 1;
    const std::string& name = step.boundary.empty() ? own_name : step.boundary;
    const std::vector<char> found = only_one ? std::vector<char>{1} : other.boundaries_in(name);
    if (std::count(found.begin(), found.end(), 1) > 0) return found;
    std::string list;
    for (const std::string& each : other.boundaries) list += (list.empty() ? "" : ", ") + with_quotes(each);
    throw InputError(step.file, ": no boundary ", with_quotes(name), " there, only ", list,
                     "; say which one: slide along FILE boundary NAME");
}

}  // namespace

std::vector<OtherSurface> read_other_surfaces(const Deck& deck, const Mesh& mesh, std::vector<std::string>& notes) {
    std::vector<OtherSurface> surfaces;
    std::map<std::string, std::shared_ptr<const Mesh>> of_path;
    for (int b = 0; b < static_cast<int>(mesh.boundaries.size()); ++b) {
        const std::string& name = mesh.boundaries[b];
        const DeckBoundary* const line = motion_for(deck, name);
        const MotionStep* const step = line ? surface_step(line->motion) : nullptr;
        if (!step) continue;
        try {
            std::shared_ptr<const Mesh>& other = of_path[step->file];
            if (!other) other = read(step->file, mesh.dim, notes);
            surfaces.resize(mesh.boundaries.size());
            surfaces[b] = {other, boundaries_of(*other, *step, name)};
        } catch (const InputError& error) {
            throw InputError(line->where, ": boundary ", with_quotes(name), ": ", error.what());
        }
    }
    return surfaces;
}

}  // namespace almesh
