#include "io/proof_file.hpp"

#include <algorithm>
#include <filesystem>

#include "base/files.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "check/proof.hpp"
#include "io/mesh_format.hpp"

namespace almesh {

ProofFile write_proof(const Mesh& given, const std::string& path, const std::string& proof) {
    if (given.degree > 4) return {false, concat("no proof: there is none above degree 4, and this has ", given.degree)};
    const FileFormat& format = given.file.format;
    const bool is_msh = format.ending == ".msh" && (format.msh_version == 22 || format.msh_version == 41);
    const bool is_readable = format.ending == ".su2" || (is_msh && !format.binary);
    const bool is_given = is_readable && given.file.has_elements && given.kept[given.dim].count() == 0;
    const std::string of = is_given ? path : proof + ".msh";
    std::error_code none;  // of files that are not there
    for (const std::string& target : {proof, is_given ? proof : of})
        if (std::filesystem::equivalent(target, path, none))
            throw UsageError(target, " is the mesh, which the proof would overwrite: give the proof another name");
    Mesh written;
    if (!is_given) {
        std::vector<std::string> notes;
        written = given;
        written.kept = {};
        write_file(of, msh_text(written, given.x));
        written = read_as_it_is(of, notes);
    }
    const Mesh& mesh = is_given ? given : written;
    const Proof found = make_proof(mesh, mesh.x);
    if (!found.missing.empty())
        return {false, concat("no proof: ", found.missing, found.missing.starts_with("element") ? "" : " (ids of corners)",
                              " is too close to the limit to tell, or faces touch there")};
    std::string turned;
    for (const int e : mesh.file.turned) turned += concat("turned ", mesh.file.element_id[e], " 1\n");
    std::string lines = concat("almesh proof 1\nversion ", version(), "\nhash ", hash_of(read_file(of)), "\nelements ",
                               mesh.element_count(), "\n", turned, found.lines);
    lines += concat("end ", std::count(lines.begin(), lines.end(), '\n') + 1, "\n");
    write_file(proof, lines);
    return {true, concat("proof: ", proof, " of ", of, ", ", lines.size(), " bytes")};
}

}  // namespace almesh
