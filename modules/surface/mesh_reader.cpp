// SPDX-License-Identifier: BSD-3-Clause
// Reads PLY (Turk, The PLY polygon file format, 1994).
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/surface/mesh_files.hpp"

namespace holdfast {

namespace {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

std::size_t bytes_of(PlyType type) {
  constexpr std::array<std::size_t, 8> bytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return bytes[static_cast<std::size_t>(type)];
}

std::optional<PlyType> ply_type(std::string_view name) {
  constexpr std::array<std::array<std::string_view, 2>, 8> names = {{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (name == names[i][0] || name == names[i][1]) return static_cast<PlyType>(i);
  return std::nullopt;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t\r", at);
    if (begin == std::string_view::npos) break;
    at = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, at - begin));
  }
  return words;
}

class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file)
      : file_(file), bytes_(file_content(file, largest_file::cloud, "a mesh in PLY format")) {}

  TriangleMesh read() {
    read_header();
    for (const PlyElement& element : elements_) {
      // Every record has a byte or more, so that a count cannot exceed the rest of the file.
      if (element.count > bytes_.size() - at_ && !element.properties.empty())
        refuse("states " + std::to_string(element.count) + " elements '" + element.name + "', more than it has");
      if (element.properties.empty()) continue;
      if (element.name == "vertex")
        read_vertices(element);
      else
        read_faces(element);
    }
    if (mesh_.empty()) refuse("has no triangle");
    for (const auto& triangle : mesh_.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner >= mesh_.vertices.size())
          refuse("has a face with the vertex " + std::to_string(corner) + ", and it has " +
                 std::to_string(mesh_.vertices.size()) + " vertices");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError({file_.string()}, reason + "; expected a mesh in PLY format with vertices and faces");
  }

  std::string_view next_line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) refuse("its header has no end");
    const std::string_view line = std::string_view(bytes_).substr(at_, end - at_);
    at_ = end + 1;
    return line;
  }

  void read_header() {
    if (!bytes_.starts_with("ply")) refuse("is no PLY file");
    next_line();
    for (;;) {
      const std::string_view line = next_line();
      const std::vector<std::string_view> words = words_of(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") return;
      if (words[0] == "format" && words.size() >= 2)
        read_format(words[1]);
      else if (words[0] == "element" && words.size() == 3)
        add_element(words[1], words[2]);
      else if (words[0] == "property" && !elements_.empty())
        add_property(words, line);
      else
        refuse("its header has the line '" + std::string(line) + "'");
    }
  }

  void read_format(std::string_view format) {
    is_ascii_ = format == "ascii";
    is_big_ = format == "binary_big_endian";
    if (!is_ascii_ && !is_big_ && format != "binary_little_endian")
      refuse("has the format '" + std::string(format) + "'");
  }

  void add_element(std::string_view name, std::string_view count) {
    PlyElement element{std::string(name), 0, {}};
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || end != count.data() + count.size() || element.count > 0xFFFFFFFF)
      refuse("states '" + std::string(count) + "' elements '" + element.name + "'");
    elements_.push_back(std::move(element));
  }

  void add_property(const std::vector<std::string_view>& words, std::string_view line) {
    PlyProperty property;
    const bool is_list = words.size() == 5 && words[1] == "list";
    const std::optional<PlyType> type = words.size() > 2 ? ply_type(words[words.size() - 2]) : std::nullopt;
    if (is_list) property.count_type = ply_type(words[2]);
    if (!type || (is_list ? !property.count_type : words.size() != 3))
      refuse("its header has the line '" + std::string(line) + "'");
    property.type = *type;
    property.name = words.back();
    elements_.back().properties.push_back(std::move(property));
  }

  double next_value(PlyType type) { return is_ascii_ ? next_word() : next_number(type); }

  double next_word() {
    at_ = std::min(bytes_.find_first_not_of(" \t\r\n", at_), bytes_.size());
    const std::size_t end = std::min(bytes_.find_first_of(" \t\r\n", at_), bytes_.size());
    double value = 0.0;
    const auto [last, error] = std::from_chars(bytes_.data() + at_, bytes_.data() + end, value);
    if (error != std::errc() || last != bytes_.data() + end)
      refuse(at_ == end
                 ? "ends early"
                 : "has '" + bytes_.substr(at_, std::min<std::size_t>(end - at_, 40)) + "' in place of a number");
    at_ = end;
    return value;
  }

  template <class T>
  double number() {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if (is_big_ != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
    return static_cast<double>(std::bit_cast<T>(raw));
  }

  double next_number(PlyType type) {
    if (bytes_.size() - at_ < bytes_of(type)) refuse("ends early");
    double value = 0.0;
    switch (type) {
      case PlyType::int8:
        value = number<std::int8_t>();
        break;
      case PlyType::uint8:
        value = number<std::uint8_t>();
        break;
      case PlyType::int16:
        value = number<std::int16_t>();
        break;
      case PlyType::uint16:
        value = number<std::uint16_t>();
        break;
      case PlyType::int32:
        value = number<std::int32_t>();
        break;
      case PlyType::uint32:
        value = number<std::uint32_t>();
        break;
      case PlyType::float32:
        value = number<float>();
        break;
      case PlyType::float64:
        value = number<double>();
        break;
    }
    at_ += bytes_of(type);
    return value;
  }

  void read_vertices(const PlyElement& element) {
    for (const char* name : {"x", "y", "z"})
      if (std::none_of(element.properties.begin(), element.properties.end(),
                       [&](const PlyProperty& property) { return property.name == name; }))
        refuse(std::string("its vertices have no ") + name);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      MeshVertex vertex;
      for (const PlyProperty& property : element.properties) {
        if (property.count_type) {
          skip_list(property);
          continue;
        }
        set(vertex, property, next_value(property.type));
      }
      if (!vertex.position.allFinite()) refuse("contains a position that is not finite");
      mesh_.vertices.push_back(vertex);
    }
  }

  static void set(MeshVertex& vertex, const PlyProperty& property, double value) {
    constexpr std::array<std::string_view, 6> numbers = {"x", "y", "z", "nx", "ny", "nz"};
    const auto found = std::find(numbers.begin(), numbers.end(), property.name);
    if (found != numbers.end()) {
      const auto i = found - numbers.begin();
      (i < 3 ? vertex.position : vertex.normal)[i % 3] = static_cast<float>(value);
      return;
    }
    if (property.type != PlyType::uint8 || !(value >= 0.0 && value <= 255.0)) return;
    if (property.name == "red") vertex.red = static_cast<std::uint8_t>(value);
    if (property.name == "green") vertex.green = static_cast<std::uint8_t>(value);
    if (property.name == "blue") vertex.blue = static_cast<std::uint8_t>(value);
    if (property.name == "label") vertex.label = static_cast<std::uint8_t>(value);
  }

  std::uint64_t list_length(const PlyProperty& property) {
    const double count = next_value(*property.count_type);
    if (!(count >= 0.0 && count <= static_cast<double>(bytes_.size() - at_))) refuse("has a list without end");
    return static_cast<std::uint64_t>(count);
  }

  void skip_list(const PlyProperty& property) {
    for (std::uint64_t i = list_length(property); i > 0; --i) next_value(property.type);
  }

  void read_faces(const PlyElement& element) {
    std::vector<std::uint32_t> polygon;
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) {
        const bool is_face = element.name == "face" && property.count_type &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        if (!property.count_type) {
          next_value(property.type);
          continue;
        }
        if (!is_face) {
          skip_list(property);
          continue;
        }
        polygon.clear();
        for (std::uint64_t k = list_length(property); k > 0; --k) {
          const double index = next_value(property.type);
          if (!(index >= 0.0 && index < 4294967295.0)) refuse("has a face with a negative vertex");
          polygon.push_back(static_cast<std::uint32_t>(index));
        }
        for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
          mesh_.triangles.push_back({polygon[0], polygon[k], polygon[k + 1]});
      }
  }

  std::filesystem::path file_;
  std::string bytes_;
  std::size_t at_ = 0;
  bool is_ascii_ = false, is_big_ = false;
  std::vector<PlyElement> elements_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& file) { return PlyReader(file).read(); }

}  // namespace holdfast
