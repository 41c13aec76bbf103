#!/usr/bin/env python3
"""Large motions in one table: reads outputs/gauntlet/<deck>/ of every deck of inputs/gauntlet/, prints the table and
writes it to outputs/gauntlet/table.md.

  plot/gauntlet.py      the same as the last step of `make gauntlet`

Ends with exit code 1, and one line per failure on stderr, where a deck has not been run or one of its `expect` lines
does not hold. Standard library only.
"""
import sys

import runs

DECKS = runs.OUTPUTS.parent / "inputs" / "gauntlet"
QUANTITIES = ["status", "certified_injective", "newton_iterations", "earlier_newton_iterations", "max_distortion",
              "certified_bound", "refined_elements", "relative_boundary_error", "nodes_off_target", "time_run"]


def main():
    lines = ["| deck | " + " | ".join(QUANTITIES) + " |", "|---" * (len(QUANTITIES) + 1) + "|"]
    failures = []
    for deck in sorted(f"gauntlet/{path.stem}" for path in DECKS.glob("*.deck")):
        try:
            summary = runs.summary(deck)
            lines.append(f"| {deck} | " + " | ".join(summary[quantity] for quantity in QUANTITIES) + " |")
            failures += [f"{deck}: expected {row['quantity']} {row['expected']}, got {row['got']}"
                         for row in runs.expectations(deck) if row["holds"] != "yes"]
        except (runs.MissingRun, runs.MissingName) as error:
            failures.append(str(error))
    table = "\n".join(lines) + "\n"
    print(table)
    (runs.OUTPUTS / "gauntlet").mkdir(parents=True, exist_ok=True)
    (runs.OUTPUTS / "gauntlet" / "table.md").write_text(table)
    for failure in failures:
        print(failure, file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
