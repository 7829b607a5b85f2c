#include "pipeline/detail/toml_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace sunder::pipeline::detail {
namespace {

// Levenshtein's distance, where swapping two neighbours also counts as one edit (optimal string alignment).
int edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = static_cast<int>(i);
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    case toml::node_type::date:
    case toml::node_type::time:
    case toml::node_type::date_time:
      return "a date or time";
    case toml::node_type::none:
      break;
  }
  return "nothing";
}

// As short as it can be written and read back.
std::string number_text(double value) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

}  // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  const int reach = std::max(2, static_cast<int>(word.size()) / 3);
  std::string nearest;
  int least = reach + 1;
  for (const std::string& candidate : candidates) {
    const int distance = edit_distance(word, candidate);
    // A word that shares no letter with the candidate is no misspelling of it, however short both are.
    if (distance < least && distance < static_cast<int>(std::max(word.size(), candidate.size()))) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates) {
  if (const std::string nearest = nearest_word(word, candidates); !nearest.empty()) {
    return "; did you mean '" + nearest + "'?";
  }
  std::string list;
  for (const std::string& candidate : candidates) list += (list.empty() ? "" : ", ") + candidate;
  return "; expected one of: " + list;
}

void fail(const std::filesystem::path& file, int line, const std::string& message) {
  throw Error(ErrorKind::usage, file.string() + ":" + std::to_string(line) + ": " + message);
}

toml::table parse_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw Error(ErrorKind::usage, file.string() + ": there is no such file");
  }
  try {
    return toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    fail(file, static_cast<int>(error.source().begin.line), "not valid TOML: " + std::string(error.description()));
  }
}

void Value::fail_type(std::string_view expected) const {
  fail("expected " + std::string(expected) + ", found " + std::string(type_name(*node_)));
}

std::string Value::text() const {
  const auto* string = node_->as_string();
  if (!string) fail_type("a string");
  if (string->get().empty()) fail("expected a string that is not empty");
  return string->get();
}

bool Value::flag() const {
  const auto* boolean = node_->as_boolean();
  if (!boolean) fail_type("true or false");
  return boolean->get();
}

std::int64_t Value::integer(std::int64_t minimum, std::int64_t maximum) const {
  const auto* integer = node_->as_integer();
  if (!integer) fail_type("an integer");
  if (integer->get() < minimum || integer->get() > maximum) {
    fail("expected an integer from " + std::to_string(minimum) + " to " + std::to_string(maximum) + ", found " +
         std::to_string(integer->get()));
  }
  return integer->get();
}

double Value::finite(const toml::node& node, std::string_view expected) const {
  if (const auto* integer = node.as_integer()) return static_cast<double>(integer->get());
  const auto* number = node.as_floating_point();
  if (!number) fail("expected " + std::string(expected) + ", found " + std::string(type_name(node)));
  if (!std::isfinite(number->get())) fail("expected a finite number");
  return number->get();
}

double Value::number() const { return finite(*node_, "a number"); }

double Value::positive() const {
  const double value = number();
  if (value <= 0) fail("expected a number above 0, found " + number_text(value));
  return value;
}

double Value::non_negative() const {
  const double value = number();
  if (value < 0) fail("expected a number that is not negative, found " + number_text(value));
  return value;
}

double Value::within(double low, double high) const {
  const double value = number();
  if (value < low || value > high) {
    fail("expected a number from " + number_text(low) + " to " + number_text(high) + ", found " + number_text(value));
  }
  return value;
}

Vec3 Value::vector() const {
  constexpr std::string_view kExpected = "three numbers [x, y, z]";
  const toml::array* array = node_->as_array();
  if (!array) fail_type(kExpected);
  if (array->size() != 3) {
    fail("expected " + std::string(kExpected) + ", found an array of " + std::to_string(array->size()));
  }
  Vec3 result;
  for (int i = 0; i < 3; ++i) result[i] = finite((*array)[static_cast<std::size_t>(i)], kExpected);
  return result;
}

Vec3 Value::positive_vector() const {
  const Vec3 result = vector();
  if ((result.array() <= 0).any()) fail("expected three numbers above 0");
  return result;
}

std::vector<Value> Value::list() const {
  const toml::array* array = node_->as_array();
  if (!array) fail_type("a list");
  std::vector<Value> values;
  for (const toml::node& node : *array) values.emplace_back(*file_, node, subject_);
  return values;
}

Section Value::section() const {
  const toml::table* table = node_->as_table();
  if (!table) fail_type("a table");
  return {*file_, *table, subject_};
}

std::vector<Section> Value::tables() const {
  const toml::array* array = node_->as_array();
  if (!array || !array->is_array_of_tables()) fail_type("an array of tables [{ ... }, ...]");
  std::vector<Section> sections;
  for (const toml::node& entry : *array)
    sections.push_back({*file_, *entry.as_table(), subject_ + ": " + std::to_string(sections.size() + 1)});
  return sections;
}

void Section::fail_at(std::string_view key, const std::string& message) const {
  const toml::node* node = table.get(key);
  const int at = node ? static_cast<int>(node->source().begin.line) : line();
  detail::fail(file, at, name + ": " + message);
}

void check_keys(const Section& section, const std::vector<std::string>& known) {
  for (const auto& [key, node] : section.table) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    detail::fail(section.file, static_cast<int>(key.source().begin.line),
                 section.name + ": unknown key '" + std::string(key.str()) + "'" + suggestion(key.str(), known));
  }
}

}  // namespace sunder::pipeline::detail
