#!/bin/sh
# Fuzzes one harness after the other (all, or those named), each for some minutes: tests/fuzz/fuzz.sh PROGRAM MINUTES
# [HARNESS ...]. What was found new grows in outputs/fuzz/HARNESS/; findings land in outputs/fuzz/, with the files that
# the harness was working on. Exit code 1 where there are any.
set -u
program=$1
minutes=$2
shift 2
[ $# -gt 0 ] || set -- deck msh su2 vtk inp vtu frames rows quality improve run library
memory=${TMPDIR:-/tmp}
if [ -w /dev/shm ]; then memory=/dev/shm; fi
found=0
for harness in "$@"; do
    corpus=outputs/fuzz/$harness
    mkdir -p "$corpus"
    # Whole runs and meshes are made from a few choices; files are longer.
    case $harness in run | quality | improve | library) longest=200 ;; *) longest=4000 ;; esac
    work=$(mktemp -d "$memory/almesh-fuzz.XXXXXX")
    log=outputs/fuzz/$harness.log
    echo "$harness: $minutes min"
    HARNESS=$harness TMPDIR=$work "$program" -max_total_time=$((minutes * 60)) -max_len=$longest \
        -len_control=0 -timeout=120 \
        -rss_limit_mb=3000 -print_final_stats=1 -artifact_prefix="outputs/fuzz/$harness-" \
        "$corpus" "tests/fuzz/seeds/$harness" >"$log" 2>&1
    code=$?
    grep -E 'DONE|what\(\)|ERROR|SUMMARY|number_of_executed_units|slowest_unit' "$log"
    if [ $code -ne 0 ]; then
        found=1
        rm -rf "outputs/fuzz/$harness-files"
        cp -r "$work" "outputs/fuzz/$harness-files"
        input=$(sed -n 's/.*Test unit written to //p' "$log" | tail -1)
        echo "found: $log; its files are in outputs/fuzz/$harness-files"
        echo "again: HARNESS=$harness $program $input"
        echo "smaller: HARNESS=$harness $program -minimize_crash=1 -runs=10000 $input"
    fi
    rm -rf "$work"
done
exit $found
