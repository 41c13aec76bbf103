#!/bin/sh
# Regenerates every mesh of this folder from its .geo file and prints the node and
# element counts that came out, next to those of the committed files. One thread
# (gmsh -nt 1): with two, gmsh gives another mesh on every run.
#
#   sh inputs/meshes/generate.sh        or        make meshes
set -eu
cd "$(dirname "$0")"

if ! command -v gmsh >/dev/null 2>&1; then
  echo "generate.sh: gmsh not found. On Debian or Ubuntu: apt-get install gmsh" >&2
  echo "The meshes are committed: gmsh is needed only to make them anew." >&2
  exit 1
fi

version=$(gmsh --version 2>&1)
echo "gmsh $version (the committed meshes are from 4.8.4; others may count differently)"

# Nodes in the file and elements of dimension $2, MSH 2.2 or 4.1.
counts() {
  awk -v dim="$2" '
    BEGIN {
      split("2 9 21 3 10 36", t2); split("4 11 29 5 6 7", t3)
      for (i in t2) of_type[t2[i]] = 2
      for (i in t3) of_type[t3[i]] = 3
    }
    /^\$/ { section = $1; line = 0; next }
    { line++ }
    section == "$MeshFormat" { format = $1 + 0 }
    section == "$Nodes" && line == 1 { nodes = (format < 4) ? $1 : $2 }
    section == "$Elements" && format < 4 && line > 1 && of_type[$2] == dim { cells++ }
    section == "$Elements" && format >= 4 && line > 1 {
      if (left > 0) { left--; next }
      left = $4
      if ($1 == dim) cells += $4
    }
    END { print nodes + 0, cells + 0 }' "$1"
}

log=$(mktemp)
trap 'rm -f "$log" new.msh' EXIT

printf '%-18s %8s %9s   %s\n' mesh nodes elements "committed file"

# name, dimension, format, degree, nodes and elements of the committed file; where
# they are not the name's, the .geo file and options
while read -r name dim format degree nodes cells geo options; do
  # shellcheck disable=SC2086
  if ! gmsh -nt 1 "-$dim" -order "$degree" -format "$format" "${geo:-$name}.geo" $options -o new.msh \
       >"$log" 2>&1; then
    echo "generate.sh: gmsh failed on ${geo:-$name}.geo:" >&2
    grep Error "$log" >&2 || cat "$log" >&2
    exit 1
  fi
  made=$(counts new.msh "$dim")
  mv new.msh "$name.msh"
  if [ "$made" = "$nodes $cells" ]; then verdict="the same"; else verdict="$nodes $cells"; fi
  printf '%-18s %8s %9s   %s\n' "$name.msh" "${made% *}" "${made#* }" "$verdict"
done <<TABLE
circle        2  msh22  1    841   1642
curving       2  msh22  1    697   1368
aircraft      3  msh22  1  20198  97861
square        2  msh41  1     65    104
cube          3  msh41  1    133    378
channel-bump  2  msh41  3    550    112
sphere-shell  3  msh41  1    238    922
plate         2  msh22  1    940   1742
block         2  msh22  1    492    912
airfoil       2  msh22  1   4478   8706
plates        3  msh22  1   4215  22777
airfoil-layers  2  msh22  1 10029  19808
torus         3  msh22  3   6078   1020
sphere-layers  3  msh22  1   1146   6344
piston        3  msh22  1    366   1291
bump          2  msh41  3     91     16
inclusion     2  msh41  1    289    525
inclusion-3d  3  msh22  1    267    923
layer         2  msh22  1    318    580
circle-quads  2  msh22  1    815    795
curving-quads  2  msh22  1   697    864
airfoil-quads  2  msh41  1  1044   1414
rotor         3  msh41  1   1168    780
sphere-prisms  3  msh22  1  1146   2804 sphere-layers -setnumber prisms 1
half-aircraft  3  msh22  1   3541  16590 aircraft -setnumber half 1 -setnumber h_edge 0.03 -setnumber h_body 0.09
TABLE
python3 solids.py
