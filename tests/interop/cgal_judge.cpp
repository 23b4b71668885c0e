// What CGAL says about meshes, beside what vkmesh says.
//   cgal_judge counts FILE POINTS FACES ...    reads each file as polygon soup; "-" stands for any count
//   cgal_judge info FILE INFO ...              judges each file, and compares with the JSON of `vkmesh info
//   FILE --json`
//   cgal_judge distances FIRST SECOND COMPARED ...   measures how far the surfaces lie from each other, and
//   compares with the JSON of `vkmesh compare FIRST SECOND --json`
// Prints one line of totals; every disagreement goes to standard error and fails.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <nlohmann/json.hpp>

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Json = nlohmann::json;

struct Soup {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> polygons;

  /// Coordinates as vkmesh keeps them: floats relative to an offset.
  bool read(const std::string& file, const std::array<double, 3>& offset = {}) {
    if (!CGAL::IO::read_polygon_soup(file, points, polygons)) return false;
    const auto kept = [&](double x, std::size_t axis) {
      return static_cast<double>(static_cast<float>(x - offset[axis])) + offset[axis];
    };
    for (auto& p : points) p = {kept(p.x(), 0), kept(p.y(), 1), kept(p.z(), 2)};
    return true;
  }
};

int compare_counts(int count, char** arguments) {
  int bad = 0, good = 0;
  for (int i = 2; i + 2 < count; i += 3) {
    const std::string file = arguments[i], points = arguments[i + 1], faces = arguments[i + 2];
    Soup soup;
    const bool read = soup.read(file);
    if (read && (points == "-" || std::to_string(soup.points.size()) == points) &&
        (faces == "-" || std::to_string(soup.polygons.size()) == faces)) {
      ++good;
      continue;
    }
    ++bad;
    std::cerr << "CGAL: " << file << ": ";
    if (read)
      std::cerr << soup.points.size() << " points and " << soup.polygons.size() << " faces, expected "
                << points << " and " << faces << "\n";
    else
      std::cerr << "not read\n";
  }
  return bad;
}

bool is_degenerate(std::vector<std::size_t> polygon) {
  const std::size_t corners = polygon.size();
  std::sort(polygon.begin(), polygon.end());
  polygon.erase(std::unique(polygon.begin(), polygon.end()), polygon.end());
  return corners < 3 || polygon.size() < corners;
}

/// What CGAL says, under the names of `vkmesh info`. Only what it can say.
Json judge(const Soup& soup) {
  Json said;
  said["points"] = soup.points.size();
  said["faces"] = soup.polygons.size();
  Soup sound = soup;
  auto& polygons = sound.polygons;
  polygons.erase(std::remove_if(polygons.begin(), polygons.end(), is_degenerate), polygons.end());
  said["degenerate_faces"] = soup.polygons.size() - polygons.size();
  {
    Soup copy = soup;
    said["duplicate_points"] = pmp::merge_duplicate_points_in_polygon_soup(copy.points, copy.polygons);
  }
  {
    Soup copy = soup;
    said["isolated_points"] = pmp::remove_isolated_points_in_polygon_soup(copy.points, copy.polygons);
  }
  {
    // By indices alone: CGAL looks for a polygon's first corner by coordinates.
    Soup copy = sound;
    for (std::size_t i = 0; i < copy.points.size(); ++i) copy.points[i] = {static_cast<double>(i), 0, 0};
    said["duplicate_faces"] = pmp::merge_duplicate_polygons_in_polygon_soup(copy.points, copy.polygons);
  }
  std::array<double, 3> low{}, high{};
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const double x = soup.points[i][axis];
      auto& l = low[static_cast<std::size_t>(axis)];
      auto& h = high[static_cast<std::size_t>(axis)];
      l = i == 0 ? x : std::min(l, x);
      h = i == 0 ? x : std::max(h, x);
    }
  said["bounds"] = {{"min", low}, {"max", high}};

  const bool valid = said["degenerate_faces"] == 0 && pmp::is_polygon_soup_a_polygon_mesh(soup.polygons);
  said["polygon_mesh"] = valid;
  if (!valid) return said;
  Mesh mesh;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.polygons, mesh);
  std::size_t border = 0, isolated = 0;
  for (const auto e : mesh.edges()) border += mesh.is_border(e);
  for (const auto v : mesh.vertices()) isolated += mesh.is_isolated(v);
  std::vector<Mesh::Halfedge_index> cycles;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(cycles));
  auto component = mesh.add_property_map<Mesh::Face_index, std::size_t>("component").first;
  said["edges"] = mesh.number_of_edges();
  said["boundary_edges"] = border;
  said["boundary_loops"] = cycles.size();
  said["components"] = pmp::connected_components(mesh, component);
  said["closed"] = mesh.number_of_faces() > 0 && CGAL::is_closed(mesh);
  said["euler_characteristic"] = static_cast<long>(mesh.number_of_vertices() - isolated) -
                                 static_cast<long>(mesh.number_of_edges()) +
                                 static_cast<long>(mesh.number_of_faces());
  if (CGAL::is_triangle_mesh(mesh)) {
    said["area"] = pmp::area(mesh);
    if (said["closed"] == true) said["volume"] = pmp::volume(mesh);
  }
  return said;
}

/// What `vkmesh info` says that positions are kept relative to.
std::array<double, 3> offset_of(const Json& info) {
  std::array<double, 3> offset{};
  for (const Json& loss : info.value("losses", Json::array()))
    if (loss["code"] == "offset.positions")
      std::sscanf(loss["sentence"].get<std::string>().c_str(), "%*[^(](%lf, %lf, %lf)", &offset[0],
                  &offset[1], &offset[2]);
  return offset;
}

int compare_info(int count, char** arguments) {
  int bad = 0;
  std::size_t files = 0, meshes = 0, numbers = 0;
  for (int i = 2; i + 1 < count; i += 2) {
    const std::string file = arguments[i];
    const Json info = Json::parse(std::ifstream(arguments[i + 1]), nullptr, false);
    Soup soup;
    if (!soup.read(file, info.is_object() ? offset_of(info) : std::array<double, 3>{})) continue;
    if (!info.is_object() || !info.contains("result")) {
      std::cerr << "CGAL: " << file << ": CGAL reads it, vkmesh info does not\n";
      ++bad;
      continue;
    }
    const Json& ours = info["result"];
    const Json theirs = judge(soup);
    ++files;
    meshes += theirs["polygon_mesh"] == true;
    const auto disagree = [&](const std::string& name, const Json& mine) {
      std::cerr << "CGAL: " << file << ": " << name << " is " << theirs[name] << ", vkmesh says " << mine
                << "\n";
      ++bad;
    };
    double diagonal = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      diagonal += std::pow(
          theirs["bounds"]["max"][axis].get<double>() - theirs["bounds"]["min"][axis].get<double>(), 2);
    diagonal = std::sqrt(diagonal);
    for (const auto& [name, value] : theirs.items()) {
      ++numbers;
      if (name == "polygon_mesh") {
        const bool mine = ours.value("manifold", false) && ours.value("oriented", false) &&
                          ours.value("degenerate_faces", Json()) == 0;
        if (mine != value) disagree(name, mine);
      } else if (!ours.contains(name)) {
        disagree(name, "nothing");
      } else if (name == "area" || name == "volume") {
        // Sums over the faces in double precision, each in its own order.
        const double scale = name == "area" ? value.get<double>() : ours.value("area", 0.0) * diagonal;
        if (!ours[name].is_number() ||
            !(std::abs(ours[name].get<double>() - value.get<double>()) <= 1e-9 * scale))
          disagree(name, ours[name]);
      } else if (name == "bounds") {
        for (const char* side : {"min", "max"})
          for (std::size_t axis = 0; axis < 3; ++axis)
            if (!ours[name].is_object() ||
                ours[name][side][axis].get<float>() != value[side][axis].get<float>()) {
              disagree(name, ours[name]);
              axis = 3;
            }
      } else if (ours[name] != value) {
        disagree(name, ours[name]);
      }
    }
  }
  std::cout << files << " files read, " << meshes << " of them polygon meshes, " << numbers
            << " numbers compared\n";
  if (files == 0) {
    std::cerr << "CGAL: no file was compared\n";
    ++bad;
  }
  return bad;
}

using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

bool read_mesh(const std::string& file, Mesh& mesh) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> polygons;
  if (!CGAL::IO::read_polygon_soup(file, points, polygons)) return false;
  // Coordinates as vkmesh keeps them.
  for (Kernel::Point_3& p : points)
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
    const Kernel::Point_3 &a = from.point(from.source(h)), &b = from.point(from.target(h)),
                          &c = from.point(from.target(from.next(h)));
    const double root = std::sqrt(share(random)), along = share(random);
    const Kernel::Point_3 at = a + root * ((1 - along) * (b - a) + along * (c - a));
    const double squared = tree.squared_distance(at);
    result.sum += std::sqrt(squared);
    result.squares += squared;
  }
  return result;
}

/// Returns how many disagree. Mean and root mean square over samples of its own, by area, to 1 %; the
/// Hausdorff distance by CGAL's bounded search, to its bound.
int compare_distances(int count, char** arguments) {
  int bad = 0, pairs = 0;
  for (int i = 2; i + 2 < count; i += 3) {
    const std::string name = std::string(arguments[i]) + ", " + arguments[i + 1];
    Mesh first, second;
    const Json compared = Json::parse(std::ifstream(arguments[i + 2]), nullptr, false);
    if (!read_mesh(arguments[i], first) || !read_mesh(arguments[i + 1], second) || !compared.is_object()) {
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
  return pairs == 0 ? 1 : bad;
}

}  // namespace

int main(int count, char** arguments) {
  const std::string mode = count > 1 ? arguments[1] : "";
  if (mode != "counts" && mode != "info" && mode != "distances") return 2;
  const int bad = mode == "info"        ? compare_info(count, arguments)
                  : mode == "distances" ? compare_distances(count, arguments)
                                        : compare_counts(count, arguments);
  return bad > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
