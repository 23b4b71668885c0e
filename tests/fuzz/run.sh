#!/usr/bin/env bash
# Fuzzes: tests/fuzz/run.sh [SECONDS [TARGET...]], by default each target for 60 seconds, one after another.
# What was learnt stays in build/fuzz/corpus, so that a later run goes on from there; an input that breaks something
# is kept in build/fuzz/crashes. A summary of one line for each target; the exit status is 1 when one was broken.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/lib.sh

seconds=60
[ $# -eq 0 ] || { seconds=$1; shift; }
build_preset fuzz
if [ $# -gt 0 ]; then
  targets=("$@")
else
  targets=()
  for program in build/fuzz/bin/fuzz_*; do
    name=${program##*/fuzz_}
    [ "$name" = seeds ] || targets+=("$name")
  done
fi
build/fuzz/bin/fuzz_seeds build/fuzz/seeds

status=0 summary=
for target in "${targets[@]}"; do
  corpus=build/fuzz/corpus/$target crashes=build/fuzz/crashes/$target log=build/fuzz/$target.log
  mkdir -p "$corpus" "$crashes"
  verdict=clean
  # A run ends after its time or at the first input that breaks something.
  build/fuzz/bin/fuzz_"$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=4096 \
    -artifact_prefix="$crashes/" -print_final_stats=1 "$corpus" "build/fuzz/seeds/$target" >"$log" 2>&1 </dev/null || {
    verdict="BROKEN, see $log and $crashes"
    status=1
  }
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  coverage=$(grep -oE 'cov: [0-9]+' "$log" | tail -n 1 | cut -d' ' -f2 || true)
  summary+="$target: ${executions:-0} executions, ${coverage:-0} edges covered, $verdict"$'\n'
done
echo "== Fuzzing, $seconds s a target"
printf %s "$summary"
exit $status
