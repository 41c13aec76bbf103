#!/usr/bin/env python3
"""A blade between hub and tip in layers of hexahedra, as MSH 2.2, and a deck that bends it: numpy alone.

  plot/blade_row.py FOLDER [--cells N] [--first H]

The blade is a Joukowski profile of chord 1 with a round trailing edge, the mesh the circles and rays around a circle
under the same map, so that its cells are rectangular, in layers that grow from H (6e-6) at the blade to 1.5 chords;
from hub to tip 0.8 chords. N (1,000,000) hexahedra, about. The deck bends the blade by 0.1 chords at the tip; nodes of
hub and tip slide.
"""
import argparse
from pathlib import Path

import numpy as np

import cell_mesh

DECK = """# A blade bends by 0.1 chords at its tip; hub and tip slide, and the outer boundary stays.
mesh = blade.msh
output = {output}
boundary blade = expression "x" "y + 0.1*(z/0.8)^2" "z"
boundary hub = slide
boundary tip = slide
boundary outer = fixed

expect status = converged
expect certified_injective = yes
"""
TAGS = {1: "blade", 2: "outer", 3: "hub", 4: "tip"}


def growth(first, layers, thickness):
    """The ratio of layers that add up to the thickness, by bisection."""
    low, high = 1 + 1e-9, 4.0
    for _ in range(200):
        r = 0.5 * (low + high)
        low, high = (r, high) if first * (r ** layers - 1) / (r - 1) < thickness else (low, r)
    return r


def section(around, layers, first):
    """Points around x (layers + 1), of the plane."""
    radius, centre = 1.12, -0.1 + 0.06j  # of the circle, which encloses 1 and -1
    angle = 2 * np.pi * np.arange(around) / around
    shape = lambda zeta: 0.26 * (zeta + 1 / zeta)  # noqa: E731
    ring = centre + radius * np.exp(1j * angle)
    mean = np.median(np.abs(0.26 * (1 - 1 / ring ** 2)))  # length there per length on the circle
    r = growth(first / mean, layers, 1.5 / 0.26)
    distance = first / mean * (r ** np.arange(layers + 1) - 1) / (r - 1)
    z = shape(centre + (radius + distance[None]) * np.exp(1j * angle[:, None]))
    return z / (z[:, 0].real.max() - z[:, 0].real.min())


def blade(cells, first):
    layers = max(6, round(1.6 * cells ** (1 / 3) * 0.5))
    span = max(3, round(0.5 * cells ** (1 / 3)))
    around = max(12, round(cells / layers / span))
    z = section(around, layers, first)
    height = 0.8 * np.arange(span + 1) / span
    x = np.empty((around, layers + 1, span + 1, 3))
    x[..., 0], x[..., 1], x[..., 2] = z.real[..., None], z.imag[..., None], height
    number = np.arange(x.size // 3).reshape(x.shape[:3])
    near, next_ = number, np.roll(number, -1, axis=0)
    corner = [a[:, j:j + layers, k:k + span] for k in (0, 1) for a, j in ((near, 0), (near, 1), (next_, 1), (next_, 0))]
    hexes = np.stack(corner, -1).reshape(-1, 8)
    quads = []
    for tag, (j, k) in {1: (0, None), 2: (layers, None), 3: (None, 0), 4: (None, span)}.items():
        if k is None:
            face = np.stack([near[:, j, :-1], next_[:, j, :-1], next_[:, j, 1:], near[:, j, 1:]], -1)
        else:
            face = np.stack([near[:, :-1, k], near[:, 1:, k], next_[:, 1:, k], next_[:, :-1, k]], -1)
        quads.append((np.full(face.size // 4, tag), face.reshape(-1, 4)))
    return cell_mesh.CellMesh(x.reshape(-1, 3), {3: tuple(np.concatenate(part) for part in zip(*quads)),
                                                 5: (np.full(len(hexes), 5), hexes)})


def write(mesh, path):
    """With physical groups, which are the entities."""
    with open(path, "w", encoding="ascii") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n")
        out.writelines(f'2 {tag} "{name}"\n' for tag, name in TAGS.items())
        out.write(f'3 5 "fluid"\n$EndPhysicalNames\n$Nodes\n{len(mesh.x)}\n')
        np.savetxt(out, np.column_stack([np.arange(1, len(mesh.x) + 1), mesh.x]), "%d %.17g %.17g %.17g")
        out.write(f"$EndNodes\n$Elements\n{sum(len(nodes) for _, nodes in mesh.blocks.values())}\n")
        first = 1
        for kind, (tags, nodes) in mesh.blocks.items():
            rows = np.column_stack([np.arange(first, first + len(nodes)), np.full(len(nodes), kind),
                                    np.full(len(nodes), 2), tags, tags, nodes + 1])
            np.savetxt(out, rows, "%d")
            first += len(nodes)
        out.write("$EndElements\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cells", type=int, default=1_000_000)
    parser.add_argument("--first", type=float, default=6e-6)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    mesh = blade(arguments.cells, arguments.first)
    write(mesh, arguments.folder / "blade.msh")
    (arguments.folder / "blade.deck").write_text(DECK.format(output="outputs/blade"), encoding="ascii")
    print(f"{arguments.folder}/blade.deck, blade.msh: {len(mesh.blocks[5][1])} hexahedra, "
          f"{len(mesh.x)} nodes")


if __name__ == "__main__":
    main()
