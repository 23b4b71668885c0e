#include <algorithm>
#include <cmath>
#include <numbers>

#include <vkmesh/view/color_map.h>

namespace vkmesh {
namespace {

/// Oklab in polar form: lightness in [0, 1], chroma, hue in degrees.
struct Lch {
  double lightness, chroma, hue;
};

struct LinearRgb {
  double r, g, b;
  [[nodiscard]] bool in_gamut() const { return std::min({r, g, b}) >= 0.0 && std::max({r, g, b}) <= 1.0; }
};

LinearRgb to_linear_rgb(const Lch& c) {
  const double h = c.hue * std::numbers::pi / 180.0;
  const double a = c.chroma * std::cos(h), b = c.chroma * std::sin(h);
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(c.lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(c.lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(c.lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

std::uint8_t encoded(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * srgb));
}

/// The colour itself where sRGB has it, else the one of the same lightness and hue with the most chroma.
Color to_srgb(Lch c) {
  if (!to_linear_rgb(c).in_gamut()) {
    double inside = 0.0, outside = c.chroma;
    for (int i = 0; i < 30; ++i) {
      c.chroma = (inside + outside) / 2;
      (to_linear_rgb(c).in_gamut() ? inside : outside) = c.chroma;
    }
    c.chroma = inside;
  }
  const LinearRgb rgb = to_linear_rgb(c);
  return {encoded(rgb.r), encoded(rgb.g), encoded(rgb.b), 255};
}

Color sequential(double t) {
  // The hue turns from violet backwards to yellow; the chroma stays within what sRGB has on the way, least at
  // blue-green, so that nothing is clipped and no step shows.
  return to_srgb({0.27 + 0.64 * t, 0.094 + 0.19 * (t - 0.4) * (t - 0.4), 300.0 - 192.0 * t});
}

Color diverging(double t) {
  const double side = 2.0 * t - 1.0, away = std::abs(side);
  return to_srgb({0.96 - 0.48 * away, 0.15 * std::pow(away, 0.8), side < 0 ? 256.0 : 30.0});
}

Color categorical(std::size_t i) {
  // Turning by the golden angle keeps any few successive hues apart.
  const double turn = static_cast<double>(i) * 137.50776405003785;
  return to_srgb({i % 2 == 0 ? 0.72 : 0.62, 0.13, std::fmod(250.0 + turn, 360.0)});
}

}  // namespace

ColorTable color_table(ColorMap map) {
  ColorTable table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double t = static_cast<double>(i) / 255.0;
    switch (map) {
      case ColorMap::kSequential:
        table[i] = sequential(t);
        break;
      case ColorMap::kDiverging:
        table[i] = diverging(t);
        break;
      case ColorMap::kCategorical:
        table[i] = categorical(i);
        break;
    }
  }
  return table;
}

ValueRange robust_range(std::span<const float> values, double fraction) {
  std::vector<float> finite;
  finite.reserve(values.size());
  for (const float v : values)
    if (std::isfinite(v)) finite.push_back(v);
  if (finite.empty()) return {};
  const auto quantile = [&](double q) {
    const auto k = static_cast<std::ptrdiff_t>(std::lround(q * static_cast<double>(finite.size() - 1)));
    std::nth_element(finite.begin(), finite.begin() + k, finite.end());
    return static_cast<double>(finite[static_cast<std::size_t>(k)]);
  };
  const ValueRange robust{quantile(fraction), quantile(1.0 - fraction)};
  if (robust.low < robust.high) return robust;
  const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
  return {static_cast<double>(*low), static_cast<double>(*high)};
}

std::vector<double> round_ticks(const ValueRange& range, std::size_t most) {
  const double width = range.high - range.low;
  if (!(width > 0.0) || !std::isfinite(width) || most < 2) return {range.low};
  double step = std::pow(10.0, std::floor(std::log10(width / static_cast<double>(most))));
  const auto ticks_of = [&](double s) { return std::floor(range.high / s) - std::ceil(range.low / s) + 1.0; };
  for (int i = 0; ticks_of(step) > static_cast<double>(most); ++i) step *= i % 3 == 1 ? 2.5 : 2.0;
  std::vector<double> ticks;
  const double first = std::ceil(range.low / step);
  for (double k = 0.0; k < ticks_of(step); ++k) ticks.push_back((first + k) * step);
  return ticks;
}

}  // namespace vkmesh
