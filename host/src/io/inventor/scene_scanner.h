// Walks over the text of a scene, word by word.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "io/text.h"

namespace vkmesh::detail {

/// A name as a message shows it.
[[nodiscard]] inline std::string shown(std::string_view name) {
  return TextCursor(name).found();
}

/// Walks over the text of a scene. Commas are blanks, comments run from # to the end of the line.
class SceneScanner {
 public:
  explicit SceneScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  [[nodiscard]] const char* at() const { return at_; }
  [[nodiscard]] bool at_end() const { return at_ == end_; }
  [[nodiscard]] std::string_view rest() const { return {at_, static_cast<std::size_t>(end_ - at_)}; }

  void skip() {
    while (at_ != end_) {
      if (is_blank(*at_)) {
        ++at_;
      } else if (*at_ == '#') {
        while (at_ != end_ && *at_ != '\n' && *at_ != '\r') ++at_;
      } else {
        return;
      }
    }
  }

  /// What the next content begins with; 0 at the end.
  char peek() {
    skip();
    return at_ == end_ ? '\0' : *at_;
  }

  bool accept(char c) {
    if (peek() != c || at_ == end_) return false;
    ++at_;
    return true;
  }

  /// The next word or number; empty where a bracket, a quote or the end stands.
  std::string_view word() {
    skip();
    const char* from = at_;
    while (at_ != end_ && !ends_word(*at_)) ++at_;
    return {from, static_cast<std::size_t>(at_ - from)};
  }

  /// Over a quoted string that begins here. False where it does not end.
  bool skip_string() {
    for (++at_; at_ != end_; ++at_) {
      if (*at_ == '"') {
        ++at_;
        return true;
      }
      if (*at_ == '\\' && at_ + 1 != end_) ++at_;
    }
    return false;
  }

  void skip_one() {
    if (at_ != end_) ++at_;
  }

  /// Over `count` bytes, all of which must be there.
  void skip_bytes(std::size_t count) { at_ += count; }

  /// To behind the next `c`. False where there is none.
  bool skip_past(char c) {
    while (at_ != end_)
      if (*at_++ == c) return true;
    return false;
  }

  /// From behind an opening bracket to behind the one that closes it. False where none does.
  bool skip_nested(char open, char close) {
    for (std::size_t depth = 1; peek() != '\0' || !at_end();) {
      if (*at_ == '"') {
        if (!skip_string()) return false;
        continue;
      }
      if (*at_ == open) ++depth;
      if (*at_++ == close && --depth == 0) return true;
    }
    return false;
  }

  /// A number, which must end where a word ends.
  template <class T>
  bool number(T& value) {
    skip();
    TextCursor text(rest());
    if (!text.number_prefix(value) || (!text.at_end() && !ends_word(*text.at()))) return false;
    at_ = text.at();
    return true;
  }

 private:
  static bool is_blank(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == ',' || c == '\v' || c == '\f';
  }
  static bool ends_word(char c) {
    return is_blank(c) || c == '{' || c == '}' || c == '[' || c == ']' || c == '"' || c == '#';
  }

  const char* at_;
  const char* end_;
};

}  // namespace vkmesh::detail
