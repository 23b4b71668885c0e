# A coast as an OBJ file: a closed line, a lake in it, and a road. awk -f docs/coast.awk </dev/null >coast.obj
BEGIN {
  pi = atan2(0, -1)
  for (i = 0; i < 90; ++i) {
    a = 2 * pi * i / 90
    r = 8 + cos(3 * a) + 0.7 * cos(7 * a + 1) + 0.35 * cos(23 * a) + 0.25 * sin(41 * a)
    print "v", r * cos(a), r * sin(a), 0
  }
  for (i = 0; i < 24; ++i) print "v", 2 * cos(2 * pi * i / 24) - 2, 1.4 * sin(2 * pi * i / 24) + 1.5, 0
  print "v -6 -3 0\nv -1 -2 0\nv 3 -2.4 0\nv 4.5 3.5 0"
  line = "l"
  for (i = 1; i <= 90; ++i) line = line " " i
  print line, 1
  line = "l"
  for (i = 91; i <= 114; ++i) line = line " " i
  print line, 91
  print "l 115 116 117 118"
}
