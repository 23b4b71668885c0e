#!/usr/bin/env bash
# Measures decimation beside its peers and writes the table that docs/performance.md shows. Downloads nothing.
#   tools/decimation_table.sh [REPETITIONS [OUT]]
# Writes OUT.md and OUT.json, by default bench/results/decimation-2core-xeon, which docs/performance.md then shows. Nine
# repetitions take about four minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/lib.sh

committed=bench/results/decimation-2core-xeon
repetitions=${1:-9} out=${2:-$committed}

missing=()
[ -e data/dragon/dragon_vrip.ply.gz ] || missing+=("the dragon: tools/fetch_data.sh dragon")
[ -e /usr/include/meshoptimizer.h ] && [ -d /usr/include/OpenMesh ] ||
  missing+=("OpenMesh and meshoptimizer as Debian has them: tools/setup.sh test")
if [ ${#missing[@]} -gt 0 ]; then
  printf 'decimation_table: missing is %s\n' "${missing[@]}" >&2
  exit 1
fi

build_preset release -DVKMESH_BENCH=ON -- vkmesh_bench
build/release/bin/vkmesh_bench data/dragon/dragon_vrip.ply.gz --only decimation --ratio 0.1 0.01 --device none \
  --repetitions "$repetitions" --markdown "$out.md" --json "$out.json"
[ "$out" = "$committed" ] || exit 0
sed -i -e '/^<!-- table -->/,/^<!-- end of table -->/{//!d}' -e "/^<!-- table -->/r $out.md" docs/performance.md
