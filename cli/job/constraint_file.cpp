#include "job/constraint_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace vkmesh::cli {
namespace {

/// Words of one line of text, before a '#'.
std::vector<std::string_view> words_of(std::string_view line, std::string_view separators) {
  line = line.substr(0, line.find('#'));
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(separators);
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    words.push_back(line.substr(0, line.find_first_of(separators)));
    line.remove_prefix(words.back().size());
  }
}

template <class T>
std::optional<T> number_of(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

/// Puts points that follow each other into segments.
class Polyline {
 public:
  explicit Polyline(ConstraintFile& file) : file_(file) {}
  void add(std::uint32_t from, std::uint32_t to) {
    if (segments_.empty() || segments_.back()[1] != from) end();
    segments_.push_back({from, to});
    if (to == segments_.front()[0]) end();
  }
  void end() {
    if (segments_.empty()) return;
    auto& all = segments_.front()[0] == segments_.back()[1] ? file_.loops : file_.lines;
    all.insert(all.end(), segments_.begin(), segments_.end());
    segments_.clear();
  }

 private:
  ConstraintFile& file_;
  std::vector<PointPair> segments_;
};

class ConstraintReader {
 public:
  explicit ConstraintReader(const std::filesystem::path& path) : path_(path) {}

  Result<ConstraintFile> read() {
    std::error_code error;
    if (std::filesystem::is_directory(path_, error)) return bad("is a directory");
    std::ifstream stream(path_, std::ios::binary);
    if (!stream) return bad("cannot be opened");
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) return bad("cannot be read");
    const std::string extension = path_.extension().string();
    if (extension == ".gz") return bad("constraints are read from plain files, not from gzipped ones");
    file_.has_points = extension == ".obj" || extension == ".OBJ";
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      ++line_;
      const std::string_view line = std::string_view(text).substr(begin, end - begin);
      VKMESH_CHECK(file_.has_points ? read_obj(line) : read_pair(line));
      begin = end + 1;
    }
    pairs_.end();
    return std::move(file_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> bad(std::string message) const {
    Location where{path_.string(), {}, {}};
    if (line_ > 0) where.line = line_;
    return fail(ErrorCode::kUnreadable, std::move(message), std::move(where));
  }

  Result<void> read_pair(std::string_view line) {
    const auto words = words_of(line, " \t\r,;");
    if (words.empty()) return {};
    std::vector<std::uint32_t> numbers;
    for (const std::string_view word : words)
      if (const auto number = number_of<std::uint32_t>(word)) numbers.push_back(*number);
    if (words.size() != 2 || numbers.size() != 2) return bad("expected the numbers of two points");
    pairs_.add(numbers[0], numbers[1]);
    return {};
  }

  Result<void> read_obj(std::string_view line) {
    const auto words = words_of(line, " \t\r");
    if (words.empty()) return {};
    if (words[0] == "v") {
      DVec3 point(0.0);
      for (std::size_t i = 0; i < 3 && i + 1 < words.size(); ++i) {
        const auto number = number_of<double>(words[i + 1]);
        if (!number || !std::isfinite(*number))
          return bad("'" + std::string(words[i + 1]) + "' is no coordinate");
        point[static_cast<int>(i)] = *number;
      }
      if (words.size() < 3) return bad("expected the coordinates of a point");
      file_.points.push_back(point);
      return {};
    }
    if (words[0] != "l" && words[0] != "f") return {};
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto number = number_of<std::int64_t>(words[i].substr(0, words[i].find('/')));
      const auto count = static_cast<std::int64_t>(file_.points.size());
      const std::int64_t index = !number ? -1 : *number < 0 ? count + *number : *number - 1;
      if (index < 0 || index >= count)
        return bad("'" + std::string(words[i]) + "' is none of the " + std::to_string(count) +
                   " points above");
      corners.push_back(static_cast<std::uint32_t>(index));
    }
    if (words[0] == "f" && !corners.empty()) corners.push_back(corners.front());
    if (corners.size() < 2) return bad("a line has two points or more");
    auto& all = corners.front() == corners.back() ? file_.loops : file_.lines;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) all.push_back({corners[i], corners[i + 1]});
    return {};
  }

  std::filesystem::path path_;
  std::uint64_t line_ = 0;
  ConstraintFile file_;
  Polyline pairs_{file_};
};

}  // namespace

Result<ConstraintFile> read_constraints(const std::filesystem::path& path) {
  return ConstraintReader(path).read();
}

}  // namespace vkmesh::cli
