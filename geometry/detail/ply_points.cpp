#include "geometry/detail/ply_points.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>

#include "core/error.h"

namespace sunder::geometry::detail {

namespace {

template <typename Number>
double read_as(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

struct Type {
  std::size_t size;
  double (*read)(const char*);
};

const std::map<std::string, Type, std::less<>>& types() {
  static const std::map<std::string, Type, std::less<>> table = {
      {"char", {1, read_as<std::int8_t>}},     {"int8", {1, read_as<std::int8_t>}},
      {"uchar", {1, read_as<std::uint8_t>}},   {"uint8", {1, read_as<std::uint8_t>}},
      {"short", {2, read_as<std::int16_t>}},   {"int16", {2, read_as<std::int16_t>}},
      {"ushort", {2, read_as<std::uint16_t>}}, {"uint16", {2, read_as<std::uint16_t>}},
      {"int", {4, read_as<std::int32_t>}},     {"int32", {4, read_as<std::int32_t>}},
      {"uint", {4, read_as<std::uint32_t>}},   {"uint32", {4, read_as<std::uint32_t>}},
      {"float", {4, read_as<float>}},          {"float32", {4, read_as<float>}},
      {"double", {8, read_as<double>}},        {"float64", {8, read_as<double>}}};
  return table;
}

/// What a vertex of the file consists of.
struct Layout {
  bool binary = false;
  std::size_t count = 0, vertex_size = 0;
  std::vector<std::string> names;
  std::vector<Type> kinds;
  std::size_t header_size = 0;
};

class Reader {
 public:
  Reader(const std::filesystem::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  DamagedPoints run() {
    if (bytes_.empty()) refuse("there are no points in it");
    const Layout layout = read_header();
    std::array<int, 5> column{};
    constexpr std::array<const char*, 5> wanted = {"x", "y", "z", "damage", "damage_time"};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const auto found = std::find(layout.names.begin(), layout.names.end(), wanted[i]);
      column[i] = found == layout.names.end() ? -1 : static_cast<int>(found - layout.names.begin());
      if (column[i] < 0 && i < 4) refuse("the vertices have no property '" + std::string(wanted[i]) + "'");
    }
    DamagedPoints cloud;
    std::string_view rest = bytes_.substr(layout.header_size);
    std::vector<double> row(layout.names.size());
    for (std::size_t i = 0; i < layout.count; ++i) {
      if (!(layout.binary ? binary_row(rest, layout, row) : text_row(rest, row)))
        refuse("it ends or breaks off at vertex " + std::to_string(i + 1) + " of " + std::to_string(layout.count));
      cloud.points.emplace_back(row[column[0]], row[column[1]], row[column[2]]);
      cloud.damage.push_back(row[column[3]]);
      if (column[4] >= 0) cloud.damage_time.push_back(row[column[4]]);
    }
    return cloud;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::usage, file_.string() + ": " + what);
  }

  Layout read_header() const {
    Layout layout;
    std::size_t at = 0;
    bool in_vertices = false, seen_format = false;
    for (int number = 0;; ++number) {
      const std::size_t end = bytes_.find('\n', at);
      if (end == std::string_view::npos || number > 1000) refuse("its PLY header has no end");
      std::istringstream line{std::string(bytes_.substr(at, end - at))};
      at = end + 1;
      std::string word, kind, name;
      line >> word >> kind >> name;
      if (number == 0 && word != "ply") refuse("it is not a PLY file");
      if (word == "end_header") break;
      if (word == "format") {
        if (kind != "ascii" && kind != "binary_little_endian") refuse("the PLY format '" + kind + "' is not supported");
        layout.binary = kind != "ascii";
        seen_format = true;
      } else if (word == "element") {
        in_vertices = kind == "vertex";
        if (!in_vertices && layout.names.empty()) refuse("the vertices are not its first element");
        if (in_vertices) layout.count = count_of(name);
      } else if (word == "property" && in_vertices) {
        const auto type = types().find(kind);
        if (type == types().end()) refuse("a vertex property of type '" + kind + "' is not supported");
        layout.names.push_back(name);
        layout.kinds.push_back(type->second);
        layout.vertex_size += type->second.size;
      }
    }
    if (!seen_format) refuse("its PLY header names no format");
    layout.header_size = at;
    return layout;
  }

  std::size_t count_of(const std::string& digits) const {
    std::size_t count = 0;
    const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
    if (error != std::errc() || rest != digits.data() + digits.size()) refuse("'" + digits + "' vertices");
    return count;
  }

  static bool binary_row(std::string_view& rest, const Layout& layout, std::vector<double>& row) {
    if (rest.size() < layout.vertex_size) return false;
    const char* at = rest.data();
    for (std::size_t i = 0; i < row.size(); at += layout.kinds[i].size, ++i) row[i] = layout.kinds[i].read(at);
    rest.remove_prefix(layout.vertex_size);
    return true;
  }

  static bool text_row(std::string_view& rest, std::vector<double>& row) {
    for (double& value : row) {
      const std::size_t start = rest.find_first_not_of(" \t\r\n");
      if (start == std::string_view::npos) return false;
      rest.remove_prefix(start);
      const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
      if (error != std::errc()) return false;
      rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    }
    return true;
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
};

}  // namespace

DamagedPoints parse_ply_points(const std::filesystem::path& file, std::string_view bytes) {
  return Reader(file, bytes).run();
}

}  // namespace sunder::geometry::detail
