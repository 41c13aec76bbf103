#!/usr/bin/env python3
"""What `almesh --json` printed: every line is an object that outputs/schema.json allows, and the last one says how the
command ended.

  almesh --json DECK 2> log.txt | tests/json_lines.py [FOLDER] [--open]

FOLDER: of the results; what summary.txt, history.csv, frames.csv and sweep.csv there have is what the lines have, to the
last digit. --open: of a program that was killed: there may be no last object, and the end of the last line may be
missing. The schema is read by the few of its words that it uses; a text that is no JSON as RFC 8259 has it, or names a
member twice, is refused. Exit code 1 where one of this does not hold. Standard library only.
"""
import csv
import json
import sys
from collections import Counter
from pathlib import Path

SCHEMA = json.loads((Path(__file__).resolve().parent.parent / "outputs" / "schema.json").read_text(encoding="utf-8"))
KNOWN = {"$ref", "$defs", "$schema", "title", "description", "unit", "type", "enum", "const", "anyOf", "oneOf", "items",
         "required", "properties", "additionalProperties", "unevaluatedProperties"}


class Number(str):
    """A number as it is written."""


def members_once(pairs):
    if len({name for name, _ in pairs}) < len(pairs):
        raise ValueError(f"a member is there twice: {[name for name, _ in pairs]}")
    return dict(pairs)


def no_number(text):
    raise ValueError(f"{text} is no number of JSON")


def parse(line):
    return json.loads(line, object_pairs_hook=members_once, parse_float=Number, parse_int=Number,
                      parse_constant=no_number)


def is_type(value, name):
    if name in ("number", "integer"):
        return isinstance(value, Number) and (name == "number" or value.lstrip("-").isdigit())
    if name == "string":
        return isinstance(value, str) and not isinstance(value, Number)
    return isinstance(value, {"null": type(None), "array": list, "object": dict}[name])


def is_allowed(schema, value):
    """Whether the value is as the schema says."""
    try:
        check(schema, value, "")
    except ValueError:
        return False
    return True


def allowed(schema):
    """The members that an object of the schema may have."""
    other = SCHEMA["$defs"][schema["$ref"].split("/")[-1]] if "$ref" in schema else {}
    return {**(allowed(other) if other else {}), **schema.get("properties", {})}


def check(schema, value, where):
    """Throws ValueError where the value is not as the schema says."""
    def need(holds, what):
        if not holds:
            raise ValueError(f"{where}: {what}: {json.dumps(value)[:200]}")

    need(set(schema) <= KNOWN, f"the schema has other words, {set(schema) - KNOWN}")
    if "$ref" in schema:
        check(SCHEMA["$defs"][schema["$ref"].split("/")[-1]], value, where)
    if "type" in schema:
        types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        need(any(is_type(value, name) for name in types), f"not of type {types}")
    if "enum" in schema:
        need(value in [Number(entry) if isinstance(entry, int) else entry for entry in schema["enum"]], "not in the list")
    if "const" in schema:
        need(value == schema["const"], f"not {schema['const']}")
    if "anyOf" in schema:
        need(any(is_allowed(one, value) for one in schema["anyOf"]), "none of what is allowed")
    if "oneOf" in schema:
        of_kind = [one for one in schema["oneOf"] if allowed(one)["event"]["const"] == value.get("event")]
        need(len(of_kind) == 1, "no such event")
        check(of_kind[0], value, value["event"])
    for k, item in enumerate(value if "items" in schema else []):
        check(schema["items"], item, f"{where}[{k}]")
    if "additionalProperties" in schema:
        for name, item in value.items():
            check(schema["additionalProperties"], item, f"{where}.{name}")
    need(all(name in value for name in schema.get("required", [])), "a member is missing")
    for name, item in value.items() if "properties" in schema else ():
        if name in schema["properties"]:
            check(schema["properties"][name], item, f"{where}.{name}")
    if schema.get("unevaluatedProperties") is False:
        need(set(value) <= set(allowed(schema)), f"the schema lacks {set(value) - set(allowed(schema))}")


def as_in_file(value):
    """What a file of results has in its place; there texts have other quotes and stand on one line."""
    return "none" if value is None else value.replace('"', "'").replace("\n", " ")


def same(found, wanted, where):
    """Compares the members of two rows: those of the file that are not empty, and of the line what the file has."""
    found = {name: as_in_file(value) for name, value in found.items() if name in wanted}
    wanted = {name: as_in_file(value) for name, value in wanted.items() if value != ""}
    if found != wanted:
        raise ValueError(f"{where}: {dict(set(found.items()) ^ set(wanted.items()))}")


def compare(lines, folder):
    """Lines beside the files of results. Returns the names of those that there are."""
    of = {event: [line for line in lines if line["event"] == event] for event in ("iteration", "frame", "run")}
    names = []

    def rows_of(name):
        if not (folder / name).exists():
            return []
        names.append(name)
        with open(folder / name, newline="", encoding="utf-8", errors="replace") as file:
            return list(csv.DictReader(file))

    if of["frame"]:
        for line, row in zip(of["frame"], rows_of("frames.csv"), strict=True):
            same(line, row, f"frame {line['frame']}")
    elif (folder / "summary.txt").exists():
        names.append("summary.txt")
        text = (folder / "summary.txt").read_text(encoding="utf-8", errors="replace")
        summary = dict(line.split(" = ", 1) for line in text.splitlines())
        same(lines[-1], summary, "summary.txt")
        if list(summary) != list(SCHEMA["$defs"]["quantities"]["properties"]):
            raise ValueError("summary.txt has other quantities than the schema")
        for line, row in zip(of["iteration"], rows_of("history.csv"), strict=True):
            same(line, row, "history.csv")
            if set(row) | {"event"} != set(SCHEMA["$defs"]["iteration"]["properties"]):
                raise ValueError("history.csv has other columns than the schema")
    table = {row["number"]: row for row in rows_of("sweep.csv")}
    for line in of["run"]:
        results, row = line["results"], dict(table.pop(line["number"]))
        values = {name: row.pop(name) for name in results["values"] if name not in results}  # else a quantity, too
        same(results["values"], values, "values")
        same(results, {name: value for name, value in row.items() if name != "number"}, f"run {line['number']}")
    if table:
        raise ValueError(f"no lines for the runs {list(table)}")
    return names


def main():
    folder = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    is_open = "--open" in sys.argv[1:]
    text = sys.stdin.buffer.read().decode("utf-8")  # strict: no other bytes
    *whole, rest = text.split("\n")
    lines = [parse(line) for line in whole]
    for line in lines:
        check(SCHEMA, line, "")
    ends = [k for k, line in enumerate(lines) if line["event"] == "end"]
    if not is_open and (rest or ends != [len(lines) - 1]):
        raise ValueError("there is not one last object")
    names = compare(lines, Path(folder[0])) if folder else []
    counts = Counter(line["event"] for line in lines)
    print(", ".join(f"{count} {event}" for event, count in counts.items()) + ": as in outputs/schema.json" +
          (", numbers as in " + ", ".join(names) if names else ""))


if __name__ == "__main__":
    try:
        main()
    except (ValueError, KeyError) as error:
        sys.exit(f"tests/json_lines.py: {type(error).__name__}: {str(error)[-500:]}")
