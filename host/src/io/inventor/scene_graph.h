// OpenInventor and VRML files as a graph of nodes. They are split into nodes and fields once; numbers are
// read when they are asked for, and once however often their node is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <vkmesh/base/result.h>

#include "io/formats.h"

namespace vkmesh::detail {

/// How deep nodes may stand within nodes, by text and by USE.
inline constexpr std::size_t kMaxSceneDepth = 256;

/// How the value of a field stands in the file: as text, or as the words of 4 bytes, the most significant
/// first, that binary files have for numbers, or as the characters of a binary file's string.
enum class SceneForm : std::uint8_t { kText, kWholeWords, kRealWords, kCharacters };

/// A field of a node. `text` is what stands between the brackets, or the single value.
struct SceneField {
  std::string_view name;
  std::string_view text;
  SceneForm form = SceneForm::kText;
  std::vector<std::uint32_t> nodes;  ///< Where the value is one node or a list of them.

  /// The first string of the value, without quotes.
  [[nodiscard]] std::string string() const;
};

/// A node whose type the reader knows. Those it uses have smaller numbers, so that no walk can loop.
struct SceneNode {
  int kind = 0;
  std::string_view type;  ///< As the file writes it; its place is the node's.
  std::vector<SceneField> fields;
  std::vector<std::uint32_t> children;  ///< Nodes that stand among the fields.

  /// The field of that name, or nullptr.
  [[nodiscard]] const SceneField* field(std::string_view name) const;
  /// What a field that is a word says, or `otherwise`.
  [[nodiscard]] std::string_view word(std::string_view name, std::string_view otherwise) const;
};

struct KnownNode {
  std::string_view name;
  int kind;  ///< Not 0, which stands for every ignored node.
};

/// The number of the node that stands for every node that is ignored.
inline constexpr std::uint32_t kIgnoredNode = 0;

struct SceneGraph {
  std::vector<SceneNode> nodes;  ///< The first is kIgnoredNode.
  std::vector<std::uint32_t> roots;
};

/// Counts what is ignored, by name.
class IgnoredNodes {
 public:
  void add(std::string_view type);
  void add_to(Notes& notes) const;
  /// "3 'IndexedLineSet', 1 'Sound'"; empty where nothing was ignored.
  [[nodiscard]] std::string text() const;

 private:
  std::map<std::string_view, std::size_t> counts_;
  std::size_t others_ = 0;
};

/// Splits the text into nodes. Instances of PROTOs are expanded. Types that `known` does not list and fields
/// that `fields` does not list are skipped, but for the nodes in them that have a name; the former are
/// counted, as are EXTERNPROTO and ROUTE, connections of fields and uses of names nobody defined.
[[nodiscard]] Result<SceneGraph> parse_scene(const Source& source, std::span<const KnownNode> known,
                                             std::span<const std::string_view> fields, IgnoredNodes& ignored,
                                             Notes& notes);

/// The same for the binary form of OpenInventor 2.0 and 2.1, whose nodes begin at `begin`. Node types that
/// neither the file describes nor OpenInventor defines are an error, since their length is not known.
[[nodiscard]] Result<SceneGraph> parse_binary_scene(const Source& source, const char* begin, bool has_flags,
                                                    std::span<const KnownNode> known,
                                                    std::span<const std::string_view> fields,
                                                    IgnoredNodes& ignored, Notes& notes);

/// "2 ROUTE statements ignored" where the count is not 0.
void note_ignored(Notes& notes, std::size_t count, const char* code, const char* what);

/// The numbers of a field, and where they stand.
template <class T>
struct SceneArray {
  std::vector<T> values;
  std::string_view text;
  SceneForm form = SceneForm::kText;
};
using SceneFloats = SceneArray<float>;
using SceneDoubles = SceneArray<double>;
using SceneIndices = SceneArray<std::int32_t>;

/// The numbers of fields, each field read once. What it returns lives as long as it.
class SceneNumbers {
 public:
  explicit SceneNumbers(const Source& source) : source_(source), farthest_(source.bytes.data()) {}

  /// Rows of `width` finite numbers. nullptr where the field is missing.
  [[nodiscard]] Result<const SceneFloats*> floats(const SceneField* field, unsigned width);
  /// The same in the precision of positions.
  [[nodiscard]] Result<const SceneDoubles*> doubles(const SceneField* field, unsigned width);
  /// Whole numbers. nullptr where the field is missing, empty or a single -1, which Inventor writes for it.
  [[nodiscard]] Result<const SceneIndices*> indices(const SceneField* field);
  /// 0xRRGGBBAA as four fractions of 1; `reversed`: 0xAABBGGRR.
  [[nodiscard]] Result<const SceneFloats*> packed_colors(const SceneField* field, bool reversed = false);
  /// Exactly `to.size()` finite numbers; left as they are where the field is missing.
  [[nodiscard]] Result<void> values(const SceneField* field, std::span<double> to);
  [[nodiscard]] Result<void> whole_number(const SceneField* field, std::int64_t& to);

  /// kUnreadable at number `i` of an array.
  template <class T>
  [[nodiscard]] tl::unexpected<Error> bad_number(const SceneArray<T>& array, std::size_t i,
                                                 std::string message) const {
    return source_.bad_line(place_of(array.text, array.form, i), std::move(message));
  }
  /// Progress never goes back, though fields are read in the order of their use.
  [[nodiscard]] Result<void> tick(const char* at);

 private:
  [[nodiscard]] static const char* place_of(std::string_view text, SceneForm form, std::size_t i);
  template <class Read>
  Result<void> each(const SceneField& field, const char* what, Read&& read);
  template <class T>
  Result<const SceneArray<T>*> rows(const SceneField* field, unsigned width,
                                    std::map<const char*, SceneArray<T>>& known);

  const Source& source_;
  const char* farthest_;
  std::map<const char*, SceneFloats> floats_, colors_;
  std::map<const char*, SceneDoubles> doubles_;
  std::map<const char*, SceneIndices> indices_;
};

}  // namespace vkmesh::detail
