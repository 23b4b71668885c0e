// STL, the stereolithography format (3D Systems, 1988), as text and binary.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

constexpr std::size_t kHeader = 80;
constexpr std::size_t kStart = kHeader + 4;
constexpr std::size_t kFacet = 50;  // Normal, three corners, 16 bits of attribute.

bool same_word(std::string_view word, std::string_view lower) {
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return a == b || (a >= 'A' && a <= 'Z' && a + ('a' - 'A') == b); });
}

class AsciiStlReader {
 public:
  explicit AsciiStlReader(const Source& source) : source_(source), text_(source.bytes) {}

  Result<MeshFile> read() {
    std::size_t solids = 0;
    for (text_.skip_to_content(); !text_.at_end(); text_.skip_to_content()) {
      VKMESH_CHECK(keyword("solid"));
      skip_name("facet", "normal");
      VKMESH_CHECK(facets());
      ++solids;
    }
    MeshFile file;
    file.format = FileFormat::kStl;
    if (solids > 1)
      file.notes.push_back({"dropped.solids", std::to_string(solids) + " solids joined into one mesh"});
    if (unended_) file.notes.push_back({"repaired.endsolid", "the file ends without 'endsolid'"});
    note_small_faces(file.notes, small_faces_);
    if (!soup_.face_offsets.empty() && soup_.face_offsets.back() == 3 * (soup_.face_offsets.size() - 1))
      soup_.face_offsets = {};
    soup_.face_channels.push_back({"normal", 3, std::move(normals_)});
    file.geometry = std::move(soup_);
    return file;
  }

 private:
  tl::unexpected<Error> expected(const std::string& what) {
    text_.skip_to_content();
    return source_.bad_line(text_.at(), "expected " + what + ", found " + text_.found());
  }

  /// The next word, which may stand in two: "end loop".
  bool accept(std::string_view wanted) {
    text_.skip_to_content();
    const TextCursor before = text_;
    const std::string_view word = text_.word();
    if (same_word(word, wanted)) return true;
    if (wanted.starts_with("end") && same_word(word, "end")) {
      text_.skip_to_content();
      if (same_word(text_.word(), wanted.substr(3))) return true;
    }
    text_ = before;
    return false;
  }

  Result<void> keyword(std::string_view wanted) {
    if (accept(wanted)) return {};
    return expected("'" + std::string(wanted) + "'");
  }

  /// Over a name of any words: to the end of the line, or to where two words go on with the content, as in
  /// files without line ends.
  void skip_name(std::string_view first, std::string_view second) {
    while (!text_.line_done()) {
      const TextCursor before = text_;
      if (same_word(text_.word(), first)) {
        const TextCursor behind = text_;
        if (same_word(text_.word(), second)) {
          text_ = before;
          return;
        }
        text_ = behind;
      }
    }
  }

  /// The rest of the line behind 'endsolid', unless another solid with facets begins in it.
  void skip_end_name() {
    while (!text_.line_done()) {
      const TextCursor before = text_;
      if (!same_word(text_.word(), "solid")) continue;
      const TextCursor behind = text_;
      skip_name("facet", "normal");
      const bool facets = !text_.line_done();
      text_ = facets ? before : behind;
      if (facets) return;
    }
  }

  Result<void> vector(const char* what, DVec3& to) {
    for (int axis = 0; axis < 3; ++axis) {
      text_.skip_to_content();
      if (!text_.coordinate(to[axis])) return expected(std::string("a number of ") + what);
    }
    return {};
  }

  Result<void> facets() {
    for (std::size_t f = 0;; ++f) {
      if (Source::due(f)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_content();
      const char* at = text_.at();
      if (accept("facet")) {
        VKMESH_CHECK(facet(at));
        continue;
      }
      // Some writers glue the name to it.
      const TextCursor before = text_;
      const std::string_view word = text_.word();
      if (same_word(word.substr(0, 8), "endsolid") || (text_ = before, accept("endsolid"))) {
        skip_end_name();
        return {};
      }
      if (text_.at_end() && f > 0) {
        unended_ = true;
        return {};
      }
      return source_.bad_line(at, word.empty()
                                      ? "the file ends without 'endsolid'"
                                      : "expected 'facet' or 'endsolid', found " + TextCursor(word).found());
    }
  }

  Result<void> facet(const char* at) {
    VKMESH_CHECK(keyword("normal"));
    DVec3 normal(0.0);
    VKMESH_CHECK(vector("a normal", normal));
    VKMESH_CHECK(keyword("outer"));
    VKMESH_CHECK(keyword("loop"));
    std::size_t count = 0;
    for (;; ++count) {
      text_.skip_to_content();
      const char* corner_at = text_.at();
      const TextCursor before = text_;
      if (!same_word(text_.word(), "vertex")) {
        text_ = before;
        break;
      }
      DVec3 corner(0.0);
      VKMESH_CHECK(vector("a vertex", corner));
      const Vec3 placed = source_.positions->place(corner);
      if (!all_finite(placed)) return source_.bad_line(corner_at, "a coordinate is not finite");
      soup_.corners.push_back(placed);
    }
    VKMESH_CHECK(keyword("endloop"));
    VKMESH_CHECK(keyword("endfacet"));
    if (count < 3) {
      soup_.corners.resize(soup_.corners.size() - count);
      ++small_faces_;
      return {};
    }
    if (soup_.corners.size() > kMaxElements)
      return source_.bad_line(at, "the facets have more corners than 32-bit indices can number");
    if (count != 3 && soup_.face_offsets.empty())
      for (std::size_t f = 0; f <= faces_; ++f)
        soup_.face_offsets.push_back(static_cast<std::uint32_t>(3 * f));
    ++faces_;
    if (!soup_.face_offsets.empty())
      soup_.face_offsets.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
    for (int axis = 0; axis < 3; ++axis) normals_.push_back(static_cast<float>(normal[axis]));
    return {};
  }

  const Source& source_;
  TextCursor text_;
  PolygonSoup soup_;
  std::vector<float> normals_;
  std::size_t faces_ = 0, small_faces_ = 0;
  bool unended_ = false;
};

/// Where the facets of a binary file begin, and what follows them.
struct BinaryLayout {
  std::vector<std::size_t> places;  ///< Where each facet stands, if they do not follow each other.
  std::uint64_t facets = 0;
  std::uint64_t payload = 0;   ///< Bytes between facets.
  std::uint64_t trailing = 0;  ///< Bytes behind the last.
};

/// Some files count the bytes of an attribute that follows each facet in the 16 bits at its end. True when
/// the file is one of those: the bytes come out exactly.
bool find_payload(std::string_view bytes, BinaryLayout& layout) {
  std::size_t at = kStart;
  for (std::uint64_t f = 0; f < layout.facets; ++f) {
    if (bytes.size() - at < kFacet) return false;
    layout.places.push_back(at);
    std::uint16_t length = 0;
    std::memcpy(&length, bytes.data() + at + 48, sizeof(length));
    at += kFacet;
    if (bytes.size() - at < length) return false;
    at += length;
    layout.payload += length;
  }
  return layout.payload > 0 && at == bytes.size();
}

Vec3 facet_normal(const std::array<Vec3, 3>& corners) {
  const DVec3 a(corners[0]), u = DVec3(corners[1]) - a, v = DVec3(corners[2]) - a;
  const DVec3 n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
  const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  return length > 0 ? Vec3(n / length) : Vec3(0);
}

}  // namespace

std::uint64_t stl_binary_size(std::string_view bytes) {
  if (bytes.size() < kStart) return 0;
  std::uint32_t facets = 0;
  std::memcpy(&facets, bytes.data() + kHeader, sizeof(facets));
  return kStart + std::uint64_t{kFacet} * facets;
}

Result<MeshFile> parse_stl_ascii(const Source& source) {
  return AsciiStlReader(source).read();
}

Result<MeshFile> parse_stl_binary(const Source& source) {
  const std::string_view bytes = source.bytes;
  const char* end = bytes.data() + bytes.size();
  if (bytes.size() < kStart)
    return source.bad_byte(end, "the file ends within the 84 bytes that begin a binary STL file");
  BinaryLayout layout;
  layout.facets = (stl_binary_size(bytes) - kStart) / kFacet;
  MeshFile file;
  // Some writers do not know the count when they write the header.
  const bool counted = layout.facets > 0 || bytes.size() == kStart;
  if (!counted && bytes.size() - kStart < kFacet)
    return source.bad_byte(bytes.data() + kHeader, "the header promises 0 facets, but the file has " +
                                                       std::to_string(bytes.size()) + " bytes");
  if (!counted) {
    layout.facets = (bytes.size() - kStart) / kFacet;
    file.notes.push_back({"repaired.count", "the header promises 0 facets, but the file has bytes for " +
                                                std::to_string(layout.facets) + ", which are read"});
  }
  const std::uint64_t facets = layout.facets, promised = kStart + kFacet * facets;
  if (promised > bytes.size())
    return source.bad_byte(bytes.data() + kHeader, "the header promises " + std::to_string(facets) +
                                                       " facets, " + std::to_string(promised) +
                                                       " bytes in all, but the file has " +
                                                       std::to_string(bytes.size()));
  if (promised < bytes.size() && !(counted && find_payload(bytes, layout))) {
    layout.places.clear();
    layout.payload = 0;
    layout.trailing = bytes.size() - promised;
    file.notes.push_back(
        {"dropped.trailing_bytes", std::to_string(layout.trailing) + " bytes behind the last facet ignored"});
  }
  if (layout.payload > 0)
    file.notes.push_back({"dropped.attribute_bytes",
                          std::to_string(layout.payload) + " bytes of attributes behind facets ignored"});
  if (3 * facets > kMaxElements)
    return source.bad_byte(bytes.data() + kHeader,
                           "the facets have more corners than 32-bit indices can number");

  PolygonSoup soup;
  soup.corners.resize(3 * facets);
  std::vector<float> normals(3 * facets);
  std::vector<std::uint16_t> attributes;
  const bool moved = source.offset != DVec3(0.0);  // Floats lose nothing where they are.
  for (std::size_t f = 0; f < facets; ++f) {
    const char* at = bytes.data() + (layout.places.empty() ? kStart + f * kFacet : layout.places[f]);
    if (Source::due(f)) VKMESH_CHECK(source.tick(at));
    std::memcpy(&normals[3 * f], at, 12);
    std::memcpy(&soup.corners[3 * f], at + 12, 36);
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3& corner = soup.corners[3 * f + k];
      if (!all_finite(corner))
        return source.bad_byte(at + 12 + 12 * k,
                               "facet " + std::to_string(f) + " has a coordinate that is not finite");
      if (moved) corner = source.positions->place(DVec3(corner));
    }
    std::uint16_t attribute = 0;
    if (layout.payload == 0) std::memcpy(&attribute, at + 48, sizeof(attribute));
    if (attribute != 0 && attributes.empty()) attributes.resize(facets);
    if (attribute != 0) attributes[f] = attribute;
  }
  soup.face_channels.push_back({"normal", 3, std::move(normals)});
  if (!attributes.empty()) soup.face_channels.push_back({"attribute", 1, std::move(attributes)});
  file.geometry = std::move(soup);
  file.format = FileFormat::kStl;
  file.encoding = FileEncoding::kBinaryLittleEndian;
  return file;
}

void encode_stl(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  const bool ascii = options.encoding == FileEncoding::kAscii;
  const Channel* attribute = find_channel(mesh.face_channels, "attribute");
  if (attribute != nullptr && (ascii || attribute->components != 1 ||
                               !std::holds_alternative<std::vector<std::uint16_t>>(attribute->values)))
    attribute = nullptr;
  for (const Channel& c : mesh.point_channels)
    note_left_out(notes, "point", c, "STL has no attributes of points");
  for (const Channel& c : mesh.corner_channels)
    note_left_out(notes, "corner", c, "STL has no attributes of corners");
  std::vector<bool> used(mesh.points.size());
  for (const std::uint32_t c : mesh.corners) used[c] = true;
  if (const auto alone = std::count(used.begin(), used.end(), false); alone > 0)
    notes.push_back({"dropped.isolated_points",
                     std::to_string(alone) + " points that no face uses left out: STL holds triangles only"});
  for (const Channel& c : mesh.face_channels) {
    if (&c == attribute) continue;
    note_left_out(
        notes, "face", c,
        c.name == "normal" ? "facet normals follow from the positions" : "STL holds none of that name");
  }

  const std::vector<std::string> comment = comment_lines(options.comment);
  std::string name = comment.empty() ? "" : comment.front();
  if (ascii) {
    out.put("solid" + (name.empty() ? "" : " " + name) + "\n");
  } else {
    // Many readers take every file that begins with this word for text.
    if (name.starts_with("solid")) name.insert(0, "binary ");
    name.resize(kHeader, '\0');
    const auto facets = static_cast<std::uint32_t>(mesh.face_count());
    char* to = out.room(kStart);
    std::memcpy(to, name.data(), kHeader);
    std::memcpy(to + kHeader, &facets, sizeof(facets));
    out.commit(to + kStart);
  }

  Positions placed;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    std::array<Vec3, 3> corners = {mesh.points[face[0]], mesh.points[face[1]], mesh.points[face[2]]};
    const Vec3 normal = facet_normal(corners);
    char* to = out.room(1024);
    const auto put = [&](std::string_view word) { to = std::copy(word.begin(), word.end(), to); };
    const auto put_vector = [&](std::string_view word, const Vec3& v, const DVec3& offset) {
      put(word);
      for (int axis = 0; axis < 3; ++axis) {
        *to++ = ' ';
        to = put_coordinate(to, v[axis], offset[axis]);
      }
      *to++ = '\n';
    };
    if (ascii) {
      put_vector("facet normal", normal, DVec3(0.0));
      put("outer loop\n");
      for (const Vec3& c : corners) put_vector("vertex", c, options.offset);
      put("endloop\nendfacet\n");
    } else {
      if (options.offset != DVec3(0.0))
        for (Vec3& c : corners) c = placed.place(DVec3(c) + options.offset);
      std::memcpy(to, &normal, 12);
      std::memcpy(to + 12, corners.data(), 36);
      const std::uint16_t bits = attribute != nullptr
                                     ? std::get<std::vector<std::uint16_t>>(attribute->values)[f]
                                     : std::uint16_t{0};
      std::memcpy(to + 48, &bits, sizeof(bits));
      to += kFacet;
    }
    out.commit(to);
  }
  if (ascii) out.put("endsolid" + (name.empty() ? "" : " " + name) + "\n");
  placed.add_notes(notes);
}

}  // namespace vkmesh::detail
