"""What the scripts for CalculiX share: its runs, its tables, and the tetrahedra of its input files. numpy."""
import re
import subprocess

import numpy as np

EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]           # of C3D10, in the order of its nodes 5 to 10
# S1 to S4, by vertices and edges
SIDES = [(0, 1, 2, 4, 5, 6), (0, 3, 1, 7, 8, 4), (1, 3, 2, 8, 9, 5), (2, 3, 0, 9, 7, 6)]
A = (5 - np.sqrt(5)) / 20
INTEGRATION = np.full((4, 4), A) + np.eye(4) * (1 - 4 * A)         # where CalculiX integrates over a C3D10
LATTICE = np.array([(i, j, k, 4 - i - j - k) for i in range(5) for j in range(5 - i) for k in range(5 - i - j)]) / 4


def run(folder, name, seconds=300):
    """Whether ccx takes and solves folder/name.inp, and what it says."""
    (folder / f"{name}.dat").unlink(missing_ok=True)
    try:
        done = subprocess.run(["ccx", "-i", name], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", timeout=seconds)
    except subprocess.TimeoutExpired:
        return False, f"over {seconds} s"
    return done.returncode == 0 and "Job finished" in done.stdout, done.stdout


def tables(path):
    """[(title, rows of numbers)] of a .dat file."""
    found = []
    for line in path.read_text(errors="replace").splitlines():
        words = re.sub(r"(?<=\d)-(?=\d{3}\b)", "E-", line).split()  # 1.0-101, as Fortran writes it
        try:
            row = [float(word) for word in words]
        except ValueError:
            found.append((line.strip(), []))
            continue
        if row and found:
            found[-1][1].append(row)
    return [(title, np.array(rows)) for title, rows in found if rows and len({len(row) for row in rows}) == 1]


def tetrahedra(path):
    """Numbers and positions of the nodes of a file of one *NODE and one *ELEMENT, and its C3D10 by places of nodes."""
    text = path.read_text()
    block = {key: re.search(rf"^\*{key}\b.*\n([^*]*)", text, re.M | re.I)[1] for key in ("NODE", "ELEMENT")}
    nodes = np.array([line.split(",") for line in block["NODE"].splitlines()], float)
    elements = np.array(re.findall(r"\d+", block["ELEMENT"]), int).reshape(-1, 11)
    ids = nodes[:, 0].astype(int)
    place = np.zeros(ids.max() + 1, int)
    place[ids] = np.arange(len(ids))
    return ids, nodes[:, 1:], elements[:, 0], place[elements[:, 1:]]


def determinants(x, cells, points):
    """det J of second-order tetrahedra at barycentric points L, with J by L2, L3, L4: cells x points."""
    of_vertices = 4 * points[:, :, None] * np.eye(4) - np.eye(4)     # points x nodes x L
    of_edges = np.zeros((len(points), 6, 4))
    for e, (i, j) in enumerate(EDGES):
        of_edges[:, e, i], of_edges[:, e, j] = 4 * points[:, j], 4 * points[:, i]
    dN = np.concatenate([of_vertices, of_edges], axis=1)
    return np.linalg.det(np.einsum("pna,cnx->cpax", dN[:, :, 1:] - dN[:, :, :1], x[cells]))


def von_mises(s):
    """Of rows sxx, syy, szz, sxy, sxz, syz."""
    normal = (s[:, 0] - s[:, 1])**2 + (s[:, 1] - s[:, 2])**2 + (s[:, 2] - s[:, 0])**2
    return np.sqrt(normal / 2 + 3 * (s[:, 3:]**2).sum(axis=1))
