#include <utility>

#include "io/msh_scanner.hpp"
#include "mesh/periodic.hpp"

namespace almesh {
namespace {

void next_record(MshScanner& from) {
    if (from.binary) return;
    from.rest_of_line();
    from.next_line();
}

}  // namespace

void read_periodic(MshScanner& from, const IdIndex& node_index, RawMesh& mesh) try {
    const bool in_blocks = from.version > 40;
    if (from.version == 40) return;
    from.binary = from.binary && in_blocks;
    from.begin_numbers();
    const int dim = dim_of(mesh);
    const long long count = from.size("the number of periodic entities", 0, LLONG_MAX);
    for (long long k = 0; k < count; ++k) {
        next_record(from);
        PeriodicSides sides{};
        sides.dim = from.integer("the dimension", 0, 2);
        sides.slave = from.integer("the tag of an entity", 1);
        sides.master = from.integer("the tag of its master", 1);
        next_record(from);
        if (in_blocks) from.skip_reals(static_cast<int>(from.size("the numbers of a transformation", 0, 16)));
        if (in_blocks || (from.at != from.end && *from.at == 'A')) next_record(from);  // Affine
        std::vector<std::pair<Vec<3>, Vec<3>>> points;
        const long long nodes = from.size("the number of pairs of nodes", 0, INT_MAX);
        for (long long i = 0; i < nodes; ++i) {
            next_record(from);
            const int slave = node_index.find(from.id("a node id")), master = node_index.find(from.id("a node id"));
            if (slave >= 0 && master >= 0)
                points.emplace_back(std::to_array(mesh.nodes[master].x), std::to_array(mesh.nodes[slave].x));
        }
        if (sides.dim != dim - 1) continue;
        if (fit(points, sides)) mesh.periodic.push_back(sides);
        else mesh.notes.push_back(concat("periodic sides do not move as one: the nodes of entity ", sides.slave,
                                         " are not those of its master ", sides.master, " rotated and moved"));
    }
} catch (const InputError& error) {
    mesh.notes.push_back(concat("periodic sides are not known: ", error.what()));
}

}  // namespace almesh
