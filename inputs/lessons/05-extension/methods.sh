#!/bin/sh
# methods.sh "PROGRAM ..." "DISTANCES" [TITLE]: the circle translated by each distance by a program with its arguments; the
# distortion of the worst element, inf where one is inverted.
here=inputs/lessons/05-extension summary=outputs/lessons/05-extension/circle/summary.txt
line=$(printf '%-22s' "${3:-$1}")
for distance in $2; do
    $1 $here/circle.deck "boundary inner = translate $distance 0" > /dev/null
    line="$line $(printf '%s' "$distance:"; sed -n 's/^max_distortion = / /p' $summary) "
done
echo "$line"
