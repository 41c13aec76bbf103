#!/bin/sh
# The manual page of a program, from what it says itself: packaging/man.sh build/almesh > almesh.1
set -eu
program=$1
# Verbatim lines: a backslash, a minus sign and a dot or quote at the beginning would be read as something else.
verbatim() {
    echo .nf
    sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"
    echo .fi
}
version=$("$program" --version | sed -n '1s/almesh \([^,]*\),.*/\1/p')
cat <<END
.TH ALMESH 1 "" "almesh $version" "User Commands"
.SH NAME
almesh \- move, curve and repair meshes without inverting an element
.SH SYNOPSIS
.B almesh
.I DECK
.RI [ key=value " ...]"
.br
.B almesh
.RB { info | quality | improve | adjoint | tangent | sweep }
.I FILE
.RI [ key=value " ...]"
.SH DESCRIPTION
END
"$program" --help | sed 's/^  almesh/almesh/' | verbatim
echo .SH KEYS OF A DECK
"$program" --keys | verbatim
echo .SH SEE ALSO
echo The C interface is documented in almesh.h, the one for C++ in almesh.hpp.
