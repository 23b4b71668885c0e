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

bool is_finite(const Vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

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
      text_.skip_to_line_end();  // A name, of any words.
      VKMESH_CHECK(facets());
      ++solids;
    }
    MeshFile file;
    file.format = FileFormat::kStl;
    if (solids > 1) file.notes.push_back(std::to_string(solids) + " solids joined into one mesh");
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

  Result<void> keyword(std::string_view wanted) {
    text_.skip_to_content();
    const TextCursor before = text_;
    if (same_word(text_.word(), wanted)) return {};
    text_ = before;
    return expected("'" + std::string(wanted) + "'");
  }

  Result<void> vector(const char* what, Vec3& to) {
    for (int axis = 0; axis < 3; ++axis) {
      text_.skip_to_content();
      if (!text_.number(to[axis])) return expected(std::string("a number of ") + what);
    }
    return {};
  }

  Result<void> facets() {
    for (std::size_t f = 0;; ++f) {
      if (Source::due(f)) VKMESH_CHECK(source_.tick(text_.at()));
      text_.skip_to_content();
      const char* at = text_.at();
      const std::string_view word = text_.word();
      if (same_word(word, "endsolid")) {
        text_.skip_to_line_end();
        return {};
      }
      if (!same_word(word, "facet"))
        return source_.bad_line(
            at, word.empty() ? "the file ends without 'endsolid'"
                             : "expected 'facet' or 'endsolid', found " + TextCursor(word).found());
      VKMESH_CHECK(facet(at));
    }
  }

  Result<void> facet(const char* at) {
    VKMESH_CHECK(keyword("normal"));
    Vec3 normal(0);
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
      Vec3 corner(0);
      VKMESH_CHECK(vector("a vertex", corner));
      if (!is_finite(corner)) return source_.bad_line(corner_at, "a coordinate is not finite");
      soup_.corners.push_back(corner);
    }
    VKMESH_CHECK(keyword("endloop"));
    VKMESH_CHECK(keyword("endfacet"));
    if (count < 3) return source_.bad_line(at, "a facet has " + std::to_string(count) + " corners");
    if (soup_.corners.size() > kMaxElements)
      return source_.bad_line(at, "the facets have more corners than 32-bit indices can number");
    if (count != 3 && soup_.face_offsets.empty())
      for (std::size_t f = 0; f <= faces_; ++f)
        soup_.face_offsets.push_back(static_cast<std::uint32_t>(3 * f));
    ++faces_;
    if (!soup_.face_offsets.empty())
      soup_.face_offsets.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
    normals_.insert(normals_.end(), {normal.x, normal.y, normal.z});
    return {};
  }

  const Source& source_;
  TextCursor text_;
  PolygonSoup soup_;
  std::vector<float> normals_;
  std::size_t faces_ = 0;
};

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
  const std::uint64_t promised = stl_binary_size(bytes), facets = (promised - kStart) / kFacet;
  if (promised != bytes.size())
    return source.bad_byte(bytes.data() + kHeader, "the header promises " + std::to_string(facets) +
                                                       " facets, " + std::to_string(promised) +
                                                       " bytes in all, but the file has " +
                                                       std::to_string(bytes.size()));
  if (3 * facets > kMaxElements)
    return source.bad_byte(bytes.data() + kHeader,
                           "the facets have more corners than 32-bit indices can number");

  PolygonSoup soup;
  soup.corners.resize(3 * facets);
  std::vector<float> normals(3 * facets);
  std::vector<std::uint16_t> attributes;
  for (std::size_t f = 0; f < facets; ++f) {
    const char* at = bytes.data() + kStart + f * kFacet;
    if (Source::due(f)) VKMESH_CHECK(source.tick(at));
    std::memcpy(&normals[3 * f], at, 12);
    std::memcpy(&soup.corners[3 * f], at + 12, 36);
    for (std::size_t k = 0; k < 3; ++k)
      if (!is_finite(soup.corners[3 * f + k]))
        return source.bad_byte(at + 12 + 12 * k,
                               "facet " + std::to_string(f) + " has a coordinate that is not finite");
    std::uint16_t attribute = 0;
    std::memcpy(&attribute, at + 48, sizeof(attribute));
    if (attribute != 0 && attributes.empty()) attributes.resize(facets);
    if (attribute != 0) attributes[f] = attribute;
  }
  soup.face_channels.push_back({"normal", 3, std::move(normals)});
  if (!attributes.empty()) soup.face_channels.push_back({"attribute", 1, std::move(attributes)});
  MeshFile file;
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

  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const std::array<Vec3, 3> corners = {mesh.points[face[0]], mesh.points[face[1]], mesh.points[face[2]]};
    const Vec3 normal = facet_normal(corners);
    char* to = out.room(1024);
    const auto put = [&](std::string_view word) { to = std::copy(word.begin(), word.end(), to); };
    const auto put_vector = [&](std::string_view word, const Vec3& v) {
      put(word);
      for (int axis = 0; axis < 3; ++axis) {
        *to++ = ' ';
        to = put_number(to, v[axis]);
      }
      *to++ = '\n';
    };
    if (ascii) {
      put_vector("facet normal", normal);
      put("outer loop\n");
      for (const Vec3& c : corners) put_vector("vertex", c);
      put("endloop\nendfacet\n");
    } else {
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
}

}  // namespace vkmesh::detail
