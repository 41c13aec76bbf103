#!/usr/bin/env python3
"""The pages of the course, plot/lessons/pages/, in a headless Chromium: what is dragged moves, the numbers are those of
the lessons, nothing is an error, nothing asks a network. Without Chromium they are left out, with a message.

  tests/lesson_pages.py

Chromium is driven as tests/page.py does it; all ends after two minutes. Standard library only.
"""
import signal
import sys
import tempfile
import time
from pathlib import Path

from page import CHROMIUM, ROOT, Browser, check, counts

PAGES = ROOT / "plot" / "lessons" / "pages"
FRAME = "new Promise(f => requestAnimationFrame(() => requestAnimationFrame(f)))"


class Pages(Browser):
    def settle(self):
        self.value(FRAME)

    def open(self, name):
        self.events.clear()
        self.call("Page.navigate", url=(PAGES / name).as_uri())
        end = time.monotonic() + 20
        while self.value("document.readyState") != "complete" and time.monotonic() < end:
            time.sleep(0.05)

    def centre(self, selector):
        x, y, width, height = self.box(selector)
        return x + width / 2, y + height / 2

    def move(self, selector, x, y):
        """Drags what has this selector by x and y pixels."""
        at = self.centre(selector)
        self.drag(*at, at[0] + x, at[1] + y)
        self.settle()


def check_eta(browser):
    browser.open("eta.html")
    browser.move("#apex", -90, 40)
    x, y = browser.value("z")
    check(abs(x - 0.9) < 0.02 and abs(y - 0.15) < 0.02, f"eta: the apex is dragged to ({x}, {y})")
    browser.click("#run")
    check(abs(browser.value("eta(z)") - 1) < 1e-9, "eta: steps downhill do not end at the ideal triangle")
    check(browser.value("path.every(p => p[1] > 0)"), "eta: a step was accepted below the barrier")
    browser.move("#apex", 0, 250)
    check(browser.value("z[1] < 0 && eta(z) === Infinity"), "eta: an inverted triangle is not infinite")
    browser.click("#descend")
    check("no gradient" in browser.text_of("says"), "eta: a step from an inverted triangle")
    browser.set("delta", "0.1")
    check(browser.value("[[0.5, 0], [0.5, -0.1], [0.5, -0.5]].map(p => eta(p).toFixed(4)).join()") ==
          "5.0000,8.7757,39.6120", "eta: not the numbers of lesson 1")
    browser.click("#run")
    check(abs(browser.value("z[1]") - 0.85) < 0.02, "eta: with delta the start is not untangled")
    browser.click("#reset")
    browser.move("#ideal", 60, 20)
    check(browser.value("ideal[0] > 0.7"), "eta: the ideal apex is not dragged")


def check_springs(browser):
    browser.open("springs.html")
    browser.move("#wall", -105, 0)
    check(abs(browser.value("state.g") - 5) < 0.15, "springs: the wall is not dragged")
    factors = browser.value("[1, 2, 3].map(() => { const before = state.lambda - state.kappa * state.g; update();"
                            "return (state.lambda - state.kappa * state.g) / before; })")
    check(all(abs(factor - 1 / 3) < 1e-9 for factor in factors), f"springs: factors {factors}, not kappa/(kappa + mu)")
    browser.click("#reset")
    for _ in range(6):
        browser.click("#step")
    check("converged" in browser.text_of("says"), "springs: Algorithm 1 does not converge")
    browser.click("#reset")
    browser.set("kappa", "-2")
    browser.set("mu", "0")
    check("no minimum" in browser.text_of("factor"), "springs: a minimum where kappa + mu < 0")


def check_circle(browser):
    browser.open("circle.html")
    last = browser.value("rows.length - 1")
    browser.set("at", str(last))
    check("iteration 5 of Algorithm 1" in browser.text_of("says"), "circle: the slider")
    worst = browser.value("rows.map((row, k) => Math.max(...Array.from({length: triangles.length / 3}, (_, e) => "
                          "eta(frames[k], e))) / row.eta)")
    check(all(abs(ratio - 1) < 0.005 for ratio in worst), f"circle: eta of the packed positions {worst}")
    browser.set("at", "0")
    browser.click("#play")
    time.sleep(1.2)
    check(browser.value("Number(element('at').value)") > 0.5, "circle: nothing is played")
    browser.click("#play")
    check(browser.text_of("play") == "play", "circle: it does not stop")


def main():
    if not CHROMIUM:
        print("pages of the course are left out: there is no Chromium here (Debian: chromium)")
        return 0
    signal.alarm(120)
    with tempfile.TemporaryDirectory() as name:
        browser = Pages(Path(name))
        for check_one in (check_eta, check_springs, check_circle):
            check_one(browser)
            for trouble in browser.troubles():
                check(False, f"{check_one.__name__}: {str(trouble)[:300]}")
        browser.close()
    print(f"{counts[True]} passed, {counts[False]} failed")
    return 1 if counts[False] else 0


if __name__ == "__main__":
    sys.exit(main())
