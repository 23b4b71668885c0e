#include "commands/simplify/simplify_criteria.h"

#include <limits>
#include <map>
#include <numbers>

namespace vkmesh::cli {

Result<DecimateCriteria> SimplifyCriteria::criteria() const {
  DecimateCriteria result = bounds;
  if (result.max_original_normal_deviation) *result.max_original_normal_deviation *= std::numbers::pi / 180;
  const std::map<std::string, double*> by_name = {{"quadric", &result.quadric_weight},
                                                  {"density", &result.density_weight},
                                                  {"aspect-ratio", &result.aspect_weight},
                                                  {"normals", &result.normal_weight}};
  for (const std::string& text : weights) {
    VKMESH_TRY(const auto named, named_weight("--criterion", text, 1.0));
    const auto found = by_name.find(named.first);
    if (found == by_name.end())
      return fail(ErrorCode::kUsage,
                  "--criterion " + text + ": it is none of quadric, density, aspect-ratio, normals");
    *found->second = named.second;
  }
  return result;
}

void add_simplify_criteria(CLI::App& command, const std::shared_ptr<SimplifyCriteria>& given) {
  const CLI::Validator any_size = number_between(0, std::numeric_limits<double>::max());
  DecimateCriteria& bounds = given->bounds;
  command
      .add_option_function<std::vector<std::string>>(
          "--criterion", [given](const std::vector<std::string>& texts) { given->weights = texts; },
          "What makes a removal dear, with its weight; more than one may be given. quadric (1 unless it\n"
          "is named): distance from the planes; density: vertices go where they are dense; aspect-ratio:\n"
          "no long thin triangles; normals: no faces that look where none looked")
      ->type_name("NAME[=WEIGHT]");
  command
      .add_option("--max-distance", bounds.max_distance,
                  "Keep every point of either surface within this distance of the other, guaranteed, in\n"
                  "units of the file's coordinates")
      ->type_name("D")
      ->check(any_size);
  command
      .add_option("--max-relative-distance", bounds.max_relative_distance,
                  "The same as a share of the bounding box's diagonal")
      ->type_name("D")
      ->check(any_size);
  command.add_flag("--watch-distance", bounds.watch_distance,
                   "Report a bound of the distance between the surfaces without limiting it");
  command
      .add_option("--max-original-normal-deviation", bounds.max_original_normal_deviation,
                  "No face may look farther than this from where the faces looked that it stands for,\n"
                  "in degrees; default none")
      ->type_name("DEG")
      ->check(number_between(0.001, 179.999));
  command
      .add_option("--max-aspect-ratio", bounds.max_aspect_ratio,
                  "Make no triangle whose longest side over its height is more than so many times that\n"
                  "of an equilateral one, unless there was a worse one")
      ->type_name("R")
      ->check(number_between(1, std::numeric_limits<double>::max()));
  command
      .add_option("--max-edge-length", bounds.max_edge_length,
                  "Make no longer edge, in units of the file's coordinates, unless there was one")
      ->type_name("L")
      ->check(number_between(std::numeric_limits<double>::min(), std::numeric_limits<double>::max()));
  command
      .add_option("--max-valence", bounds.max_valence,
                  "Give no vertex more than so many edges, unless one had more; at least 3")
      ->type_name("N")
      ->check(count_up_to(std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace vkmesh::cli
