#!/bin/sh
# methods.sh PROGRAM "METHODS" "DISTANCES" [KEY=VALUE]: the circle translated by each distance with each method; the
# distortion of the worst element, inf where one is inverted.
here=inputs/lessons/05-extension summary=outputs/lessons/05-extension/circle/summary.txt
for method in $2; do
    line=$(printf '%-22s' "$method")
    for distance in $3; do
        "$1" $here/circle.deck "boundary inner = translate $distance 0" method="$method" $4 > /dev/null
        line="$line $(printf '%s' "$distance:"; sed -n 's/^max_distortion = / /p' $summary) "
    done
    echo "$line"
done
