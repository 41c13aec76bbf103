"""Where the functions of a C++ file are: those of the file itself and of its namespaces. Standard library only."""
import re
from dataclasses import dataclass, replace

NOT_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|'
                      r"^[ \t]*#(?:\\\n|[^\n])*", re.DOTALL | re.MULTILINE)
NAMESPACE = re.compile(r"(\bnamespace\b[^=;(]*|\bextern\s*)$")
KEYWORD = r"(?!(?:else|return|if|for|while|switch|do|case|new|delete|throw|using|typedef|goto|co_return)\b)"
HEAD = re.compile(rf"^{KEYWORD}[A-Za-z_][\w:<>,&*\[\] ]*[\s&*>]([\w:]+)\s*\([^;{{}}]*\)[^;{{}}]*\{{", re.MULTILINE)
CLASS = re.compile(r"^\s*(template\s*<[^{]*>\s*)?(struct|class|union|enum)\b[^(]*$")


@dataclass(frozen=True)
class Function:
    name: str
    start: int      # its first character in the text,
    body: int       # that of its body
    end: int        # and the one after its last
    first: int      # its first and last line, from 1
    last: int
    is_whole: bool  # whether its braces match


def code_of(text):
    """The same with blanks for comments, texts and directives."""
    return NOT_CODE.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def definitions(text):
    """The functions in their order. Where braces do not match over the file, a line that begins like a function,
    without a blank, ends the one before."""
    code = code_of(text)
    strict = parse(code, [])
    return parse(code, [found.start() for found in HEAD.finditer(code)]) if strict is None else strict


def parse(code, heads):
    """None where the braces do not match and there are no heads to go by."""
    found, depth, begin, i = [], 0, 0, 0
    while i < len(code):
        character = code[i]
        if character == "{":
            if NAMESPACE.search(code[begin:i]):
                depth += 1
            else:
                end = closing(code, i, heads)
                if end is None:
                    return None
                found += function_of(code, begin, i, *end)
                i = begin = end[0]
                if code[i:i + 1] == ";":
                    i = begin = i + 1
                continue
            begin = i + 1
        elif character == "}":
            if "{" not in code[i:] or depth > (1 if heads else 0):
                depth -= 1
            elif not heads:
                return None
            elif found:
                found[-1] = replace(found[-1], end=i + 1, last=code.count("\n", 0, i) + 1, is_whole=False)
            begin = i + 1
        elif character == ";":
            begin = i + 1
        i += 1
    if depth > 0 and heads and found:  # the last one has taken the brace of its namespace
        last = found[-1]
        found[-1] = replace(last, end=last.end - 1, last=code.count("\n", 0, last.end - 1) + 1, is_whole=False)
    return found if depth == 0 or heads else None


def closing(code, opening, heads):
    """(the place after the brace that closes, whether there is one); None: there is none."""
    depth = 0
    limit = next((head for head in heads if head > opening), len(code) if heads else None)
    for i in range(opening, len(code) if limit is None else limit):
        depth += {"{": 1, "}": -1}.get(code[i], 0)
        if depth == 0:
            return i + 1, True
    return None if limit is None else (limit, False)


def function_of(code, begin, body, end, is_whole):
    """A list of one function, or of none: what begins there may be a class or a variable."""
    head = code[begin:body]
    names = re.findall(r"([\w:~]+)\s*\(", head)
    if not names or CLASS.match(head) or re.match(r"[^(]*[^=!<>]=[^=]", head):
        return []
    start = begin + len(head) - len(head.lstrip())
    line = code.count("\n", 0, start) + 1
    return [Function(names[0], start, body, end, line, code.count("\n", 0, end) + 1, is_whole)]
