#!/usr/bin/env bash
# Are the files that vkmesh writes accepted by other people's programs, with the same counts? And does `vkmesh info` say
# what CGAL says? Each section runs where its program is installed, and says so where it is not; those named in
# VKMESH_INTEROP_REQUIRED ("gltf-validator admesh cgal openmesh coin") must be there.
#   tests/interop/run.sh VKMESH FOLDER-OF-THE-COMPILED-READERS
set -euo pipefail
[ $# = 2 ] || {
  sed -n '5s/^# *//p' "$0" >&2
  exit 2
}
vkmesh=$(realpath "$1") readers=$(realpath "$2")
cd "$(dirname "$0")/../.."
here=tests/interop modules=build/interop
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

fails() {
  echo "interop: $*" >&2
  failed=1
}

# absent PROGRAM REASON
absent() {
  case " ${VKMESH_INTEROP_REQUIRED:-} " in
    *" $1 "*) fails "$1 is required: $2" ;;
    *) echo "$1: skipped: $2" ;;
  esac
}

# A torus of triangles whose uv have seams, with normals and colours.
awk 'BEGIN {
  rings = 24; sides = 12; pi = atan2(0, -1)
  for (i = 0; i < rings; ++i) for (j = 0; j < sides; ++j) {
    a = 2 * pi * i / rings; b = 2 * pi * j / sides
    printf "v %.6f %.6f %.6f %.4f %.4f 0.5\n", (1 + 0.4 * cos(b)) * cos(a), (1 + 0.4 * cos(b)) * sin(a), 0.4 * sin(b), i / rings, j / sides
    printf "vn %.8f %.8f %.8f\n", cos(b) * cos(a), cos(b) * sin(a), sin(b)
  }
  for (i = 0; i <= rings; ++i) for (j = 0; j <= sides; ++j) printf "vt %.6f %.6f\n", i / rings, j / sides
  for (i = 0; i < rings; ++i) for (j = 0; j < sides; ++j) {
    if (j == 0 && i % 8 == 0) print "usemtl part" i / 8
    for (k = 0; k < 4; ++k) {
      x = i + (k == 1 || k == 2); y = j + (k >= 2)
      p[k] = (x % rings) * sides + y % sides + 1
      c[k] = p[k] "/" x * (sides + 1) + y + 1 "/" p[k]
    }
    print "f", c[0], c[1], c[2]; print "f", c[0], c[2], c[3]
  }
}' </dev/null >"$work/torus.obj"
printf 'OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n' >"$work/cube.off"
printf 'v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0.5 0.25 2 1 1 1\n' >"$work/cloud.obj"

meshes=("$work/torus.obj" "$work/cube.off" "$work/cloud.obj")
# The scan has tatters, at which some readers leave faces out, and isolated points, which others do not count.
scan=data/dragon/dragon_vrip_res4.ply.gz
if [ -e $scan ]; then
  "$vkmesh" convert $scan "$work/dragon.ply" --drop-isolated --quiet
  meshes+=("$work/dragon.ply")
else
  echo "interop: $scan is not there, see tools/fetch_data.sh"
fi
for file in data/cgal/meshes/{elephant,knot1,double-torus-example,mesh_with_border,cube_quad}.off; do
  if [ -e "$file" ]; then meshes+=("$file"); else echo "interop: $file is not there, see tools/fetch_data.sh"; fi
done

# ---- What vkmesh writes: "file points faces" of each, by format.
declare -A written=()
# write NAME MESH KIND [options]: one more file of that kind
write() {
  local name=$1 mesh=$2 kind=$3 counts
  shift 3
  counts=$("$vkmesh" convert "$mesh" "$work/$name" --as-is --json "$@" 2>"$work/error") || {
    fails "vkmesh convert $mesh $name: $(cat "$work/error")"
    return 0
  }
  counts=$(grep -A99 '"output"' <<<"$counts" | tr -d ' ,"' | awk -F: '$1 == "points" { p = $2 } $1 == "faces" { f = $2 } END { print p, f }')
  written[$kind]+="$work/$name $counts "
}
for mesh in "${meshes[@]}"; do
  name=$(basename "${mesh%.gz}")
  name=${name%.*}
  kind=mesh
  [ "$name" != cloud ] || kind=cloud
  write "$name.glb" "$mesh" gltf --triangulate
  write "$name.gltf" "$mesh" gltf --triangulate
  write "$name-vkmesh.ply" "$mesh" $kind
  write "$name-ascii.ply" "$mesh" $kind --ascii
  write "$name-vkmesh.obj" "$mesh" $kind
  write "$name-vkmesh.off" "$mesh" $kind
  [ $kind = mesh ] || continue
  write "$name.stl" "$mesh" stl --triangulate
  write "$name-ascii.stl" "$mesh" stl --triangulate --ascii
  if "$vkmesh" convert --help | grep -q '\.iv\|Inventor'; then
    write "$name.iv" "$mesh" scene --triangulate
    write "$name.wrl" "$mesh" scene --triangulate
  fi
done

# ---- Levels of detail: "file levels triangles" of each; what knows no MSFT_lod sees one level
levels=()
# lod NAME MESH LEVELS [options]
lod() {
  local name=$1 mesh=$2 shown=$3 counts
  shift 3
  counts=$("$vkmesh" lod "$mesh" "$work/$name" --levels 4 --json "$@" 2>"$work/error") || {
    fails "vkmesh lod $mesh $name: $(cat "$work/error")"
    return 0
  }
  counts=$(grep -A99 '"levels"' <<<"$counts" | tr -d ' ,"' | awk -F: '$1 == "faces" { print $2; exit }')
  levels+=("$work/$name" "$shown" "$counts")
}
for mesh in "${meshes[@]}"; do
  name=$(basename "${mesh%.*}")
  case "$name" in cloud | cube*) continue ;; esac
  lod "$name-nodes.glb" "$mesh" 4
  lod "$name-shared.gltf" "$mesh" 4 --operation half-edge-collapse
  lod "$name-msft.glb" "$mesh" 1 --operation half-edge-collapse --layout msft
done

# files KIND...: how many triples there are
files() {
  local all=()
  for kind in "$@"; do
    # shellcheck disable=SC2206
    all+=(${written[$kind]:-})
  done
  echo $((${#all[@]} / 3))
}

# ---- Khronos' validator of glTF
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
  absent gltf-validator "node or npm is not installed"
else
  if ! cmp -s $here/package-lock.json $modules/package-lock.json || [ ! -e $modules/node_modules/three ]; then
    mkdir -p $modules
    cp $here/package.json $here/package-lock.json $modules
    (cd $modules && npm ci --no-audit --no-fund --ignore-scripts >npm.log 2>&1) || rm -f $modules/package-lock.json
  fi
  if [ ! -e $modules/node_modules/three ] || [ ! -e $modules/package-lock.json ]; then
    absent gltf-validator "npm could not install it: $(tail -n 1 $modules/npm.log 2>/dev/null)"
  else
    # Seams make 325 vertices of the torus, and the validator counts them for each of its three materials.
    arguments=()
    # shellcheck disable=SC2086
    set -- ${written[gltf]:-}
    while [ $# -ge 3 ]; do
      case "$1" in */torus.*) arguments+=("$1" "$3" 975) ;; *) arguments+=("$1" "$3" "$2") ;; esac
      shift 3
    done
    for ((i = 0; i < ${#levels[@]}; i += 3)); do arguments+=("${levels[i]}" - -); done
    if node $here/validate_gltf.cjs $modules/node_modules "${arguments[@]}"; then
      echo "gltf-validator: $((${#arguments[@]} / 3)) files without errors or warnings, triangles and vertices agree"
    else
      failed=1
    fi
    if node $here/count_levels.mjs $modules/node_modules "${levels[@]}"; then
      echo "three: $((${#levels[@]} / 3)) files of levels load, and have as many as were written"
    else
      failed=1
    fi
  fi
fi

# ---- admesh
if ! command -v admesh >/dev/null; then
  absent admesh "admesh is not installed"
else
  bad=0
  # shellcheck disable=SC2086
  set -- ${written[stl]:-}
  while [ $# -ge 3 ]; do
    facets=$(admesh --no-check "$1" 2>&1 | awk -F: '/^Number of facets/ { split($2, n, " "); print n[1] }' || true)
    admesh "$1" >/dev/null 2>&1 || facets="failure"
    if [ "$facets" != "$3" ]; then
      fails "admesh: $1: facets: ${facets:-none}, expected $3"
      bad=1
    fi
    shift 3
  done
  [ $bad = 1 ] || echo "admesh: $(files stl) files, text and binary, facets agree"
fi

# compiled NAME PROGRAM LABEL KIND...: one of the readers that CMake built
compiled() {
  local name=$1 program=$readers/$2 label=$3 arguments=() file points faces
  shift 3
  if [ ! -x "$program" ]; then
    absent "$name" "its library was not there when tests/interop was compiled"
    return 0
  fi
  for kind in "$@"; do
    # shellcheck disable=SC2086
    while read -r file points faces; do
      [ -n "$file" ] || continue
      # STL has no shared points; Coin tells points apart by their places, and the repaired scan has copies of some.
      case "$kind $file" in stl* | scene*dragon*) points=- ;; esac
      # OpenMesh drops faces where joining equal corners gives no manifold, as on the dragon.
      # Its PLY reader takes a second list of a face, as the UVs of corners are, for the next face.
      case "$name $file" in openmesh*dragon*.stl | openmesh*torus*.ply*) continue ;; esac
      arguments+=("$file" "$points" "$faces")
    done < <(printf '%s %s %s\n' ${written[$kind]:-})
  done
  local mode=()
  [ "$name" != cgal ] || mode=(counts)
  if timeout 60 "$program" "${mode[@]}" "${arguments[@]}" >"$work/out" 2>"$work/err"; then
    echo "$name: $((${#arguments[@]} / 3)) files, $label agree"
  else
    cat "$work/err" >&2
    fails "$name disagrees, or took longer than a minute"
  fi
}
compiled cgal cgal_judge "points and faces" mesh stl
compiled openmesh openmesh_counts "points and faces" mesh stl
if [ -n "${written[scene]:-}" ]; then compiled coin coin_counts "points and triangles" scene; else absent coin "this vkmesh writes neither Inventor nor VRML"; fi

# ---- What vkmesh reads of a binary Inventor file that Coin made of a text
if [ -x "$readers/coin_counts" ]; then
  count=0
  # shellcheck disable=SC2086
  while read -r file _; do
    case "$file" in *.iv) ;; *) continue ;; esac
    if timeout 60 "$readers/coin_counts" binary "$file" "$work/binary.iv" 2>"$work/err" && "$vkmesh" convert "$work/binary.iv" "$work/binary.ply" --quiet &&
      "$vkmesh" convert "$file" "$work/text.ply" --quiet && cmp "$work/text.ply" "$work/binary.ply"; then
      count=$((count + 1))
    else
      cat "$work/err" >&2
      fails "$file, written in binary by Coin, is not what its text is"
    fi
  done < <(printf '%s %s %s\n' ${written[scene]:-})
  echo "coin: $count files read in its binary form"
fi

# ---- What CGAL and vkmesh say about the meshes of libcgal-demo
if [ -x "$readers/cgal_judge" ] && [ -e data/cgal/meshes ]; then
  arguments=()
  for file in data/cgal/meshes/*; do
    info="$work/$(basename "$file").json"
    "$vkmesh" info "$file" --json >"$info" 2>/dev/null || true
    arguments+=("$file" "$info")
  done
  if totals=$(timeout 300 "$readers/cgal_judge" info "${arguments[@]}" 2>"$work/err"); then
    echo "cgal: vkmesh info agrees: $totals"
  else
    cat "$work/err" >&2
    fails "CGAL and vkmesh info disagree ($totals)"
  fi
elif [ -x "$readers/cgal_judge" ]; then
  absent cgal "data/cgal is not there, see tools/fetch_data.sh"
fi

# ---- How far surfaces lie from each other
if [ -x "$readers/cgal_judge" ] && [ -e data/cgal/meshes ]; then
  arguments=()
  for name in elephant fandisk knot1; do
    "$vkmesh" convert "data/cgal/meshes/$name.off" "$work/$name-whole.off" --triangulate --quiet
    "$vkmesh" simplify "$work/$name-whole.off" "$work/$name-tenth.off" --ratio 0.1 --quiet
    "$vkmesh" compare "$work/$name-whole.off" "$work/$name-tenth.off" --json >"$work/$name-compared.json"
    arguments+=("$work/$name-whole.off" "$work/$name-tenth.off" "$work/$name-compared.json")
  done
  if totals=$(timeout 120 "$readers/cgal_judge" distances "${arguments[@]}" 2>"$work/err"); then
    echo "cgal: vkmesh compare agrees: $totals"
  else
    cat "$work/err" >&2
    fails "CGAL and vkmesh compare disagree ($totals)"
  fi
fi
exit $failed
