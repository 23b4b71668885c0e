// How far two surfaces lie from each other, by CGAL, beside what vkmesh says.
//   cgal_distance FIRST SECOND COMPARED ...    COMPARED: the JSON of `vkmesh compare FIRST SECOND --json`
// Mean and root mean square over samples of its own, by area, to 1 %; the Hausdorff distance by CGAL's
// bounded search, to its bound. Prints one line of totals; every disagreement goes to standard error and
// fails.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <nlohmann/json.hpp>

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;
using Json = nlohmann::json;

bool read(const std::string& file, Mesh& mesh) {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  if (!CGAL::IO::read_polygon_soup(file, points, polygons)) return false;
  // Coordinates as vkmesh keeps them.
  for (Point& p : points)
    p = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
  if (!pmp::is_polygon_soup_a_polygon_mesh(polygons)) return false;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  return CGAL::is_triangle_mesh(mesh);
}

struct Distances {
  double sum = 0, squares = 0;
};

Distances sampled(const Mesh& from, const Mesh& to, std::size_t samples) {
  Tree tree(faces(to).begin(), faces(to).end(), to);
  tree.accelerate_distance_queries();
  std::vector<double> areas;
  for (const auto face : from.faces()) areas.push_back(pmp::face_area(face, from));
  std::mt19937_64 random(7);
  std::discrete_distribution<std::size_t> any(areas.begin(), areas.end());
  std::uniform_real_distribution<double> share(0, 1);
  Distances result;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto h = from.halfedge(Mesh::Face_index(static_cast<unsigned>(any(random))));
    const Point &a = from.point(from.source(h)), &b = from.point(from.target(h)),
                &c = from.point(from.target(from.next(h)));
    const double root = std::sqrt(share(random)), along = share(random);
    const Point at = a + root * ((1 - along) * (b - a) + along * (c - a));
    const double squared = tree.squared_distance(at);
    result.sum += std::sqrt(squared);
    result.squares += squared;
  }
  return result;
}

}  // namespace

int main(int count, char** arguments) {
  int bad = 0, pairs = 0;
  for (int i = 1; i + 2 < count; i += 3) {
    const std::string name = std::string(arguments[i]) + ", " + arguments[i + 1];
    Mesh first, second;
    const Json compared = Json::parse(std::ifstream(arguments[i + 2]), nullptr, false);
    if (!read(arguments[i], first) || !read(arguments[i + 1], second) || !compared.is_object()) {
      std::cerr << "CGAL: " << name << ": cannot be read\n";
      ++bad;
      continue;
    }
    constexpr std::size_t kSamples = 300000;
    const Distances there = sampled(first, second, kSamples), back = sampled(second, first, kSamples);
    // Two-sided, the means of both ways count alike.
    const double mean = (there.sum + back.sum) / (2.0 * kSamples),
                 rms = std::sqrt((there.squares + back.squares) / (2.0 * kSamples));
    const Json& ours = compared["result"]["two_sided"];
    const double low = ours["hausdorff_low"], high = ours["hausdorff_high"], error = high / 100;
    const double hausdorff =
        pmp::bounded_error_symmetric_Hausdorff_distance<CGAL::Sequential_tag>(first, second, error);
    const auto check = [&](const char* what, bool agrees, double mine, double theirs) {
      if (agrees) return;
      std::cerr << "CGAL: " << name << ": " << what << " is " << theirs << ", vkmesh says " << mine << "\n";
      ++bad;
    };
    check("the mean", std::abs(ours["mean"].get<double>() - mean) <= 0.01 * mean, ours["mean"], mean);
    check("the root mean square", std::abs(ours["root_mean_square"].get<double>() - rms) <= 0.01 * rms,
          ours["root_mean_square"], rms);
    check("Hausdorff's distance", hausdorff >= low - error && hausdorff <= high + error, high, hausdorff);
    ++pairs;
  }
  std::cout << pairs << " pairs of surfaces, mean and root mean square to 1 %, Hausdorff to its bound\n";
  return bad > 0 || pairs == 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
