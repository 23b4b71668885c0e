#include "commands/simplify/simplify_criteria.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>

namespace vkmesh::cli {

Result<DecimateWeights> SimplifyCriteria::weights() const {
  DecimateWeights result;
  const std::map<std::string, double*> by_name = {{"quadric", &result.quadric},
                                                  {"density", &result.density},
                                                  {"aspect-ratio", &result.aspect_ratio},
                                                  {"normals", &result.normals}};
  for (const std::string& text : weights_) {
    VKMESH_TRY(const auto named, named_weight("--criterion", text, 1.0));
    const auto found = by_name.find(named.first);
    if (found == by_name.end())
      return fail(ErrorCode::kUsage,
                  "--criterion " + text + ": it is none of quadric, density, aspect-ratio, normals");
    *found->second = named.second;
  }
  if (std::max({result.quadric, result.density, result.aspect_ratio, result.normals}) == 0)
    return fail(ErrorCode::kUsage,
                "--criterion: one of quadric, density, aspect-ratio and normals needs a "
                "weight above 0");
  return result;
}

DecimateBounds SimplifyCriteria::bounds() const {
  DecimateBounds result = bounds_;
  if (result.original_normal_deviation) *result.original_normal_deviation *= std::numbers::pi / 180;
  if (distance_) result.distance = Length::absolute(*distance_);
  if (relative_distance_) result.distance = Length::relative(*relative_distance_);
  if (edge_length_) result.edge_length = Length::absolute(*edge_length_);
  return result;
}

void add_simplify_criteria(CLI::App& command, const std::shared_ptr<SimplifyCriteria>& given) {
  const CLI::Validator any_size = number_between(0, std::numeric_limits<double>::max());
  DecimateBounds& bounds = given->bounds_;
  command
      .add_option_function<std::vector<std::string>>(
          "--criterion", [given](const std::vector<std::string>& texts) { given->weights_ = texts; },
          "What makes a removal dear, with its weight; more than one may be given. quadric (1 unless it\n"
          "is named): distance from the planes; density: vertices go where they are dense; aspect-ratio:\n"
          "no long thin triangles; normals: no faces that look where none looked")
      ->type_name("NAME[=WEIGHT]");
  CLI::Option* const distance =
      command
          .add_option("--max-distance", given->distance_,
                      "Keep every point of either surface within this distance of the other, guaranteed, in\n"
                      "units of the file's coordinates")
          ->type_name("D")
          ->check(any_size);
  command
      .add_option("--max-relative-distance", given->relative_distance_,
                  "The same as a share of the bounding box's diagonal")
      ->type_name("D")
      ->check(any_size)
      ->excludes(distance);
  command.add_flag("--watch-distance", bounds.report_distance,
                   "Report a bound of the distance between the surfaces without limiting it");
  command
      .add_option("--max-original-normal-deviation", bounds.original_normal_deviation,
                  "No face may look farther than this from where the faces looked that it stands for,\n"
                  "in degrees; default none")
      ->type_name("DEG")
      ->check(number_between(0.001, 179.999));
  command
      .add_option("--max-aspect-ratio", bounds.aspect_ratio,
                  "Make no triangle whose longest side over its height is more than so many times that\n"
                  "of an equilateral one, unless there was a worse one")
      ->type_name("R")
      ->check(number_between(1, std::numeric_limits<double>::max()));
  command
      .add_option("--max-edge-length", given->edge_length_,
                  "Make no longer edge, in units of the file's coordinates, unless there was one")
      ->type_name("L")
      ->check(number_between(std::numeric_limits<double>::min(), std::numeric_limits<double>::max()));
  command
      .add_option("--max-valence", bounds.valence,
                  "Give no vertex more than so many edges, unless one had more; at least 3")
      ->type_name("N")
      ->check(count_up_to(std::numeric_limits<std::uint32_t>::max()))
      ->check(number_between(3, std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace vkmesh::cli
