#!/usr/bin/env bash
# Decimates the dragon under guaranteed bounds of the distance, measures the distance, and puts the table into
# bench/results/distances-2core-epyc.md and docs/performance.md. Needs jq (Debian: jq). Takes some minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v jq >/dev/null || { echo "$0: needs jq: apt-get install jq" >&2; exit 1; }
mesh=data/dragon/dragon_vrip.ply.gz
[ -e $mesh ] || { echo "$0: needs the dragon: tools/fetch_data.sh dragon" >&2; exit 1; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
result=bench/results/distances-2core-epyc.md
percent() { jq -r "$1" "$2" | awk '{ printf "%.3g %%", 100 * $1 }'; }
row() {
  local bound=$1
  shift
  build/release/bin/vkmesh simplify $mesh "$scratch/out.ply" "$@" --json >"$scratch/simplified" 2>/dev/null
  build/release/bin/vkmesh compare $mesh "$scratch/out.ply" --tolerance 0 --samples 500000 --json >"$scratch/compared" 2>/dev/null
  local told
  told=$(jq -s '.[0].result.distance_bound / .[1].result.diagonal' "$scratch/simplified" "$scratch/compared")
  printf '| %s | %s | %s | %s | %s | %.1f s |\n' "$bound" "$(percent .result.ratio "$scratch/simplified")" \
    "$(awk -v x="$told" 'BEGIN { printf "%.3g %%", 100 * x }')" \
    "$(percent '.result.two_sided.maximum / .result.diagonal' "$scratch/compared")" \
    "$(percent '.result.two_sided.mean / .result.diagonal' "$scratch/compared")" \
    "$(jq '.timings_ms.compute / 1000' "$scratch/simplified")"
}
{
  echo "| \`--max-relative-distance\` | faces left | bound told | largest of 500,000 samples each way | mean | takes |"
  echo "| --- | ---: | ---: | ---: | ---: | ---: |"
  for bound in 3e-4 1e-3 3e-3; do row $bound --ratio 0.005 --max-relative-distance $bound; done
  row "none, \`--ratio 0.1 --watch-distance\`" --ratio 0.1 --watch-distance
} >$result
sed -i -e '/^<!-- distances -->/,/^<!-- end of distances -->/{//!d}' -e "/^<!-- distances -->/r $result" docs/performance.md
