#!/usr/bin/env python3
"""The table behind the defaults of `objective`, `weight_exponent` and `power`: runs every case below with every choice,
prints the worst distortion and the Newton steps of each, and writes the table to outputs/defaults/table.md.

  plot/defaults.py          the same as `make defaults`; some minutes
  plot/defaults.py WORD...  the cases whose names contain one of the words

Standard library only.
"""
import subprocess
import sys

import runs

CHOICES = [("squared", "1", "2"), ("deviation", "1", "2"), ("deviation", "0.5", "2"), ("deviation", "0", "2"),
           ("deviation", "0.5", "4"), ("minimax", "0", "auto")]
CASES = [
    ("circle translated by 8", "circle", []),
    ("by 14", "circle", ["boundary inner=translate 14 0"]),
    ("by 18", "circle", ["boundary inner=translate 18 0"]),
    ("rotated by 90", "circle", ["boundary inner=rotate 90 about 0 0"]),
    ("rotated by 180", "circle", ["boundary inner=rotate 180 about 0 0"]),
    ("grown 4 times", "circle", ["boundary inner=scale 4 about 0 0"]),
    ("circle refined, by 8", "circle-refined-2", []),
    ("boundary layer curved, degree 4", "curving", []),
    ("channel with a bump", "channel-bump", []),
    ("shell of a sphere, degree 3", "sphere-shell", []),
    ("plate rotated by 90", "gauntlet/plate-turned", ["boundary plate=rotate 90 about 0 0"]),
    ("plate rotated by 180", "gauntlet/plate-turned", []),
    ("block rotated by 180", "gauntlet/block-turned", []),
    ("airfoil turned by 150", "gauntlet/airfoil-turned", []),
    ("aircraft translated by 4", "aircraft", ["length_scale=auto", "omega_star=1e-8", "epsilon_star=1e-14"]),
    ("aircraft pitched by 90", "aircraft", ["boundary aircraft=rotate 90 axis 0 1 0 about 0 0 0",
                                            "length_scale=auto", "omega_star=1e-8", "epsilon_star=1e-14"]),
]
CASES = [case for case in CASES if not sys.argv[1:] or any(word in case[0] for word in sys.argv[1:])]
LIMIT = 120  # seconds of one run


def run(number, deck, objective, alpha, power, settings):
    """(worst distortion, Newton steps) as text."""
    name = f"defaults/{number}-{objective}-{alpha}-{power}"
    command = ["./almesh", f"inputs/{deck}.deck", "algorithm=adaptive", f"objective={objective}",
               f"weight_exponent={alpha}", f"power={power}", f"output=outputs/{name}", "vtk=none", *settings]
    try:
        code = subprocess.run(command, stdout=subprocess.DEVNULL, timeout=LIMIT, check=False).returncode
    except subprocess.TimeoutExpired:
        return f"not in {LIMIT} s", ""
    if code not in (0, 3, 4, 5):
        sys.exit(f"{' '.join(command)} ended with exit code {code}")
    summary = runs.summary(name)
    steps = sum(int(summary[f"{part}newton_iterations"]) for part in ("", "earlier_", "coarse_"))
    if summary["status"] != "converged" or summary["certified_injective"] != "yes":
        return summary["status"], str(steps)
    return f"{float(summary['max_distortion']):.4g}", str(steps)


def main():
    formula = {"squared": "∫η²", "deviation": "Eq. 5", "minimax": "minimax"}
    titles = [f"{formula[objective]}, α {alpha}" + (", power 4" if power == "4" else "")
              for objective, alpha, power in CHOICES]
    lines = ["| worst η (Newton steps) | " + " | ".join(titles) + " |", "|---" * (len(titles) + 1) + "|"]
    for number, (title, deck, settings) in enumerate(CASES):
        cells = ["{} ({})".format(*run(number, deck, *choice, settings)) for choice in CHOICES]
        lines.append(f"| {title} | " + " | ".join(cells) + " |")
        print(lines[-1], flush=True)
    (runs.OUTPUTS / "defaults" / "table.md").write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
