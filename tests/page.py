#!/usr/bin/env python3
"""Whether plot/page.py makes pages that work: its messages, the nodes on the faces of every cell, and pages opened in a
headless Chromium, where the slider, mouse, list and cut must change what is seen, without an error or a request, and
where nothing may be covered, cut off or hard to see on a large screen and a small one.

  tests/page.py [--build FOLDER] [--pictures FOLDER]     --pictures: keeps the pictures taken

The pages are left out, with a message, where there is no Chromium or where three.js cannot be fetched. Chromium is
driven by its debugging protocol through a pipe; all ends after fifteen minutes. Exit code 1 where a check failed.
Standard library only.
"""
import argparse
import base64
import json
import math
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
import page_tables  # noqa: E402
import vtk_file  # noqa: E402

SIZES = (1400, 900), (800, 600)
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run", "--enable-unsafe-swiftshader",
         "--use-angle=swiftshader", f"--window-size={SIZES[0][0]},{SIZES[0][1]}"]
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
        self.resize(*SIZES[0])

    def resize(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

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
        self.settle()

    def key(self, key, text=""):
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, text=text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key)
        self.settle()

    def box(self, selector, k=0):
        """x, y, width, height of the k-th element with this selector, in pixels."""
        return self.value(f"(({{x, y, width, height}}) => [x, y, width, height])"
                          f"(document.querySelectorAll('{selector}')[{k}].getBoundingClientRect())")

    def pixels(self, expression):
        """Of the pixels of the mesh's picture (d: their red, green, blue, opacity, drawn now; before: at the last
        call), the share for which this holds at its number k."""
        return self.value("(() => { const canvas = document.querySelector('#view canvas');"
                          "const {width: w, height: h} = canvas, to = Object.assign(document.createElement('canvas'),"
                          "{width: w, height: h}).getContext('2d'); page.draw(); to.drawImage(canvas, 0, 0);"
                          "const d = to.getImageData(0, 0, w, h).data, before = globalThis.before ?? d; let count = 0;"
                          f"for (let k = 0; k < d.length; k += 4) if ({expression}) ++count;"
                          "globalThis.before = d; return count / (w * h); })()")

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


def apart(a, b):
    """Whether two boxes do not overlap."""
    return a[0] + a[2] <= b[0] or b[0] + b[2] <= a[0] or a[1] + a[3] <= b[1] or b[1] + b[3] <= a[1]


def distance(x, y, side):
    """Of a point from a side."""
    ax, ay, ux, uy = side[0], side[1], side[2] - side[0], side[3] - side[1]
    s = min(max(((x - ax) * ux + (y - ay) * uy) / (ux * ux + uy * uy or 1), 0), 1)
    return math.hypot(x - ax - s * ux, y - ay - s * uy)


def check_badges(browser, name):
    """Badges overlap neither each other nor the sides of what they mark, and have a line to it."""
    boxes = [browser.box(".mark", k) for k in range(10)]
    view, sides = browser.box("#view"), browser.value("page.sides()")
    check(all(box[2] > 0 for box in boxes), f"{name}: only {sum(box[2] > 0 for box in boxes)} badges are seen at first")
    middle = [(box[0] - view[0] + box[2] / 2, box[1] - view[1] + box[3] / 2) for box in boxes if box[2]]
    free = [min(distance(*at, side) for side in sides) for at in middle]
    check(min(free) >= 9, f"{name}: a badge covers a side of a marked element ({min(free):.1f} pixels from it)")
    between = min(math.dist(a, b) for k, a in enumerate(middle) for b in middle[:k])
    check(between >= 18, f"{name}: badges overlap ({between:.1f} pixels apart)")
    leaders = browser.value("[...document.querySelectorAll('#view svg line')].map(l => +l.getAttribute('x1'))")
    check(len(leaders) == 2 * len(middle), f"{name}: a badge without a line to its element")


def check_outline(browser, name):
    """A click draws a line around the element that changes at least two pixels across, along what is seen of it."""
    browser.key("f")
    browser.click("#marks")
    x, y, width, height = browser.box("#view")
    browser.pixels("false")
    for k in range(100):  # until it meets an element
        at = x + width * (0.5 + 0.4 * math.cos(k) * k / 100), y + height * (0.5 + 0.4 * math.sin(k) * k / 100)
        browser.drag(*at, *at)
        if browser.text_of("picked"):
            break
    browser.settle()
    changed = browser.pixels("Math.abs(d[k] + d[k + 1] + d[k + 2] - before[k] - before[k + 1] - before[k + 2]) > 180")
    sides = browser.value("page.sides()")
    length = sum(math.dist(side[:2], side[2:]) for side in sides)
    is_solid = browser.value("document.getElementById('space').hidden") is False
    visible = 0.4 * length if is_solid else length  # each edge of a solid element is one of two of its faces
    check(length and changed * width * height > 2 * visible,
          f"{name}: an outline of {changed * width * height:.0f} pixels for {visible:.0f} of length")
    browser.key("Escape")
    check(browser.text_of("picked") == "", f"{name}: Escape lets the element go")
    browser.click("#marks")


def check_layout(browser, name):
    """Nothing covers what one needs, and what changes does not move it."""
    view, slider = browser.box("#view"), browser.box("#frame")
    for part in ("#legend", "#picked", "#status", "aside", "#time", "header"):
        check(apart(browser.box(part), view), f"{name}: {part} covers the picture")
    for share in (0.02, 0.5, 0.98):
        x, y = slider[0] + share * slider[2], slider[1] + slider[3] / 2
        check(browser.value(f"document.elementFromPoint({x}, {y})?.id") == "frame", f"{name}: the slider is covered")
    check(browser.value("document.querySelector('aside').scrollWidth <= document.querySelector('aside').clientWidth"),
          f"{name}: the side is wider than its place")
    boxes = set()
    for k in range(int(browser.value("document.getElementById('frame').max")) + 1):
        browser.set("frame", k)
        boxes.add(tuple(browser.box("#frame")))
        check(browser.value("(l => l.scrollWidth <= l.clientWidth)(document.getElementById('label'))"),
              f"{name}: the label is cut at frame {k}")
    check(len(boxes) == 1, f"{name}: the slider has {len(boxes)} places")
    if browser.value("document.querySelector('table.frames') !== null"):
        check(browser.value("(t => t.scrollWidth <= t.clientWidth)(document.getElementById('table'))"),
              f"{name}: the table of frames is wider than its place")
        heads = browser.value("[...document.querySelectorAll('.frames th')].filter(h => h.checkVisibility())"
                              ".map(h => h.textContent)")
        check({"t", "max η", "path"} <= set(heads), f"{name}: the table of frames has only {heads}")


def check_curves(browser, name, titles):
    """The curves are above the picture, with a marker at the frame, values at the pointer and clicks that go there."""
    shown = browser.value("[...document.querySelectorAll('figure b')].map(b => b.textContent)")
    check(shown == titles, f"{name}: curves of {shown}")
    last = int(browser.value("document.getElementById('frame').max"))
    for k in (0, last):
        browser.set("frame", k)
        marker = float(browser.value("document.querySelector('line.marker').getAttribute('x1')"))
        x, y, width, height = browser.box("figure svg")
        check(abs(marker - (width - 8 if k else 52)) < 1, f"{name}: the marker of frame {k} is at {marker}")
        worst = browser.text_of("label").split()[-1]
        check(browser.value("document.querySelector('figure span').textContent") == worst, f"{name}: not {worst}")
    browser.mouse("mouseMoved", x + 52, y + height / 2)
    browser.settle()
    under = browser.value("document.querySelector('figure span').textContent")
    check(re.fullmatch(r"[\d.e+]+ at (t = 0|Newton step 0)", under), f"{name}: the pointer reads '{under}'")
    browser.drag(x + 52, y + height / 2, x + 52, y + height / 2)
    check(browser.value("document.getElementById('frame').value") == "0", f"{name}: a click at a curve")
    browser.mouse("mouseMoved", 5, 5)


def check_first_view(browser, name):
    """The boundary of a solid mesh is drawn; around a body in a distant box the far walls of the box are."""
    share = browser.pixels("d[k] < 250")
    is_far = browser.value("!document.getElementById('outer').checked")
    check(share > (0.9 if is_far else 0.1), f"{name}: the first view draws {share:.0%} of the picture")
    drawn = browser.pixels("Math.abs(d[k] - d[k + 2]) > 8 || d[k] < 215")
    browser.click("#marks")
    check(browser.pixels("Math.abs(d[k] - d[k + 2]) > 8 || d[k] < 215") > 0.5 * drawn,
          f"{name}: little more than marks is drawn at first")
    browser.click("#marks")


def check_controls(browser, name):
    """Keys, and what they leave to the control that has the focus."""
    browser.key("2")
    second = browser.value("document.querySelectorAll('#worst td')[5].textContent")
    check(browser.text_of("picked").startswith(f"element {second} ·"), f"{name}: the key of the second worst element")
    browser.value("document.getElementById('edges').focus()")
    browser.key(" ", " ")
    check(not browser.value("document.getElementById('edges').checked"), f"{name}: space does not reach a box to tick")
    check(browser.text_of("play") == "▶ play", f"{name}: space plays although a box to tick has the focus")
    browser.value("document.querySelector('#worst tbody tr:nth-child(3)').focus()")
    browser.key("Enter")
    third = browser.value("document.querySelectorAll('#worst td')[9].textContent")
    check(browser.text_of("picked").startswith(f"element {third} ·"), f"{name}: Enter at a row")


def check_contrast(browser, name):
    """Text on its background, in light and dark: a ratio of 4.5 (WCAG)."""
    luminance = "(c => c.match(/[\\d.]+/g).slice(0, 3).map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : " \
                "((v + 0.055) / 1.055) ** 2.4).reduce((s, v, k) => s + v * [0.2126, 0.7152, 0.0722][k], 0))"
    for scheme in ("dark", "light"):
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        paper = browser.value(f"{luminance}(getComputedStyle(document.body).backgroundColor)")
        check((paper < 0.1) == (scheme == "dark"), f"{name}: the page is not {scheme}")
        for part in ("h1", "#about", "#meaning", "td", "#help", "#tabs button", "figure text", "figcaption b"):
            kind = "fill" if part == "figure text" else "color"
            ink = browser.value(f"{luminance}(getComputedStyle(document.querySelector('{part}')).{kind})")
            ratio = (max(ink, paper) + 0.05) / (min(ink, paper) + 0.05)
            check(ratio >= 4.5, f"{name}: {part} has a contrast of {ratio:.1f} in {scheme}")


CURVES = {"circle": ["worst distortion η", "least scaled Jacobian", "|c_D| (log)"],
          "frames": ["worst distortion η", "least scaled Jacobian", "Newton steps"],
          "aircraft": ["worst distortion η", "least scaled Jacobian", "|c_D| (log)"]}


def check_looks(browser, name, folder, pictures):
    """What a user sees at once, on a large and on a small screen."""
    page.write_page(folder)
    for width, height in SIZES:
        browser.resize(width, height)
        browser.open(folder / "page.html")
        at = f"{name}, {width} x {height}"
        if pictures:
            (pictures / f"{name}-{width}.png").write_bytes(
                base64.b64decode(browser.call("Page.captureScreenshot", format="png")["data"]))
        if browser.value("document.getElementById('space').hidden") is False:
            check_first_view(browser, at)
        check_badges(browser, at)
        check_outline(browser, at)
        check_layout(browser, at)
        if name in CURVES:
            check_curves(browser, at, CURVES[name])
    browser.resize(*SIZES[0])
    for trouble in browser.troubles():
        check(False, f"{name}: {str(trouble)[:400]}")


def check_endings(browser, folder):
    """Pages of a run that failed, of one without a table, of one without the program."""
    print(page.write_page(folder / "failed"))
    browser.open(folder / "failed" / "page.html")
    about = browser.text_of("about")
    check(about.startswith("max al iterations") and "diagnosis: off target" in about, f"a run that failed: {about}")
    check(browser.value("document.getElementById('about').className") == "failed", "a run that failed looks well")
    check_contrast(browser, "failed")
    browser.open(folder / "circle" / "page.html")
    check_controls(browser, "circle")
    explained = browser.value("document.querySelectorAll('#table td[title]').length")
    check(browser.text_of("notes") == "" and explained > 20, f"{explained} names of the summary are explained")
    path, os.environ["PATH"] = os.environ["PATH"], ""
    page_tables.HERE = folder / "plot"
    page.write_page(folder / "circle")
    page_tables.HERE, os.environ["PATH"] = ROOT / "plot", path
    browser.open(folder / "circle" / "page.html")
    check("almesh --keys" in browser.text_of("notes"), "nothing says that explanations are missing")
    for name in ("history.csv", "summary.txt", "expectations.csv"):
        (folder / "curving" / name).unlink(missing_ok=True)
    page.write_page(folder / "curving")
    browser.open(folder / "curving" / "page.html")
    check(browser.value("document.querySelector('figure svg text:nth-of-type(3)').textContent") == "mesh 1",
          "a folder without a history")
    for trouble in browser.troubles():
        check(False, f"endings: {str(trouble)[:400]}")


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
    browser.mouse("mouseWheel", 600, 450, deltaX=0, deltaY=-300)
    changes("the wheel")
    direction = "page.camera.getWorldDirection(page.camera.position.clone()).toArray().map(v => v.toFixed(6)).join()"
    before = browser.value(direction)
    browser.drag(600, 450, 660, 500)
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
    check(browser.text_of("picked").startswith(f"element {shown} ·"), f"{name}: the values of the element flown to")
    x, y, width, height = browser.box("#view canvas")
    browser.drag(x + 2, y + height - 2, x + 2, y + height - 2)
    browser.drag(x + width / 2, y + height / 2, x + width / 2, y + height / 2)
    check(browser.text_of("picked").startswith(f"element {shown} ·"), f"{name}: a click at the element flown to")
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
        "aircraft": ["inputs/aircraft.deck", "algorithm=adaptive"],
        "failed": ["inputs/circle.deck", "max_al_iterations=2"]}
PAGES = ["circle", "curving", "frames", "kinds-2", "aircraft"]
LOOKS = ["circle", "frames", "kinds-3", "aircraft"]


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
            rows = folder / "frames" / "frames.csv"
            rows.write_text(re.sub(r"^2,(.*),converged,0,(.*),yes,", r"2,\1,max_newton_iterations,3,\2,no,",
                                   rows.read_text(), flags=re.M))
            os.environ["PATH"] = f"{(ROOT / arguments.build).resolve()}{os.pathsep}{os.environ['PATH']}"
            browser = Browser(folder / "chromium")
            for run in PAGES:
                check_page(browser, run, folder / run, arguments.pictures)
            for run in LOOKS:
                check_looks(browser, run, folder / run, arguments.pictures)
            check_endings(browser, folder)
            browser.close()
    print(f"{counts[True]} passed, {counts[False]} failed, {skipped} skipped")
    sys.exit(1 if counts[False] else 0)


if __name__ == "__main__":
    main()
