#!/usr/bin/env bash
# check.sh BUILD: configures the project beside this file in BUILD, and looks at what vkmesh makes of its settings.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cmake -S "$here" -B "$1" -G Ninja -DCMAKE_BUILD_TYPE=Release
cd "$1"
# It installs nothing into the project.
if grep -rn 'file(INSTALL' --include=cmake_install.cmake .; then
  echo "vkmesh added install rules to the project that it is part of" >&2
  exit 1
fi
grep -q 'SONAME = libvkmesh_host.so.0.1$' build.ninja
# It builds without the project's exceptions and arithmetic, and exports what VKMESH_API marks.
objects=(vkmesh/host/CMakeFiles/vkmesh_host.dir/src/math/arithmetic.cpp.o vkmesh/picture/CMakeFiles/vkmesh_picture.dir/src/png.cpp.o)
ninja "${objects[@]}"
for object in "${objects[@]}"; do
  readelf -sW "$object"
done | awk '$5 != "LOCAL" && $7 != "UND" && $6 == "DEFAULT" { print $8 }' | c++filt | sed -n 's/^\(vkmesh::[^(]*\)(.*/\1/p' |
  sort -u | diff - <(printf 'vkmesh::%s\n' check_positions decode_png encode_png prepare_positions write_png)
