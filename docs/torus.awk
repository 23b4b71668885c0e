# Writes a torus as OFF: `rings` by `sides` points, moved along it by up to `jitter` of the step to the next, and quads cut along
# random diagonals.
function step() { return 2 * jitter * (rand() - 0.5) }
BEGIN {
  if (rings == "") { rings = 24; sides = 32; jitter = 0.33 }
  srand(1)
  tau = 6.283185307179586
  print "OFF"
  print rings * sides, 2 * rings * sides, 0
  for (i = 0; i < rings; ++i)
    for (j = 0; j < sides; ++j) {
      u = tau * (i + step()) / rings
      v = tau * (j + step()) / sides
      print (1 + 0.4 * cos(v)) * cos(u), (1 + 0.4 * cos(v)) * sin(u), 0.4 * sin(v)
    }
  for (i = 0; i < rings; ++i)
    for (j = 0; j < sides; ++j) {
      a = i * sides + j
      b = (i + 1) % rings * sides + j
      c = (i + 1) % rings * sides + (j + 1) % sides
      d = i * sides + (j + 1) % sides
      if (rand() < 0.5) { print 3, a, b, c; print 3, a, c, d }
      else { print 3, a, b, d; print 3, b, c, d }
    }
}
