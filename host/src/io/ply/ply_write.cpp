// Writing PLY.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "io/ply/ply.h"

namespace vkmesh::detail {

namespace {

using namespace ply;

struct OutColumn {
  std::string property;
  const Channel* channel = nullptr;
  unsigned component = 0;
  Scalar type = Scalar::kFloat;
  bool as_byte = false;  ///< Colours are written as bytes, which is what readers of PLY expect.
};

/// The alternatives of ChannelValues, in their order.
Scalar scalar_type(const Channel& channel) {
  constexpr std::array kTypes = {Scalar::kFloat, Scalar::kDouble, Scalar::kInt8,  Scalar::kUint8,
                                 Scalar::kInt16, Scalar::kUint16, Scalar::kInt32, Scalar::kUint32};
  static_assert(kTypes.size() == std::variant_size_v<ChannelValues>);
  return kTypes[channel.values.index()];
}

/// The properties in which the channels are written; what has no place among them is noted.
std::vector<OutColumn> columns_of(const std::vector<Channel>& channels, std::set<std::string> used,
                                  const char* element, Notes& notes) {
  std::vector<OutColumn> columns;
  for (const Channel& channel : channels) {
    const Scalar type = scalar_type(channel);
    std::vector<std::string> names;
    const bool color = channel.name == "color" && (channel.components == 3 || channel.components == 4);
    if (channel.name == "normal" && channel.components == 3)
      names = {"nx", "ny", "nz"};
    else if (channel.name == "uv" && channel.components == 2)
      names = {"s", "t"};
    else if (color)
      names = {"red", "green", "blue", "alpha"};
    else if (channel.components == 1)
      names = {channel.name};
    else
      for (unsigned k = 0; k < channel.components; ++k)
        names.push_back(channel.name + "_" + std::to_string(k));
    names.resize(channel.components);

    const bool word = !channel.name.empty() &&
                      std::none_of(channel.name.begin(), channel.name.end(),
                                   [](char c) { return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f; });
    const bool free =
        std::none_of(names.begin(), names.end(), [&](const std::string& n) { return used.contains(n); });
    if (!word || !free || channel.components == 0) {
      note_left_out(notes, element, channel,
                    word ? "its property names are taken" : "its name is not one word");
      continue;
    }
    used.insert(names.begin(), names.end());
    if (color && !is_integer(type))
      notes.push_back({"rounded.color", std::string(element) + " channel 'color' rounded to 8 bits"});
    if (!channel.labels.empty()) note_labels_left_out(notes, element, channel);
    for (unsigned k = 0; k < channel.components; ++k)
      columns.push_back({names[k], &channel, k, color ? Scalar::kUint8 : type, color});
  }
  return columns;
}

template <FileEncoding kEncoding, class T>
char* put_scalar(char* to, T value) {
  if constexpr (kEncoding == FileEncoding::kAscii) {
    to = put_number(to, value);
    *to++ = ' ';
    return to;
  } else {
    if constexpr (kEncoding == FileEncoding::kBinaryBigEndian && sizeof(T) > 1) value = swap_bytes(value);
    std::memcpy(to, &value, sizeof(T));
    return to + sizeof(T);
  }
}

/// Ends a line of text: its last blank becomes the line end.
template <FileEncoding kEncoding>
void end_line(Output& out, char* to) {
  if constexpr (kEncoding == FileEncoding::kAscii) to[-1] = '\n';
  out.commit(to);
}

template <FileEncoding kEncoding>
void put_columns(Output& out, char*& to, const std::vector<OutColumn>& columns, std::size_t i) {
  for (const OutColumn& column : columns) {
    out.commit(to);
    to = out.room(64);
    const std::size_t at = i * column.channel->components + column.component;
    if (column.as_byte)
      to = put_scalar<kEncoding>(to, color_byte(*column.channel, at));
    else
      to = std::visit([&](const auto& values) { return put_scalar<kEncoding>(to, values[at]); },
                      column.channel->values);
  }
}

template <FileEncoding kEncoding>
void put_body(const IndexedFaceSet& mesh, const std::vector<OutColumn>& point_columns,
              const std::vector<OutColumn>& face_columns, const Channel* wedges, bool wide_counts,
              const DVec3& offset, Output& out) {
  const bool moved = offset != DVec3(0.0);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    char* to = out.room(256);
    for (int axis = 0; axis < 3; ++axis) {
      const float coordinate = mesh.points[i][axis];
      if (!moved) {
        to = put_scalar<kEncoding>(to, coordinate);
      } else if (kEncoding == FileEncoding::kAscii) {
        to = put_coordinate(to, coordinate, offset[axis]);
        *to++ = ' ';
      } else {
        to = put_scalar<kEncoding>(to, static_cast<double>(coordinate) + offset[axis]);
      }
    }
    put_columns<kEncoding>(out, to, point_columns, i);
    end_line<kEncoding>(out, to);
  }
  for (std::size_t f = 0, corner = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.face(f);
    char* to = out.room(256);
    const auto count = static_cast<std::uint32_t>(corners.size());
    to = wide_counts ? put_scalar<kEncoding>(to, count)
                     : put_scalar<kEncoding>(to, static_cast<std::uint8_t>(count));
    for (const std::uint32_t c : corners) {
      out.commit(to);
      to = out.room(64);
      to = put_scalar<kEncoding>(to, c);
    }
    if (wedges != nullptr) {
      to = wide_counts ? put_scalar<kEncoding>(to, 2 * count)
                       : put_scalar<kEncoding>(to, static_cast<std::uint8_t>(2 * count));
      for (std::uint32_t k = 0; k < 2 * count; ++k) {
        out.commit(to);
        to = out.room(64);
        to = put_scalar<kEncoding>(to, channel_float(*wedges, 2 * corner + k));
      }
      corner += count;
    }
    put_columns<kEncoding>(out, to, face_columns, f);
    end_line<kEncoding>(out, to);
  }
}

}  // namespace

void encode_ply(const IndexedFaceSet& mesh, const WriteOptions& options, Output& out, Notes& notes) {
  const auto point_columns = columns_of(mesh.point_channels, {"x", "y", "z"}, "point", notes);
  const auto face_columns =
      columns_of(mesh.face_channels, {"vertex_indices", "vertex_index", "texcoord"}, "face", notes);
  const Channel* wedges = find_channel(mesh.corner_channels, "uv");
  if (wedges != nullptr && (wedges->components != 2 || mesh.corners.empty())) wedges = nullptr;
  for (const Channel& c : mesh.corner_channels)
    if (&c != wedges) note_left_out(notes, "corner", c, "PLY holds uv of corners");

  std::size_t widest = 3;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) widest = std::max(widest, mesh.face(f).size());
  const bool wide_counts = (wedges != nullptr ? 2 : 1) * widest > 255;
  const std::string coordinate = options.offset == DVec3(0.0) ? "float" : "double";

  std::string header = "ply\nformat " + name_of(options.encoding) + " 1.0\n";
  for (const std::string& line : comment_lines(options.comment)) header += "comment " + line + "\n";
  const auto property = [](const OutColumn& c) {
    return "property " + std::string(name_of_scalar(c.type)) + " " + c.property + "\n";
  };
  header += "element vertex " + std::to_string(mesh.points.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += "property " + coordinate + " " + axis + "\n";
  for (const OutColumn& c : point_columns) header += property(c);
  header += "element face " + std::to_string(mesh.face_count()) + "\nproperty list ";
  header += wide_counts ? "uint " : "uchar ";
  header += mesh.points.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()) ? "uint"
                                                                                                    : "int";
  header += " vertex_indices\n";
  if (wedges != nullptr)
    header += std::string("property list ") + (wide_counts ? "uint" : "uchar") + " float texcoord\n";
  for (const OutColumn& c : face_columns) header += property(c);
  out.put(header + "end_header\n");

  switch (options.encoding) {
    case FileEncoding::kAscii:
      put_body<FileEncoding::kAscii>(mesh, point_columns, face_columns, wedges, wide_counts, options.offset,
                                     out);
      break;
    case FileEncoding::kBinaryLittleEndian:
      put_body<FileEncoding::kBinaryLittleEndian>(mesh, point_columns, face_columns, wedges, wide_counts,
                                                  options.offset, out);
      break;
    case FileEncoding::kBinaryBigEndian:
      put_body<FileEncoding::kBinaryBigEndian>(mesh, point_columns, face_columns, wedges, wide_counts,
                                               options.offset, out);
      break;
  }
}

}  // namespace vkmesh::detail
