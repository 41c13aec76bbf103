"""What an answer may not be made of: files of the checkout beyond those that its exercises include, in whatever
spelling, functions of the library in the student's place, and what belongs to other programs. Standard library only.
"""
import re
import subprocess
from functools import lru_cache
from pathlib import Path

from running import ROOT, environment

# What the headers that exercises need would do in place of the student.
LIBRARY = re.compile(r"\b(matrix_of_cells|pattern_of_cells|density_gradient|distortion\s*<)")
QUOTED = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
# Directives that say that what follows is another file's text.
RELOCATED = re.compile(r"^(?:.*\*/)?\s*(?:#|%:|\?\?=)(?:\s|/\*.*?\*/)*(?:line\b|\d)", re.MULTILINE)
# Code that the compiler does not read, or that its sanitizers do not watch.
UNWATCHED = re.compile(r"\b(asm|__asm__|__asm|\w*no_sanitize\w*|\w*no_address_safety\w*|\w*disable_sanitizer\w*|"
                       r"__(?:a|ub)san_\w*)\b")
# Of other programs, their memory, and code that is loaded: nothing that an answer needs.
REFUSED = set("""dlopen dlmopen dlsym dlvsym dl_iterate_phdr fork vfork _Fork clone posix_spawn posix_spawnp execl
    execle execlp execv execve execvp execvpe fexecve system popen ptrace kill killpg tgkill pthread_kill sigqueue
    syscall process_vm_readv process_vm_writev prctl setsid setpgid""".split())


@lru_cache(maxsize=None)
def closure(header):
    """The header and all of the checkout that it includes."""
    found, left = {}, [ROOT / "src" / header]
    while left:
        path = left.pop()
        if path not in found and path.is_file():
            found[path] = path.read_text()
            left += [place / name for name in QUOTED.findall(found[path]) for place in (ROOT / "src", path.parent)]
    return found


@lru_cache(maxsize=None)
def system_folders(command):
    """Where the compiler looks for headers in angles, but for those of the checkout."""
    said = subprocess.run([*command, "-E", "-v", "-x", "c++", "-"], stdin=subprocess.DEVNULL, text=True, cwd=ROOT,
                          capture_output=True, env=environment()).stderr
    found = said.partition("search starts here:")[2].partition("End of search list")[0].splitlines()
    folders = [Path(ROOT, line.split(" (")[0].strip()).resolve() for line in found if line.startswith(" ")]
    return [folder for folder in folders if not folder.is_relative_to(ROOT)]


def foreign_file(dependencies, header, command):
    """A file that an answer is made of, and that is neither the compiler's nor needed by the exercises."""
    allowed = {path.resolve() for path in closure(header)}
    names = re.split(r"(?<!\\)\s+", dependencies.replace("\\\n", " ").partition(":")[2].strip())
    for name in names:
        path = Path(ROOT, name.replace("\\ ", " ")).resolve()
        if name and path not in allowed and not any(path.is_relative_to(folder) for folder in system_folders(command)):
            return path
    return None


def own_part(preprocessed):
    """The lines that are the student's, macros replaced."""
    kept_lines, own = [], False
    for line in preprocessed.splitlines():
        if marker := re.match(r'# \d+ "(.*?)"', line):
            own = marker[1] == "<stdin>"
        elif own:
            kept_lines.append(line)
    return "\n".join(kept_lines)


def without_texts(code):
    return re.sub(r'"(?:\\.|[^"\\\n])*"', '""', code)


def symbols(path, *options):
    done = subprocess.run(["nm", "-P", *options, path], text=True, capture_output=True, env=environment())
    return [line.split()[0].split("@")[0] for line in done.stdout.splitlines() if line.strip()]


def plain_names(names):
    return subprocess.run(["c++filt"], input="\n".join(names), text=True, capture_output=True).stdout.splitlines()


def refused_symbol(obj, header):
    """Why the object may not be linked, or ""."""
    texts = "\n".join(re.sub(r"//[^\n]*", "", text) for text in closure(header).values())
    wanted = symbols(obj, "-u")
    refused = next((symbol for symbol in wanted if symbol in REFUSED), None)
    if refused:
        return f"calls {refused}: an answer computes, and leaves other programs and their memory alone"
    for name in plain_names(wanted):
        called = re.match(r"(?:.* )?almesh::(?!lessons::)(?:\w+::)*(\w+)[(<\[]", name)
        if called and (LIBRARY.search(name) or not re.search(rf"\b{called[1]}\(", texts)):
            return f"calls {called[1]}, which is the library's: write what it does yourself"
    return ""
