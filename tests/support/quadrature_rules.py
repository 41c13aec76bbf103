"""Finds the symmetric quadrature rules of src/mesh/quadrature_table.hpp and prints that file's entries.

    python3 tests/support/quadrature_rules.py            every rule of the list `rules` below, some minutes
    python3 tests/support/quadrature_rules.py 3 8        only dimension 3, exactness 8

A rule is a set of orbits: all permutations of one point in barycentric coordinates share a weight. It integrates all
polynomials up to a degree if it integrates the symmetric ones among them, and these are the polynomials in the elementary
symmetric functions e2, e3 (and e4) of the coordinates: 2i + 3j (+ 4k) <= degree. That is a small system of polynomial
equations for the weights and coordinates, solved by Gauss-Newton from random starts until a solution has positive weights
and points inside; the last steps take the residual in extended precision.
"""
import itertools
import math
import sys
from fractions import Fraction

import numpy as np

# (dimension, exactness): how many orbits of each kind. Kinds by equal coordinates, triangle: centroid, aab, abc;
# tetrahedron: centroid, aaab, aabb, aabc, abcd. Counts as in Witherden & Vincent, Comput. Math. Appl. 69 (2015) 1232.
rules = {
    (2, 2): (0, 1, 0), (2, 4): (0, 2, 0), (2, 5): (1, 2, 0), (2, 6): (0, 2, 1), (2, 7): (0, 3, 1), (2, 8): (1, 3, 1),
    (2, 9): (1, 4, 1), (2, 10): (1, 2, 3), (2, 12): (0, 5, 3), (2, 13): (1, 6, 3),
    (3, 2): (0, 1, 0, 0, 0), (3, 3): (0, 2, 0, 0, 0), (3, 5): (0, 2, 1, 0, 0), (3, 6): (0, 3, 0, 1, 0),
    (3, 7): (1, 1, 1, 2, 0), (3, 8): (0, 4, 1, 2, 0), (3, 9): (1, 4, 1, 3, 0), (3, 10): (1, 2, 0, 6, 0),
}
patterns = {2: ("aaa", "aab", "abc"), 3: ("aaaa", "aaab", "aabb", "aabc", "abcd")}
points_of = {"aaa": 1, "aab": 3, "abc": 6, "aaaa": 1, "aaab": 4, "aabb": 6, "aabc": 12, "abcd": 24}


def barycentric(pattern, free):
    """One point of an orbit from its free coordinates, the last of the distinct ones makes the sum 1."""
    letters = sorted(set(pattern))
    values = dict(zip(letters, free))
    rest = 1 - sum(values[c] * pattern.count(c) for c in letters[:-1])
    values[letters[-1]] = rest / pattern.count(letters[-1])
    return [values[c] for c in pattern]


def elementary(coordinates):
    """e2, e3 (, e4) of the coordinates."""
    return [sum(math.prod(c) for c in itertools.combinations(coordinates, k)) for k in range(2, len(coordinates) + 1)]


def exact_moments(dim, exponents):
    """Means over the simplex of the products of powers of e2, e3 (, e4): Fractions."""
    def times(p, q):
        product = {}
        for a, x in p.items():
            for b, y in q.items():
                index = tuple(i + j for i, j in zip(a, b))
                product[index] = product.get(index, 0) + x * y
        return product

    e = [{tuple(int(i in c) for i in range(dim + 1)): 1 for c in itertools.combinations(range(dim + 1), k)}
         for k in range(2, dim + 2)]
    moments = []
    for powers in exponents:
        p = {(0,) * (dim + 1): 1}
        for factor, power in zip(e, powers):
            for _ in range(power):
                p = times(p, factor)
        moments.append(sum(Fraction(x * math.prod(map(math.factorial, a)) * math.factorial(dim),
                                    math.factorial(sum(a) + dim)) for a, x in p.items()))
    return moments


class System:
    """The equations of one rule. Unknowns: the weight of each orbit in all, then the free coordinates of each."""

    def __init__(self, dim, degree, counts):
        self.degree = degree
        self.orbits = [kind for kind, count in zip(patterns[dim], counts) for _ in range(count)]
        self.free = [len(set(kind)) - 1 for kind in self.orbits]
        ranges = [range(degree // k + 1) for k in range(2, dim + 2)]
        self.exponents = [i for i in itertools.product(*ranges)
                          if sum(k * power for k, power in enumerate(i, 2)) <= degree]
        self.exact = [np.longdouble(m.numerator) / np.longdouble(m.denominator)
                      for m in exact_moments(dim, self.exponents)]
        # An orthonormal basis of the same polynomials, by samples: the powers themselves are nearly dependent.
        random = np.random.default_rng(1)
        samples = random.dirichlet(np.ones(dim + 1), 4000).T
        values = np.array(self.monomials(elementary(samples)))
        scale = np.abs(values).max(axis=1)
        _, r = np.linalg.qr((values / scale[:, None]).T / 63)
        self.basis = np.linalg.inv(r).T / scale

    def monomials(self, e):
        powers = []
        for k, x in enumerate(e, 2):
            powers.append([1 + 0 * x])
            while len(powers[-1]) <= self.degree // k:
                powers[-1].append(powers[-1][-1] * x)
        return [math.prod((p[i] for p, i in zip(powers, exponents)), start=1) for exponents in self.exponents]

    def points(self, unknowns):
        """A point of each orbit: coordinates x orbits (x vectors of unknowns, if there is more than one)."""
        coordinates, at = [], len(self.orbits)
        for kind, free in zip(self.orbits, self.free):
            point = barycentric(kind, unknowns[at:at + free])
            coordinates.append([x + 0 * unknowns[0] for x in point])
            at += free
        return np.swapaxes(np.array(coordinates), 0, 1)

    def moments(self, unknowns):
        values = np.array(self.monomials(elementary(self.points(unknowns))))
        return (values * unknowns[:len(self.orbits)]).sum(axis=1)

    def residual(self, unknowns):
        return self.basis @ (self.moments(unknowns) - self.exact).astype(float)

    def jacobian(self, unknowns):
        """By complex steps, all at once: exact to rounding."""
        shifted = unknowns[:, None] + 1e-30j * np.eye(len(unknowns))
        return self.basis @ (self.moments(shifted).imag / 1e-30)

    def good(self, unknowns):
        inside = self.points(unknowns).min() > 1e-3
        return inside and min(unknowns[:len(self.orbits)]) > 0

    def start(self, random):
        weights = random.uniform(0.2, 1, len(self.orbits))
        free = []
        for kind, count in zip(self.orbits, self.free):
            sizes = random.dirichlet(np.ones(count + 1))
            letters = sorted(set(kind))
            free += [size / kind.count(c) for size, c in zip(sizes, letters[:-1])]
        return np.array(list(weights / sum(weights)) + free)

    def solve(self, unknowns):
        """Levenberg-Marquardt; None where it ends elsewhere than at a good rule."""
        r, damping = self.residual(unknowns), 1e-2
        for _ in range(150):
            J = self.jacobian(unknowns)
            step = np.linalg.lstsq(np.vstack([J, damping * np.eye(len(unknowns))]),
                                   np.concatenate([-r, np.zeros(len(unknowns))]), rcond=None)[0]
            trial = unknowns + step
            r_trial = self.residual(trial)
            if r_trial @ r_trial < r @ r:
                unknowns, r, damping = trial, r_trial, damping * 0.2
                if r @ r < 1e-26:
                    break
            elif (damping := damping * 4) > 1e6:  # a local minimum, or as good as rounding lets it be
                break
            if not -0.2 < self.points(unknowns).min():
                return None
        if r @ r > 1e-22 or not self.good(unknowns):
            return None
        unknowns = unknowns.astype(np.longdouble)
        for _ in range(4):
            unknowns += np.linalg.lstsq(self.jacobian(unknowns.astype(float)), -self.residual(unknowns), rcond=None)[0]
        return unknowns if self.good(unknowns) else None


def find(dim, degree, counts, starts):
    system, random = System(dim, degree, counts), np.random.default_rng(7)
    for _ in range(starts):
        unknowns = system.solve(system.start(random))
        if unknowns is not None:
            return system, unknowns
    return system, None


def entry(degree, system, unknowns):
    """The rows of one rule: exactness, weight of a point as a part of the volume, pattern, free coordinates."""
    def digits(x):
        return np.format_float_positional(float(x), unique=True)

    count, at = sum(points_of[kind] for kind in system.orbits), len(system.orbits)
    rows = []
    for kind, weight, free in zip(system.orbits, unknowns, system.free):
        coordinates = ", ".join(digits(x) for x in unknowns[at:at + free])
        at += free
        rows.append(f'    {{{degree}, {digits(weight / points_of[kind])}, "{kind}", {{{coordinates}}}}},')
    rows[0] += f"  // {count} point{'' if count == 1 else 's'}"
    return "\n".join(rows)


def main():
    wanted = tuple(int(a) for a in sys.argv[1:])
    for (dim, degree), counts in rules.items():
        if wanted in ((), (dim, degree)):
            system, unknowns = find(dim, degree, counts, starts=20000)
            if unknowns is None:
                sys.exit(f"no rule found for dimension {dim}, exactness {degree}, orbits {counts}")
            print(entry(degree, system, unknowns), flush=True)


if __name__ == "__main__":
    main()
