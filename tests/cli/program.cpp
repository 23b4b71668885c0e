#include "program.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace vkmesh::test {
namespace {

constexpr auto kDeadline = std::chrono::minutes(2);

/// In the child: nothing here may return.
[[noreturn]] void become(const std::vector<std::string>& arguments, const RunOptions& options,
                         const std::string& in, const std::string& out, const std::string& err) {
  const auto redirect = [](int to, const std::string& path, int flags) {
    const int from = open(path.c_str(), flags, 0600);
    if (from < 0 || dup2(from, to) < 0) _exit(126);
  };
  redirect(STDIN_FILENO, in, O_RDONLY);
  redirect(STDOUT_FILENO, out, O_WRONLY | O_CREAT | O_TRUNC);
  redirect(STDERR_FILENO, err, O_WRONLY | O_CREAT | O_TRUNC);
  if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(126);
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  if (options.file_size_limit > 0) {
    const rlimit limit = {options.file_size_limit, options.file_size_limit};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(126);
  }
  std::vector<std::string> copies = {VKMESH_PROGRAM};
  copies.insert(copies.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

}  // namespace

Scratch::Scratch() {
  std::string name = (std::filesystem::temp_directory_path() / "vkmesh-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) FAIL("no folder for the test could be made");
  folder_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string Scratch::file(const std::string& name, const std::string& content) const {
  std::ofstream(path(name), std::ios::binary) << content;
  return path(name);
}

std::vector<std::string> Scratch::names() const {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    found.push_back(entry.path().filename());
  std::sort(found.begin(), found.end());
  return found;
}

nlohmann::json Outcome::json() const {
  nlohmann::json object = nlohmann::json::parse(out, nullptr, false);
  INFO("standard output: " << out);
  REQUIRE(object.is_object());
  return object;
}

Outcome vkmesh_run(const std::vector<std::string>& arguments, const RunOptions& options) {
  const Scratch streams;
  const std::string in = streams.file("in", options.input);
  const std::string out = options.output_to.empty() ? streams.path("out") : options.output_to;
  const std::string err = streams.path("err");
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) become(arguments, options, in, out, err);

  int status = 0;
  bool signalled = options.signal == 0, late = false;
  const auto start = std::chrono::steady_clock::now();
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (!signalled && content_of(err).find(options.signal_after) != std::string::npos) {
      kill(child, options.signal);
      signalled = true;
    }
    if (!late && std::chrono::steady_clock::now() - start > kDeadline) {
      kill(child, SIGKILL);
      late = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  Outcome outcome;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  if (options.output_to.empty()) outcome.out = content_of(out);
  outcome.err = content_of(err);
  if (late) FAIL("vkmesh did not end within two minutes; it had said: " << outcome.err);
  if (!signalled) FAIL("vkmesh ended before the signal could be sent; it had said: " << outcome.err);
  return outcome;
}

std::string content_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

}  // namespace vkmesh::test
