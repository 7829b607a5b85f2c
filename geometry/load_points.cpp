#include "geometry/load_points.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "geometry/detail/ply_points.h"
#include "geometry/detail/vdb_points.h"

namespace sunder::geometry {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& where, const std::string& what) {
  std::string place = file.string();
  if (!where.empty()) place.append(", ").append(where);
  throw Error(ErrorKind::usage, place.append(": ").append(what));
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  char block[1 << 16];
  while (in.read(block, sizeof block) || in.gcount() > 0) text.append(block, static_cast<std::size_t>(in.gcount()));
  if (!in.eof() || in.bad()) throw Error(ErrorKind::io, "cannot read " + file.string());
  return text;
}

bool is_separator(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }

/// The numbers of a line, up to the first thing that is none; false when there is one.
bool parse_numbers(std::string_view line, std::vector<double>& numbers) {
  numbers.clear();
  const char *at = line.data(), *const end = at + line.size();
  while (true) {
    while (at != end && is_separator(*at)) ++at;
    if (at == end) return true;
    double value = 0;
    const auto [rest, error] = std::from_chars(at + (*at == '+'), end, value);
    if (error != std::errc() || (rest != end && !is_separator(*rest))) return false;
    numbers.push_back(value);
    at = rest;
  }
}

DamagedPoints parse_text(const std::filesystem::path& file, std::string_view text) {
  DamagedPoints cloud;
  std::vector<double> numbers;
  std::size_t columns = 0;
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::string where = "line " + std::to_string(number);
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#') continue;
    if (!parse_numbers(line, numbers)) {
      if (cloud.points.empty() && columns == 0 && numbers.empty()) {  // names of columns
        columns = std::string_view::npos;
        continue;
      }
      refuse(file, where, std::string("not a line of numbers: ").append(line.substr(0, 40)));
    }
    if (numbers.size() != 4 && numbers.size() != 5)
      refuse(file, where,
             std::to_string(numbers.size()) + " numbers; a point is 'x y z damage' or 'x y z damage damage_time'");
    if (!cloud.points.empty() && numbers.size() != columns)
      refuse(file, where, "the lines before have " + std::to_string(columns) + " numbers");
    columns = numbers.size();
    cloud.points.emplace_back(numbers[0], numbers[1], numbers[2]);
    cloud.damage.push_back(numbers[3]);
    if (columns == 5) cloud.damage_time.push_back(numbers[4]);
  }
  return cloud;
}

void check(const std::filesystem::path& file, DamagedPoints& cloud) {
  if (cloud.points.empty()) refuse(file, "", "there are no points in it");
  constexpr double rounding = 1e-6;  // of a damage that was written in single precision
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::string where = "point " + std::to_string(i + 1);
    if (!cloud.points[i].allFinite()) refuse(file, where, "its position is not finite");
    double& damage = cloud.damage[i];
    if (!(damage >= -rounding && damage <= 1 + rounding))
      refuse(file, where, "damage is " + std::to_string(damage) + "; it must lie between 0 and 1");
    damage = std::clamp(damage, 0.0, 1.0);
    if (!cloud.damage_time.empty() && !std::isfinite(cloud.damage_time[i]))
      refuse(file, where, "its damage time is not finite; write -1 for never");
  }
}

}  // namespace

DamagedPoints load_points(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  DamagedPoints cloud = extension == ".ply"   ? detail::parse_ply_points(file, contents(file))
                        : extension == ".vdb" ? detail::load_vdb_points(file)
                                              : parse_text(file, contents(file));
  check(file, cloud);
  return cloud;
}

}  // namespace sunder::geometry
