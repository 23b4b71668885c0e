// Whole numbers as large as predicates of four points need them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace vkmesh::detail {

/// A whole number below 2^8640 in size, which sums of products of four differences of doubles are, in units
/// of the least subnormal one: sign and size, in words of 64 bits, no zeros at the top.
class WholeNumber {
 public:
  WholeNumber() = default;
  /// `value` times 2^`shift`, at most 2^2100.
  WholeNumber(std::int64_t value, int shift) : negative_(value < 0) {
    const std::uint64_t magnitude =
        value < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
    const auto zeros = static_cast<std::size_t>(shift) / 64, bits = static_cast<std::size_t>(shift) % 64;
    std::fill_n(words_.begin(), zeros, std::uint64_t{0});
    words_[zeros] = magnitude << bits;
    words_[zeros + 1] = bits == 0 ? 0 : magnitude >> (64 - bits);
    size_ = zeros + 2;
    trim();
  }
  // Only the words in use are copied.
  WholeNumber(const WholeNumber& other) { *this = other; }
  WholeNumber& operator=(const WholeNumber& other) {
    std::copy_n(other.words_.begin(), other.size_, words_.begin());
    size_ = other.size_;
    negative_ = other.negative_;
    return *this;
  }

  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : negative_ ? -1 : 1; }

  /// a / b times 2^`exponent`, off by less than 0.51 units in the last place of a normal result. b is not 0.
  [[nodiscard]] static double quotient(const WholeNumber& a, const WholeNumber& b, int exponent) {
    if (a.size_ == 0) return 0;
    const auto [a_bits, a_exponent] = a.leading();
    const auto [b_bits, b_exponent] = b.leading();
    const auto size = static_cast<double>((Wide{a_bits} << 63) / b_bits);
    return std::ldexp(a.negative_ == b.negative_ ? size : -size, a_exponent - b_exponent - 63 + exponent);
  }

  friend WholeNumber operator+(const WholeNumber& a, const WholeNumber& b) { return sum(a, b, b.negative_); }
  friend WholeNumber operator-(const WholeNumber& a, const WholeNumber& b) { return sum(a, b, !b.negative_); }
  friend WholeNumber operator*(const WholeNumber& a, const WholeNumber& b) {
    WholeNumber result;
    result.size_ = a.size_ + b.size_;
    result.negative_ = a.negative_ != b.negative_;
    std::fill_n(result.words_.begin(), result.size_, std::uint64_t{0});
    for (std::size_t i = 0; i < a.size_; ++i) {
      std::uint64_t carry = 0;
      for (std::size_t j = 0; j < b.size_; ++j) {
        const Wide step = Wide{a.words_[i]} * b.words_[j] + result.words_[i + j] + carry;
        result.words_[i + j] = static_cast<std::uint64_t>(step);
        carry = static_cast<std::uint64_t>(step >> 64);
      }
      result.words_[i + b.size_] = carry;
    }
    result.trim();
    return result;
  }

 private:
  using Wide = unsigned __int128;

  /// The 64 first bits of the size, which is not 0, and how many follow.
  [[nodiscard]] std::pair<std::uint64_t, int> leading() const {
    const std::uint64_t top = words_[size_ - 1], below = size_ > 1 ? words_[size_ - 2] : 0;
    const int zeros = std::countl_zero(top);
    return {zeros == 0 ? top : top << zeros | below >> (64 - zeros),
            64 * (static_cast<int>(size_) - 1) - zeros};
  }
  void trim() {
    while (size_ > 0 && words_[size_ - 1] == 0) --size_;
  }
  [[nodiscard]] std::uint64_t word(std::size_t i) const { return i < size_ ? words_[i] : 0; }
  /// Whether the size of a is less than that of b.
  static bool is_smaller(const WholeNumber& a, const WholeNumber& b) {
    if (a.size_ != b.size_) return a.size_ < b.size_;
    for (std::size_t i = a.size_; i-- > 0;)
      if (a.words_[i] != b.words_[i]) return a.words_[i] < b.words_[i];
    return false;
  }
  /// a plus b, whose sign is taken for `b_negative`.
  static WholeNumber sum(const WholeNumber& a, const WholeNumber& b, bool b_negative) {
    WholeNumber result;
    result.size_ = std::max(a.size_, b.size_);
    if (a.negative_ == b_negative) {
      result.negative_ = a.negative_;
      std::uint64_t carry = 0;
      for (std::size_t i = 0; i < result.size_; ++i) {
        const Wide step = Wide{a.word(i)} + b.word(i) + carry;
        result.words_[i] = static_cast<std::uint64_t>(step);
        carry = static_cast<std::uint64_t>(step >> 64);
      }
      result.words_[result.size_++] = carry;
    } else {
      const bool smaller = is_smaller(a, b);
      const WholeNumber &large = smaller ? b : a, &small = smaller ? a : b;
      result.negative_ = smaller ? b_negative : a.negative_;
      std::uint64_t borrow = 0;
      for (std::size_t i = 0; i < result.size_; ++i) {
        const Wide step = Wide{large.word(i)} - small.word(i) - borrow;
        result.words_[i] = static_cast<std::uint64_t>(step);
        borrow = static_cast<std::uint64_t>(step >> 64) & 1;
      }
    }
    result.trim();
    return result;
  }

  std::array<std::uint64_t, 136> words_;  // those from size_ on have no value
  std::size_t size_ = 0;
  bool negative_ = false;
};

}  // namespace vkmesh::detail
