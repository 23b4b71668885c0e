// Starts the built vkmesh program, and keeps what it prints.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace vkmesh::test {

/// A folder for one test, removed at its end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Writes a file and returns its path.
  std::string file(const std::string& name, const std::string& content) const;
  /// Names of everything in the folder, sorted.
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  std::filesystem::path folder_;
};

struct RunOptions {
  std::string input;      ///< Standard input.
  std::string output_to;  ///< A file to be standard output; not captured then.
  std::string folder;     ///< Working directory; empty: the test's.
  std::vector<std::pair<std::string, std::string>> environment;  ///< Added to the test's.
  std::size_t file_size_limit = 0;  ///< Bytes a file may have (RLIMIT_FSIZE); 0: no limit.
  /// Sends a signal once standard error holds this text.
  int signal = 0;
  std::string signal_after;
};

struct Outcome {
  int code = -1;    ///< Exit code; -1 when a signal ended the program.
  int signal = 0;   ///< The signal that ended it, or 0.
  std::string out;  ///< Standard output.
  std::string err;  ///< Standard error.

  /// Standard output as one JSON object; fails the test when it is anything else.
  [[nodiscard]] nlohmann::json json() const;
};

/// Runs vkmesh with these arguments. Fails the test when it takes more than two minutes.
Outcome vkmesh_run(const std::vector<std::string>& arguments, const RunOptions& options = {});

[[nodiscard]] std::string content_of(const std::string& path);

}  // namespace vkmesh::test
