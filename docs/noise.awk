# Moves every point of an OFF file by Gaussian noise (Box and Muller) of the standard deviation `sigma` along each axis.
function gaussian() { return sqrt(-2 * log(1 - rand())) * cos(6.283185307 * rand()) }
BEGIN { srand(1) }
/^#/ || /^[A-Z]/ { print; next }
points == "" { points = $1; print; next }
seen < points { seen++; print $1 + sigma * gaussian(), $2 + sigma * gaussian(), $3 + sigma * gaussian(); next }
{ print }
