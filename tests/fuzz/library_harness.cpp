// Calls of the interface for C in any order, with arguments that are wrong at times.
#include <cmath>
#include <limits>

#include "almesh.h"
#include "fuzz/harness.hpp"
#include "fuzz/independent_check.hpp"
#include "fuzz/small_mesh.hpp"

namespace almesh::fuzz {
namespace {

constexpr const char* motions[] = {"fixed", "slide",   "translate 0.1 0", "rotate \"20*t\"",
                                   "free",  "scale 2", "twist",           nullptr};
constexpr const char* names[] = {"rest", "all", "boundary", "inner", "left", "no such", "", nullptr};
constexpr const char* keys[] = {"degree", "objective", "continuation", "frames", "surface",
                                "let a",  "qualty",    "mesh",         nullptr};
constexpr const char* values[] = {"1", "2", "auto", "minimax", "keep", "0 : 1 : 2", "a b", "", nullptr};

double number_of(Choices& choose) {
    constexpr double odd[] = {0.5, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -1e300};
    return choose.byte() < 240 ? choose.fraction() : choose.of(odd);
}

void demand_sound(almesh_mesh* mesh) {
    almesh_sizes sizes;
    almesh_cells cells;
    demand(almesh_sizes_of(mesh, &sizes) == ALMESH_OK && almesh_elements(mesh, &cells) == ALMESH_OK, almesh_error());
    demand(cells.count == sizes.elements && cells.offset[0] == 0, "cells");
    for (int k = 0; k < cells.offset[cells.count]; ++k)
        demand(cells.node[k] >= 0 && cells.node[k] < sizes.nodes, "node");
    const double* const x = almesh_positions(mesh);
    for (int k = 0; k < sizes.dim * sizes.nodes; ++k) demand(std::isfinite(x[k]), "positions");
}

int call(almesh_mesh* mesh, Choices& choose, const std::string& saved) {
    almesh_sizes sizes;
    if (almesh_sizes_of(mesh, &sizes) != ALMESH_OK) return almesh_move(mesh);
    std::vector<double> x(static_cast<std::size_t>(sizes.dim) * sizes.nodes), out(x.size());
    const int kind = choose.below(14);
    for (std::size_t k = 0; k < x.size() && kind > 3; ++k) x[k] = almesh_positions(mesh)[k] + 0.05 * number_of(choose);
    const std::size_t count = x.size() - (choose.byte() == 255);
    switch (kind) {
        case 0: {
            const char* const name = choose.of(names);
            return almesh_set_boundary(mesh, name, choose.of(motions));
        }
        case 1: {
            const char* const key = choose.of(keys);
            return almesh_set(mesh, key, choose.of(values));
        }
        case 2: return almesh_move(mesh);
        case 3: return almesh_improve(mesh);
        case 4: return almesh_frame(mesh, number_of(choose));
        case 5: return almesh_set_boundary_positions(mesh, choose.of(names), x.data(), count);
        case 6: return almesh_certify(mesh, x.data(), count);
        case 7: return almesh_adjoint(mesh, x.data(), count, out.data());
        case 8: return almesh_tangent(mesh, x.data(), count, out.data());
        case 9: almesh_element_values(mesh, choose.yes() ? "distortion" : "quality"); return almesh_error_code();
        case 10: almesh_multipliers(mesh); return almesh_error_code();
        case 11: return almesh_set_deck(mesh, choose.yes() ? "boundary all = slide\nframes = 0, 1" : "degree = 2\n");
        case 12: almesh_word(mesh, choose.yes() ? "status" : "statsu"); return almesh_error_code();
        default: return almesh_save(mesh, saved.c_str());
    }
}

}  // namespace

void fuzz_library(std::string_view bytes) {
    Choices choose(bytes);
    const std::string path = work_folder().write("library.msh", damaged(text_of_mesh(small_mesh(choose)), choose));
    const std::string saved = work_folder().path("saved.msh");
    almesh_mesh* mesh = nullptr;
    if (almesh_read(path.c_str(), &mesh) != ALMESH_OK)
        return demand(!mesh && almesh_error()[0], "a refusal without a sentence");
    struct Freed {
        almesh_mesh* mesh;
        ~Freed() { almesh_free(mesh); }
    } const freed{mesh};
    for (const auto& [key, value] : {std::pair("threads", "1"), {"max_seconds", "0.1"}}) almesh_set(mesh, key, value);
    for (int left = choose.below(12); left >= 0; --left) {
        const int code = call(mesh, choose, saved);
        demand(code == 0 || almesh_error()[0], "code ", code, " without a sentence");
        demand(code != ALMESH_INTERNAL && code != ALMESH_HANDLE && code != ALMESH_BUSY && code != ALMESH_MEMORY,
               "code ", code, ": ", almesh_error());
        demand_sound(mesh);
        const char* const valid = almesh_word(mesh, "certified_injective");
        if (!valid || valid != std::string("yes") || almesh_save(mesh, saved.c_str()) != ALMESH_OK) continue;
        const std::string fault = fault_of(Elements(read_mesh(saved)), true);  // the file may have turned elements
        demand(fault.empty(), "certified, but ", fault);
    }
}

}  // namespace almesh::fuzz
