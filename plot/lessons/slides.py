#!/usr/bin/env python3
"""Slides of the lessons, from inputs/lessons/NN-*/slides.md: outputs/slides/NN-*.html and .pdf.

  plot/lessons/slides.py [NN ...]      all lessons where none is named

HTML by pandoc (Debian: pandoc), one file for each lesson that needs no network: formulas are MathML, pictures are
inside. PDF by Chromium (Debian: chromium), which prints that file; without it there is no PDF. Exit code 1 where
something is missing, or where a slide has more than it can show.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
TEMPLATE = Path(__file__).with_suffix(".html")
SLIDES = ROOT / "outputs" / "slides"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


def write_html(source, target):
    subprocess.run(["pandoc", "--from", "markdown-implicit_figures", "--to", "html5", "--section-divs", "--mathml",
                    "--no-highlight", "--self-contained", "--template", TEMPLATE, "--output", target, source.name],
                   cwd=source.parent, check=True)


def headless(browser, profile, *words):
    """What the browser prints. Root has no sandbox."""
    sandbox = ["--no-sandbox"] if os.geteuid() == 0 else []
    return subprocess.run([browser, "--headless", "--disable-gpu", f"--user-data-dir={profile}", *sandbox, *words],
                          check=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def write_pdf(browser, profile, page):
    """The titles of slides that are too full."""
    headless(browser, profile, f"--print-to-pdf={page.with_suffix('.pdf')}", "--no-pdf-header-footer", page.as_uri())
    seen = headless(browser, profile, "--dump-dom", page.as_uri())
    return re.findall(r'<section id="([^"]*)"[^>]* class="[^"]*\bcut\b', seen)


def main(lessons):
    if not shutil.which("pandoc"):
        sys.exit("no slides without pandoc: apt-get install pandoc")
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    SLIDES.mkdir(parents=True, exist_ok=True)
    full = 0
    with tempfile.TemporaryDirectory() as profile:
        for handout in sorted((ROOT / "inputs" / "lessons").glob("[0-9]*/README.md")):
            source = handout.with_name("slides.md")
            if lessons and source.parent.name[:2] not in lessons:
                continue
            page = SLIDES / f"{source.parent.name}.html"
            write_html(source, page)
            for title in write_pdf(browser, profile, page) if browser else []:
                print(f"{source.relative_to(ROOT)}: the slide {title} has more than it can show")
                full += 1
            print(f"outputs/slides/{page.stem}.html{' and .pdf' if browser else ''}")
    if not browser:
        sys.exit("no PDF without Chromium: apt-get install chromium")
    return 1 if full else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
