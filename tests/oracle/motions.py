"""Decks and motions, as inputs/motions.md describes them: where the nodes of each boundary are to go."""
import math
import re
from pathlib import Path

import numpy as np

from meshes import raised, read

FUNCTIONS = {**{name: getattr(np, name) for name in "sin cos tan sinh cosh tanh exp log sqrt abs hypot".split()},
             "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "min": np.minimum,
             "max": np.maximum, "pi": math.pi, "__builtins__": {}}


def unquoted(text):
    return re.sub(r'^"(.*)"$', r"\1", text.strip())


def pieces(text, separators):
    """The parts of a text between separators outside of double quotes."""
    return [p for p in re.findall(rf'(?:"[^"]*"|[^"{separators}])+', text) if p.strip()]


class Deck:
    """A deck with what the command line adds: keys, boundaries, volumes, constants, expectations."""

    def __init__(self, path, added=()):
        self.path, self.folder = Path(path), Path(path).parent
        self.keys, self.moves, self.constants, self.expected = {}, {"boundary": {}, "volume": {}, "select": {}}, {}, []
        lines = [re.match(r'(?:"[^"]*"|[^"#])*', line)[0] for line in self.path.read_text().splitlines()]
        where = [self.folder] * len(lines) + [Path()] * len(added)
        for line, folder in zip([*lines, *added], where):
            self.add(line, folder)

    def add(self, line, folder):
        left, _, value = line.partition("=")
        word, _, name = left.strip().partition(" ")
        name, value = unquoted(name), value.strip()
        if word == "expect":
            self.expected.append(line.strip().partition(" ")[2])
        elif word == "let":
            self.constants[name] = value
        elif word in self.moves:
            self.moves[word][name] = (value, folder)
        elif word and word != "sweep":
            self.keys[word] = str(folder / unquoted(value)) if word == "mesh" else unquoted(value)

    def number(self, text, t=0.0):
        return float(self.formula(unquoted(text), {"t": t}))

    def formula(self, text, variables):
        def table(match):
            rows = [row for row in map(numbers, open(self.folder / match[1])) if row]
            return repr(float(np.interp(variables["t"], *np.array(rows).T)))
        known = dict(variables)
        for name, value in self.constants.items():
            known[name] = eval(unquoted(value).replace("^", "**"), {**FUNCTIONS, **known})
        return eval(re.sub(r"table\(([^)]*)\)", table, text).replace("^", "**"), {**FUNCTIONS, **known})

    def value(self, key, otherwise):
        return self.keys.get(key, otherwise)


def numbers(line):
    try:
        return [float(word) for word in line.split("#")[0].replace(",", " ").split()]
    except ValueError:
        return None  # a heading


def turned(d, axis, degrees):
    """Rodrigues' formula; degrees: one angle, or one for each point."""
    u, angle = np.array(axis) / np.linalg.norm(axis), np.radians(degrees)
    s, c = np.sin(angle), np.cos(angle)
    if np.ndim(degrees) == 0 and degrees % 90 == 0:  # quarters of a turn are exact
        s, c = round(float(s)), round(float(c))
    s, c = np.reshape(s, (-1, 1)), np.reshape(c, (-1, 1))
    return d * c + np.cross(u, d) * s + u * (d @ u)[:, None] * (1 - c)


def stepped(deck, step, x, dim, t):
    """One step but file and mesh, of points x 3."""
    word = pieces(step, r"\s")
    name, arguments, options, part = word[0], [], {}, None
    for w in word[1:]:
        if w in ("axis", "about"):
            part = options[w] = []
        else:
            (arguments if part is None else part).append(w)
    if name == "expression":
        coordinates = {"x": x[:, 0], "y": x[:, 1], "z": x[:, 2], "t": t}
        new = [deck.formula(unquoted(a), coordinates) + 0 * x[:, 0] for a in arguments]
        return np.stack([*new, *x.T[len(new):]], axis=1)
    if name in ("fixed", "slide", "free"):
        return x
    a = [deck.number(w, t) for w in arguments]
    centre = np.zeros(3)
    about = [deck.number(w, t) for w in options.get("about", [])]
    centre[:len(about)] = about
    axis = [deck.number(w, t) for w in options.get("axis", ["0", "0", "1"])]
    if name == "translate":
        return x + np.array([*a, 0, 0][:3])
    if name == "rotate":
        return centre + turned(x - centre, axis, a[0])
    if name == "twist":
        return centre + turned(x - centre, axis, a[0] * ((x - centre) @ axis) / np.linalg.norm(axis))
    if name == "scale":
        return centre + (x - centre) * np.array((a * 3)[:3] if len(a) < 3 and len(a) != 2 else [*a, 1][:3])
    if name in ("circle", "sphere", "cylinder"):
        centre[:dim] = a[:dim]
        d, along = x - centre, 0
        if name == "cylinder":
            u = np.array(a[3:6]) / np.linalg.norm(a[3:6])
            along = (d @ u)[:, None] * u
        radial = d - along
        return centre + along + a[-1] * radial / np.linalg.norm(radial, axis=1)[:, None]
    raise ValueError(f"the step {step} is not known here")


class Moved:
    """Where a motion takes the nodes of the result. kind: per node "moves", "slides" or "free"; is_fixed: nodes are to
    stay to the last bit; x: where to; surface: where the nodes of the file are before they slide."""

    def __init__(self, deck, text, folder, mesh, result, came, t=0.0, frame=0):
        steps = [step.strip() for step in pieces(text, ";")]
        first, last = pieces(steps[0], r"\s"), pieces(steps[-1], r"\s")[0]
        self.along = "along" in pieces(steps[-1], r"\s")
        hold = {"slide": "slides", "free": "free"}.get(last, "moves")
        self.kind = np.full(len(result.ids), hold, object)
        self.is_fixed = all(step == "fixed" for step in steps)
        x, self.surface = came.copy(), mesh.x.copy()
        if first[0] in ("file", "mesh"):
            path = folder / (unquoted(first[1]) % frame if "%" in first[1] else unquoted(first[1]))
            if first[0] == "mesh":
                other = read(path)
                x = raised(other, other.x, result, set(mesh.ids.tolist()))
            else:
                rows = np.array([row for row in map(numbers, open(path)) if row])
                at = {node: k for k, node in enumerate(mesh.ids.tolist())}
                to = mesh.x.copy()
                which = [at[int(node)] for node in rows[:, 0]]
                by = np.zeros((len(rows), 3))
                by[:, :rows.shape[1] - 1] = rows[:, 1:]
                listed = np.zeros((len(mesh.ids), 1))
                listed[which] = 1
                to[which] = to[which] + by if "displacement" in first else by
                x, told = raised(mesh, to, result), raised(mesh, listed, result)[:, 0]
                if "else" in first:
                    rest = first[first.index("else") + 1]
                    left = ~(np.abs(told - 1) < 1e-9)
                    x[left] = came[left]
                    self.kind[left] = {"slide": "slides", "free": "free", "fixed": "moves"}[rest]
            steps = steps[1:]
        for step in steps:
            x, self.surface = (stepped(deck, step, y, mesh.dim, t) for y in (x, self.surface))
        self.x = x
