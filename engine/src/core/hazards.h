// What work since the last barrier has read and written: where the next barrier must go.
#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>

namespace vkmesh::detail {

/// Notes by resource, which a key names. All functions are O(1), however many resources were noted: a barrier
/// forgets them by beginning a new epoch, not by going through them.
template <class Key, class Equal = std::equal_to<Key>>
class Hazards {
 public:
  /// Whether a read must wait: for a write.
  [[nodiscard]] bool hinder_read(const Key& key) const {
    const auto found = last_.find(key);
    return found != last_.end() && found->second.written == epoch_;
  }
  /// Whether a write must wait: for a read or a write.
  [[nodiscard]] bool hinder_write(const Key& key) const {
    const auto found = last_.find(key);
    return found != last_.end() && (found->second.written == epoch_ || found->second.read == epoch_);
  }
  void note_read(const Key& key) { last_[key].read = epoch_; }
  void note_write(const Key& key) { last_[key].written = epoch_; }
  /// A barrier: nothing that was noted hinders any more.
  void pass_barrier() { ++epoch_; }

 private:
  /// The epochs of the last read and write; 0: none.
  struct Last {
    std::uint64_t read = 0, written = 0;
  };
  std::unordered_map<Key, Last, std::hash<Key>, Equal> last_;
  std::uint64_t epoch_ = 1;
};

}  // namespace vkmesh::detail
