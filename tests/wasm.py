#!/usr/bin/env python3
"""Whether the page of `make wasm` works: in a headless Chromium a mesh is dropped into it, moved, improved and saved,
to what the program saves, but for the last bits of sin(), cbrt() and the like, which are another library's; errors are
sentences; a run is cancelled. Nothing may leave the page or fail in it.

  tests/wasm.py [--build FOLDER] [PAGE]       outputs/almesh.html where none is named

Left out, with a message, where there is no Chromium. Exit code 1 where a check failed. Standard library only.
"""
import argparse
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import verify
from page import CHROMIUM, ROOT, Browser, check, counts

LARGE = ROOT / "inputs/meshes/aircraft.msh"


def until(holds, seconds=60):
    end = time.monotonic() + seconds
    while not (found := holds()) and time.monotonic() < end:
        time.sleep(0.05)
    return found


class App(Browser):
    def settle(self):
        """Until the library has answered, and the viewer has drawn."""
        until(lambda: self.value("document.getElementById('cancel').hidden"), 300)
        time.sleep(0.2)
        until(lambda: self.value("(v => v.contentDocument?.body?.dataset.ready === 'yes' || !v.given)"
                                 "(document.getElementById('viewer'))"))

    def settle_anew(self):
        """After a mesh was given, of which nothing may be seen yet."""
        until(lambda: not self.value("document.getElementById('cancel').hidden"), 1)
        self.settle()

    def drop(self, path):
        data = {"items": [], "files": [str(path.resolve())], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.call("Input.dispatchDragEvent", type=kind, x=120, y=80, data=data)
        self.settle_anew()

    def choose(self, path):
        found = self.call("Runtime.evaluate", expression="document.getElementById('file')")["result"]["objectId"]
        self.call("DOM.setFileInputFiles", files=[str(path.resolve())], objectId=found)
        self.settle_anew()

    def motion(self, name, text):
        self.value(f"document.querySelector('#boundaries input[name={name}]').value = {text!r}")

    def viewer(self, expression):
        return self.value(f"(d => {expression})(document.getElementById('viewer').contentDocument)")

    def state(self):
        return self.text_of("state")

    def saved(self, folder, name, button="#save"):
        """The bytes of the file that `save` downloads."""
        self.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
        self.click(button)
        until((folder / name).exists, 20)
        time.sleep(0.2)
        return (folder / name).read_bytes() if (folder / name).exists() else b""


def program(arguments, *words):
    command = [ROOT / arguments.build / "almesh", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    return done.returncode, done.stdout, done.stderr


def apart(text, other):
    """The largest difference between numbers of two files; infinite where anything but numbers with a point differs."""
    words, others = text.split(), other.split()
    pairs = [pair for pair in zip(words, others) if pair[0] != pair[1]]
    if len(words) != len(others) or not all(b"." in word for pair in pairs for word in pair):
        return float("inf")
    return max((abs(float(a) - float(b)) for a, b in pairs), default=0.0)


def check_saved(app, folder, name, results, most):
    """results: the program's folder of the same run; numbers may be so far apart."""
    saved, final = app.saved(folder, name), (results / "final.msh").read_bytes()
    final = final.partition(b"$Comments")[0]  # which run has written it
    difference = apart(saved.partition(b"$Comments")[0], final)
    print(f"  {name}: numbers are within {difference:.1e} of the program's")
    check(final and difference <= most, f"{name}: {difference} from the program's")


def check_move(app, arguments, folder):
    app.drop(ROOT / "inputs/meshes/circle.msh")
    check(app.state() == "circle.msh: certified: every element is valid, no two overlap", f"read: {app.state()}")
    names = app.value("[...document.querySelectorAll('#boundaries input')].map(input => input.name).join()")
    check(names == "inner,outer", f"boundaries: {names}")
    check("1642 elements" in app.viewer("d.getElementById('about').textContent"), "the viewer's line")
    marks = app.viewer("[...d.querySelectorAll('.mark')].filter(mark => !mark.hidden).length")
    check(marks == 10, f"{marks} marks of the worst elements")
    app.motion("inner", "translate 8 0")
    app.click("#move")
    check(app.state() == "circle.msh: certified: every element is valid, no two overlap", f"moved: {app.state()}")
    progress = app.text_of("progress")
    check(progress.startswith("moving: iteration ") and progress.endswith(" s"), f"progress: {progress}")
    check(app.viewer("d.getElementById('label').textContent").startswith("moved (2 of 2): worst quality"), "the label")
    check(app.viewer("d.querySelectorAll('#table tr').length") > 20, "the table of quantities")
    deck = folder / "circle.deck"
    deck.write_text(f"mesh = {ROOT / 'inputs/meshes/circle.msh'}\nboundary inner = translate 8 0\n"
                    f"boundary outer = fixed\noutput = {folder / 'circle'}\nvtk = none\n")
    program(arguments, deck)
    check_saved(app, folder, "circle-moved.msh", folder / "circle", 1e-13)
    code, said, _ = program(arguments, "quality", folder / "circle-moved.msh")
    check(code == 0, f"the program does not certify what was saved: {said}")
    proof = app.saved(folder, "circle-moved.msh.proof", "#prove").decode()
    check(verify.verify((folder / "circle-moved.msh").read_bytes(), proof) > (0, 0), "the proof")
    app.motion("inner", "translate 8")
    app.click("#move")
    check("translate" in app.state() and "failed" in app.value("document.getElementById('state').className"),
          f"a wrong motion: {app.state()}")


def check_improve(app, arguments, folder):
    app.choose(ROOT / "inputs/meshes/square.msh")
    app.click("#improve")
    check("certified" in app.state(), f"improved: {app.state()}")
    program(arguments, "improve", "inputs/meshes/square.msh", f"output={folder / 'square'}", "vtk=none")
    check_saved(app, folder, "square-moved.msh", folder / "square", 1e-7)
    app.choose(ROOT / "inputs/meshes/kinds.msh")
    check("certified" in app.state() and app.viewer("d.getElementById('space').hidden") is False, "solids of all types")


def check_errors(app, arguments, folder):
    broken = folder / "broken.msh"
    broken.write_bytes((ROOT / "inputs/meshes/circle.msh").read_bytes()[:3000])
    app.drop(broken)
    _, _, said = program(arguments, "quality", broken)
    sentence = said.strip().removeprefix("almesh: ").replace(str(folder) + "/", "")
    check(app.state() == sentence, f"a broken mesh: `{app.state()}`, the program says `{sentence}`")
    check(app.value("document.getElementById('form').hidden"), "a broken mesh can be moved")
    check(app.viewer("d.querySelector('canvas') === null"), "a broken mesh: another one is shown")


def check_cancel(app):
    begin = time.monotonic()
    app.drop(LARGE)
    print(f"  {app.state()}: read, certified and shown in {time.monotonic() - begin:.1f} s")
    check("certified" in app.state(), f"a large mesh: {app.state()}")
    name = app.value("document.querySelector('#boundaries input').name")
    app.motion(name, "translate 0.01 0 0")
    app.value("document.getElementById('move').click()")
    seen = until(lambda: "iteration" in app.text_of("progress"), 120)
    check(seen and app.value("document.getElementById('move').disabled"), f"no progress: {app.text_of('progress')}")
    app.value("document.getElementById('cancel').click()")
    check("cancelled" in app.state(), f"after cancel: {app.state()}")
    app.settle()
    check("cancelled" in app.state() and not app.value("document.getElementById('move').disabled"), "after cancel")
    app.choose(ROOT / "inputs/meshes/circle.msh")
    check("certified" in app.state(), f"a mesh after a run that was cancelled: {app.state()}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("page", type=Path, nargs="?", default=ROOT / "outputs/almesh.html")
    arguments = parser.parse_args()
    if not CHROMIUM:
        sys.exit("there is no Chromium here (Debian: chromium)")
    signal.alarm(900)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        app = App(folder / "chromium")
        app.open(arguments.page)
        check_move(app, arguments, folder)
        check_improve(app, arguments, folder)
        check_errors(app, arguments, folder)
        check_cancel(app)
        for trouble in app.troubles():
            check(False, str(trouble)[:400])
        app.close()
    print(f"{counts[True]} passed, {counts[False]} failed")
    sys.exit(1 if counts[False] else 0)


if __name__ == "__main__":
    main()
