#!/usr/bin/env bash
# Does each test case of a Catch2 program that is not hidden belong to exactly one of the test specs that ctest runs?
#   tests/support/check_specs.sh PROGRAM TEST-SPEC...
set -euo pipefail
program=$1
shift
# The exit status of a list is the number of its lines.
names() { "$program" --list-test-names-only "$1" || true; }
[ -n "$(names '~[.]')" ] || {
  echo "check_specs: $program lists no test case" >&2
  exit 1
}
diff <(names '~[.]' | sort) <(for spec in "$@"; do names "$spec"; done | sort) || {
  echo "check_specs: < belongs to no spec of $*, > to two" >&2
  exit 1
}
