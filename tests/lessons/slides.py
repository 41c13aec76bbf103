#!/usr/bin/env python3
"""Whether the slides of each lesson say what its handout says, and the pages in a browser are whole.

  tests/lessons/slides.py              all lessons
  tests/lessons/slides.py --self-test  whether wrong numbers, commands, outputs, ... are noticed

On slides every command and every line of output must be a line of the handout (its blanks aside; `...` stands for any
lines), and every number of two digits or more, or with a point, must be in it. A deck has the learning outcomes, the
question, a prediction, a run that fails, exercises and what to take home, on 10 to 15 slides. Pages must be whole and
name no address of a network. Standard library only.
"""
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
LESSONS = ROOT / "inputs" / "lessons"
PAGES = ROOT / "plot" / "lessons" / "pages"
SLIDES = range(10, 16)
PARTS = ("After this lesson you can", "The question", "Predict", "fail", "Exercises", "Take home")
FENCED = re.compile(r"^```\w*\n(.*?)^```$", re.M | re.S)
NUMBER = re.compile(r"(?<![\w.])(?:\d+\.\d+(?:e[-+]?\d+)?|\d+e[-+]?\d+|\d{2,}(?!\w))")
RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
NETWORK = re.compile(r"https?://(?!www\.w3\.org/2000/svg)|[\"'(]//\w|\b(?:fetch|XMLHttpRequest|import)\s*\(")


def words_of(line):
    return " ".join(line.split())


def numbers_of(text):
    """10⁻⁴ and $10^{-4}$ are 1e-4; subscripts and other exponents are no numbers."""
    text = re.sub(r"\b10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+)", lambda found: "1e" + found.group(1).translate(RAISED), text)
    text = re.sub(r"\b10\^\{?(-?\d+)\}?", r"1e\1", text)
    return NUMBER.findall(re.sub(r"[_^]\{[^}]*\}", " ", text))


def faults_of_slides(slides, handout, folder):
    """What is on the slides and not in the handout, or not on the slides at all. folder: of the lesson."""
    faults = []
    body = slides.split("\n---\n", 1)[1]
    count = 1 + len(re.findall(r"^## ", body, re.M))
    if count not in SLIDES:
        faults.append(f"{count} slides, not {SLIDES[0]} to {SLIDES[-1]}")
    faults += [f"no slide or sentence has '{part}'" for part in PARTS if part not in body]
    lines = {words_of(line) for line in handout.split("\n")}
    for block in FENCED.findall(body):
        for line in map(words_of, block.split("\n")):
            if line and line != "..." and line not in lines and not line.startswith("make "):
                faults.append(f"not in the handout: {line}")
    exercises = {f"{int(folder.name[:2])}.{k}" for k in re.findall(r"^(\d)\. ", handout, re.M)}
    known = {*numbers_of(handout), *exercises}
    for number in numbers_of(FENCED.sub("", body)):
        if number not in known:
            faults.append(f"the number {number} is not in the handout")
    pictures = [folder / name for name in re.findall(r"\]\(([^)]+)\)", body)]
    pages = [ROOT / name for name in re.findall(r"`(plot/lessons/pages/[^`]+)`", body)]
    return faults + [f"no file {path.name}" for path in pictures + pages if not path.exists()]


class Page(HTMLParser):
    """The elements that are open at the end."""
    VOID = {"meta", "input", "br", "link", "img", "hr"}

    def __init__(self):
        super().__init__()
        self.open, self.faults = [], []

    def handle_starttag(self, tag, attributes):
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes nothing")


def faults_of_page(text):
    page = Page()
    page.feed(text)
    faults = page.faults[:1] + [f"<{tag}> is not closed" for tag in page.open]
    if not text.rstrip().endswith("</html>"):
        faults.append("it does not end with </html>")
    faults += [f"it names a network: {found.group(0)}" for found in NETWORK.finditer(text)]
    faults += [f"it needs a file: {name}" for name in re.findall(r'<(?:script|img|link)[^>]*(?:src|href)="([^"]*)', text)
               if not name.startswith("data:")]
    return faults


def self_test():
    handout = "Text with 12.5 and 10⁻⁴⁰.\n```console\n$ run it\n  a   17\n```\n"
    good = "---\ntitle: t\n---\n" + "".join(f"## {part}\n" for part in PARTS) + "## more\n" * 5
    block = "```\n$ run it\n...\n a 17\n```\n12.5 and $10^{-40}$"
    cases = [(good + block, 0), (good + block.replace("17", "18"), 1), (good + block.replace("run", "walk"), 1),
             (good + "12.6", 1), (good + "43", 1), (good.replace("Take home", "End"), 1), (good + "## more\n" * 9, 1),
             (good + "![p](no.png)", 1)]
    found = [(text, faults_of_slides(text, handout, LESSONS / "01-distortion"), count) for text, count in cases]
    failures = [f"{text[-60:]!r}: {faults}" for text, faults, count in found if len(faults) != count]
    whole = '<!DOCTYPE html><html><body><svg xmlns="http://www.w3.org/2000/svg"></svg></body></html>'
    pages = [(whole, 0), (whole.replace("</svg>", ""), 2), (whole[:-7], 2),
             (whole.replace("<svg", '<script src="https://a.b/c.js"></script><svg'), 2),
             (whole.replace("<svg", "<script>fetch('x')</script><svg"), 1)]
    return failures + [f"{text}: {faults_of_page(text)}" for text, count in pages if len(faults_of_page(text)) != count]


def main(words):
    if words == ["--self-test"]:
        faults = self_test()
    else:
        faults = []
        for handout in sorted(LESSONS.glob("[0-9]*/README.md")):
            folder, slides = handout.parent, handout.parent / "slides.md"
            if not slides.exists():
                faults.append(f"{folder.name} has no slides.md")
            else:
                faults += [f"{slides.relative_to(ROOT)}: {fault}"
                           for fault in faults_of_slides(slides.read_text(), handout.read_text(), folder)]
        for page in sorted(PAGES.glob("*.html")):
            faults += [f"{page.relative_to(ROOT)}: {fault}" for fault in faults_of_page(page.read_text())]
    print("\n".join(faults) if faults else "slides and pages hold")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
