#!/usr/bin/python3
"""Draws outputs/figures/*.png from outputs/<deck>/: the counterparts of the paper's Figures 1-10, the README's picture;
from outputs/bench.csv, where there is one: the growth of time and memory, the shares of the stages.

  plot/figures.py [name ...]     all, or those named: fig01 ... fig10, readme, scaling, splits

Ends with exit code 1 where a run, quantity or column is missing, which it names; the other figures are drawn. Needs numpy and matplotlib.
"""
import sys

try:
    import aircraft_figures
    import bench_figures
    import circle_figures
    import convergence_figures
    import curving_figures
    import readme_figure
    import runs
    import style
except ModuleNotFoundError as error:
    sys.exit(f"{error}: the figures need numpy and matplotlib "
             "(Debian: apt-get install python3-numpy python3-matplotlib, and run with /usr/bin/python3)")

FIGURES = {
    "fig01": circle_figures.fig01,
    "fig02": convergence_figures.fig02,
    "fig03": convergence_figures.fig03,
    "fig04": curving_figures.fig04,
    "fig05": curving_figures.fig05,
    "fig06": convergence_figures.fig06,
    "fig07": aircraft_figures.fig07,
    "fig08": aircraft_figures.fig08,
    "fig09": aircraft_figures.fig09,
    "fig10": convergence_figures.fig10,
    "readme": readme_figure.readme,
    "scaling": bench_figures.scaling,
    "splits": bench_figures.splits,
}


def main(names):
    unknown = [name for name in names if name not in FIGURES]
    if unknown:
        print(f"no figure `{unknown[0]}`: there are {', '.join(FIGURES)}", file=sys.stderr)
        return 1
    style.apply()
    missing = False
    for name in names or FIGURES:
        try:
            FIGURES[name]()
            print(f"outputs/figures/{name}.png")
        except (runs.MissingRun, runs.MissingName) as error:
            print(f"{name} not drawn: {error}", file=sys.stderr)
            missing = True
        except runs.NoBench as error:
            print(f"{name} left out: {error}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
