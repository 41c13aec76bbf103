#!/usr/bin/env python3
"""Writes the shortest proof there is for a mesh of triangles, with no claim in it: forge.py MESH > PROOF. It knows
nothing of the mesh but its bytes and the number of its triangles. Whether the proof proves anything is for a checker
to say."""
import sys

data = open(sys.argv[1], "rb").read()
h = 14695981039346656037
for byte in data:
    h = (h ^ byte) * 1099511628211 % 2 ** 64
section = data.decode().split("$Elements\n")[1].split("\n$EndElements")[0]
triangles = sum(line.split()[1] in ("2", "9") for line in section.split("\n")[1:])
print(f"almesh proof 1\nversion forged\nhash {h:016x}\nelements {triangles}\nend 5")
