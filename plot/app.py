#!/usr/bin/env python3
"""One HTML file in which almesh runs in a browser: a mesh is dropped into it, moved or improved, and saved.

  plot/app.py build-wasm/almesh.js outputs/almesh.html       `make wasm` makes the first, and runs this

The page has the viewer of plot/page.py in a frame of its own. Python's standard library only, and npm once.
"""
import base64
import gzip
import json
import sys
from pathlib import Path

import page

VIEWER = page.HERE / "viewer"


def kinds():
    """page.face_kind() of faces with all their nodes, by corners, degree and the parts into which an edge is cut."""
    found = {}
    for corners, p in ((corners, p) for corners in (3, 4) for p in range(1, 8)):
        for parts in {p, max(p, 8)} if p > 1 else {1}:
            kind = page.face_kind(corners, p, len(page.vtk_file.lattice(corners, p)), 1e6 / (parts + 0.1) ** 2)
            kind["basis"] = [round(value, 9) for value in kind["basis"]]
            found[f"{corners} {p} {parts}"] = kind
    return found


def main():
    library, out = map(Path, sys.argv[1:])
    fields = {name: dict(zip(("title", "text", "worst"), page.FIELDS[name]))
              for name in ("quality", "scaled_jacobian", "certified_bound", "distortion", "element_id")}
    fields["quality"]["text"] = "the least 1/η of the element against the regular cell; no unit, 1 at best"
    given = f"const KINDS = {json.dumps(kinds())}, FIELDS = {json.dumps(fields)};\n"
    try:
        parts = page.three_files()
    except page.PageError as error:
        sys.exit(f"plot/app.py: {error}")
    parts["worker"] = (library.read_text() + given + (VIEWER / "worker.js").read_text()).encode()
    parts["viewer-page"] = page.with_scripts("", "").encode()
    packed = {name: base64.b64encode(gzip.compress(part, 9, mtime=0)).decode() for name, part in parts.items()}
    scripts = "\n".join(f'<script type="text/plain" id="{name}">{text}</script>' for name, text in packed.items())
    text = (VIEWER / "app.html").read_text().replace("<!-- parts -->", scripts)
    out.parent.mkdir(exist_ok=True)
    out.write_text(text.replace("<!-- script -->", (VIEWER / "app.js").read_text()))
    print(f"{out}: {out.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
