#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <utility>

#include "io/inventor/big_endian.h"
#include "io/inventor/scene_graph.h"
#include "io/inventor/scene_scanner.h"
#include "io/text.h"

namespace vkmesh::detail {
namespace {

/// Walks over the numbers of a field, whatever their form.
class NumberScanner {
 public:
  NumberScanner(std::string_view text, SceneForm form) : text_(text), form_(form) {}

  [[nodiscard]] const char* at() const { return text_.at(); }
  [[nodiscard]] bool at_end() const { return text_.at_end(); }

  void skip() {
    if (!in_words()) text_.skip();
  }
  /// Over a number, whatever it is.
  void skip_number() {
    if (in_words())
      text_.skip_bytes(4);
    else
      static_cast<void>(text_.word());
  }

  /// The next number; false, and no step, where it is none of type T.
  template <class T>
  bool number(T& value) {
    if (!in_words()) return text_.number(value);
    const std::uint32_t word = big_endian_word(text_.at());
    if (form_ == SceneForm::kWholeWords)
      value = static_cast<T>(std::bit_cast<std::int32_t>(word));
    else if constexpr (std::is_floating_point_v<T>)
      value = static_cast<T>(std::bit_cast<float>(word));
    else
      return false;
    text_.skip_bytes(4);
    return true;
  }

  /// The next number as 32 bits, in text also with 0x.
  bool bits(std::uint32_t& value) {
    if (in_words()) {
      if (form_ != SceneForm::kWholeWords) return false;
      value = big_endian_word(text_.at());
      text_.skip_bytes(4);
      return true;
    }
    const SceneScanner before = text_;
    std::string_view word = text_.word();
    const bool hex = word.starts_with("0x") || word.starts_with("0X");
    if (hex) word.remove_prefix(2);
    const auto [to, code] = std::from_chars(word.data(), word.data() + word.size(), value, hex ? 16 : 10);
    if (!word.empty() && code == std::errc{} && to == word.data() + word.size()) return true;
    text_ = before;
    return false;
  }

  /// What stands here, for a message.
  [[nodiscard]] std::string found() const {
    if (!in_words()) return TextCursor(text_.rest()).found();
    const std::uint32_t word = big_endian_word(text_.at());
    return form_ == SceneForm::kRealWords ? std::to_string(std::bit_cast<float>(word)) : std::to_string(word);
  }

 private:
  [[nodiscard]] bool in_words() const {
    return form_ == SceneForm::kWholeWords || form_ == SceneForm::kRealWords;
  }

  SceneScanner text_;
  SceneForm form_;
};

}  // namespace

const char* SceneNumbers::place_of(std::string_view text, SceneForm form, std::size_t i) {
  NumberScanner scan(text, form);
  for (std::size_t k = 0; k < i; ++k) scan.skip_number();
  scan.skip();
  return scan.at();
}

Result<void> SceneNumbers::tick(const char* at) {
  farthest_ = std::max(farthest_, at);
  return source_.tick(farthest_);
}

/// Calls read(scanner) until the field ends; false from it is an error.
template <class Read>
Result<void> SceneNumbers::each(const SceneField& field, const char* what, Read&& read) {
  NumberScanner scan(field.text, field.form);
  for (std::size_t i = 0;; ++i) {
    if (Source::due(i)) VKMESH_CHECK(tick(scan.at()));
    scan.skip();
    if (scan.at_end()) return {};
    if (!read(scan))
      return source_.bad_line(scan.at(), std::string("expected ") + what + ", found " + scan.found());
  }
}

template <class T>
Result<const SceneArray<T>*> SceneNumbers::rows(const SceneField* field, unsigned width,
                                                std::map<const char*, SceneArray<T>>& known) {
  if (field == nullptr) return nullptr;
  const auto [found, is_new] = known.try_emplace(field->text.data());
  SceneArray<T>& array = found->second;
  if (is_new) {
    array.text = field->text;
    array.form = field->form;
    VKMESH_CHECK(each(*field, "a number", [&](NumberScanner& scan) {
      const NumberScanner before = scan;
      T value = 0;
      // What a float cannot hold is no number here, whatever the array keeps.
      if (!scan.number(value) || !std::isfinite(static_cast<float>(value))) {
        scan = before;
        return false;
      }
      array.values.push_back(value);
      return true;
    }));
  }
  if (array.values.size() % width != 0)
    return source_.bad_line(field->name.data(), "the field " + shown(field->name) + " holds " +
                                                    std::to_string(array.values.size()) +
                                                    " numbers, which are not rows of " +
                                                    std::to_string(width));
  return &array;
}

Result<const SceneFloats*> SceneNumbers::floats(const SceneField* field, unsigned width) {
  return rows(field, width, floats_);
}

Result<const SceneDoubles*> SceneNumbers::doubles(const SceneField* field, unsigned width) {
  return rows(field, width, doubles_);
}

Result<const SceneIndices*> SceneNumbers::indices(const SceneField* field) {
  if (field == nullptr) return nullptr;
  const auto [found, is_new] = indices_.try_emplace(field->text.data());
  SceneIndices& array = found->second;
  if (is_new) {
    array.text = field->text;
    array.form = field->form;
    VKMESH_CHECK(each(*field, "a whole number", [&](NumberScanner& scan) {
      std::int32_t value = 0;
      if (!scan.number(value)) return false;
      array.values.push_back(value);
      return true;
    }));
  }
  if (array.values.empty() || (array.values.size() == 1 && array.values[0] == -1)) return nullptr;
  return &array;
}

Result<const SceneFloats*> SceneNumbers::packed_colors(const SceneField* field, bool reversed) {
  if (field == nullptr) return nullptr;
  const auto [found, is_new] = colors_.try_emplace(field->text.data());
  SceneFloats& array = found->second;
  if (is_new) {
    array.text = field->text;
    array.form = field->form;
    VKMESH_CHECK(each(*field, "a colour as one number", [&](NumberScanner& scan) {
      std::uint32_t value = 0;
      if (!scan.bits(value)) return false;
      for (int byte = 0; byte < 4; ++byte) {
        const int shift = 8 * (reversed ? byte : 3 - byte);
        array.values.push_back(static_cast<float>((value >> shift) & 0xff) / 255.0f);
      }
      return true;
    }));
  }
  return &array;
}

Result<void> SceneNumbers::values(const SceneField* field, std::span<double> to) {
  if (field == nullptr) return {};
  VKMESH_TRY(const SceneDoubles* array, doubles(field, 1));
  if (array->values.size() != to.size())
    return source_.bad_line(field->name.data(), "the field " + shown(field->name) + " holds " +
                                                    std::to_string(array->values.size()) +
                                                    " numbers instead of " + std::to_string(to.size()));
  std::copy(array->values.begin(), array->values.end(), to.begin());
  return {};
}

Result<void> SceneNumbers::whole_number(const SceneField* field, std::int64_t& to) {
  if (field == nullptr) return {};
  NumberScanner scan(field->text, field->form);
  std::int64_t value = 0;
  if (scan.at_end() || !scan.number(value))
    return source_.bad_line(field->name.data(), "the field " + shown(field->name) + " is no whole number");
  to = value;
  return {};
}

}  // namespace vkmesh::detail
