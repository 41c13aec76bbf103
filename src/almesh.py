"""A mesh follows its boundary, and no element is ever inverted: almesh for Python.

    import almesh

    m = almesh.read("wing.msh")                            # or almesh.from_arrays(x, cells, boundaries)
    m.boundary["wall"].rotate(10, about=(0.25, 0))
    m.boundary["rest"].fix()
    r = m.move()                                           # raises almesh.NotConverged, almesh.NotCertified
    print(r.certified, r.relative_quality, m.x)            # m.x: nodes x dim
    m.save("out.msh")

A motion in time is a loop; each mesh starts from those before:

    for t in (0.1, 0.2, 0.3):
        m.boundary["wall"].move_to(positions(t))
        m.frame(t)

The same input gives the same bits as the program `almesh`, whose settings, motions, quantities and sentences these
are: keys(), motions(), quantities(). Nodes, elements and faces are counted from 0, coordinates and the unit of length
are the caller's. Arrays are numpy's where it is installed, else memoryviews of the same shape (`.tolist()` of them is a
list of lists). Every array that is returned is a copy.

While a mesh is computed other threads of Python run. Ctrl-C ends a run and leaves its last valid mesh. Meshes are
independent; one of them is used by one thread at a time. Needs libalmesh.so, which it finds beside itself, where
ALMESH_LIBRARY says, in the folder build/ of the sources, or where the system has it. Standard library only.
"""
from __future__ import annotations

import array
import ctypes as c
import ctypes.util
import os
import signal
import threading
from pathlib import Path
from typing import Any, Callable, Iterable, Iterator, Mapping, NamedTuple, Sequence, Union

try:
    import numpy as _np
except ImportError:
    _np = None

__all__ = ["Boundary", "Cancelled", "Cells", "Error", "ExpectationFailed", "InputError", "Mesh", "NotCertified",
           "NotConverged", "Progress", "Result", "UsageError", "Verdict", "from_arrays", "keys", "motions", "quantities",
           "read", "read_deck", "version"]

Numbers = Union[Sequence[float], Sequence[Sequence[float]], Any]  # an array, or nested lists, of nodes x dim numbers


# ---- Errors

class Error(RuntimeError):
    """What the library refuses, or why a run has no good mesh; the text says what, where and what to do."""
    code = 21


class UsageError(Error, ValueError):
    """A setting, a name, a size or a number is wrong; or a mesh is used out of order or by two threads."""
    code = 1


class InputError(Error):
    """A file, a mesh or a target is wrong."""
    code = 2


class _Ended(Error):
    """A run ended without a good mesh; `result` has what it ended with, and so has the mesh."""
    result: "Result"


class NotConverged(_Ended):
    """The run did not converge: result.status says why."""
    code = 3


class NotCertified(_Ended):
    """The mesh is not certified valid and injective."""
    code = 4


class ExpectationFailed(_Ended):
    """The mesh is certified, but a line `expect` of the deck does not hold."""
    code = 5


class Cancelled(_Ended):
    """The callback has ended the run; the mesh has the last valid positions."""
    code = 16


_ERRORS = {kind.code: kind
           for kind in (UsageError, InputError, NotConverged, NotCertified, ExpectationFailed, Cancelled)}
_ERRORS.update({17: UsageError, 18: UsageError, 19: UsageError})


# ---- The library

class _Block(c.Structure):
    _fields_ = [("type", c.c_int), ("count", c.c_int), ("nodes", c.POINTER(c.c_int)), ("group", c.c_char_p)]


class _Cells(c.Structure):
    _fields_ = [("count", c.c_int), ("type", c.POINTER(c.c_int)), ("offset", c.POINTER(c.c_int)),
                ("node", c.POINTER(c.c_int))]


class _Sizes(c.Structure):
    _fields_ = [(name, c.c_int) for name in ("dim", "degree", "nodes", "elements", "boundaries", "volumes")]


class _Progress(c.Structure):
    _fields_ = [("iteration", c.c_int), ("newton_step", c.c_int), ("energy", c.c_double), ("gradient_norm", c.c_double),
                ("step_length", c.c_double), ("constraint_norm", c.c_double)]


_Callback = c.CFUNCTYPE(c.c_int, c.c_void_p, c.POINTER(_Progress))
_text, _mesh, _doubles, _ints, _ids = c.c_char_p, c.c_void_p, c.POINTER(c.c_double), c.POINTER(c.c_int), \
    c.POINTER(c.c_longlong)
_out = c.POINTER
_DECLARED = {  # of almesh.h: results, then arguments
    "version": (_text,), "error": (_text,), "error_code": (c.c_int,),
    "key": (c.c_int, c.c_int, _out(_text), _out(_text), _out(_text), _out(_text)),
    "motion": (c.c_int, c.c_int, _out(_text), _out(_text)), "quantity": (c.c_int, c.c_int, _out(_text), _out(_text)),
    "read": (c.c_int, _text, _out(_mesh)), "read_deck": (c.c_int, _text, _out(_mesh)),
    "from_arrays": (c.c_int, c.c_int, c.c_int, c.c_int, _doubles, c.c_int, _out(_Block), _out(_mesh)),
    "free": (c.c_int, _mesh), "set_deck": (c.c_int, _mesh, _text), "set": (c.c_int, _mesh, _text, _text),
    "get": (_text, _mesh, _text), "set_boundary": (c.c_int, _mesh, _text, _text),
    "set_volume": (c.c_int, _mesh, _text, _text),
    "set_boundary_positions": (c.c_int, _mesh, _text, _doubles, c.c_size_t),
    "on_progress": (c.c_int, _mesh, _Callback, c.c_void_p), "move": (c.c_int, _mesh),
    "frame": (c.c_int, _mesh, c.c_double), "improve": (c.c_int, _mesh),
    "certify": (c.c_int, _mesh, _doubles, c.c_size_t),
    "adjoint": (c.c_int, _mesh, _doubles, c.c_size_t, _doubles),
    "tangent": (c.c_int, _mesh, _doubles, c.c_size_t, _doubles),
    "sizes_of": (c.c_int, _mesh, _out(_Sizes)), "positions": (_doubles, _mesh), "first_positions": (_doubles, _mesh),
    "node_ids": (_ids, _mesh), "element_ids": (_ids, _mesh), "elements": (c.c_int, _mesh, _out(_Cells)),
    "boundary": (c.c_int, _mesh, c.c_int, _out(_text), _out(_Cells)),
    "volume": (c.c_int, _mesh, c.c_int, _out(_text), _out(_ints), _ints),
    "element_values": (_doubles, _mesh, _text), "number": (c.c_int, _mesh, _text, _doubles),
    "word": (_text, _mesh, _text), "multipliers": (_doubles, _mesh), "notes": (_text, _mesh),
    "save": (c.c_int, _mesh, _text),
    "save_proof": (c.c_int, _mesh, _text, _text)}


def _library() -> Any:
    here, name = Path(__file__).resolve().parent, "libalmesh.so.0"
    named = os.environ.get("ALMESH_LIBRARY")
    places = [named] if named else [here / name, here / "almesh.libs" / name,
                                    *(folder / "lib" / name for folder in list(here.parents)[1:3]),
                                    *sorted(here.parent.glob("build/libalmesh.so.0*")),
                                    c.util.find_library("almesh"), name]
    failed = []
    for place in filter(None, places):
        try:
            library = c.CDLL(str(place))
            break
        except OSError as error:
            failed.append(str(error))
    else:
        raise ImportError("libalmesh is not found: `make lib` builds it, and ALMESH_LIBRARY may name it\n  "
                          + "\n  ".join(failed))
    for function, (result, *arguments) in _DECLARED.items():
        of = getattr(library, "almesh_" + function)
        of.restype, of.argtypes = result, arguments
    return library


_lib = _library()
_NAMES = ("line", "triangle", "quadrilateral", "tetrahedron", "hexahedron", "prism", "pyramid")
_NODES = (lambda m: m, lambda m: m * (m + 1) // 2, lambda m: m * m, lambda m: m * (m + 1) * (m + 2) // 6,
          lambda m: m ** 3, lambda m: m * m * (m + 1) // 2, lambda m: m * (m + 1) * (2 * m + 1) // 6)  # m: degree + 1


def _raise(code: int) -> None:
    raise _ERRORS.get(code, Error)(_lib.almesh_error().decode("utf-8", "replace"))


def _check(code: int) -> None:
    if code:
        _raise(code)


def _bytes(text: Any) -> bytes:
    data = os.fsencode(text) if isinstance(text, (str, os.PathLike)) else text
    if not isinstance(data, bytes):
        raise UsageError(f"a text is due, not {text!r}")
    if b"\0" in data:
        raise UsageError(f"{text!r} has a character of code 0")
    return data


def _shaped(pointer: Any, rows: int, columns: int, kind: str) -> Any:
    """A copy of numbers of the library, rows x columns; columns 0: rows."""
    if not pointer:
        _raise(_lib.almesh_error_code())
    shape = (rows, columns) if columns else (rows,)
    count = rows * max(columns, 1)
    data = c.string_at(pointer, count * array.array(kind).itemsize) if count else b""
    if _np:
        kinds = {"d": _np.float64, "i": _np.int32, "q": _np.int64}
        return _np.frombuffer(data, dtype=kinds[kind]).reshape(shape).copy()
    view = memoryview(bytearray(data))
    return view.cast(kind, shape) if columns and count else view.cast(kind)


def _given(numbers: Numbers, kind: str = "d") -> tuple[Any, int]:
    """An array of C with these numbers, in rows one after the other, and their count."""
    of_c = {"d": c.c_double, "i": c.c_int}[kind]
    if _np:
        try:
            flat = _np.asarray(numbers).ravel()
            flat = flat.astype(_np.float64 if kind == "d" else _np.int64, casting="same_kind") if flat.size else flat
        except (TypeError, ValueError, OverflowError) as error:
            raise UsageError(f"an array of {'numbers' if kind == 'd' else 'indices'} is due: {error}") from error
        if kind == "i" and flat.size and abs(flat).max() >= 2**31:
            raise UsageError("a node's index is beyond the range of int")
        flat = _np.ascontiguousarray(flat, dtype=_np.float64 if kind == "d" else _np.int32)
        values = (of_c * flat.size).from_buffer_copy(flat.tobytes()) if flat.size else (of_c * 1)()
        return values, flat.size
    nested = numbers.tolist() if hasattr(numbers, "tolist") else list(numbers)
    flat = [v for row in nested for v in row] if nested and hasattr(nested[0], "__iter__") else nested
    try:
        return (of_c * max(len(flat), 1))(*flat), len(flat)
    except TypeError as error:
        raise UsageError(f"an array of {'numbers' if kind == 'd' else 'indices'} is due: {error}") from error


def _table(function: Any, columns: int) -> Iterator[list[str]]:
    for index in range(10**6):
        texts = [c.c_char_p() for _ in range(columns)]
        if function(index, *map(c.byref, texts)):
            return
        yield [(text.value or b"").decode() for text in texts]


class Key(NamedTuple):
    """A setting: its legal values and its default, as texts, and its meaning."""
    legal: str
    default: str
    meaning: str


def keys() -> dict[str, Key]:
    """The settings of a run: name -> legal values, default, meaning."""
    return {name: Key(*rest) for name, *rest in _table(_lib.almesh_key, 4)}


def motions() -> dict[str, str]:
    """The forms of a motion, "rotate ANGLE ..." -> meaning; several are separated by `;`."""
    return dict(_table(_lib.almesh_motion, 2))


def quantities() -> dict[str, str]:
    """The quantities that a Result has: name -> meaning."""
    return dict(_table(_lib.almesh_quantity, 2))


def version() -> str:
    """Version of the library, "0.2.0"."""
    return _lib.almesh_version().decode()


# ---- Meshes

class Cells(NamedTuple):
    """Cells of one type ("triangle", ...): indices, and nodes (count x nodes of a cell, in the order of Gmsh)."""
    type: str
    index: Any
    nodes: Any


class Progress(NamedTuple):
    """After every Newton step and, with newton_step = 0, every iteration of the augmented Lagrangian."""
    iteration: int
    newton_step: int
    energy: float
    gradient_norm: float
    step_length: float      # of a Newton step; else 1
    constraint_norm: float  # |c_D| of an iteration; else 0


class Verdict(NamedTuple):
    """certified: every element is proved valid, and that no two overlap; else the reason why not. It is true if so."""
    certified: bool
    reason: str

    def __bool__(self) -> bool:
        return self.certified


class Result(Mapping):
    """The quantities of a run: r["relative_quality"] or r.relative_quality, numbers or words; see quantities()."""

    def __init__(self, code: int, values: dict[str, Any]):
        self.code, self._values = code, values

    certified = property(lambda self: self.code in (0, 5) or
                         self._values.get("certified_injective") == "yes", doc="valid and injective, proved")
    status: str = property(lambda self: self._values["status"], doc="why the run ended: converged, stalled, ...")

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["_values"][name]
        except KeyError:
            raise AttributeError(f"a result has no quantity {name!r}: almesh.quantities() lists them") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._values]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"<almesh.Result: {self.status}, {'certified' if self.certified else 'not certified'}>"


def _words(*numbers: Any) -> str:
    return " ".join(repr(float(v)) for v in numbers)


class Boundary:
    """A boundary of a mesh, or a volume, and what holds its nodes. Motions of one object go on from each other:
    m.boundary["wall"].rotate(10).translate(1, 0) turns it, and then shifts it. m.boundary["wall"] begins anew, and so
    do fix(), free(), slide(), move_to(); a run moves the mesh as it was read."""

    def __init__(self, mesh: "Mesh", name: str, index: Union[int, None], is_volume: bool = False):
        self._mesh, self.name, self._index, self._is_volume, self._steps = mesh, name, index, is_volume, []

    def __repr__(self) -> str:
        return f"<almesh.Boundary {self.name!r}: {self.motion or 'no motion'}>"

    def _set(self, steps: list[str]) -> "Boundary":
        text = "; ".join(steps)
        function = _lib.almesh_set_volume if self._is_volume else _lib.almesh_set_boundary
        _check(function(self._mesh._handle, _bytes(self.name), _bytes(text) if text else None))
        self._steps = steps
        self._mesh._motions[self._is_volume, self.name] = text
        return self

    @property
    def motion(self) -> str:
        """What holds it, as a text of a deck that was set here: "rotate 10 about 0.25 0"; see motions(). None, or "":
        nothing."""
        return self._mesh._motions.get((self._is_volume, self.name), "")

    @motion.setter
    def motion(self, text: Union[str, None]) -> None:
        self._set([text] if text else [])

    def fix(self) -> "Boundary":
        """It stays."""
        return self._set(["fixed"])

    def free(self) -> "Boundary":
        """It goes where the mesh is best."""
        return self._set(["free"])

    def slide(self, along: str = "") -> "Boundary":
        """Its nodes slide along its surface; along: a quadric ("sphere 0 0 0 1") or a file (STL, OBJ, a mesh)."""
        return self._set([f"slide along {along}" if along else "slide"])

    def translate(self, *d: float) -> "Boundary":
        """Shifts it by d, one number for each dimension."""
        return self._set([*self._steps, "translate " + _words(*d)])

    def rotate(self, degrees: float, about: Sequence[float] = (), axis: Sequence[float] = ()) -> "Boundary":
        """Turns it, right-handed; about: a point, by default the origin; axis: in 3D."""
        return self._set([*self._steps, f"rotate {_words(degrees)}" + (f" axis {_words(*axis)}" if len(axis) else "") +
                          (f" about {_words(*about)}" if len(about) else "")])

    def scale(self, *factors: float, about: Sequence[float] = ()) -> "Boundary":
        """Scales it by one factor, or one per axis."""
        return self._set([*self._steps,
                          f"scale {_words(*factors)}" + (f" about {_words(*about)}" if len(about) else "")])

    def expression(self, *formulas: str) -> "Boundary":
        """Moves each point to formulas of x, y, z and t, one for each dimension."""
        return self._set([*self._steps, "expression " + " ".join(f'"{formula}"' for formula in formulas)])

    def move_to(self, x: Numbers) -> "Boundary":
        """Its nodes go to these positions: of all nodes of the mesh as it was read (nodes x dim), of which those of the
        boundary count; or of its own nodes alone, in the order of Boundary.nodes as it was read."""
        mesh, dim, nodes = self._mesh, self._mesh.dim, self._mesh._read_nodes
        values, count = _given(x)
        own = [node for node in self.nodes.tolist() if node < nodes]
        if count == len(own) * dim and count != nodes * dim:
            every, count = (c.c_double * (nodes * dim))(*_given(mesh.first_x)[0][:nodes * dim]), nodes * dim
            for k, node in enumerate(own):
                every[dim * node:dim * (node + 1)] = values[dim * k:dim * (k + 1)]
            values = every
        _check(_lib.almesh_set_boundary_positions(mesh._handle, _bytes(self.name), values, count))
        self._steps = []
        mesh._motions[False, self.name] = "positions"
        return self

    @property
    def faces(self) -> list[Cells]:
        """Its faces, oriented outward (of a volume: its elements), by type."""
        if self._index is None:
            raise UsageError(f"{self.name} stands for several boundaries")
        if self._is_volume:
            chosen = set(self.elements.tolist())
            return [Cells(of.type, *_rows(of, [k for k, e in enumerate(of.index.tolist()) if e in chosen]))
                    for of in self._mesh.elements]
        cells = _Cells()
        _check(_lib.almesh_boundary(self._mesh._handle, self._index, None, c.byref(cells)))
        return _by_type(cells)

    @property
    def elements(self) -> Any:
        """Of a volume: indices of its elements."""
        pointer, count = _ints(), c.c_int()
        _check(_lib.almesh_volume(self._mesh._handle, self._index, None, c.byref(pointer), c.byref(count)))
        return _shaped(pointer, count.value, 0, "i")

    @property
    def nodes(self) -> Any:
        """Indices of its nodes, ascending."""
        found = sorted({node for cells in self.faces for row in cells.nodes.tolist() for node in row})
        return _np.array(found, dtype=_np.int32) if _np else memoryview(array.array("i", found))


def _rows(of: Cells, rows: list[int]) -> tuple[Any, Any]:
    if _np:
        return of.index[rows], of.nodes[rows]
    width = of.nodes.shape[1]
    nodes = array.array("i", [v for k in rows for v in of.nodes.tolist()[k]])
    index = memoryview(array.array("i", [of.index[k] for k in rows]))
    return index, memoryview(nodes).cast("B").cast("i", (len(rows), width)) if rows else memoryview(nodes)


def _by_type(cells: _Cells) -> list[Cells]:
    types, offset = cells.type[:cells.count], cells.offset[:cells.count + 1]
    node = array.array("i", cells.node[:offset[-1]])
    result = []
    for kind in sorted(set(types)):
        index = [k for k in range(cells.count) if types[k] == kind]
        flat = array.array("i", [v for k in index for v in node[offset[k]:offset[k + 1]]])
        width = offset[index[0] + 1] - offset[index[0]]
        if _np:
            nodes = _np.array(flat, _np.int32).reshape(-1, width)
            result.append(Cells(_NAMES[kind], _np.array(index, _np.int32), nodes))
        else:
            nodes = memoryview(flat).cast("B").cast("i", (len(index), width))
            result.append(Cells(_NAMES[kind], memoryview(array.array("i", index)), nodes))
    return result


class _Named(Mapping):
    """The boundaries, or volumes, of a mesh by name; of boundaries also "rest" (all without a motion) and "all"."""

    def __init__(self, mesh: "Mesh", names: list[str], is_volume: bool):
        self._mesh, self._of, self._is_volume = mesh, {name: k for k, name in enumerate(names)}, is_volume
        self._groups = () if is_volume else ("rest", "all")

    def __getitem__(self, name: str) -> Boundary:
        if name not in self:
            raise UsageError(f"the mesh has no {name!r}; it has {', '.join(map(repr, self._of)) or 'none'}")
        return Boundary(self._mesh, name, self._of.get(name), self._is_volume)

    def __iter__(self) -> Iterator[str]:
        return iter(self._of)

    def __len__(self) -> int:
        return len(self._of)

    def __contains__(self, name: object) -> bool:
        return name in self._of or name in self._groups


class Mesh:
    """A mesh with its settings and, after a run, its results. See read(), read_deck(), from_arrays()."""

    def __init__(self, handle: c.c_void_p):
        self._handle, self._sizes, self._motions, self.result = handle, None, {}, None
        sizes = self._size()
        self._read_nodes = sizes.nodes
        self._boundaries = self._names(_lib.almesh_boundary, sizes.boundaries, 1)
        self._volumes = self._names(_lib.almesh_volume, sizes.volumes, 2)

    def _names(self, function: Any, count: int, others: int) -> list[str]:
        names = []
        for index in range(count):
            name = c.c_char_p()
            _check(function(self._handle, index, c.byref(name), *[None] * others))
            names.append(os.fsdecode(name.value))
        return names

    @property
    def boundary(self) -> Mapping[str, Boundary]:
        """The boundaries by name; "rest": all without a motion, "all": also those inside."""
        return _Named(self, self._boundaries, False)

    @property
    def volume(self) -> Mapping[str, Boundary]:
        """The named groups of elements."""
        return _Named(self, self._volumes, True)

    def close(self) -> None:
        """Frees the memory now; any other call is refused then."""
        if self._handle:
            _check(_lib.almesh_free(self._handle))
            self._handle = None

    def __enter__(self) -> "Mesh":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None) and _lib:
            _lib.almesh_free(self._handle)

    def __repr__(self) -> str:
        return f"<almesh.Mesh: {self.node_count} nodes, {self.element_count} elements, boundaries " + \
            ", ".join(self._boundaries) + ">"

    # ---- Settings

    def set(self, key: str, value: Any) -> None:
        """A setting of the next runs: m.set("omega_star", 1e-9). None takes it back. See keys()."""
        if isinstance(value, bool):
            value = "yes" if value else "no"
        text = None if value is None else _bytes(repr(value) if isinstance(value, float) else str(value))
        _check(_lib.almesh_set(self._handle, _bytes(key), text))

    def get(self, key: str) -> str:
        """The value of a setting, or its default, as a text."""
        return self._text(_lib.almesh_get(self._handle, _bytes(key)))

    def set_deck(self, text: str) -> None:
        """All settings anew, from the text of a deck."""
        _check(_lib.almesh_set_deck(self._handle, _bytes(text)))

    # ---- Runs

    def move(self, progress: Union[Callable[[Progress], Any], None] = None, **settings: Any) -> Result:
        """Moves the mesh, as it was read, to where its boundaries are told to go. progress(p) is called after every
        step; if it returns something true but None, the run ends as Cancelled. settings: see set()."""
        return self._run(lambda: _lib.almesh_move(self._handle), progress, settings)

    def frame(self, t: float, progress: Union[Callable[[Progress], Any], None] = None, **settings: Any) -> Result:
        """The same at the time t of a motion in time, from the meshes of frames before."""
        return self._run(lambda: _lib.almesh_frame(self._handle, float(t)), progress, settings)

    def frames(self, times: Iterable[float]) -> Iterator[Result]:
        """frame(t) for each of the times: `for r in m.frames(times): use(m.x)`."""
        return (self.frame(t) for t in times)

    def improve(self, progress: Union[Callable[[Progress], Any], None] = None, **settings: Any) -> Result:
        """Makes the mesh, as it was read, valid and its worst elements better."""
        return self._run(lambda: _lib.almesh_improve(self._handle), progress, settings)

    def certify(self, x: Union[Numbers, None] = None) -> Verdict:
        """Whether every element is proved valid at the positions x (those of the mesh) and no two overlap."""
        values, count = (None, 0) if x is None else _given(x)
        code = _lib.almesh_certify(self._handle, values, count)
        if code not in (0, NotCertified.code):
            _raise(code)
        return Verdict(code == 0, "" if code == 0 else _lib.almesh_error().decode("utf-8", "replace"))

    def adjoint(self, dJ_dx: Numbers) -> Any:
        """dJ/dg, nodes x dim: the derivative of J(x) by the position of each boundary node; zero elsewhere. At the mesh
        of the last run, whose positions are first made stationary to rounding."""
        return self._derivative(_lib.almesh_adjoint, dJ_dx)

    def tangent(self, dg: Numbers) -> Any:
        """dx, nodes x dim: the derivative of all positions along a velocity dg (nodes x dim) of the boundary nodes."""
        return self._derivative(_lib.almesh_tangent, dg)

    def _derivative(self, function: Any, given: Numbers) -> Any:
        values, count = _given(given)
        result = (c.c_double * max(count, 1))()
        self._interruptible(lambda: function(self._handle, values, count, result), None)
        return _shaped(c.cast(result, _doubles), self.node_count, self.dim, "d")

    def _run(self, call: Callable[[], int], progress: Any, settings: dict[str, Any]) -> Result:
        for key, value in settings.items():
            self.set(key, value)
        self._sizes = None
        return self._interruptible(call, progress)

    def _interruptible(self, call: Callable[[], int], progress: Any) -> Any:
        """Calls; Ctrl-C, and what `progress` throws, end the run and are passed on when it has ended."""
        thrown, pressed = [], []

        def tell(_: Any, now: Any) -> int:
            if pressed or thrown:
                return 1
            try:
                of = now.contents
                return int(bool(progress and progress(Progress(*(getattr(of, name) for name, _ in of._fields_)))))
            except BaseException as error:  # it cannot pass through C
                thrown.append(error)
                return 1

        callback, handler = _Callback(tell), None
        _check(_lib.almesh_on_progress(self._handle, callback, None))
        if threading.current_thread() is threading.main_thread():
            handler = signal.getsignal(signal.SIGINT)
            if callable(handler):
                signal.signal(signal.SIGINT, lambda *of: pressed.append(of))
        try:
            code = call()
        finally:
            if callable(handler):
                signal.signal(signal.SIGINT, handler)
            _lib.almesh_on_progress(self._handle, _Callback(), None)
        return self._ended(code, _lib.almesh_error().decode("utf-8", "replace"), thrown,
                           lambda: [handler(*of) for of in pressed])

    def _ended(self, code: int, sentence: str, thrown: list[BaseException], press: Callable[[], Any]) -> Any:
        has_mesh = code in (0, *(kind.code for kind in _Ended.__subclasses__()))
        if has_mesh:
            self.result = Result(code, self._quantities())
        press()
        if thrown:
            raise thrown[0]
        if code:
            error = _ERRORS.get(code, Error)(sentence)
            if has_mesh:
                error.result = self.result
            raise error
        return self.result

    def _quantities(self) -> dict[str, Any]:
        values = {}
        for name in quantities():
            text = _lib.almesh_word(self._handle, name.encode())
            if text is None:
                continue
            number = c.c_double()
            is_number = _lib.almesh_number(self._handle, name.encode(), c.byref(number)) == 0
            word = text.decode("utf-8", "replace")
            values[name] = (int(word) if word.lstrip("-").isdigit() else number.value) if is_number else word
        return values

    # ---- The mesh as it is

    def _size(self) -> _Sizes:
        if self._sizes is None:
            sizes = _Sizes()
            _check(_lib.almesh_sizes_of(self._handle, c.byref(sizes)))
            self._sizes = sizes
        return self._sizes

    def _text(self, text: Union[bytes, None]) -> str:
        if text is None:
            _raise(_lib.almesh_error_code())
        return text.decode("utf-8", "replace")

    dim = property(lambda self: self._size().dim, doc="2 or 3")
    degree = property(lambda self: self._size().degree, doc="of the elements, 1 to 7")
    node_count = property(lambda self: self._size().nodes, doc="of the mesh as it is")
    element_count = property(lambda self: self._size().elements, doc="of the mesh as it is")

    @property
    def x(self) -> Any:
        """Positions, nodes x dim: of the last run, or as they were read. A copy."""
        return _shaped(_lib.almesh_positions(self._handle), self.node_count, self.dim, "d")

    @property
    def first_x(self) -> Any:
        """Positions as they were read."""
        return _shaped(_lib.almesh_first_positions(self._handle), self.node_count, self.dim, "d")

    @property
    def multipliers(self) -> Any:
        """Of the boundary condition of the last move(): nodes x dim, zero off the boundary."""
        return _shaped(_lib.almesh_multipliers(self._handle), self.node_count, self.dim, "d")

    @property
    def node_ids(self) -> Any:
        """Ids of all nodes in the file; of arrays the index + 1."""
        return _shaped(_lib.almesh_node_ids(self._handle), self.node_count, 0, "q")

    @property
    def element_ids(self) -> Any:
        """Ids of all elements in the file; of arrays the index + 1."""
        return _shaped(_lib.almesh_element_ids(self._handle), self.element_count, 0, "q")

    @property
    def elements(self) -> list[Cells]:
        """The elements, by type."""
        cells = _Cells()
        _check(_lib.almesh_elements(self._handle, c.byref(cells)))
        return _by_type(cells)

    def quality(self, name: str = "scaled_jacobian") -> Any:
        """A number of each element: "scaled_jacobian" (least at a corner), "quality" (1/eta against the regular cell),
        "certified_bound" (below det J over that of the straight element), after a run "distortion" (largest eta)."""
        return _shaped(_lib.almesh_element_values(self._handle, _bytes(name)), self.element_count, 0, "d")

    @property
    def notes(self) -> str:
        """What the program would have told of the mesh and of the last run besides, a line each."""
        return self._text(_lib.almesh_notes(self._handle))

    def save(self, path: Union[str, os.PathLike], proof: Union[str, os.PathLike, None] = None) -> None:
        """Writes the mesh as it is. One of a file in that file's format: the file with other coordinates; else .msh or
        .su2. proof: a file for a proof that the mesh in the file is valid and covers no point twice, which others can
        check (outputs/README.md); NotCertified where there is none."""
        if proof is None: _check(_lib.almesh_save(self._handle, _bytes(path)))
        else: _check(_lib.almesh_save_proof(self._handle, _bytes(path), _bytes(proof)))


def _made(function: Any, *arguments: Any) -> Mesh:
    handle = c.c_void_p()
    _check(function(*arguments, c.byref(handle)))
    return Mesh(handle)


def read(path: Union[str, os.PathLike], **settings: Any) -> Mesh:
    """The mesh of a file: Gmsh MSH, SU2, Abaqus, VTU, VTK. settings: see Mesh.set()."""
    mesh = _made(_lib.almesh_read, _bytes(path))
    for key, value in settings.items():
        mesh.set(key, value)
    return mesh


def read_deck(path: Union[str, os.PathLike]) -> Mesh:
    """The mesh of a deck, with all its settings."""
    return _made(_lib.almesh_read_deck, _bytes(path))


def from_arrays(x: Numbers, cells: Mapping[str, Any], boundaries: Mapping[str, Mapping[str, Any]] = {},
                degree: int = 1, volumes: Mapping[str, Mapping[str, Any]] = {}) -> Mesh:
    """A mesh from arrays. x: nodes x dim. cells: {"triangle": count x nodes, ...}, nodes of a cell of the degree in the
    order of Gmsh. boundaries: {"wall": {"line": count x 2}}; outer faces in none are "untagged", all are "boundary" if
    there is none. volumes: elements with a name, {"rotor": {"triangle": ...}}, which are in `cells` no more."""
    rows = x.tolist() if hasattr(x, "tolist") else [list(row) if hasattr(row, "__iter__") else row for row in x]
    if degree not in range(1, 8):
        raise UsageError(f"degree = {degree}: degrees are 1 to 7")
    if not rows or not hasattr(rows[0], "__len__") or len({len(row) for row in rows}) != 1:
        raise UsageError("x: an array of nodes x dim is due")
    blocks, kept = [], []
    for group, of_type in [(None, cells), *volumes.items(), *boundaries.items()]:
        for kind, nodes in of_type.items():
            if kind not in _NAMES:
                raise UsageError(f"{kind!r} is no type of cells: {', '.join(_NAMES)}")
            values, count = _given(nodes, "i")
            width = _NODES[_NAMES.index(kind)](degree + 1)
            shape = getattr(nodes, "shape", None) or \
                (len(nodes), *(len(row) for row in nodes[:1] if hasattr(row, "__len__")))
            if count % width or (count and len(shape) == 2 and shape[1] != width):
                raise UsageError(f"{kind}s of degree {degree} have {width} nodes each, and {count} are given")
            blocks.append(_Block(_NAMES.index(kind), count // width, values, None if group is None else _bytes(group)))
            kept.append(values)
    values, count = _given(rows)
    return _made(_lib.almesh_from_arrays, len(rows[0]), degree, len(rows), values, len(blocks),
                 (_Block * max(len(blocks), 1))(*blocks))
