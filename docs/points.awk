# Writes n random points of the unit square as XYZ, with -v hills=1 at the heights of a landscape.
function uniform() {
  seed = (seed * 16807) % 2147483647 # S. K. Park, K. W. Miller (1988)
  return seed / 2147483647
}
function hill(x, y, at_x, at_y, width) { return exp(-((x - at_x) ^ 2 + (y - at_y) ^ 2) / (2 * width ^ 2)) }
BEGIN {
  seed = 2022
  for (i = 0; i < n; ++i) {
    x = uniform()
    y = uniform()
    z = 0.22 * hill(x, y, 0.3, 0.62, 0.12) + 0.16 * hill(x, y, 0.68, 0.35, 0.16) + 0.1 * hill(x, y, 0.75, 0.8, 0.07)
    z += 0.012 * sin(17 * x + 3 * y) * cos(13 * y - 4 * x)
    if (hills) printf "%.5f %.5f %.5f\n", x, y, z
    else printf "%.5f %.5f\n", x, y
  }
}
