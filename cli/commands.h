// The subcommands: one function and one source file each.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include <vkmesh/base/result.h>

#include "job/common.h"

namespace vkmesh::cli {

/// What the parsed command line asks for.
struct Program {
  std::string command;
  CommonOptions options;
  std::function<Result<void>(Job&)> action;
};

/// Each adds its subcommand to `app`; parsing it sets `program`.
void add_info(CLI::App& app, Program& program);
void add_convert(CLI::App& app, Program& program);
void add_normals(CLI::App& app, Program& program);
void add_creases(CLI::App& app, Program& program);
void add_curvature(CLI::App& app, Program& program);
void add_smooth(CLI::App& app, Program& program);
void add_optimize(CLI::App& app, Program& program);
void add_simplify(CLI::App& app, Program& program);
void add_lod(CLI::App& app, Program& program);
void add_remesh(CLI::App& app, Program& program);
void add_delaunay(CLI::App& app, Program& program);
void add_voronoi(CLI::App& app, Program& program);
void add_render(CLI::App& app, Program& program);
void add_compare(CLI::App& app, Program& program);
void add_bench(CLI::App& app, Program& program);
void add_digest(CLI::App& app, Program& program);
void add_devices(CLI::App& app, Program& program);

}  // namespace vkmesh::cli
