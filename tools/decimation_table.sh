#!/usr/bin/env bash
# Measures decimation beside its peers and writes the table that docs/decimation.md shows. Downloads nothing.
#   VKMESH_MESHOPTIMIZER_SOURCE=FOLDER tools/decimation_table.sh [REPETITIONS [OUT]]
# FOLDER holds the sources of meshoptimizer 1.2 or later. Writes OUT.md and OUT.json, by default
# bench/results/decimation-2core-xeon, which docs/decimation.md then shows. Nine repetitions take about five minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/lib.sh

committed=bench/results/decimation-2core-xeon
repetitions=${1:-9} out=${2:-$committed}
peers=${VKMESH_MESHOPTIMIZER_SOURCE:-}

missing=()
[ -e data/dragon/dragon_vrip.ply.gz ] || missing+=("the dragon: tools/fetch_data.sh dragon")
[ -e /usr/include/meshoptimizer.h ] && [ -d /usr/include/OpenMesh ] ||
  missing+=("OpenMesh and meshoptimizer as Debian has them: tools/setup.sh test")
[ -n "$peers" ] && [ -e "$peers/src/meshoptimizer.h" ] || missing+=("a newer meshoptimizer: git clone --branch v1.2 \
https://github.com/zeux/meshoptimizer FOLDER, and VKMESH_MESHOPTIMIZER_SOURCE=FOLDER $0")
if [ ${#missing[@]} -gt 0 ]; then
  printf 'decimation_table: missing is %s\n' "${missing[@]}" >&2
  exit 1
fi

build_preset release -DVKMESH_BENCH=ON -DVKMESH_MESHOPTIMIZER_SOURCE="$(realpath "$peers")" -- vkmesh_bench
build/release/bin/vkmesh_bench data/dragon/dragon_vrip.ply.gz --only decimation --ratio 0.1 0.01 --device none \
  --repetitions "$repetitions" --markdown "$out.md" --json "$out.json"
[ "$out" = "$committed" ] || exit 0
sed -i -e '/^<!-- table -->/,/^<!-- end of table -->/{//!d}' -e "/^<!-- table -->/r $out.md" docs/decimation.md
