#!/usr/bin/env bash
# Runs one piece of a Catch2 program's test cases: the K-th of every N, so that each test case is in exactly one of N pieces.
# Then says how long each took, as "duration: SECONDS NAME".
#   tests/support/run_piece.sh PROGRAM K N TEST-SPEC
set -euo pipefail
program=$1 piece=$2 pieces=$3 spec=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The exit status of a list is the number of its lines.
"$program" --list-test-names-only "$spec" >"$work/all" || true
awk -v piece="$piece" -v pieces="$pieces" 'NR % pieces == piece % pieces' "$work/all" >"$work/names"
count=$(wc -l <"$work/names")
[ "$count" -gt 0 ] || {
  echo "run_piece: $program has no test case for piece $piece of $pieces of '$spec'" >&2
  exit 1
}
# In the file that Catch2 reads, commas separate names.
sed 's/[\\,"[]/\\&/g; s/.*/"&"/' "$work/names" >"$work/input"
status=0
"$program" --input-file "$work/input" --durations yes >"$work/output" || status=$?
# A duration has the line of a test case or of one of its sections.
awk -v names="$work/names" '
  BEGIN { while ((getline name <names) > 0) total[name] = 0 }
  /^[0-9.]+ s: / {
    seconds = $1
    sub(/^[0-9.]+ s: /, "")
    if ($0 in total) total[$0] += seconds
    next
  }
  { print }
  END { for (name in total) printf "duration: %.3f %s\n", total[name], name }' "$work/output"
[ $status = 0 ] || exit $status
# Names that Catch2 read as something else would run more test cases, or fewer.
grep -qE "(^| in )$count test cases?\b|^test cases: +$count " "$work/output" || {
  echo "run_piece: $program ran other test cases than the $count of piece $piece of $pieces of '$spec'" >&2
  exit 1
}
