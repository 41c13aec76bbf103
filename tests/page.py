#!/usr/bin/env python3
"""Whether plot/page.py makes pages that work: its messages, the nodes on the faces of every cell, and pages opened in a
headless Chromium, where the slider, mouse, list and cut must change what is seen, without an error or a request.

  tests/page.py [--build FOLDER] [--pictures FOLDER]     --pictures: keeps the pictures taken

The pages are left out, with a message, where there is no Chromium or where three.js cannot be fetched. Chromium is
driven by its debugging protocol through a pipe; all ends after fifteen minutes. Exit code 1 where a check failed.
Standard library only.
"""
import argparse
import base64
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "plot"))

import page  # noqa: E402
import vtk_file  # noqa: E402

SIZE = 1200, 760
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run", "--enable-unsafe-swiftshader",
         "--use-angle=swiftshader", f"--window-size={SIZE[0]},{SIZE[1]}"]
counts = {True: 0, False: 0}


def check(holds, what):
    counts[bool(holds)] += 1
    if not holds:
        print(f"failed: {what}")


# ------------------------------------------------------------------------------------------------------------- messages

def message(*words, **environment):
    """What the script ends with; "" where it ends well."""
    done = subprocess.run([sys.executable, ROOT / "plot" / "page.py", *map(str, words)], capture_output=True, text=True,
                          env=os.environ | {name: str(value) for name, value in environment.items()})
    return done.stderr if done.returncode else ""


def check_messages(folder, results):
    check("there is no such folder" in message(folder / "none"), "a folder that is not there")
    empty = folder / "empty"
    empty.mkdir()
    check("has no mesh to show" in message(empty), "a folder without results")
    (empty / "deck.txt").write_text("vtk = none\n")
    check("run it again with vtk=binary" in message(empty), "a run with vtk = none")
    (empty / "final.vtk").write_bytes((results / "final.vtk").read_bytes()[:5000])
    check("final.vtk: ends early" in message(empty), "a VTK file that was cut off")
    (empty / "final.vtk").write_text("solid cube\n")
    check("does not begin with" in message(empty), "another file")
    check("npm is missing" in message(results, XDG_CACHE_HOME=folder / "cache", PATH=""), "neither cache nor npm")
    cached = folder / "cache" / "almesh" / f"{page.THREE}.tgz"
    cached.write_text("something else")
    check("is not the file" in message(results, XDG_CACHE_HOME=folder / "cache", PATH=""), "another file in the cache")


# ---------------------------------------------------------------------------------------------------------------- faces

def check_faces(name, vtk):
    """Elements are straight before the run: each node of a face is at its place between the corners. And a face of two
    elements has the same nodes in both, or fewer in the one where VTK has no cell of its degree: in a pyramid."""
    x = [vtk.points[3 * k:3 * k + 3] for k in range(len(vtk.points) // 3)]
    at, seen, worst = 0, {}, 0.0
    for vtk_type in vtk.types:
        nodes = vtk.cells[at + 1:at + 1 + vtk.cells[at]]
        at += 1 + len(nodes)
        faces, p = vtk_file.faces_of(vtk_type, len(nodes))
        for corners, places in faces:
            face = [nodes[k] for k in places]
            corner = [face[k] for k in (0, p, -1, -1 - p)[:corners]]
            other = seen.setdefault(frozenset(corner), set(face))
            check(other <= set(face) or other >= set(face), f"{name}: a face with other nodes in its other element")
            lattice = vtk_file.lattice(corners, p)
            for (u, v), node in zip(lattice, face) if len(face) == len(lattice) else []:
                linear = page.basis(corners, 1, True, u / p, v / p)
                order = [0, 1, 2] if corners == 3 else [0, 1, 3, 2]
                for a in range(3):
                    worst = max(worst, abs(x[node][a] - sum(w * x[corner[k]][a] for w, k in zip(linear, order))))
    check(worst < 1e-12, f"{name}: a node of a face {worst:.2g} from its place")


# -------------------------------------------------------------------------------------------------------------- browser

class Browser:
    """Chromium and a page in it. Messages are JSON, each with a zero byte at its end, on its files 3 and 4."""

    def __init__(self, folder):
        (to_read, self.write), (self.read, to_write) = os.pipe(), os.pipe()
        command = [CHROMIUM, *FLAGS, f"--user-data-dir={folder}", "about:blank"]
        self.process = subprocess.Popen(["sh", "-c", f'exec "$@" 3<&{to_read} 4>&{to_write}', "sh", *command],
                                        pass_fds=(to_read, to_write), stderr=subprocess.DEVNULL)
        os.close(to_read), os.close(to_write)
        self.text, self.number, self.session, self.events = b"", 0, {}, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.session = {"sessionId": session}
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=SIZE[0], height=SIZE[1], deviceScaleFactor=1,
                  mobile=False)

    def call(self, method, **parameters):
        self.number += 1
        sent = {"id": self.number, "method": method, "params": parameters, **self.session}
        os.write(self.write, json.dumps(sent).encode() + b"\0")
        while True:
            while b"\0" not in self.text:
                part = os.read(self.read, 1 << 20)
                if not part:
                    raise RuntimeError("Chromium has ended")
                self.text += part
            answer, self.text = self.text.split(b"\0", 1)
            answer = json.loads(answer)
            if answer.get("id") == self.number:
                return answer["result"]
            self.events.append(answer)

    def value(self, expression):
        """Of JavaScript, a promise's when it is there."""
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def settle(self):
        """Waits until two frames have been drawn and the camera stands still."""
        while True:
            before = self.value("JSON.stringify(page.camera)")
            self.value("new Promise(f => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(f, 60))))")
            if self.value("JSON.stringify(page.camera)") == before:
                return

    def open(self, path):
        self.events.clear()
        self.call("Page.navigate", url=path.resolve().as_uri())
        end = time.monotonic() + 60
        while self.value("document.body?.dataset.ready") != "yes" and time.monotonic() < end:
            time.sleep(0.1)
        self.settle()

    def picture(self):
        """The bytes of a PNG of the mesh alone."""
        self.settle()
        box = self.value("(({x, y, width, height}) => ({x, y, width, height}))"
                         "(document.querySelector('#view canvas').getBoundingClientRect())")
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", clip={**box, "scale": 1})["data"])

    def set(self, name, value):
        """Gives the control of the page this value, as its user does."""
        self.value(f"(c => {{ c.value = {value!r}; c.dispatchEvent(new Event('input')); "
                   f"c.dispatchEvent(new Event('change')); }})(document.getElementById('{name}'))")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, x, y, to_x, to_y):
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        self.mouse("mouseMoved", to_x, to_y, button="left", buttons=1)
        self.mouse("mouseReleased", to_x, to_y, button="left", clickCount=1)

    def click(self, selector):
        x, y = self.value(f"(({{x, y, width, height}}) => [x + width / 2, y + height / 2])"
                          f"(document.querySelector('{selector}').getBoundingClientRect())")
        self.drag(x, y, x, y)

    def text_of(self, name):
        return self.value(f"document.getElementById('{name}').textContent")

    def troubles(self):
        """Errors and warnings on the console, and requests that leave the page."""
        found = [event for event in self.events if event.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded",
                                                                           "Runtime.consoleAPICalled")]
        requests = [event["params"]["request"]["url"] for event in self.events
                    if event.get("method") == "Network.requestWillBeSent"]
        return found + [url for url in requests if not url.startswith(("file:", "blob:", "data:"))]

    def close(self):
        self.call("Browser.close")
        self.process.wait()


def check_page(browser, name, folder, pictures):
    """Every control of the page changes what is seen of it."""
    print(page.write_page(folder))
    browser.open(folder / "page.html")
    seen = [browser.picture()]
    check(browser.picture() == seen[0], f"{name}: the picture changes by itself")

    def changes(what, must=True):
        picture = browser.picture()
        check((picture != seen[-1]) == must, f"{name}: {what} {'does not change' if must else 'changes'} the picture")
        if pictures:
            (pictures / f"{name}-{len(seen)}.png").write_bytes(picture)
        seen.append(picture)

    browser.set("field", browser.value("document.getElementById('field').options.length") - 1)
    changes("another colour")
    browser.click("#marks")
    changes("marks")
    has_inside = browser.value("document.getElementById('outer-label').checkVisibility()")
    if has_inside and browser.value("document.getElementById('outer').checked"):
        browser.click("#outer")
    frames = int(browser.value("document.getElementById('frame').max")) + 1  # colours are of ids: the mesh has to move
    for k in (0, frames // 3, frames - 1):
        label = browser.text_of("label")
        browser.set("frame", k)
        changes("the slider", browser.text_of("label") != label)
    browser.value(UNTIL_PLAYED)
    changes("a step of playing")
    if has_inside:
        browser.click("#outer")
        changes("the outermost surface")
    browser.set("field", 0)
    browser.click("#marks")
    browser.click("#edges")
    changes("edges")
    browser.mouse("mouseWheel", 600, 350, deltaX=0, deltaY=-300)
    changes("the wheel")
    direction = "page.camera.getWorldDirection(page.camera.position.clone()).toArray().map(v => v.toFixed(6)).join()"
    before = browser.value(direction)
    browser.drag(600, 350, 660, 400)
    changes("dragging")
    is_solid = browser.value("document.getElementById('space').hidden") is False
    check((browser.value(direction) != before) == is_solid, f"{name}: dragging turns a plane mesh, or no solid one")
    if is_solid:
        browser.set("cut", "1")
        changes("a cut")
        browser.set("place", "0.3")
        changes("moving the cut")
        print(f"  moving the cut: {browser.value(TIME_OF_CUT):.0f} ms to rebuild what is drawn")
    before = browser.value("JSON.stringify([page.controls.target, page.camera.zoom])")
    browser.click("#worst tbody tr:nth-child(2)")
    changes("a click at one of the worst elements")
    check(browser.value("JSON.stringify([page.controls.target, page.camera.zoom])") != before, f"{name}: no flight")
    shown = browser.value("document.querySelector('#worst tr.on').cells[1].textContent")
    check(browser.text_of("picked").startswith(f"element {shown}\n"), f"{name}: the values of the element flown to")
    tag = browser.value("(({x, y}) => [x - 5, y + 22])(document.querySelectorAll('.mark')[1].getBoundingClientRect())")
    browser.drag(2, 700, 2, 700)
    browser.drag(*tag, *tag)
    check(browser.text_of("picked").startswith(f"element {shown}\n"), f"{name}: a click at the element flown to")
    if browser.value("document.querySelector('table.frames') !== null"):
        for row, shown in ((3, "t = 0.125 "), (2, "t = 0.125 "), (5, "t = 0.25 ")):  # of the second there is no mesh
            browser.click(f"table.frames tbody tr:nth-child({row}) td")
            check(browser.text_of("label").startswith(shown), f"{name}: a click at row {row} of frames.csv")
    for trouble in browser.troubles():
        check(False, f"{name}: {str(trouble)[:400]}")


UNTIL_PLAYED = "(async (play, label) => { const before = label.textContent; play.click(); " \
               "for (let k = 0; k < 1000 && label.textContent === before; ++k) " \
               "await new Promise(f => setTimeout(f, 5)); play.click(); })" \
               "(document.getElementById('play'), document.getElementById('label'))"
TIME_OF_CUT = "(begin => { for (let k = 0; k < 5; ++k) page.rebuild(); return (performance.now() - begin) / 5; })" \
              "(performance.now())"
RUNS = {"circle": ["inputs/circle.deck", "iterates=1"], "curving": ["inputs/curving.deck", "vtk=binary"],
        "frames": ["inputs/frames/pitch.deck"], "kinds-2": ["inputs/cells/kinds-2.deck"],
        "kinds-3": ["inputs/cells/kinds-3.deck"], "kinds-4": ["inputs/cells/kinds-4.deck"],
        "quadrilaterals": ["inputs/cells/curving.deck"], "shell": ["inputs/sphere-shell.deck"],
        "aircraft": ["inputs/aircraft.deck", "algorithm=adaptive"]}
PAGES = ["circle", "curving", "frames", "kinds-2", "aircraft"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build")
    parser.add_argument("--pictures", type=Path)
    arguments = parser.parse_args()
    signal.alarm(900)
    skipped = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for run, words in RUNS.items():
            subprocess.run([ROOT / arguments.build / "almesh", *words, f"output={folder / run}"], cwd=ROOT,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        check_messages(folder, folder / "circle")
        for run in ("circle", "curving", "kinds-2", "kinds-3", "kinds-4", "quadrilaterals", "shell"):
            check_faces(run, vtk_file.read(folder / run / "initial.vtk"))
        reason = "" if CHROMIUM else "there is no Chromium here (Debian: chromium)"
        try:
            page.three_files()
        except page.PageError as error:
            reason = str(error)
        if reason:
            print(f"pages are left out: {reason}")
            skipped = len(PAGES)
        else:
            series = folder / "frames" / "frames.vtk.series"
            series.write_text(re.sub(r'.*"frame-0002.vtk".*\n', "", series.read_text()))
            browser = Browser(folder / "chromium")
            for run in PAGES:
                check_page(browser, run, folder / run, arguments.pictures)
            browser.close()
    print(f"{counts[True]} passed, {counts[False]} failed, {skipped} skipped")
    sys.exit(1 if counts[False] else 0)


if __name__ == "__main__":
    main()
