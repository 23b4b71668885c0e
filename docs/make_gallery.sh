#!/usr/bin/env bash
# Makes the pictures of docs/gallery.md anew. Needs the release build and the data that ./test fetches.
#   docs/make_gallery.sh [path/to/vkmesh]
set -euo pipefail
cd "$(dirname "$0")/.."
vkmesh=${1:-build/release/bin/vkmesh}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
dragon=data/dragon/dragon_vrip.ply.gz
cgal=data/cgal
out=docs/images
mkdir -p "$out"

"$vkmesh" smooth "$dragon" "$work/smooth.ply" --iterations 30 --quiet
"$vkmesh" simplify "$dragon" "$work/tenth.ply" --ratio 0.1 --quiet
"$vkmesh" simplify "$dragon" "$work/hundredth.ply" --ratio 0.01 --quiet
"$vkmesh" render "$dragon" "$dragon" "$work/smooth.ply" "$work/tenth.ply" "$work/hundredth.ply" "$work/hundredth.ply" \
  "$out/dragon_sheet.png" --size 340x280 --columns 3 --error --color none,curvature,none,none,none,none \
  --style shaded,shaded,shaded,shaded,shaded,shaded-wire --caption dragon --caption curvature \
  --caption "30 smoothing steps" --caption "10 %" --caption "1 %" --caption "1 %, edges"
"$vkmesh" render "$dragon" "$out/dragon.png" --size 800x600
"$vkmesh" render "$dragon" "$out/dragon_curvature.png" --size 800x600 --color curvature
"$vkmesh" render "$cgal/meshes/fandisk.off" "$cgal/meshes/fandisk.off" "$out/fandisk.png" --size 480x400 \
  --style shaded,shaded-wire --color crease,dihedral
"$vkmesh" render "$cgal/meshes/elephant.off" "$cgal/meshes/elephant.off" "$cgal/meshes/elephant.off" \
  "$out/elephant.png" --size 360x400 --columns 3 --style shaded,flat,wireframe --color none,normal,valence
"$vkmesh" render "$cgal/points_3/kitten.off" "$cgal/points_3/ball.ply" "$cgal/points_3/hippo1.ply" "$out/clouds.png" \
  --size 360x360 --columns 3 --frame each --style splats,splats,points --color none,segment_index,normal
"$vkmesh" render "$cgal/meshes/elephant-with-holes.off" "$cgal/meshes/blobby-shuffled.off" "$out/broken.png" \
  --size 480x400 --frame each --style flat --show-flipped --show-boundary --show-non-manifold
