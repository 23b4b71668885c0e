// vkmesh SUBCOMMAND IN [OUT] [options]
#include <cstring>
#include <exception>
#include <new>

#include "commands.h"

namespace vkmesh::cli {
namespace {

int fail_with(const Error& error, bool json) {
  print_error(error, json);
  return static_cast<int>(error.code);
}

/// Whether the caller asked for JSON, for errors of the command line itself.
bool wants_json(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--json") == 0) return true;
  return false;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Reads, judges, shades, smooths, optimises and simplifies polygonal meshes, on the CPU or a Vulkan "
      "device.",
      "vkmesh");
  app.set_version_flag("--version", "vkmesh " VKMESH_VERSION);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error&) { return std::string(); });
  app.footer(
      "Exit codes: 0 done, 1 internal error, 2 usage, 3 input unreadable or malformed, 4 mesh unsuitable for "
      "the "
      "operation,\n5 no such device, 6 out of memory, 7 output not writable, 130 interrupted.\n"
      "'vkmesh SUBCOMMAND --help' shows the options of a subcommand and an example.");
  Program program;
  for (const auto add : {add_info, add_convert, add_normals, add_creases, add_curvature, add_smooth,
                         add_optimize, add_simplify, add_lod, add_remesh, add_delaunay, add_voronoi,
#ifdef VKMESH_HAS_VULKAN
                         add_render,
#endif
                         add_compare, add_bench, add_digest, add_devices})
    add(app, program);

  // The parser would only say that a subcommand is required.
  const auto is_first = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first).empty())
    return fail_with(
        {ErrorCode::kUsage, std::string("there is no subcommand ") + argv[1] + " (see vkmesh --help)", {}},
        wants_json(argc, argv));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::string advice = " (see vkmesh";
    for (const CLI::App* command : app.get_subcommands()) advice += " " + command->get_name();
    return fail_with({ErrorCode::kUsage, error.what() + advice + " --help)", {}}, wants_json(argc, argv));
  }
  if (program.options.json && program.options.output == "-")
    return fail_with(
        {ErrorCode::kUsage, "--json and an output of - both want standard output: choose one", {}}, true);

  install_signal_handlers(program.options.json);
  Job job(program.command, program.options);
  Result<void> done = program.action(job);
  if (done) done = job.print();
  if (done) return 0;
  if (done.error().code == ErrorCode::kInterrupted)
    done.error() = {ErrorCode::kInterrupted, "interrupted", {}};
  job.print_error(done.error());
  return static_cast<int>(done.error().code);
}

}  // namespace
}  // namespace vkmesh::cli

int main(int argc, char** argv) {
  using namespace vkmesh;
  try {
    return cli::run(argc, argv);
  } catch (const std::bad_alloc&) {
    return cli::fail_with({ErrorCode::kOutOfMemory, "host memory ran out", {}}, cli::wants_json(argc, argv));
  } catch (const std::exception& error) {
    return cli::fail_with({ErrorCode::kInternal, std::string("unexpected exception: ") + error.what(), {}},
                          cli::wants_json(argc, argv));
  }
}
