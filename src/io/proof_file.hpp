// The proof of a mesh file (check/proof.hpp), for tests/verify.py.
#pragma once
#include <string>

namespace almesh {

struct Mesh;

// Writes the proof that the mesh, as it is in the file `path`, certified valid and injective, is that. Where the file is
// not MSH 2.2 or 4.1 in text or SU2, or has other elements than the mesh, the mesh is first written as MSH 2.2 with the
// same coordinates, beside the proof. Returns what was written, or why there is no proof, in a sentence. Throws
// UsageError where that would overwrite the file `path`, InputError where it cannot be written.
struct ProofFile {
    bool is_written = false;
    std::string told;
};
ProofFile write_proof(const Mesh& mesh, const std::string& path, const std::string& proof);

}  // namespace almesh
