#!/usr/bin/env python3
"""Checks the proof that a mesh is valid and covers no point twice: verify.py MESH PROOF. Exact arithmetic throughout.

Format of the proof: outputs/README.md. Let phi be the map of all cells, glued at nodes in the same place.

1. det D phi > 0 in every cell: a polynomial in Bernstein form is positive where its coefficients are, in the whole cell
   or in all pieces that the bisections of the proof cut it into. The cells on both sides of a side lie on two sides.
2. So the points that phi takes to y are as many as the boundary winds around y: that number changes only across the
   boundary, by one. The boundary does not cross itself, hence along a part of it (faces joined by sides that belong to
   two faces of the boundary) the number just inside is the same everywhere.
   - Faces with nothing in common: a plane separates their Bernstein points.
   - With a common corner: a plane through it does, the corner left out.
   - With a common edge, or one face with itself: on the convex plane figure of the two reference triangles, for two
     vectors u and q, and all Bernstein coefficients of the derivatives, (u.x_e)(q.x_f) > |u.x_f||q.x_e|. Then
     (y - y').(c u dx + q dx) > 0 along every segment from y' to y, for some c: no two points fall together.
   A pair for which this fails is cut as the proof says, and holds of all pairs of pieces.
3. In each part of the boundary one point is in no other cell, and once in its own: so the number is 1 all along the
   inside of the boundary, 0 outside, and 0 or 1 everywhere. (A ring that goes around twice has 2 somewhere.)
Straight simplices are compared by exact separating planes, which always exist if they have no other point in common.
"""
import itertools, math, sys
from fractions import Fraction

# Gmsh's numbering: dimensions of the factors, corners in their barycentric coordinates, edges, sides seen from outside.
P, Q, H = (0, 1), ((1, 0), (0, 1)), range
CELLS = {
    "line": ((1,), ((1, 0), (0, 1)), "01", ""),
    "triangle": ((2,), ((1, 0, 0), (0, 1, 0), (0, 0, 1)), "01 12 20", "01 12 20"),
    "quadrilateral": ((1, 1), ((1, 0, 1, 0), (0, 1, 1, 0), (0, 1, 0, 1), (1, 0, 0, 1)), "01 12 23 30", "01 12 23 30"),
    "tetrahedron": ((3,), ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)), "01 12 20 30 32 31",
                    "021 013 032 312"),
    "hexahedron": ((1, 1, 1), tuple(Q[a] + Q[b] + Q[c] for c in P for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))),
                   "01 03 04 12 15 23 26 37 45 47 56 67", "0321 0154 0473 1265 2376 4567"),
    "prism": ((2, 1), tuple(tuple(int(i == a) for i in H(3)) + Q[c] for c in P for a in H(3)),
              "01 02 03 12 14 25 34 35 45", "021 345 0143 0352 1254"),
    "pyramid": ((1, 1, 1), ((1, 0, 1, 0, 0), (0, 1, 1, 0, 0), (0, 1, 0, 1, 0), (1, 0, 0, 1, 0), (0, 0, 0, 0, 1)),
                "01 03 04 12 14 23 24 34", "014 304 124 234 0321")}
GMSH = {1: "line", 2: "triangle", 3: "quadrilateral", 4: "tetrahedron", 5: "hexahedron", 6: "prism", 7: "pyramid"}
TYPES = {t: (GMSH[k], p + 1) for k, row in {
    1: (1, 8, 26, 27), 2: (2, 9, 21, 23), 3: (3, 10, 36, 37), 4: (4, 11, 29, 30), 5: (5, 12, 92, 93),
    6: (6, 13, 90, 91), 7: (7, 14, 118, 119)}.items() for p, t in enumerate(row)}
VTK = {3: "line", 5: "triangle", 9: "quadrilateral", 10: "tetrahedron", 12: "hexahedron", 13: "prism", 14: "pyramid"}
corners_of = lambda word: [int(v) for v in word]


class Refused(Exception):
    pass


def check(is_true, why):
    if not is_true: raise Refused(why)


# ---- Polynomials: {exponents: coefficient}, homogeneous in the barycentric coordinates of each factor.
def times(a, b):
    product = {}
    for e, x in a.items():
        for f, y in b.items():
            g = tuple(map(sum, zip(e, f)))
            product[g] = product.get(g, 0) + x * y
    return product


def lattice(cell, p):
    """Nodes of degree p in Gmsh's order: corners, edges, sides, inside; p times their barycentric coordinates."""
    factors, corners, edges, sides = CELLS[cell]
    if p == 0: return [(0,) * len(corners[0])]
    at = lambda c, w: tuple(sum(x * y for x, y in zip(w, column)) for column in zip(*c))
    nodes = [at([c], [p]) for c in corners]
    nodes += [at([corners[int(v)] for v in e], (p - s, s)) for e in edges.split() for s in H(1, p)]
    for side in sides.split() if sum(factors) == 3 else ():
        face, lower = ("triangle", p - 3) if len(side) == 3 else ("quadrilateral", p - 2)
        c = [corners[int(v)] for v in side]
        for i in lattice(face, lower) if lower >= 0 else ():
            i = [k + 1 for k in i]
            if len(side) == 3: nodes.append(at(c, i))
            else: nodes.append(at((c[0], c[1], c[3]), (p - i[1] - i[3], i[1], i[3])))
    if cell == "prism": inner = [a + b for a in lattice("triangle", p - 3) for b in lattice("line", p - 2)] if p > 2 else []
    else:
        lower = p - (3 if cell == "pyramid" else factors[0] + 1)
        inner = lattice(cell, lower) if lower >= 0 and cell != "line" else []
    return nodes + [tuple(k + 1 for k in i) for i in inner]


def shapes(cell, p):
    """The Lagrange functions of degree p, one polynomial for each node. Those of a pyramid on the cube."""
    if cell == "pyramid": return pyramid_shapes(p)
    factors, functions = CELLS[cell][0], []
    width = sum(factors) + len(factors)
    unit = lambda k: tuple(int(i == k) for i in H(width))
    for node in lattice(cell, p):
        N, first = {(0,) * width: Fraction(1)}, 0
        for m in factors:
            own = H(first, first + m + 1)
            for k in own:
                for j in H(node[k]): N = times(N, {unit(i): Fraction(p * (i == k) - j, j + 1) for i in own})
            first += m + 1
        functions.append(N)
    return functions


def pyramid_shapes(p):
    """Spanned by (1 - c)^(p - k) c^k a0^i a1^(m - i) b0^j b1^(m - j), m = p - k, raised to degree p in a and b."""
    basis = [(k, i, j) for k in H(p + 1) for i in H(p - k + 1) for j in H(p - k + 1)]
    rows = []
    for a0, a1, b0, b1, c in lattice("pyramid", p):
        m = max(p - c, 1)
        a0, b0, c = (Fraction(a0, m), Fraction(b0, m), Fraction(c, p)) if c < p else (Fraction(1), Fraction(1), Fraction(1))
        rows.append([(1 - c) ** (p - k) * c ** k * a0 ** i * (1 - a0) ** (p - k - i) * b0 ** j * (1 - b0) ** (p - k - j)
                     for k, i, j in basis])
    n = len(rows)
    table = [row + [Fraction(int(r == s)) for s in H(n)] for r, row in enumerate(rows)]
    for k in H(n):  # its inverse: function s has the coefficients table[.][n + s]
        pivot = next(r for r in H(k, n) if table[r][k] != 0)
        table[k], table[pivot] = table[pivot], table[k]
        table[k] = [x / table[k][k] for x in table[k]]
        for r in H(n):
            if r != k and table[r][k] != 0: table[r] = [x - table[r][k] * y for x, y in zip(table[r], table[k])]
    functions = []
    for s in H(n):
        N = {}
        for row, (k, i, j) in zip(table, basis):
            for t, u in itertools.product(H(k + 1), H(k + 1)) if row[n + s] != 0 else ():
                e = (i + t, p - i - t, j + u, p - j - u, p - k, k)
                N[e] = N.get(e, 0) + row[n + s] * math.comb(k, t) * math.comb(k, u)
        functions.append(N)
    return functions


def whole(rows):
    """Rows of fractions {node: weight} as lists of whole numbers, all multiplied by the same one."""
    scale = math.lcm(1, *(w.denominator for row in rows for w in row.values()))
    return scale, [[(i, int(w * scale)) for i, w in row.items() if w != 0] for row in rows]


class Cell:
    """Of one type and degree: derivatives, sides, and Bernstein coefficients from nodes."""
    def __init__(self, cell, p):
        self.name, self.degree, (factors, corners, _, sides) = cell, p, CELLS[cell]
        self.dim, functions, first, self.factors, derivatives = sum(factors), shapes(cell, p), 0, [], []
        for m in factors:
            self.factors.append(H(first, first + m + 1))
            for k in H(first + 1, first + m + 1):  # by barycentric coordinate k, the first of the factor falls
                rows = {}
                for i, N in enumerate(functions):
                    for (e, w), (of, sign) in itertools.product(N.items(), ((k, 1), (first, -1))):
                        if e[of]:
                            g = e[:of] + (e[of] - 1,) + e[of + 1:]
                            if cell == "pyramid" and first < 4: g = g[:4] + (g[4] - 1, g[5])  # divided by 1 - c
                            rows.setdefault(g, {})[i] = rows.get(g, {}).get(i, 0) + sign * e[of] * w
                rows = {g: row for g, row in rows.items() if any(row.values())}
                derivatives.append((list(rows), whole(list(rows.values()))[1]))
            first += m + 1
        self.derivatives = derivatives
        exponents = sorted({e for N in functions for e in N})
        scale = [math.prod(multinomial([e[k] for k in f]) for f in self.factors) for e in exponents]
        rows = [{i: N[e] / s for i, N in enumerate(functions) if e in N} for e, s in zip(exponents, scale)]
        self.exponents, (self.scale, self.rows) = exponents, whole(rows)
        place = {node: i for i, node in enumerate(lattice(cell, p))}
        self.sides = []
        for side in sides.split():
            c = [corners[v] for v in corners_of(side)]
            face = {2: "line", 3: "triangle", 4: "quadrilateral"}[len(c)]
            at = []
            for i in lattice(face, p):
                w = i if len(c) < 4 else (p - i[1] - i[3], i[1], 0, i[3])
                at.append(place[tuple(sum(x * y for x, y in zip(w, column)) for column in zip(*c))])
            self.sides.append((face, at))

    def bernstein(self, x):
        return {e: combination(row, x) for e, row in zip(self.exponents, self.rows)}

    def determinant(self, x):
        """Of D phi: the Bernstein coefficients, up to positive factors."""
        d = [(e, [combination(row, x) for row in rows]) for e, rows in self.derivatives]
        n, result = {}, {}
        for (e, u), (f, v) in itertools.product(zip(*d[0]), zip(*d[1])):
            g = tuple(map(int.__add__, e, f))
            if self.dim == 2: n[g] = n.get(g, 0) + u[0] * v[1] - u[1] * v[0]
            else:
                a, b, c = n.get(g, (0, 0, 0))
                n[g] = (a + u[1] * v[2] - u[2] * v[1], b + u[2] * v[0] - u[0] * v[2], c + u[0] * v[1] - u[1] * v[0])
        if self.dim == 2: return n
        for (e, u), (f, v) in itertools.product(n.items(), zip(*d[2])):
            g = tuple(map(int.__add__, e, f))
            result[g] = result.get(g, 0) + u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
        return result


multinomial = lambda e: math.factorial(sum(e)) // math.prod(map(math.factorial, e))


def combination(row, x):
    a = b = c = 0
    for i, w in row:
        y = x[i]
        a += w * y[0]
        b += w * y[1]
        c += w * y[2]
    return (a, b, c)


def half(form, a, b):
    """On the half beside corner a, the middle of the edge in place of corner b; times 2^degree."""
    degree = max(e[a] + e[b] for e in form)
    result = {}
    for e in form:
        i, j, sums = e[a], e[b], []
        for t in H(j + 1):
            f = list(e)
            f[a], f[b] = i + j - t, t
            sums.append((math.comb(j, t) << (degree - j), form[tuple(f)]))
        result[e] = (tuple(sum(w * x[k] for w, x in sums) for k in H(3)) if isinstance(form[e], tuple)
                     else sum(w * x for w, x in sums))
    return result


# ---- Files
def read_mesh(text):
    """Coordinates as fractions by node, and cells [(id, name, degree, nodes)]."""
    lines, nodes, cells = text.split("\n"), {}, []
    sections = {line.strip(): i for i, line in enumerate(lines) if line.startswith("$")}
    if "$MeshFormat" not in sections: return read_su2(lines)
    check(lines[sections["$MeshFormat"] + 1].split()[:2] in (["2.2", "0"], ["4.1", "0"]), "not MSH 2.2 or 4.1 in text")
    is_41 = lines[sections["$MeshFormat"] + 1].startswith("4")
    at = sections["$Nodes"] + 1
    if is_41:
        for _ in H(int(lines[at].split()[0])):
            count = int(lines[at + 1].split()[3])
            for k in H(count): nodes[int(lines[at + 2 + k])] = tuple(lines[at + 2 + count + k].split()[:3])
            at += 1 + 2 * count
    else:
        for line in lines[at + 1:at + 1 + int(lines[at])]:
            word = line.split()
            nodes[int(word[0])] = tuple(word[1:4])
    at = sections["$Elements"] + 1
    blocks = H(int(lines[at].split()[0])) if is_41 else H(1)
    for _ in blocks:
        if is_41: at, (_, _, kind, count), skip = at + 1, map(int, lines[at + 1].split()), 1
        else: kind, count = None, int(lines[at])
        for line in lines[at + 1:at + 1 + count]:
            word = list(map(int, line.split()))
            of, skip = (kind, 1) if is_41 else (word[1], 3 + word[2])
            if of != 15:
                check(of in TYPES, f"elements of type {of}")
                cells.append((word[0], *TYPES[of], tuple(word[skip:])))
        at += count
    return nodes, cells


def read_su2(lines):
    nodes, cells, at = {}, [], 0
    lines = [line for line in (line.split("%")[0].strip() for line in lines) if line]
    for k, line in enumerate(lines):
        key, _, value = line.replace(" ", "").partition("=")
        if key == "NDIME": dim = int(value)
        if key == "NPOIN":
            for i in H(int(line.split("=")[1].split()[0])):
                word = lines[k + 1 + i].split()
                nodes[i] = tuple(word[:dim]) + ("0",) * (3 - dim)
        if key == "NELEM":
            for i in H(int(value)):
                word = list(map(int, lines[k + 1 + i].split()))
                name = VTK[word[0]]
                cells.append((i, name, 1, tuple(word[1:1 + len(CELLS[name][1])])))
    return nodes, cells


def fnv(data):
    """FNV-1a, 64 bits."""
    h = 14695981039346656037
    for byte in data: h = (h ^ byte) * 1099511628211 & 0xffffffffffffffff
    return f"{h:016x}"


def read_proof(text, mesh):
    lines = text.split("\n")
    head = dict(line.partition(" ")[::2] for line in lines[1:4])
    check(lines[0] == "almesh proof 1" and lines[-2:] == [f"end {len(lines) - 1}", ""] and
          list(head) == ["version", "hash", "elements"], "the proof is not whole")
    check(head.get("hash") == fnv(mesh), "the proof is of another mesh: the hash differs")
    trees = {}
    for line in lines[4:-2]:
        *key, tree = line.split(" ")
        key = (key[0], *map(int, key[1:]))
        check(key not in trees, f"line '{line}' is there twice")
        trees[key] = tree
    return head, trees


# ---- Patches of the boundary: (names of the corners, Bernstein points)
dot = lambda u, v: u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
minus = lambda u, v: (u[0] - v[0], u[1] - v[1], u[2] - v[2])
cross = lambda u, v: (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
moved = lambda e, k, by: e[:k] + (e[k] + by,) + e[k + 1:]


def patch_rows(face, p, corners, d):
    """Of the triangle (in 2D the line) with these corners of a face of degree p, as one of degree d."""
    simplex = "line" if face == "line" else "triangle"
    weights, at, rows = shapes(simplex, d), [CELLS[face][1][v] for v in corners], {}
    for i, N in zip(lattice(simplex, d), weights):
        x = [Fraction(sum(a * b for a, b in zip(i, column)), d) for column in zip(*at)]
        for node, function in enumerate(shapes(face, p)):
            value = sum(w * math.prod(y ** k for y, k in zip(x, e)) for e, w in function.items())
            for e, w in N.items() if value else ():
                row = rows.setdefault(e, {})
                row[node] = row.get(node, 0) + w * value / multinomial(e)
    return list(rows), list(rows.values())


def direction(v):
    """As floating-point numbers of length 1: they choose a vector, whole numbers decide."""
    largest = max(map(abs, v)) or 1
    w = [x / largest for x in v]
    size = math.sqrt(dot(w, w)) or 1
    return [x / size for x in w]


def has_positive(vectors):
    """Whether some vector has a positive product with all (perceptron algorithm)."""
    units = [direction(v) for v in vectors]
    d = [sum(column) for column in zip(*units)]
    for _ in H(100):
        least = min(units, key=lambda v: dot(v, d))
        if dot(least, d) > 1e-6 * math.sqrt(dot(d, d)):
            d = [round(x * 2 ** 40) for x in d]
            return all(dot(v, d) > 0 for v in vectors)
        d = [a + b for a, b in zip(d, least)]
    return False


def planes(edges, is_2d):
    """Normals of the planes, among which there is one between straight simplices with these edges."""
    if is_2d: return [(-y, x, 0) for x, y, _ in edges] + edges
    normals = [n for u, v in itertools.combinations(edges, 2) if any(n := cross(u, v))]
    return normals + [cross(n, u) for n in normals for u in edges] + edges


def cones_apart(f, g, axes):
    """Whether planes through the origin have the one on one side, the other on the other, then what lies in them."""
    for axis in axes:
        of_f, of_g = [dot(axis, v) for v in f], [dot(axis, v) for v in g]
        for s in (1, -1):
            if all(s * x >= 0 for x in of_f) and all(s * x <= 0 for x in of_g) and any(of_f + of_g):
                f, g = [v for v, x in zip(f, of_f) if x == 0], [v for v, x in zip(g, of_g) if x == 0]
                return not f or not g or cones_apart(f, g, axes)
    return False


def tangents(form, a, b, c):
    """By the edge from corner a to b, and from its middle to corner c, twice."""
    for e in form:
        if e[a]:
            x, y, z = form[e], form[moved(moved(e, a, -1), b, 1)], form[moved(moved(e, a, -1), c, 1)]
            yield minus(y, x), (2 * z[0] - x[0] - y[0], 2 * z[1] - x[1] - y[1], 2 * z[2] - x[2] - y[2])


def corner(form, k):
    return form[tuple(max(map(sum, form)) * (i == k) for i in H(len(next(iter(form)))))]


def is_monotone(F, G=None):
    """F, with what it shares with G: the argument of a common edge."""
    (names, form), ends = F, (0, 1)
    if len(names) == 2: return all(dot(minus(corner(form, 1), corner(form, 0)), minus(form[moved(moved(e, 0, -1), 1, 1)],
                                                                           form[e])) > 0 for e in form if e[0])
    if G: ends = tuple(k for k in H(3) if names[k] in G[0])
    a, b = ends
    u, inward, both = minus(corner(form, b), corner(form, a)), [], []
    for of, sign in ((F, 1), (G, -1)) if G else ((F, 1),):
        i, j = of[0].index(names[a]), of[0].index(names[b])
        both += [(e, f if sign > 0 else tuple(-x for x in f)) for e, f in tangents(of[1], i, j, 3 - i - j)]
        f = minus(corner(of[1], 3 - i - j), corner(of[1], i))
        f = tuple(x * dot(u, u) - y * dot(u, f) for x, y in zip(f, u))
        inward.append([sign * x for x in direction(f)])
    q = [round(sum(column) * 2 ** 40) for column in zip(*inward)]
    least = min(dot(u, e) for e, _ in both), min(dot(q, f) for _, f in both)
    return min(least) > 0 and least[0] * least[1] > (max(abs(dot(u, f)) for _, f in both) *
                                                     max(abs(dot(q, e)) for e, _ in both))


def edge_points(P, names):
    a, b = (P[0].index(name) for name in names)
    return [x for _, x in sorted((e[b], x) for e, x in P[1].items() if e[a] + e[b] == sum(e))]


def are_apart(F, G):
    """Whether they have nothing in common but the corners and edges that their names say."""
    (names, f), (others, g) = F, G
    shared = [name for name in names if name in others]
    degree, m = sum(next(iter(f))), len(names) - 1
    if len(shared) > m or (len(shared) == 2 and edge_points(F, shared) != edge_points(G, shared)): return False
    if degree > 1 and len(shared) == 2: return is_monotone(F, G)
    if not shared:
        if degree > 1: return has_positive([minus(x, y) for x in f.values() for y in g.values()])
        x, y = list(f.values()), list(g.values())
        edges = [minus(a, b) for of in (x, y) for a, b in itertools.combinations(of, 2)]
        for axis in planes(edges, m == 1):
            of_x, of_y = [dot(axis, v) for v in x], [dot(axis, v) for v in y]
            if min(of_x) > max(of_y) or min(of_y) > max(of_x): return True
        return False
    origin = corner(f, names.index(shared[0]))
    f, g = ([minus(corner(of, k), origin) for k in H(m + 1) if name[k] not in shared] if degree == 1 else
            [minus(x, origin) for e, x in of.items() if e[name.index(shared[0])] < degree] for name, of in (F, G))
    if degree > 1: return has_positive(f + [tuple(-a for a in y) for y in g])
    fixed = [minus(corner(F[1], names.index(name)), origin) for name in shared[1:]]
    axes = planes(f + g + fixed, m == 1)
    return cones_apart(f, g, [axis for axis in axes if not any(dot(axis, v) for v in fixed)])


# ---- The claims
def holds(claim, tree, *of):
    """The claim of pieces, after all bisections of the tree."""
    steps = iter(tree)
    try: return claim(*of, steps) and next(steps, None) is None
    except (TypeError, ValueError, KeyError, StopIteration): return False  # no tree


def is_positive(form, tree):
    step = next(tree, None)
    if step == ".": return all(x > 0 for x in form.values())
    a, b = int(step), int(next(tree))
    return is_positive(half(form, a, b), tree) and is_positive(half(form, b, a), tree)


def halves(P, k):
    """A patch cut at the edge opposite corner k, a line in its middle."""
    names, form = P
    if k not in (H(3) if len(names) == 3 else (0,)): raise ValueError
    a, b = [i for i in H(3) if i != k] if len(names) == 3 else (0, 1)
    middle = "(%s,%s)" % tuple(sorted((names[a], names[b])))
    change = lambda at: names[:at] + (middle,) + names[at + 1:]
    return (change(b), half(form, a, b)), (change(a), half(form, b, a))


def scaled(P):
    factor = 1 << sum(next(iter(P[1])))
    return P[0], {e: tuple(factor * a for a in x) for e, x in P[1].items()}


def prove_apart(F, G, tree):
    step = next(tree, None)
    if step == ".": return are_apart(F, G)
    if step == "b":
        cut = [halves(P, next(k for k in H(3) if P[0][k] not in other[0])) for P, other in ((F, G), (G, F))]
        return all([prove_apart(f, g, tree) for f in cut[0] for g in cut[1]])
    k = int(step)
    if k < 3: return all([prove_apart(f, scaled(G), tree) for f in halves(F, k)])
    return all([prove_apart(scaled(F), g, tree) for g in halves(G, k - 3)])


def prove_face(F, tree):
    step = next(tree, None)
    if step == ".": return is_monotone(F)
    f, g = halves(F, int(step))
    return all([prove_face(f, tree), prove_face(g, tree), prove_apart(f, g, tree)])


def overlapping(boxes):
    """Pairs of boxes that overlap, by dividing them at a plane again and again."""
    todo, pairs = [(list(H(len(boxes))), 0)], set()
    while todo:
        items, depth = todo.pop()
        axis = max(H(3), key=lambda a: max(boxes[i][1][a] for i in items) - min(boxes[i][0][a] for i in items)) if items else 0
        middle = sorted(boxes[i][0][axis] + boxes[i][1][axis] for i in items)[len(items) // 2] if items else 0
        low, high = ([i for i in items if 2 * boxes[i][0][axis] <= middle], [i for i in items if 2 * boxes[i][1][axis] >= middle])
        if len(items) > 12 and max(len(low), len(high)) < 0.9 * len(items):
            todo += [(low, depth + 1), (high, depth + 1)]
            continue
        for i, j in itertools.combinations(items, 2):
            (a, b), (c, d) = boxes[i], boxes[j]
            if a[0] <= d[0] and c[0] <= b[0] and a[1] <= d[1] and c[1] <= b[1] and a[2] <= d[2] and c[2] <= b[2]:
                pairs.add((i, j) if i < j else (j, i))
    return sorted(pairs)


def box(points):
    columns = list(zip(*points))
    return tuple(map(min, columns)), tuple(map(max, columns))


def is_once(kind, form):
    """Whether on this piece of a cell no two points fall together: its Jacobian is near that in the middle."""
    columns = []
    for f in kind.factors:
        for k in f[1:]:
            columns.append([minus(form[moved(moved(e, f[0], -1), k, 1)], x) for e, x in form.items() if e[f[0]]])
    J = [[sum(x) for x in zip(*column)] for column in columns]
    if kind.dim == 2: J.append([0, 0, 1])
    rows = [cross(J[1], J[2]), cross(J[2], J[0]), cross(J[0], J[1])][:kind.dim]
    if (sign := dot(rows[0], J[0])) == 0: return False
    rows = [tuple((1 if sign > 0 else -1) * len(columns[k]) * a for a in row) for k, row in enumerate(rows)]
    for k, row in enumerate(rows):
        others = sum(max(abs(dot(rows[a], x)) for x in columns[b]) for j in H(kind.dim) if j != k for a, b in ((k, j), (j, k)))
        if 2 * min(dot(row, x) for x in columns[k]) <= others: return False
    return True


def covers_only_at(kind, form, q, at):
    """Whether no point of the cell but `at` (or none at all, if that is None) falls on q, by bisection."""
    todo = [({e: minus(x, q) for e, x in form.items()}, at, 0)]
    while todo:
        form, at, depth = todo.pop()
        low, high = box(form.values())
        if max(low) > 0 or min(high) < 0: continue
        if is_once(kind, form) if at else has_positive(list(form.values())): continue
        if depth == 30: return False
        size, a, b = max((max(sum(map(abs, minus(form[moved(moved(e, a, -1), b, 1)], x))) for e, x in form.items() if e[a]),
                          a, b) for f in kind.factors for a, b in itertools.combinations(f, 2))
        for a, b in ((a, b), (b, a)):
            inside = None
            if at and at[a] >= at[b]:
                inside = list(at)
                inside[a], inside[b] = at[a] - at[b], 2 * at[b]
            todo.append((half(form, a, b), inside, depth + 1))
    return True


def verify(mesh, proof):
    nodes, cells = read_mesh(mesh.decode())
    head, trees = read_proof(proof, mesh)
    dim = max(sum(CELLS[name][0]) for _, name, _, _ in cells)
    cells = [of for of in cells if sum(CELLS[of[1]][0]) == dim]
    check(str(len(cells)) == head["elements"], "the mesh has another number of elements than the proof says")
    used = {i for of in cells for i in of[3]}
    ratio = {i: [float(word).as_integer_ratio() for word in nodes[i]] for i in used}
    scale = max(d for x in ratio.values() for _, d in x)
    X = {i: tuple(n * (scale // d) for n, d in x) for i, x in ratio.items()}
    if dim == 2:
        flat = [a for a in (2, 1, 0) if len({x[a] for x in X.values()}) == 1][0]
        X = {i: x[:flat] + x[flat + 1:] + (0,) for i, x in X.items()}
    place, same = {}, {}
    for i in sorted(used): same[i] = place.setdefault(X[i], i)
    kinds = {of[1:3]: Cell(*of[1:3]) for of in {of[1:3]: of for of in cells}.values()}
    sides = {}
    for number, (id_, name, p, at) in enumerate(cells):
        kind, x = kinds[name, p], [X[i] for i in at]
        form, tree = kind.determinant(x), trees.pop(("element", id_), ".")
        turned = trees.pop(("turned", id_), None)
        if turned: form = {e: -a for e, a in form.items()}
        if tree != ".":
            scales = {e: math.prod(multinomial([e[k] for k in f]) for f in kind.factors) for e in form}
            common = math.lcm(*scales.values())
            form = {e: a * (common // scales[e]) for e, a in form.items()}
        check(holds(is_positive, tree, form), f"element {id_}: det J is not proved positive")
        for k, (face, local) in enumerate(kind.sides):
            own = [same[at[i]] for i in local]
            c = own[:len(CELLS[face][1])]
            first = c.index(min(c))
            sign = (c[1] > c[0] if len(c) == 2 else c[first - 1] > c[(first + 1) % len(c)]) ^ bool(turned)
            before = sides.setdefault((key := tuple(sorted(own))), (number, k, face, own, sign))
            if before[0] != number:
                check(before[0] >= 0 and before[4] != sign,
                      f"element {id_}: at its side {c} is more than one element on one side")
                sides[key] = (-1,)
    check_boundary(dim, kinds, cells, X, [of for of in sides.values() if of[0] >= 0], trees)
    check(not trees, f"the proof names what is not there: {list(trees)[:1]}")
    return len(cells), dim


def check_boundary(dim, kinds, cells, X, faces, trees):
    rows, patches = {}, []
    degree = cells[0][2] * (2 if any(of[2] == "quadrilateral" for of in faces) else 1)
    for number, k, face, own, _ in faces:
        count = len(CELLS[face][1])
        first = min(H(count), key=lambda i: own[i])
        for c in [H(count)] if count < 4 else [((first + i) % 4, (first + j) % 4, first) for i, j in ((1, 2), (2, 3))]:
            c, p = tuple(sorted(c, key=lambda i: own[i])), cells[number][2]
            patches.append((own, (face, p, c)))
            if patches[-1][1] not in rows: rows[face, p, c] = patch_rows(face, p, c, degree)
    _, weights = whole([row for _, of in rows.values() for row in of])
    weights = iter(weights)
    rows = {key: (exponents, [next(weights) for _ in of]) for key, (exponents, of) in rows.items()}
    patches = [(tuple(own[i] for i in key[2]), {e: combination(row, [X[i] for i in own]) for e, row in zip(*rows[key])})
               for own, key in patches]
    name = lambda P: "face " + " ".join(map(str, P[0]))
    text = lambda P: (tuple(map(str, P[0])), P[1])
    if degree > 1:
        for P in patches:
            tree = trees.pop(("face", *P[0]), ".")
            check(holds(prove_face, tree, text(P)), f"{name(P)} is not proved to have no point twice")
    for i, j in overlapping([box(form.values()) for _, form in patches]):
        F, G = sorted((patches[i], patches[j]), key=lambda P: P[0])
        tree = trees.pop(("pair", *F[0], *G[0]), ".")
        check(holds(prove_apart, tree, text(F), text(G)), f"{name(F)} and {name(G)} are not proved to have nothing in common")
    parts = list(H(len(faces)))  # numbers of the parts of the boundary, joined at sides of two faces
    at_side = {}
    for i, (_, _, face, own, _) in enumerate(faces):
        for key in side_keys(face, own, cells[faces[i][0]][2]): at_side.setdefault(key, []).append(i)

    def root(i):
        while parts[i] != i: parts[i] = i = parts[parts[i]]
        return i
    for two in at_side.values():
        if len(two) == 2: parts[root(two[0])] = root(two[1])
    of_part, boxes = {}, {}
    for i in H(len(faces)): of_part.setdefault(root(i), []).append(i)
    for part in of_part.values():
        check(any(is_covered_once(kinds, cells, X, faces[i], boxes) for i in part[:5]),
              f"the part of the boundary with face {faces[part[0]][3]} is not proved to be covered once")


def side_keys(face, own, p):
    if face == "line": return own[:2]
    if (face, p) not in EDGES: EDGES[face, p] = [local for _, local in Cell(face, p).sides]
    return [tuple(sorted(own[i] for i in local)) for local in EDGES[face, p]]


EDGES = {}


def is_covered_once(kinds, cells, X, of, boxes):
    number, k, face, _, _ = of
    kind = kinds[cells[number][1:3]]
    c = [CELLS[kind.name][1][v] for v in corners_of(CELLS[kind.name][3].split()[k])]
    weight = {2: (3, 4), 3: (1, 2, 4), 4: (4, 1, 0, 2)}[len(c)]
    t = [Fraction(sum(a * b for a, b in zip(weight, column)), 7) for column in zip(*c)]
    if kind.name == "pyramid": t = ([a / (1 - t[4]) for a in t[:4]] + [1 - t[4], t[4]])
    point = None
    for i, (_, name, p, at) in enumerate(cells):
        if i not in boxes:
            form = kinds[name, p].bernstein([X[n] for n in at])
            boxes[i] = [box(form.values()), kinds[name, p].scale]
    form = kind.bernstein([X[n] for n in cells[number][3]])
    q = [sum(x[a] * math.prod(math.prod(t[j] ** e[j] for j in f) * multinomial([e[j] for j in f]) for f in kind.factors)
             for e, x in form.items()) / kind.scale for a in H(3)]
    common = math.lcm(*(a.denominator for a in q))
    q = [int(a * common) for a in q]
    for i, (_, name, p, at) in enumerate(cells):
        (low, high), scale = boxes[i]
        if any(common * a > scale * b or common * c < scale * b for a, b, c in zip(low, q, high)): continue
        other = kinds[name, p]
        form = {e: tuple(common * a for a in x) for e, x in other.bernstein([X[n] for n in at]).items()}
        if not covers_only_at(other, form, [scale * a for a in q], t if i == number else None): return False
    return True


def main():
    mesh, proof = open(sys.argv[1], "rb").read(), open(sys.argv[2]).read()
    try:
        count, dim = verify(mesh, proof)
    except (Refused, KeyError, ValueError, IndexError, TypeError) as why:
        print(f"NOT proved: {why}")
        return 1
    print(f"proved: all {count} elements are valid everywhere, and no two of them overlap")
    return 0


if __name__ == "__main__": sys.exit(main())
