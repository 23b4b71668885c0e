// What stands beside a picture: its legend, and other pictures with captions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/view/color_map.h>
#include <vkmesh/view/picture.h>

namespace vkmesh {

/// The key to a picture's colours. Parts that are empty are left out.
struct Legend {
  std::string title;  ///< What is shown, with its unit; where it is empty there is no bar either.
  ColorMap map = ColorMap::kSequential;
  ValueRange range;
  struct Swatch {
    Color color;
    std::string text;
  };
  std::vector<Swatch> swatches;

  [[nodiscard]] bool empty() const { return title.empty() && swatches.empty(); }
};

/// The size of text, in pixels, that suits a picture of this width: from 11 to 30.
[[nodiscard]] VKMESH_API std::uint32_t text_size_for(std::uint32_t width);

/// Pixels that a legend takes; 0 when it is empty.
[[nodiscard]] VKMESH_API std::uint32_t legend_height(const Legend& legend, std::uint32_t text_size);

/// A strip of that height: title, colours with ticks, swatches. Lines too long for it end in an ellipsis.
/// Errors: as Picture::create() and TextFace::create().
[[nodiscard]] VKMESH_API Result<Picture> legend_strip(const Legend& legend, std::uint32_t width,
                                                      Color background, std::uint32_t text_size);

struct SheetCell {
  Picture picture;
  std::vector<std::string> caption;  ///< Lines.
};

/// Pictures in rows of `columns` (0: as square a sheet as fits the pictures' shape, wider rather than
/// higher), each with its caption beneath, all captions in one size. Columns are as wide as the widest
/// picture, each row as high as its highest. Errors: kUsage for no cells; as Picture::create() and, where
/// there are captions, TextFace::create().
[[nodiscard]] VKMESH_API Result<Picture> contact_sheet(std::span<const SheetCell> cells, std::size_t columns,
                                                       Color background);

}  // namespace vkmesh
