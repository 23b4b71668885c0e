#!/usr/bin/env bash
# Brings SwiftShader, a second Vulkan implementation in software, into build/swiftshader/ without installing a browser: Debian's
# package chromium-common carries it. Safe to run again: what is there stays.
#   tools/fetch_swiftshader.sh
# A program runs on it with VK_DRIVER_FILES=build/swiftshader/vk_swiftshader_icd.json in its environment.
set -euo pipefail
cd "$(dirname "$0")/.."

place=build/swiftshader
[ -e "$place/version" ] && exit 0
mkdir -p build
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work" # apt's own user writes there
# Debian's security updates replace the package every few days, so no version is pinned: apt takes the newest that its lists name,
# and checks it by the hash that the archive has signed. Old lists name a version that is gone: then fetch them, and try again.
(
  cd "$work"
  apt-get download -q chromium-common || { $([ "$(id -u)" = 0 ] || echo sudo) apt-get update -q && apt-get download -q chromium-common; }
  dpkg-deb --extract chromium-common_*.deb .
) >"$work/apt.log" 2>&1 </dev/null || {
  cat "$work/apt.log" >&2
  echo "fetch_swiftshader: apt-get could not download chromium-common" >&2
  exit 1
}
rm -rf "$place"
mkdir "$place"
for file in libvk_swiftshader.so vk_swiftshader_icd.json; do
  mv "$work/usr/lib/chromium/$file" "$place/" || {
    echo "fetch_swiftshader: chromium-common holds no usr/lib/chromium/$file any more" >&2
    exit 1
  }
done
dpkg-deb --field "$work"/chromium-common_*.deb Version >"$place/version"
echo "Fetched SwiftShader of chromium-common $(cat "$place/version")."
