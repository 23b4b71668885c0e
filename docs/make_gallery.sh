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

"$vkmesh" smooth "$dragon" "$work/smooth.ply" --method laplacian --iterations 30 --quiet
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

# Smoothing, on surfaces with noise of a given standard deviation.
noisy() { "$vkmesh" convert "$1" "$work/clean.off" --quiet && awk -v sigma="$2" -f docs/noise.awk "$work/clean.off" >"$3"; }
noisy data/dragon/dragon_vrip_res2.ply.gz 0.0002 "$work/noisy.off"
"$vkmesh" smooth "$work/noisy.off" "$work/laplacian.ply" --method laplacian --quiet
"$vkmesh" smooth "$work/noisy.off" "$work/taubin.ply" --quiet
"$vkmesh" smooth "$work/noisy.off" "$work/noise.ply" --method bilateral --spatial 2 --influence 0.2 --quiet
"$vkmesh" smooth "$work/noisy.off" "$work/small.ply" --method bilateral --spatial 2 --influence 4 --quiet
"$vkmesh" smooth "$work/noisy.off" "$work/large.ply" --method bilateral --spatial 4 --influence 4 --quiet
"$vkmesh" render "$work/noisy.off" "$work/laplacian.ply" "$work/taubin.ply" "$work/noise.ply" "$work/small.ply" \
  "$work/large.ply" "$out/smoothing.png" --size 420x330 --columns 3 --caption "scan with noise" \
  --caption "Laplacian, 10 steps" --caption "Taubin, 10 iterations" --caption "bilateral, 2 and 0.2" \
  --caption "bilateral, 2 and 4" --caption "bilateral, 4 and 4"
noisy "$cgal/meshes/fandisk.off" 0.002 "$work/noisy.off"
"$vkmesh" smooth "$work/noisy.off" "$work/laplacian.ply" --method laplacian --quiet
"$vkmesh" smooth "$work/noisy.off" "$work/bilateral.ply" --method bilateral --spatial 2 --influence 0.3 --quiet
"$vkmesh" render "$work/noisy.off" "$work/laplacian.ply" "$work/bilateral.ply" "$out/smoothing_creases.png" \
  --size 420x360 --columns 3 --style flat --caption "with noise" --caption "Laplacian, 10 steps" \
  --caption "bilateral, 2 and 0.3"

# Edge swaps: a torus with random diagonals, and the dragon at a tenth.
awk -f docs/torus.awk </dev/null >"$work/torus.off"
for criterion in max-min-angle valence curvature; do
  "$vkmesh" optimize "$work/torus.off" "$work/$criterion.ply" --criterion $criterion --quiet
done
"$vkmesh" render "$work/torus.off" "$work/max-min-angle.ply" "$work/valence.ply" "$work/curvature.ply" "$out/swaps.png" \
  --size 420x300 --columns 2 --style flat --caption "random diagonals" --caption "max-min angle" --caption valence \
  --caption curvature
"$vkmesh" optimize "$work/tenth.ply" "$work/swapped.ply" --max-relative-deviation 2e-4 --quiet
"$vkmesh" render "$work/tenth.ply" "$work/swapped.ply" "$out/swaps_quality.png" --size 480x400 --color quality \
  --style flat --caption "dragon, 10 %" --caption "max-min angle, at most 0.02 % off"

# Remeshing, with creases kept.
"$vkmesh" remesh "$cgal/meshes/fandisk.off" "$work/even.ply" --edge-length 0.04 --keep-creases 40 --quiet
"$vkmesh" remesh "$cgal/meshes/fandisk.off" "$work/adaptive.ply" --relative-adaptive 5e-4 --keep-creases 40 --quiet
"$vkmesh" render "$cgal/meshes/fandisk.off" "$work/even.ply" "$work/adaptive.ply" "$out/remeshing.png" --size 420x380 \
  --columns 3 --style shaded-wire --caption before --caption "edges of 0.04" --caption "by curvature"

# Points in the plane: their triangulation and their cells; a terrain of scattered heights.
awk -v n=150 -f docs/points.awk </dev/null >"$work/points.xyz"
"$vkmesh" delaunay "$work/points.xyz" "$work/delaunay.ply" --quiet
"$vkmesh" voronoi "$work/points.xyz" "$work/voronoi.ply" --box 0,0,1,1 --quiet
"$vkmesh" voronoi "$work/points.xyz" "$work/lloyd.ply" --box 0,0,1,1 --lloyd 30 --quiet
"$vkmesh" render "$work/delaunay.ply" "$work/voronoi.ply" "$work/lloyd.ply" "$out/voronoi.png" --size 420x420 --columns 3 \
  --orthographic --azimuth 0 --elevation 0 --style shaded-wire,flat,flat --color none,color,color --caption Delaunay \
  --caption Voronoi --caption "Lloyd, 30 iterations"
awk -v n=30 -f docs/points.awk </dev/null >"$work/points.xyz"
"$vkmesh" delaunay "$work/points.xyz" "$out/circumcircles.svg" --dots --circumcircles --quiet
awk -v n=20000 -v hills=1 -f docs/points.awk </dev/null >"$work/hills.xyz"
"$vkmesh" delaunay "$work/hills.xyz" "$work/terrain.ply" --z --quiet
"$vkmesh" simplify "$work/terrain.ply" "$work/simple.ply" --ratio 0.05 --quiet
"$vkmesh" render "$work/terrain.ply" "$work/simple.ply" "$out/terrain.png" --size 560x360 --columns 2 --up z --elevation 35 \
  --azimuth 25 --style shaded,shaded-wire --caption "20,000 heights" --caption "5 %"

# Levels of detail, of one file.
"$vkmesh" lod "$dragon" "$work/dragon.glb" --levels 6 --reduction 0.3 --quiet
"$vkmesh" render "$work/dragon.glb" "$out/levels.png" --size 380x300 --columns 3 --style flat --caption dragon

# An outline with a hole and a line inside, and the same refined.
awk -f docs/coast.awk </dev/null >"$work/coast.obj"
"$vkmesh" delaunay "$work/coast.obj" "$work/coast.ply" --constraints "$work/coast.obj" --inside even-odd --quiet
"$vkmesh" delaunay "$work/coast.obj" "$work/refined.ply" --constraints "$work/coast.obj" --inside even-odd --min-angle 28 --quiet
"$vkmesh" delaunay "$work/coast.obj" "$work/even.ply" --constraints "$work/coast.obj" --inside even-odd --min-angle 28 \
  --max-area 0.1 --quiet
"$vkmesh" render "$work/coast.ply" "$work/refined.ply" "$work/even.ply" "$out/refined.png" --size 420x420 --columns 3 \
  --orthographic --azimuth 0 --elevation 0 --style shaded-wire --caption constrained --caption "28 degrees" \
  --caption "28 degrees, area 0.1"
