#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/picture/contact_sheet.h>
#include <vkmesh/picture/text.h>

namespace vkmesh {
namespace {

constexpr std::size_t kMostTicks = 7;

/// Black or white, whichever is farther from the background.
Color ink_on(Color background) {
  const bool dark = 2 * background.r + 5 * background.g + background.b < 8 * 128;
  return dark ? Color{240, 240, 240} : Color{30, 32, 36};
}

/// Lengths of a strip of text of one size, in pixels.
struct Layout {
  explicit Layout(std::uint32_t text_size)
      : line(line_height(text_size)), padding(line / 2), bar(line / 2), gap(line / 3), tick(line / 6) {}

  std::int64_t line, padding, bar, gap, tick;
};

std::string tick_text(double value, double step) {
  // Rounding of the ticks' sum must not show as 1e-17.
  if (std::abs(value) < 1e-9 * step) value = 0.0;
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

std::uint32_t text_size_for(std::uint32_t width) {
  return std::clamp(width / 54, 11u, 30u);
}

std::uint32_t legend_height(const Legend& legend, std::uint32_t text_size) {
  if (legend.empty()) return 0;
  const Layout at(text_size);
  std::int64_t height = at.padding + at.line * static_cast<std::int64_t>(legend.swatches.size());
  if (!legend.title.empty()) height += at.line + at.bar + at.gap + at.line;
  return static_cast<std::uint32_t>(height);
}

Result<Picture> legend_strip(const Legend& legend, std::uint32_t width, Color background,
                             std::uint32_t text_size) {
  return detail::catching([&]() -> Result<Picture> {
    VKMESH_TRY(Picture strip, Picture::create(width, legend_height(legend, text_size), background));
    if (legend.empty()) return strip;
    VKMESH_TRY(TextFace face, TextFace::create(text_size));
    const Color ink = ink_on(background);
    const Layout at(text_size);
    const std::int64_t left = at.padding, bar = std::max<std::int64_t>(std::int64_t{width} - 2 * left, 1);
    std::int64_t y = at.padding / 2;
    if (!legend.title.empty()) {
      face.draw(strip, left, y, face.beginning_that_fits(legend.title, bar), ink);
      y += at.line;
      const ColorTable table = color_table(legend.map);
      for (std::int64_t x = 0; x < bar; ++x)
        fill_rectangle(strip, left + x, y, 1, at.bar,
                       table[static_cast<std::size_t>(x * 255 / std::max<std::int64_t>(bar - 1, 1))]);
      y += at.bar;
      // As many ticks as stand apart.
      const double span = legend.range.high - legend.range.low;
      const auto place = [&](double value) {
        const double share = span > 0.0 ? (value - legend.range.low) / span : 0.5;
        return left + std::lround(share * static_cast<double>(bar - 1));
      };
      for (std::size_t most = kMostTicks; most >= 2; --most) {
        const std::vector<double> ticks = round_ticks(legend.range, most);
        struct Label {
          std::int64_t tick, x, width;
          std::string text;
        };
        std::vector<Label> labels;
        for (const double value : ticks) {
          Label label{place(value), 0, 0, tick_text(value, ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0)};
          label.width = face.width(label.text);
          label.x =
              std::clamp<std::int64_t>(label.tick - label.width / 2, left / 2,
                                       std::max<std::int64_t>(left / 2, width - left / 2 - label.width));
          labels.push_back(std::move(label));
        }
        bool apart = true;
        for (std::size_t i = 1; i < labels.size(); ++i)
          apart = apart && labels[i - 1].x + labels[i - 1].width + at.gap <= labels[i].x;
        if (!apart && most > 2) continue;
        for (const Label& label : labels) {
          fill_rectangle(strip, label.tick - at.tick / 4, y, std::max<std::int64_t>(at.tick / 2, 1), at.tick,
                         ink);
          face.draw(strip, label.x, y + at.gap, label.text, ink);
        }
        break;
      }
      y += at.gap + at.line;
    }
    for (const Legend::Swatch& swatch : legend.swatches) {
      // As high as a capital, and on the base line.
      const std::int64_t side = std::int64_t{text_size} * 3 / 4, indent = side + at.gap;
      fill_rectangle(strip, left, y + text_size - side, side, side, swatch.color);
      face.draw(strip, left + indent, y, face.beginning_that_fits(swatch.text, bar - indent), ink);
      y += at.line;
    }
    return strip;
  });
}

Result<Picture> contact_sheet(std::span<const SheetCell> cells, std::size_t columns, Color background) {
  return detail::catching([&]() -> Result<Picture> {
    if (cells.empty()) return fail(ErrorCode::kUsage, "a contact sheet of no pictures");
    std::uint32_t width = 0, height = 0;
    std::size_t lines = 0;
    for (const SheetCell& cell : cells) {
      width = std::max(width, cell.picture.width());
      height = std::max(height, cell.picture.height());
      lines = std::max(lines, cell.caption.size());
    }
    const std::uint32_t text_size = text_size_for(width);
    const Layout at(text_size);
    const std::int64_t cell_height =
        height + (lines > 0 ? at.line * static_cast<std::int64_t>(lines) + at.padding : 0);
    if (columns == 0) {
      // The columns that give the sheet most nearly four to three.
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t c = 1; c <= cells.size(); ++c) {
        const std::size_t rows = (cells.size() + c - 1) / c;
        const double shape =
            static_cast<double>(c) * width / (static_cast<double>(rows) * static_cast<double>(cell_height));
        const double off = std::abs(std::log(shape * 3.0 / 4.0));
        if (off < best) {
          best = off;
          columns = c;
        }
      }
    }
    columns = std::min(columns, cells.size());
    // Each row is as high as its highest picture: only rows with a legend need the room for one.
    const std::size_t rows = (cells.size() + columns - 1) / columns;
    std::vector<std::uint32_t> row_pictures(rows, 0);
    for (std::size_t i = 0; i < cells.size(); ++i)
      row_pictures[i / columns] = std::max(row_pictures[i / columns], cells[i].picture.height());
    std::vector<std::int64_t> row_top(rows + 1, 0);
    for (std::size_t r = 0; r < rows; ++r)
      row_top[r + 1] = row_top[r] + row_pictures[r] + (cell_height - height);
    const std::uint64_t sheet_width = std::uint64_t{width} * columns;
    const auto sheet_height = static_cast<std::uint64_t>(row_top[rows]);
    if (sheet_width > kMaxPictureSide || sheet_height > kMaxPictureSide)
      return fail(ErrorCode::kUsage, "a contact sheet of " + std::to_string(sheet_width) + " by " +
                                         std::to_string(sheet_height) + " pixels is too large");
    VKMESH_TRY(Picture sheet, Picture::create(static_cast<std::uint32_t>(sheet_width),
                                              static_cast<std::uint32_t>(sheet_height), background));
    for (std::size_t i = 0; i < cells.size(); ++i)
      paste(sheet, cells[i].picture, static_cast<std::int64_t>(i % columns) * width, row_top[i / columns]);
    if (lines == 0) return sheet;
    VKMESH_TRY(TextFace face, TextFace::create(text_size));
    const Color ink = ink_on(background);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::int64_t y = row_top[i / columns] + row_pictures[i / columns] + at.padding / 2;
      for (const std::string& text : cells[i].caption) {
        const std::string fitting = face.end_that_fits(text, width - 2 * at.padding);
        const std::int64_t left = static_cast<std::int64_t>(i % columns) * width;
        face.draw(sheet, left + (width - face.width(fitting)) / 2, y, fitting, ink);
        y += at.line;
      }
    }
    return sheet;
  });
}

}  // namespace vkmesh
