// Face sets as bytes, for the targets that fuzz algorithms rather than readers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::fuzz {

inline constexpr std::size_t kMaxPoints = 64;

/// The first byte tells the number of points, up to kMaxPoints; three bytes for each are its coordinates, in
/// small whole numbers so that points coincide often. Then face after face: a byte that tells the number of
/// corners, 3 for most values and 0 to 8 for some, and a byte for each corner. What is missing at the end is
/// zero.
inline IndexedFaceSet face_set_of(std::span<const std::uint8_t> bytes) {
  std::size_t at = 0;
  const auto next = [&]() -> std::uint8_t { return at < bytes.size() ? bytes[at++] : std::uint8_t{0}; };
  IndexedFaceSet mesh;
  mesh.points.resize(next() % (kMaxPoints + 1));
  for (Vec3& p : mesh.points) {
    p.x = static_cast<float>(next()) / 16;
    p.y = static_cast<float>(next()) / 16;
    p.z = static_cast<float>(next()) / 16;
  }
  mesh.face_offsets = {0};
  while (at < bytes.size() && !mesh.points.empty()) {
    const std::uint8_t kind = next();
    for (std::size_t k = kind < 9 ? kind : 3; k > 0; --k)
      mesh.corners.push_back(static_cast<std::uint32_t>(next() % mesh.points.size()));
    mesh.face_offsets.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  mesh.normalize_offsets();
  return mesh;
}

/// Bytes from which face_set_of() makes the same faces; coordinates are cut to what a byte holds. The mesh
/// has at most kMaxPoints points.
inline std::vector<std::uint8_t> bytes_of(const IndexedFaceSet& mesh) {
  std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(mesh.points.size())};
  for (const Vec3& p : mesh.points)
    for (int axis = 0; axis < 3; ++axis)
      bytes.push_back(static_cast<std::uint8_t>(std::clamp(128 + 16 * p[axis], 0.0f, 255.0f)));
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    bytes.push_back(static_cast<std::uint8_t>(mesh.face(f).size()));
    for (const std::uint32_t c : mesh.face(f)) bytes.push_back(static_cast<std::uint8_t>(c));
  }
  return bytes;
}

}  // namespace vkmesh::fuzz
