#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/io/svg.h>

#include "io/bytes.h"
#include "io/formats.h"

namespace vkmesh {
namespace detail {
namespace {

/// Words, numbers and places, one after the other.
class Writer {
 public:
  Writer(Output& out, DVec2 offset) : out_(out), offset_(offset) {}

  Writer& operator<<(std::string_view text) {
    out_.put(text);
    return *this;
  }
  Writer& operator<<(double value) {
    out_.commit(put_number(out_.room(64), value + 0.0));  // and no "-0"
    return *this;
  }
  Writer& operator<<(DVec2 p) {
    coordinate(p.x, offset_.x);
    *this << ",";
    coordinate(p.y, offset_.y);
    return *this;
  }
  void circle(DVec2 centre, double radius) {
    *this << R"(<circle cx=")";
    coordinate(centre.x, offset_.x);
    *this << R"(" cy=")";
    coordinate(centre.y, offset_.y);
    *this << R"(" r=")";
    coordinate(radius, 0);
    *this << "\"/>\n";
  }
  void color(const std::uint8_t* rgb) {
    constexpr char kHex[] = "0123456789abcdef";
    char* to = out_.room(8);
    *to++ = '#';
    for (int i = 0; i < 3; ++i) {
      *to++ = kHex[rgb[i] >> 4];
      *to++ = kHex[rgb[i] & 15];
    }
    out_.commit(to);
  }

 private:
  void coordinate(double value, double offset) {
    out_.commit(put_coordinate(out_.room(64), static_cast<float>(value) + 0.0f, offset));
  }

  Output& out_;
  DVec2 offset_;
};

/// A length in few digits, which nobody reads back.
double brief(double x) {
  if (!(x > 0)) return x;
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 2);
  return unit > 0 && std::isfinite(x / unit) ? std::round(x / unit) * unit : x;
}

Result<void> check_picture(const SvgPicture& picture) {
  if (picture.points.empty() && picture.dots.empty())
    return fail(ErrorCode::kUnsuitable, "a picture without points has no bounds");
  constexpr double kMost = std::numeric_limits<float>::max();
  const auto finite = [](DVec2 p) { return std::fabs(p.x) <= kMost && std::fabs(p.y) <= kMost; };
  if (!std::all_of(picture.points.begin(), picture.points.end(), finite) ||
      !std::all_of(picture.dots.begin(), picture.dots.end(), finite) ||
      !std::all_of(picture.circles.begin(), picture.circles.end(),
                   [&](const SvgCircle& c) { return finite(c.centre) && c.radius <= kMost; }))
    return fail(ErrorCode::kUnsuitable, "a coordinate of the picture is not finite in single precision");
  for (const std::uint32_t corner : picture.corners)
    if (corner >= picture.points.size()) return fail(ErrorCode::kUsage, "a polygon names no point");
  const auto offsets = picture.face_offsets;
  const std::size_t faces = offsets.empty() ? picture.corners.size() / 3 : offsets.size() - 1;
  if (offsets.empty() ? picture.corners.size() % 3 != 0
                      : offsets.front() != 0 || offsets.back() != picture.corners.size() ||
                            !std::is_sorted(offsets.begin(), offsets.end()))
    return fail(ErrorCode::kUsage, "the face offsets of the picture do not fit its corners");
  if (!picture.fills.empty() && picture.fills.size() != 3 * faces)
    return fail(ErrorCode::kUsage, "the picture has not one fill for each polygon");
  return {};
}

void draw(const SvgPicture& picture, Writer& out) {
  DVec2 low(HUGE_VAL), high(-HUGE_VAL);
  for (const auto& points : {picture.points, picture.dots})
    for (const DVec2 p : points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  double size = std::max(high.x - low.x, high.y - low.y);
  if (size == 0) size = 1;
  const double margin = brief(0.02 * size), width = high.x - low.x + 2 * margin,
               height = high.y - low.y + 2 * margin, scale = 800 / std::max(width, height);
  out << R"(<svg xmlns="http://www.w3.org/2000/svg" width=")" << std::max(1.0, std::round(scale * width))
      << R"(" height=")" << std::max(1.0, std::round(scale * height)) << R"(" viewBox=")"
      << low.x - margin + picture.offset.x << " " << -(high.y + margin + picture.offset.y) << " " << width
      << " " << height << "\">\n";
  if (!picture.comment.empty()) out << "<!-- " << picture.comment << " -->\n";
  out << R"x(<g transform="scale(1,-1)" stroke-linejoin="round">)x"
      << "\n";
  const std::size_t faces =
      picture.face_offsets.empty() ? picture.corners.size() / 3 : picture.face_offsets.size() - 1;
  if (faces > 0) {
    out << R"(<g stroke="#333333" stroke-width=")" << brief(0.0015 * size) << R"(" fill="none">)"
        << "\n";
    for (std::size_t f = 0; f < faces; ++f) {
      const std::size_t begin = picture.face_offsets.empty() ? 3 * f : picture.face_offsets[f],
                        end = picture.face_offsets.empty() ? 3 * f + 3 : picture.face_offsets[f + 1];
      if (begin == end) continue;
      out << R"(<polygon points=")";
      for (std::size_t c = begin; c < end; ++c)
        out << (c == begin ? "" : " ") << picture.points[picture.corners[c]];
      out << "\"";
      if (!picture.fills.empty()) {
        out << R"( fill=")";
        out.color(&picture.fills[3 * f]);
        out << "\"";
      }
      out << "/>\n";
    }
    out << "</g>\n";
  }
  if (!picture.circles.empty()) {
    out << R"(<g stroke="#d07020" stroke-width=")" << brief(0.001 * size) << R"(" fill="none">)"
        << "\n";
    for (const SvgCircle& c : picture.circles) out.circle(c.centre, c.radius);
    out << "</g>\n";
  }
  if (!picture.dots.empty()) {
    // Smaller where there are many.
    const double share = std::min(0.006, 0.15 / std::sqrt(static_cast<double>(picture.dots.size())));
    const double radius = brief(share * size);
    out << "<g fill=\"#111111\">\n";
    for (const DVec2 p : picture.dots) out.circle(p, radius);
    out << "</g>\n";
  }
  out << "</g>\n</svg>\n";
}

}  // namespace
}  // namespace detail

Result<void> write_svg(const std::filesystem::path& path, const SvgPicture& picture) {
  return detail::catching([&]() -> Result<void> {
    VKMESH_CHECK(detail::check_picture(picture));
    VKMESH_TRY(detail::OutputFile file, detail::OutputFile::open(path));
    detail::Output out(file.file(), path == "-" ? "standard output" : path.string(), false);
    detail::Writer writer(out, picture.offset);
    detail::draw(picture, writer);
    VKMESH_CHECK(out.finish());
    return file.commit();
  });
}

}  // namespace vkmesh
