#!/usr/bin/env bash
# Draws how the time of a triangle grows with the mesh: what `vkmesh bench FILES --splits N --json` has printed, to an
# SVG file. Needs jq and gnuplot (Debian: jq, gnuplot-nox).
set -euo pipefail
if [ $# -ne 2 ]; then
  echo "usage: tools/plot_growth.sh BENCH.json PICTURE.svg" >&2
  exit 2
fi
for program in jq gnuplot; do
  command -v "$program" > /dev/null || { echo "$0: needs $program: apt-get install jq gnuplot-nox" >&2; exit 1; }
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
jq -r '.result.rows[] | [.pass, .triangles, .ns_per_triangle] | @tsv' "$1" > "$scratch/rows"
plots=""
while IFS= read -r pass; do
  awk -F '\t' -v pass="$pass" '$1 == pass { print $2, $3 }' "$scratch/rows" > "$scratch/${pass// /_}"
  plots+="'$scratch/${pass// /_}' with linespoints title '$pass', "
done < <(cut -f 1 "$scratch/rows" | awk '!seen[$0]++')
# The least growth that a heap promises, from the first row's size and time on.
read -r size time < <(awk -F '\t' 'NR == 1 { print $2, $3 }' "$scratch/rows")
gnuplot <<PLOT
set terminal svg size 800,500 background "white"
set output "$2"
set logscale xy
set xlabel "triangles"
set ylabel "nanoseconds for each"
set key outside right
plot $plots $time * log(x) / log($size) with lines dashtype 2 linecolor "gray" title "log n"
PLOT
