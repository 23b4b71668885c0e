// Reading numbers and words from text in memory, with a place to point at when they are wrong.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace vkmesh::detail {

/// Walks over text. Locale plays no part. Blanks are space, tab, vertical tab and form feed; a line ends at a
/// line feed or a carriage return, so that the pair of both is a line and an empty one. The parse functions
/// return false where the text is something else and leave the place at its start; found() then says what is
/// there.
class TextCursor {
 public:
  /// `comment` begins a comment that runs to the end of its line, where it begins a line or stands behind a
  /// blank or the digits of a number: never within a word. 0 for none.
  explicit TextCursor(std::string_view text, char comment = 0)
      : begin_(text.data()), at_(text.data()), end_(text.data() + text.size()), comment_(comment) {}

  [[nodiscard]] const char* at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  [[nodiscard]] bool at_end() const { return at_ == end_; }
  [[nodiscard]] bool at_line_end() const { return at_ == end_ || ends_line(*at_); }

  /// Blanks, and a comment, within the line.
  void skip_blanks() {
    // Most often there is one blank, or none, before a word or the end of the line.
    if (at_ != end_ && *at_ == ' ') ++at_;
    if (at_ != end_ && ((static_cast<unsigned char>(*at_) > ' ' && *at_ != comment_) || *at_ == '\n')) return;
    skip_any_blanks();
  }

  /// Blanks, comments and line ends: to the next content, or the end of the text.
  void skip_to_content() {
    for (skip_blanks(); at_ != end_ && ends_line(*at_); skip_blanks()) ++at_;
  }

  void skip_to_line_end() {
    while (at_ != end_ && !ends_line(*at_)) ++at_;
  }

  /// Skips `c` if it stands here.
  bool accept(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }

  /// A run of characters that are neither blank nor line end; empty where there is none.
  std::string_view word() {
    skip_blanks();
    const char* from = at_;
    while (at_ != end_ && !is_blank(*at_) && !ends_line(*at_)) ++at_;
    return {from, static_cast<std::size_t>(at_ - from)};
  }

  /// The next number of the line, which must end where a number ends. T is an integer or float type; floats
  /// too small become 0 or subnormal, floats too large are refused.
  template <class T>
  bool number(T& value) {
    const char* from = at_;
    if (number_prefix(value) && is_separator()) return true;
    at_ = from;
    skip_blanks();
    return false;
  }

  /// The same, whatever follows ("12/7").
  template <class T>
  bool number_prefix(T& value) {
    skip_blanks();
    const char* from = at_;
    if constexpr (std::is_integral_v<T>)
      if (short_number(value)) return true;
    if (from != end_ && *from == '+' && from + 1 != end_ && from[1] != '-' && from[1] != '+') ++from;
    const auto [to, code] = std::from_chars(from, end_, value);
    if (code == std::errc{}) {
      at_ = to;
      if constexpr (std::is_floating_point_v<T>)
        if (at_ != end_ && *at_ == '#') not_a_number(value);
      return true;
    }
    if constexpr (std::is_floating_point_v<T>)
      if (code == std::errc::result_out_of_range) return tiny_number(from, value);
    return false;
  }

  /// The next number of the line as a coordinate: finite numbers that a float cannot hold are refused.
  bool coordinate(double& value) {
    const char* from = at_;
    if (number(value) && (!std::isfinite(value) || std::abs(value) <= std::numeric_limits<float>::max()))
      return true;
    at_ = from;
    skip_blanks();
    return false;
  }

  /// True at the end of the line, blanks and comment skipped.
  bool line_done() {
    skip_blanks();
    return at_line_end();
  }

  /// What stands here, for a message: "'abc'", "the end of the line", "the end of the file".
  [[nodiscard]] std::string found() const {
    if (at_ == end_) return "the end of the file";
    if (ends_line(*at_) || at_comment()) return "the end of the line";
    constexpr std::size_t kShown = 24;
    std::string text = "'";
    const char* p = at_;
    for (; p != end_ && !is_blank(*p) && !ends_line(*p) && static_cast<std::size_t>(p - at_) < kShown; ++p) {
      constexpr char kHex[] = "0123456789abcdef";
      const auto c = static_cast<unsigned char>(*p);
      if (c >= 0x20 && c < 0x7f)
        text += *p;
      else
        text += {'\\', 'x', kHex[c >> 4], kHex[c & 15]};
    }
    return text + (p != end_ && static_cast<std::size_t>(p - at_) == kShown ? "…'" : "'");
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool ends_line(char c) { return c == '\n' || c == '\r'; }
  bool is_separator() const { return at_ == end_ || is_blank(*at_) || ends_line(*at_) || at_comment(); }
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  bool at_comment() const {
    return comment_ != 0 && at_ != end_ && *at_ == comment_ &&
           (at_ == begin_ || is_blank(at_[-1]) || ends_line(at_[-1]) || is_digit(at_[-1]));
  }

  [[gnu::noinline]] void skip_any_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (at_comment()) skip_to_line_end();
  }

  /// "1.#INF", "-1.#IND", "1.#QNAN00": what the runtime library of Visual C++ prints for numbers that are
  /// none.
  template <class T>
  void not_a_number(T& value) {
    constexpr std::string_view kNames[] = {"INF", "IND", "QNAN", "SNAN"};
    const std::string_view rest(at_ + 1, left() - 1);
    for (const std::string_view name : kNames) {
      if (!rest.starts_with(name)) continue;
      value = std::copysign(
          name == "INF" ? std::numeric_limits<T>::infinity() : std::numeric_limits<T>::quiet_NaN(), value);
      for (at_ += 1 + name.size(); at_ != end_ && *at_ >= '0' && *at_ <= '9';) ++at_;
      return;
    }
  }

  /// Digits so few that any number of them fits, as nearly all indices are. std::from_chars weighs each
  /// digit, which takes three times as long.
  template <class T>
  bool short_number(T& value) {
    const char* p = at_;
    unsigned number = 0;
    for (int room = std::min(std::numeric_limits<T>::digits10, 9); room > 0 && p != end_; --room, ++p) {
      const unsigned digit = static_cast<unsigned>(*p) - '0';
      if (digit > 9) break;
      number = 10 * number + digit;
    }
    if (p == at_ || (p != end_ && static_cast<unsigned>(*p) - '0' <= 9)) return false;
    value = static_cast<T>(number);
    at_ = p;
    return true;
  }

  /// A number that its type cannot hold: too small is 0 (or the nearest subnormal), too large is refused.
  template <class T>
  bool tiny_number(const char* from, T& value) {
    long double wide = 0;
    const auto [to, code] = std::from_chars(from, end_, wide);
    if (code != std::errc{} || std::abs(wide) > 1) return false;
    value = static_cast<T>(wide);
    at_ = to;
    return true;
  }

  const char* begin_;
  const char* at_;
  const char* end_;
  char comment_;
};

}  // namespace vkmesh::detail
