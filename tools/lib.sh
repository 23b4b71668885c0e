# Shell functions of ./demo and ./test. To be sourced from the top folder.

# Objects are found again after a fresh clone where ccache is there; it is not needed.
if command -v ccache >/dev/null; then export CCACHE_SLOPPINESS=pch_defines,time_macros CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi

# logged NAME COMMAND...: runs a command with its output in build/NAME.log, which is shown when the command fails.
logged() {
  local log="build/$1.log"
  shift
  mkdir -p build
  "$@" >"$log" 2>&1 </dev/null || {
    local status=$?
    tail -n 60 "$log" >&2
    echo "failed: $* (log: $log)" >&2
    return $status
  }
}

# build_preset PRESET CMAKE-OPTIONS... [-- TARGETS...]: configures and builds, quietly.
build_preset() {
  local preset=$1 options=() targets=() start=$SECONDS
  shift
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    options+=("$1")
    shift
  done
  [ $# -gt 0 ] && { shift; targets=(--target "$@"); }
  logged "configure-$preset" cmake --preset "$preset" "${options[@]}"
  logged "build-$preset" cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}"
  echo "Built the preset $preset in $((SECONDS - start)) s."
}
