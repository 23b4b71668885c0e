// vkmesh render: pictures of meshes, and contact sheets of several.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include <vkmesh/analysis/surface_distance.h>
#include <vkmesh/analysis/surface_values.h>
#include <vkmesh/engine/core/context.h>
#include <vkmesh/engine/core/recorder.h>
#include <vkmesh/engine/draw/draw.h>
#include <vkmesh/engine/draw/render_target.h>
#include <vkmesh/mesh/triangulate.h>
#include <vkmesh/picture/contact_sheet.h>
#include <vkmesh/picture/png.h>
#include <vkmesh/view/camera.h>
#include <vkmesh/view/picture.h>

#include "commands.h"
#include "passes/backend.h"
#include "passes/device_probe.h"

namespace vkmesh::cli {
namespace {

constexpr Color kBoundaryColor{240, 130, 0};
constexpr Color kNonManifoldColor{220, 20, 30};
constexpr Color kCreaseColor{20, 70, 160};
/// Percent of the values that lie below and above the range of the colours. Curvature, a second derivative,
/// has more outliers than others.
int percent_left_out(const std::string& color) {
  return color == "curvature" ? 5 : 2;
}

struct RenderOptions {
  std::vector<std::string> files;  // the inputs, then the picture
  std::string size = "1024x768";
  std::vector<std::string> styles = {"auto"};
  std::vector<std::string> colors = {"none"};
  std::vector<std::string> captions;
  std::string range;
  std::string background = "white";
  double azimuth = 30, elevation = 20, field_of_view = 30;
  std::string up = "y", frame = "shared", eye, target;
  bool orthographic = false, no_legend = false, no_caption = false, error = false;
  bool show_flipped = false, show_boundary = false, show_non_manifold = false;
  double crease_angle = 40;
  double point_size = 3;
  std::size_t columns = 0;
};

/// The options, understood.
struct Plan {
  std::uint32_t width = 0, height = 0;
  Color background;
  std::optional<ValueRange> range;
  std::optional<DVec3> eye, target;
};

Result<Plan> plan_of(const RenderOptions& options) {
  Plan plan;
  VKMESH_TRY(const std::vector<double> size, parse_numbers(options.size, 'x', 2, "--size"));
  for (const double side : size)
    if (side != std::floor(side) || side < 1 || side > kMaxPictureSide)
      return fail(ErrorCode::kUsage, "--size: a picture has between 1 and " +
                                         std::to_string(kMaxPictureSide) + " pixels a side, not " +
                                         options.size);
  plan.width = static_cast<std::uint32_t>(size[0]);
  plan.height = static_cast<std::uint32_t>(size[1]);
  VKMESH_TRY(plan.background, parse_color(options.background));
  if (!options.range.empty()) {
    VKMESH_TRY(const std::vector<double> range, parse_numbers(options.range, ':', 2, "--range"));
    if (!(range[0] < range[1]))
      return fail(ErrorCode::kUsage, "--range: the first number must be below the second");
    plan.range = ValueRange{range[0], range[1]};
  }
  const auto point = [](const std::string& text, const char* option) -> Result<std::optional<DVec3>> {
    if (text.empty()) return std::optional<DVec3>();
    VKMESH_TRY(const std::vector<double> xyz, parse_numbers(text, ',', 3, option));
    return std::optional<DVec3>(DVec3(xyz[0], xyz[1], xyz[2]));
  };
  VKMESH_TRY(plan.eye, point(options.eye, "--eye"));
  VKMESH_TRY(plan.target, point(options.target, "--target"));
  if (plan.target && !plan.eye) return fail(ErrorCode::kUsage, "--target goes with --eye");
  return plan;
}

Result<std::unique_ptr<Context>> open_context(Job& job) {
  return job.timed("open", [&]() -> Result<std::unique_ptr<Context>> {
    ContextOptions options = context_options(job.options().device);
    // Pictures are the same on one device; that other devices draw the same bits is not promised.
    options.skip_exactness_check = true;
    if (options.device == "cpu")
      return fail(
          ErrorCode::kNoDevice,
          "drawing has no CPU path of its own: --device auto takes software Vulkan where there is no GPU");
    if (options.device == "auto") {
      const auto index = probe_for_auto(options, true);
      if (index)
        options.device = *index;
      else if (!index.error().message.empty())
        return tl::unexpected<Error>(index.error());
    }
    auto context = Context::create(options);
    if (!context) return context;
    report_device(job, (*context)->info());
    return context;
  });
}

/// An input and what is to be seen of it.
struct Subject {
  std::string file, style, color;
  std::size_t input = 0;              // which of the files
  std::optional<std::size_t> level;   // of detail, where a file has several
  std::size_t points = 0, faces = 0;  // of the file
  IndexedFaceSet mesh;                // triangles
  std::optional<PolygonSoup> soup;    // instead of the mesh
  std::vector<std::uint32_t> source_face;
  DrawMode mode = DrawMode::kShaded;
  DrawColors colors = DrawColors::kPlain;
  std::vector<Vec3> normals;
  std::vector<float> values, spacing;
  std::vector<Color> direct;
  DrawElement element = DrawElement::kPoint;
  std::vector<DrawMeshData::Edges> edges;  // their ends are set when all is in its place
  std::vector<std::vector<std::uint32_t>> edge_ends;
  Legend legend;
  std::optional<double> error;  // share of the first one's diagonal
  Json json;

  [[nodiscard]] std::span<const Vec3> positions() const { return soup ? soup->corners : mesh.points; }
};

std::vector<float> as_floats(const Channel& channel) {
  return std::visit(
      [](const auto& values) {
        std::vector<float> result;
        result.reserve(values.size());
        for (const auto v : values) result.push_back(static_cast<float>(v));
        return result;
      },
      channel.values);
}

std::vector<Color> as_colors(const Channel& channel) {
  const bool fraction = std::holds_alternative<std::vector<float>>(channel.values) ||
                        std::holds_alternative<std::vector<double>>(channel.values);
  const std::vector<float> scalars = as_floats(channel);
  const auto byte = [&](float v) {
    const float scaled = fraction ? v * 255.0f : v;
    return static_cast<std::uint8_t>(std::lround(scaled > 0.0f ? std::min(scaled, 255.0f) : 0.0f));
  };
  std::vector<Color> colors;
  for (std::size_t i = 0; i + 2 < scalars.size(); i += channel.components)
    colors.push_back({byte(scalars[i]), byte(scalars[i + 1]), byte(scalars[i + 2]), 255});
  return colors;
}

std::vector<Vec3> as_normals(const Channel& channel) {
  const std::vector<float> scalars = as_floats(channel);
  std::vector<Vec3> normals;
  for (std::size_t i = 0; i + 2 < scalars.size(); i += 3)
    normals.emplace_back(scalars[i], scalars[i + 1], scalars[i + 2]);
  return normals;
}

/// Colours by a channel of the file.
Result<void> use_channel(Subject& subject, const std::string& name) {
  const auto& m = subject.mesh;
  const std::pair<const std::vector<Channel>*, DrawElement> places[] = {
      {&m.point_channels, DrawElement::kPoint},
      {&m.corner_channels, DrawElement::kCorner},
      {subject.soup ? &subject.soup->face_channels : &m.face_channels, DrawElement::kFace}};
  std::string known;
  for (const auto& [channels, element] : places) {
    for (const Channel& channel : *channels) known += (known.empty() ? "" : ", ") + channel.name;
    const Channel* channel = find_channel(*channels, name);
    if (channel == nullptr) continue;
    subject.element = element;
    if (channel->components == 1) {
      subject.colors = DrawColors::kValue;
      subject.values = as_floats(*channel);
      subject.legend.title = name;
    } else if (channel->components == 3 || channel->components == 4) {
      subject.colors = DrawColors::kDirect;
      subject.direct = as_colors(*channel);
    } else {
      return fail(ErrorCode::kUnsuitable,
                  "the attribute " + name + " has " + std::to_string(channel->components) +
                      " components: 1 can be mapped to colours, 3 or 4 be shown as such",
                  {subject.file, {}, {}});
    }
    return {};
  }
  return fail(ErrorCode::kUnsuitable,
              "--color " + name + " names neither a quantity nor an attribute of the mesh" +
                  (known.empty() ? ", which has none" : "; it has " + known),
              {subject.file, {}, {}});
}

/// Edges to be drawn over the surface, with their line in the legend.
void show_edges(Subject& subject, std::span<const SurfaceEdge> edges, const std::vector<bool>& chosen,
                Color color, float width, const std::string& singular, const char* name) {
  std::vector<std::uint32_t> ends;
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (chosen[e]) ends.insert(ends.end(), {edges[e].a, edges[e].b});
  subject.json[name] = ends.size() / 2;
  subject.legend.swatches.push_back({color, count_of(ends.size() / 2, singular)});
  subject.edge_ends.push_back(std::move(ends));
  subject.edges.push_back({{}, color, width});
}

/// Numbers and edges that come from how the faces hang together. `polygons` are those of the file.
Result<void> measure(Subject& subject, const IndexedFaceSet& polygons, const RenderOptions& options) {
  const std::string& color = subject.color;
  const bool angular = color == "curvature" || color == "dihedral" || color == "crease";
  std::vector<SurfaceEdge> edges;
  if (angular || color == "valence" || options.show_boundary || options.show_non_manifold) {
    VKMESH_TRY(edges, surface_edges(polygons));
  }
  std::vector<float> angles;
  if (angular) {
    VKMESH_TRY(angles, signed_dihedral_angles(polygons, edges));
  }
  if (color == "curvature") {
    VKMESH_TRY(subject.values, mean_curvatures(polygons, edges, angles));
    subject.legend.title = "mean curvature, 1 / length";
  } else if (color == "dihedral") {
    VKMESH_TRY(subject.values, largest_angles(polygons, edges, angles));
    for (float& v : subject.values) v = static_cast<float>(static_cast<double>(v) * kDegrees);
    subject.legend.title = "dihedral angle, degrees";
  } else if (color == "valence") {
    VKMESH_TRY(subject.values, valences(polygons, edges));
    subject.legend.title = "valence, edges at a point";
  } else if (color == "component") {
    VKMESH_TRY(ConnectedComponents parts, connected_components(polygons));
    subject.values = std::move(parts.of_point);
    subject.json["components"] = parts.faces.size();
    // Beyond the table the colours begin anew.
    for (float& v : subject.values) v = std::fmod(v, 256.0f);
    subject.legend.swatches.push_back(
        {color_table(ColorMap::kCategorical)[0],
         count_of(parts.faces.size(), "component") + ", the largest in this colour"});
  } else if (color == "quality") {
    VKMESH_TRY(subject.values, triangle_qualities(subject.mesh));
    subject.element = DrawElement::kFace;
    subject.legend.title = "triangle quality, 1 is equilateral";
  }
  if (!subject.values.empty()) subject.colors = DrawColors::kValue;

  std::vector<bool> chosen(edges.size());
  if (color == "crease") {
    for (std::size_t e = 0; e < edges.size(); ++e)
      chosen[e] = std::abs(static_cast<double>(angles[e])) * kDegrees > options.crease_angle;
    show_edges(subject, edges, chosen, kCreaseColor, 2.0f, "crease edge", "crease_edges");
    subject.legend.swatches.back().text += " sharper than " + brief(options.crease_angle) + " degrees";
  }
  if (options.show_boundary && polygons.face_count() > 0) {
    for (std::size_t e = 0; e < edges.size(); ++e) chosen[e] = edges[e].faces == 1;
    show_edges(subject, edges, chosen, kBoundaryColor, 3.0f, "boundary edge", "boundary_edges");
  }
  if (options.show_non_manifold && polygons.face_count() > 0) {
    for (std::size_t e = 0; e < edges.size(); ++e) chosen[e] = edges[e].faces > 2;
    show_edges(subject, edges, chosen, kNonManifoldColor, 4.0f, "non-manifold edge", "non_manifold_edges");
  }
  return {};
}

DrawMode mode_of(const std::string& style, bool has_faces) {
  if (style == "auto") return has_faces ? DrawMode::kShaded : DrawMode::kSplats;
  if (style == "flat") return DrawMode::kFlat;
  if (style == "wireframe") return DrawMode::kWireframe;
  if (style == "shaded-wire") return DrawMode::kShadedWire;
  if (style == "points") return DrawMode::kPoints;
  if (style == "splats") return DrawMode::kSplats;
  return DrawMode::kShaded;
}

Result<Subject> prepare(Job& job, MeshFile file, Subject subject, const RenderOptions& options) {
  const bool soup = std::holds_alternative<PolygonSoup>(file.geometry);
  const std::string& color = subject.color;
  static constexpr const char* kMeasured[] = {"curvature", "dihedral",  "crease",
                                              "valence",   "component", "quality"};
  const bool measured = std::find(std::begin(kMeasured), std::end(kMeasured), color) != std::end(kMeasured);
  const bool connected = measured || options.show_boundary || options.show_non_manifold || options.error ||
                         subject.style == "points" || subject.style == "splats";
  subject.json = {{"file", subject.file}};

  if (soup && !connected && std::get<PolygonSoup>(file.geometry).face_offsets.empty()) {
    subject.soup = std::get<PolygonSoup>(std::move(file.geometry));
    subject.points = subject.soup->corners.size();
    subject.faces = subject.soup->face_count();
  } else {
    VKMESH_TRY(IndexedFaceSet mesh, to_indexed_face_set(std::move(file)));
    subject.points = mesh.points.size();
    subject.faces = mesh.face_count();
    if (mesh.is_triangles()) {
      subject.mesh = std::move(mesh);
      VKMESH_CHECK(measure(subject, subject.mesh, options));
    } else {
      VKMESH_TRY(Triangulated cut, triangulate(mesh));
      subject.mesh = std::move(cut.mesh);
      subject.source_face = std::move(cut.source_face);
      VKMESH_CHECK(measure(subject, mesh, options));
    }
  }
  subject.mode = mode_of(subject.style, subject.faces > 0 || subject.points == 0);
  const bool as_points = subject.mode == DrawMode::kPoints || subject.mode == DrawMode::kSplats;
  if (!as_points && subject.faces == 0 && subject.points > 0)
    job.note(subject.file + ": has no faces, of which --style " + subject.style +
             " would show something; points and splats show points");

  if (color == "normal") {
    subject.colors = DrawColors::kNormal;
  } else if (color != "none" && !measured) {
    VKMESH_CHECK(use_channel(subject, color.starts_with("channel:") ? color.substr(8) : color));
  }
  if (as_points && subject.element != DrawElement::kPoint)
    return fail(ErrorCode::kUnsuitable,
                "--color " + color + " is a matter of faces: --style " + subject.style + " shows points",
                {subject.file, {}, {}});

  if (!subject.soup) {
    const Channel* given = find_channel(subject.mesh.point_channels, "normal");
    if (given != nullptr && given->components == 3) {
      subject.normals = as_normals(*given);
      subject.json["normals"] = "file";
    } else if (!subject.mesh.corners.empty() && subject.mode != DrawMode::kFlat &&
               subject.mode != DrawMode::kWireframe) {
      VKMESH_TRY(subject.normals, point_normals(subject.mesh));
      subject.json["normals"] = "computed";
    }
  }
  if (subject.mode == DrawMode::kSplats) {
    VKMESH_TRY(subject.spacing, point_spacing(subject.mesh.points));
  }
  return subject;
}

/// The range of all subjects that show the same quantity, so that their colours can be compared.
void set_ranges(std::vector<Subject>& subjects, const std::optional<ValueRange>& asked, bool flipped_shown) {
  std::map<std::string, std::vector<float>> pooled;
  for (const Subject& s : subjects)
    if (s.colors == DrawColors::kValue)
      pooled[s.color].insert(pooled[s.color].end(), s.values.begin(), s.values.end());
  std::map<std::string, std::pair<ValueRange, bool>> ranges;
  for (const auto& [color, values] : pooled) {
    ValueRange range = robust_range(values, percent_left_out(color) / 100.0);
    bool robust = true;
    if (asked || color == "quality") {
      range = asked.value_or(ValueRange{0, 1});
      robust = false;
    } else if (range.low < 0 && range.high > 0) {
      range.high = std::max(range.high, -range.low);
      range.low = -range.high;
    } else if (color == "dihedral") {
      range.low = 0;
    }
    ranges[color] = {range, robust};
  }
  for (Subject& s : subjects) {
    if (flipped_shown && s.faces > 0)
      s.legend.swatches.push_back({DrawStyle{}.flipped, "faces seen from behind"});
    if (s.colors != DrawColors::kValue) continue;
    if (s.color == "component") {
      s.legend.range = {0, 255};
      s.legend.map = ColorMap::kCategorical;
      continue;
    }
    const auto& [range, robust] = ranges[s.color];
    s.legend.range = range;
    s.legend.map = range.low < 0 && range.high > 0 ? ColorMap::kDiverging : ColorMap::kSequential;
    if (robust && !s.legend.title.empty()) {
      const int out = percent_left_out(s.color);
      s.legend.title += " (percentiles " + std::to_string(out) + "-" + std::to_string(100 - out) + ")";
    }
    s.json["range"] = {range.low, range.high};
    if (s.values.empty()) s.legend.title.clear();
  }
}

/// Distances to the first subject.
Result<void> measure_errors(Job& job, std::vector<Subject>& subjects) {
  return job.timed("compute", [&]() -> Result<void> {
    const auto surface = [](const Subject& s) { return TriangleSurface{s.mesh.points, s.mesh.corners}; };
    for (std::size_t i = 1; i < subjects.size(); ++i) {
      VKMESH_TRY(const SurfaceDistance distance, surface_distance(surface(subjects[0]), surface(subjects[i]),
                                                                  {}, job.progress("measuring errors")));
      subjects[i].error = distance.two_sided().root_mean_square / distance.diagonal;
      subjects[i].json["error"] = *subjects[i].error;
    }
    return {};
  });
}

Result<Camera> camera_for(std::span<const Vec3> points, double shape, const RenderOptions& options,
                          const Plan& plan) {
  FramingOptions framing;
  framing.azimuth = options.azimuth;
  framing.elevation = options.elevation;
  framing.up = options.up == "z" ? UpAxis::kZ : UpAxis::kY;
  framing.projection = options.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  framing.field_of_view = options.field_of_view;
  VKMESH_TRY(Camera camera, vkmesh::frame_camera(points, shape, framing));
  if (plan.eye) {
    camera.eye = *plan.eye;
    if (plan.target) camera.target = *plan.target;
    camera.up = options.up == "z" ? DVec3(0, 0, 1) : DVec3(0, 1, 0);
    VKMESH_CHECK(fit_depth(camera, points));
  }
  return camera;
}

Result<Picture> draw(Job& job, Context& context, const Subject& subject, const Camera& camera,
                     RenderTarget& target, const RenderOptions& options, const Plan& plan) {
  VKMESH_TRY(const DrawMesh mesh, job.timed("upload", [&] {
    DrawMeshData data;
    data.normals = subject.normals;
    data.values = subject.values;
    data.colors = subject.direct;
    data.element = subject.element;
    data.source_face = subject.source_face;
    data.spacing = subject.spacing;
    data.edges = subject.edges;
    for (std::size_t i = 0; i < data.edges.size(); ++i) data.edges[i].ends = subject.edge_ends[i];
    return subject.soup ? DrawMesh::create(context, *subject.soup, data)
                        : DrawMesh::create(context, subject.mesh, data);
  }));
  DrawStyle style;
  style.mode = subject.mode;
  style.colors = subject.colors;
  style.map = subject.legend.map;
  style.range = subject.legend.range;
  style.background = plan.background;
  style.show_flipped = options.show_flipped;
  style.point_size = static_cast<float>(options.point_size);
  const Result<void> drawn = job.timed("device", [&]() -> Result<void> {
    VKMESH_TRY(Recorder recorder, Recorder::create(context));
    VKMESH_CHECK(record_draw(recorder, mesh.geometry(), camera, style, target));
    return recorder.submit_and_wait();
  });
  VKMESH_CHECK(drawn);
  return job.timed("download", [&] { return target.download(); });
}

std::vector<std::string> caption_of(const Subject& subject, const RenderOptions& options) {
  std::string first = std::filesystem::path(subject.file).filename().string();
  if (!options.captions.empty()) first = options.captions[subject.input];
  if (subject.level) first += ", level " + std::to_string(*subject.level);
  std::string second =
      subject.faces > 0 ? count_of(subject.faces, "face") : count_of(subject.points, "point");
  if (subject.error) {
    char text[48];
    // Below this it is the rounding of the measurement.
    const double percent = *subject.error < 1e-9 ? 0 : *subject.error * 100;
    std::snprintf(text, sizeof text, ", error %.2g %%", percent);
    second += text;
  }
  return {first, second};
}

Result<void> one_for_each(const std::vector<std::string>& list, std::size_t inputs, const char* option) {
  if (list.size() == 1 || list.size() == inputs) return {};
  return fail(ErrorCode::kUsage, std::string(option) + " takes one entry, or one for each of the " +
                                     std::to_string(inputs) + " meshes");
}

Result<std::vector<Subject>> read_subjects(Job& job, const RenderOptions& options,
                                           const std::vector<std::string>& inputs) {
  std::vector<Subject> subjects;
  std::map<std::string, MeshFile> files;
  job.json()["input"] = Json::array();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    // A file that is shown several times is read once.
    if (!files.contains(inputs[i])) {
      VKMESH_TRY(MeshFile read, job.timed("read", [&] {
        return read_mesh(inputs[i], ReadOptions{job.progress("reading"), DVec3(0.0), true});
      }));
      // All of them are shown.
      std::erase_if(read.notes, [](const FileNote& note) { return note.code == "dropped.levels"; });
      VKMESH_CHECK(job.note_differences(inputs[i], read.notes));
      files.emplace(inputs[i], std::move(read));
    }
    const bool again = std::find(inputs.begin() + static_cast<std::ptrdiff_t>(i) + 1, inputs.end(),
                                 inputs[i]) != inputs.end();
    MeshFile file = again ? files.at(inputs[i]) : std::move(files.at(inputs[i]));
    const std::size_t levels = file.levels;
    for (std::size_t level = 0; level < levels; ++level) {
      if (level > 0) {
        ReadOptions of_level;
        of_level.progress = job.progress("reading");
        of_level.offset = file.offset;
        of_level.level = level;
        VKMESH_TRY(file, job.timed("read", [&] { return read_mesh(inputs[i], of_level); }));
      }
      Subject subject;
      subject.file = inputs[i];
      subject.input = i;
      if (levels > 1) subject.level = level;
      subject.style = options.styles[options.styles.size() == 1 ? 0 : i];
      subject.color = options.colors[options.colors.size() == 1 ? 0 : i];
      const std::string format = name_of(file.format);
      const DVec3 offset = file.offset;
      VKMESH_TRY(subject, job.timed("compute", [&] {
        return prepare(job, std::move(file), std::move(subject), options);
      }));
      file.offset = offset;
      Json entry = {{"file", subject.file},
                    {"format", format},
                    {"points", subject.points},
                    {"faces", subject.faces},
                    {"soup", subject.soup.has_value()}};
      if (subject.level) entry["level"] = level;
      job.json()["input"].push_back(std::move(entry));
      job.row("input", subject.file + (subject.level ? ", level " + std::to_string(level) : "") + "  (" +
                           count_of(subject.points, subject.soup ? "corner" : "point") + ", " +
                           count_of(subject.faces, "face") + "; " + format + ")");
      subjects.push_back(std::move(subject));
    }
  }
  return subjects;
}

Result<void> run(Job& job, const RenderOptions& options) {
  const std::string& output = job.options().output;
  const std::vector<std::string> inputs(options.files.begin(), options.files.end() - 1);
  VKMESH_TRY(const Plan plan, plan_of(options));
  VKMESH_CHECK(one_for_each(options.styles, inputs.size(), "--style"));
  VKMESH_CHECK(one_for_each(options.colors, inputs.size(), "--color"));
  if (!options.captions.empty() && options.captions.size() != inputs.size())
    return fail(ErrorCode::kUsage, "--caption is given once for each of the " +
                                       std::to_string(inputs.size()) + " meshes, or not at all");
  if (output != "-" && std::filesystem::path(output).extension() != ".png")
    return fail(ErrorCode::kUsage,
                "pictures are written as .png, or as - to standard output, not as " + output);
  VKMESH_CHECK(check_place(output));

  VKMESH_TRY(const std::unique_ptr<Context> context, open_context(job));
  // Before time is spent on reading: the size may be more than the device takes.
  VKMESH_TRY(RenderTarget target, RenderTarget::create(*context, plan.width, plan.height));
  VKMESH_TRY(std::vector<Subject> subjects, read_subjects(job, options, inputs));
  if (options.error) VKMESH_CHECK(measure_errors(job, subjects));
  set_ranges(subjects, plan.range, options.show_flipped);

  // Legends get a strip of their own. The pictures above are as high for all, so that one camera serves them.
  const std::uint32_t text_size = text_size_for(plan.width);
  std::uint32_t strip = 0;
  if (!options.no_legend)
    for (const Subject& s : subjects) strip = std::max(strip, legend_height(s.legend, text_size));
  if (strip > plan.height / 2) {
    job.note("the picture is too small for its legend, which was left out");
    strip = 0;
  }
  const std::uint32_t height = plan.height - strip;
  if (strip > 0) {
    VKMESH_TRY(target, RenderTarget::create(*context, plan.width, height));
  }
  const double shape = static_cast<double>(plan.width) / static_cast<double>(height);
  Camera camera;
  if (options.frame == "shared") {
    std::vector<Vec3> all;
    for (const Subject& s : subjects) all.insert(all.end(), s.positions().begin(), s.positions().end());
    VKMESH_TRY(camera, camera_for(all, shape, options, plan));
  }

  std::vector<SheetCell> cells;
  job.json()["result"] = {{"width", nullptr}, {"height", nullptr}, {"pictures", Json::array()}};
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    const Subject& subject = subjects[i];
    if (options.frame == "each") {
      VKMESH_TRY(camera, camera_for(subject.positions(), shape, options, plan));
    }
    VKMESH_TRY(Picture drawn, draw(job, *context, subject, camera, target, options, plan));
    const std::uint32_t below = strip > 0 ? legend_height(subject.legend, text_size) : 0;
    VKMESH_TRY(Picture whole, Picture::create(plan.width, height + below, plan.background));
    paste(whole, drawn, 0, 0);
    if (below > 0) {
      VKMESH_TRY(const Picture legend, legend_strip(subject.legend, plan.width, plan.background, text_size));
      paste(whole, legend, 0, height);
    }
    cells.push_back({std::move(whole), {}});
    const bool captioned = !options.no_caption && (subjects.size() > 1 || !options.captions.empty());
    if (captioned) cells.back().caption = caption_of(subject, options);
    Json entry = subject.json;
    entry["eye"] = {camera.eye.x, camera.eye.y, camera.eye.z};
    job.json()["result"]["pictures"].push_back(std::move(entry));
  }

  VKMESH_TRY(const Picture sheet, contact_sheet(cells, options.columns, plan.background));
  VKMESH_CHECK(job.timed("write", [&] { return write_png(output, sheet); }));
  job.json()["result"]["width"] = sheet.width();
  job.json()["result"]["height"] = sheet.height();
  job.json()["output"] = {{"file", output}, {"format", "png"}};
  job.row("output", output + "  (" + std::to_string(sheet.width()) + " by " + std::to_string(sheet.height()) +
                        " pixels)");
  return {};
}

}  // namespace

void add_render(CLI::App& app, Program& program) {
  CLI::App* command =
      app.add_subcommand("render", "Draws a picture of a mesh, or a contact sheet of several");
  command->footer(
      "Drawn by Vulkan without a window. Several meshes make a contact sheet with a caption under each, seen "
      "by "
      "the same camera; of a glTF file with levels of detail each is shown.\nQuantities: curvature (signed "
      "mean curvature), dihedral (largest angle between "
      "faces "
      "around a point), crease (sharp edges),\ncomponent, quality (of triangles), valence; channel:NAME "
      "shows "
      "an attribute that bears one of these names.\nSTL files are drawn as the soups they are, unless points "
      "need to be shared for what is shown.\n\n"
      "Examples:\n  vkmesh render data/dragon/dragon_vrip.ply.gz dragon.png\n"
      "  vkmesh render mesh.obj angles.png --color dihedral --style shaded-wire --show-boundary\n"
      "  vkmesh render original.ply half.ply tenth.ply sheet.png --size 640x480 --error");
  add_common_options(*command, program.options, false, false);
  command->get_option("--device")
      ->description(
          "Where to draw: auto (a GPU, else Vulkan in software, since drawing has no CPU path), or the index "
          "or a "
          "part of the name of a Vulkan device as 'vkmesh devices' lists them");
  const auto options = std::make_shared<RenderOptions>();
  RenderOptions& o = *options;
  command
      ->add_option("FILES", o.files,
                   "Meshes to draw: PLY, OBJ, OFF or STL, also gzipped; then the picture, .png, or - for "
                   "standard output")
      ->required()
      ->expected(2, -1);
  command->add_option("--size", o.size, "Width and height of each picture, in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  const CLI::IsMember styles({"auto", "shaded", "flat", "wireframe", "shaded-wire", "points", "splats"});
  command
      ->add_option(
          "--style", o.styles,
          "auto (shaded; splats where there are no faces), shaded, flat, wireframe, shaded-wire, points, "
          "splats; one for all, or a list with one for each mesh")
      ->type_name("STYLE[,STYLE...]")
      ->delimiter(',')
      ->check(styles)
      ->default_str("auto");
  command
      ->add_option(
          "--color", o.colors,
          "none, normal, curvature, dihedral, crease, component, quality, valence, or the name of an "
          "attribute; one for all, or a list with one for each mesh")
      ->type_name("WHAT[,WHAT...]")
      ->delimiter(',')
      ->default_str("none");
  command
      ->add_option("--range", o.range,
                   "Values at the ends of the colours, instead of percentiles of the values")
      ->type_name("LOW:HIGH");
  command->add_option("--azimuth", o.azimuth, "Degrees around the mesh, from its front to its right")
      ->check(number_between(-1e6, 1e6))
      ->capture_default_str();
  command->add_option("--elevation", o.elevation, "Degrees above the horizon, from -90 to 90")
      ->check(number_between(-90, 90))
      ->capture_default_str();
  command->add_option("--up", o.up, "Axis that points up")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  command->add_flag("--orthographic", o.orthographic, "Parallel projection instead of perspective");
  command
      ->add_option("--field-of-view", o.field_of_view,
                   "Degrees from the lower to the upper edge, from 1 to 160")
      ->check(number_between(1, 160))
      ->capture_default_str();
  command->add_option("--eye", o.eye, "Where the camera stands, instead of a framing of the whole mesh")
      ->type_name("X,Y,Z");
  command->add_option("--target", o.target, "What it looks at (default: the middle of the mesh)")
      ->type_name("X,Y,Z");
  command->add_option("--frame", o.frame, "One camera for all meshes, or each framed by itself")
      ->type_name("shared|each")
      ->check(CLI::IsMember({"shared", "each"}))
      ->capture_default_str();
  command->add_option("--background", o.background, "#rrggbb, #rgb, white or black")->capture_default_str();
  command->add_flag("--show-flipped", o.show_flipped, "Paint faces that are seen from behind");
  command->add_flag("--show-boundary", o.show_boundary, "Draw edges of one face");
  command->add_flag("--show-non-manifold", o.show_non_manifold, "Draw edges of three or more faces");
  command->add_option("--crease-angle", o.crease_angle, "Degrees above which --color crease draws an edge")
      ->check(number_between(0, 180))
      ->capture_default_str();
  command->add_option("--point-size", o.point_size, "Diameter of --style points, in pixels, from 1 to 64")
      ->check(number_between(1, 64))
      ->capture_default_str();
  command->add_option("--columns", o.columns, "Pictures in a row of a contact sheet (0: what suits)")
      ->check(count_up_to(1000))
      ->capture_default_str();
  command->add_option("--caption", o.captions, "Caption instead of the file's name; once for each mesh")
      ->allow_extra_args(false)
      ->take_all();
  command->add_flag(
      "--error", o.error,
      "Measure each mesh's distance to the first, and write it into its caption: root mean square, "
      "percent of the first one's diagonal");
  command->add_flag("--no-caption", o.no_caption, "No captions on a contact sheet");
  command->add_flag("--no-legend", o.no_legend, "No legend");
  command->callback([&program, options] {
    program.command = "render";
    program.options.output = options->files.back();
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
