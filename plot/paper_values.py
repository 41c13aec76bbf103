"""What the paper prints: Ruiz-Girones, Gargallo-Peiro, Sarrate, Roca, Tables 1 and 2 and the text of section 4."""
from collections import namedtuple

# Table 1: the circle, refined uniformly. Sparse direct solver.
Table1 = namedtuple("Table1", "deck elements nodes time quality al_iterations")
TABLE1 = [
    Table1("circle", 1642, 841, 1.11, 0.936, 6),
    Table1("circle-refined-1", 6568, 3324, 3.56, 0.937, 5),
    Table1("circle-refined-2", 26272, 13216, 14.29, 0.937, 6),
    Table1("circle-refined-3", 105088, 52704, 101.94, 0.937, 6),
    Table1("circle-refined-4", 420352, 210816, 546.66, 0.937, 6),
]
MISPRINTED_NODES = 210816  # refining 105088 triangles with 52704 nodes and 320 boundary edges gives NODES_MEANT
NODES_MEANT = 210496

# Table 2: relative quality from the initial mesh on, padded to eight columns. GMRES with ILU(0).
Table2 = namedtuple("Table2", "deck example quality time")
TABLE2 = [
    Table2("circle", "circle displacement", [1.0, 0.937, 0.936, 0.936, 0.936, 0.936, 0.936, 0.936], 0.73),
    Table2("curving", "mesh curving", [1.0, 0.999, 0.999, 0.999, 0.999, 0.999, 0.999, 0.999], 26.9),
    Table2("aircraft", "aircraft displacement", [1.0, 0.998, 0.998, 0.998, 0.998, 0.998, 0.998, 0.998], 476.25),
]
CURVING_TIME_IN_TEXT = 11.13

# Figures 2, 6 and 10: AL iterations, and what the text says about the constraint norm, [(iteration, norm)].
Convergence = namedtuple("Convergence", "figure deck al_iterations stated text")
CONVERGENCE = [
    Convergence(2, "circle", 6, [(6, 1e-7)], "six iterations, of the order of 1e-7 at the end"),
    Convergence(6, "curving", 6, [(6, 1e-7)], "six iterations, of the order of 1e-7 at the end"),
    Convergence(10, "aircraft", 9, [(0, 4), (1, 1e-5), (9, 1e-6)],
                "nine iterations: 4 at first, 1e-5 after the first, 1e-6 at the end"),
]
CIRCLE_MAX_DISTORTION = 2.1

# Sizes of the other two meshes (nodes, elements), section 4.2 (linear mesh) and 4.3.
CURVING_SIZE = (697, 1368)
AIRCRAFT_SIZE = (20192, 97868)
