// Attributes whose values lie side by side, as all stages of decimation take them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <vkmesh/decimation/decimate.h>

namespace vkmesh::detail {

/// Options in which no attribute has a stride: the given ones, or a copy with copies of the values that have.
/// Borrows the given ones.
class PackedAttributes {
 public:
  explicit PackedAttributes(const DecimateOptions& options) : given_(options) {
    for (std::size_t i = 0; i < options.attributes.size(); ++i) {
      const DecimateAttribute& a = options.attributes[i];
      if (a.stride == 0) continue;
      if (!packed_) packed_ = options;
      std::vector<float>& values = values_.emplace_back();
      values.reserve(a.value_count() * a.components);
      for (std::size_t v = 0; v < a.value_count(); ++v) {
        const auto value = a.value(v);
        values.insert(values.end(), value.begin(), value.end());
      }
      packed_->attributes[i].values = values;
      packed_->attributes[i].stride = 0;
    }
  }
  PackedAttributes(const PackedAttributes&) = delete;
  PackedAttributes& operator=(const PackedAttributes&) = delete;

  [[nodiscard]] const DecimateOptions& options() const { return packed_ ? *packed_ : given_; }

 private:
  const DecimateOptions& given_;
  std::optional<DecimateOptions> packed_;
  std::vector<std::vector<float>> values_;
};

}  // namespace vkmesh::detail
