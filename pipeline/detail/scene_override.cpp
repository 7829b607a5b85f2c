#include "pipeline/detail/scene_override.h"

namespace sunder::pipeline::detail {
namespace {

constexpr std::string_view value_key = "value";

/// "body.cup.velocity": "body", "cup", "velocity". What is between the first and the last point is one name.
std::vector<std::string> steps_of(const std::string& key) {
  const std::size_t first = key.find('.'), last = key.rfind('.');
  if (first == std::string::npos || first == 0 || last + 1 == key.size()) return {};
  if (first == last) return {key.substr(0, first), key.substr(first + 1)};
  return {key.substr(0, first), key.substr(first + 1, last - first - 1), key.substr(last + 1)};
}

toml::table* body_of(const std::string& name, toml::table& document, std::vector<std::string>& known) {
  toml::array* bodies = document["body"].as_array();
  if (!bodies) return nullptr;
  for (toml::node& node : *bodies) {
    toml::table* body = node.as_table();
    if (!body) continue;
    known.push_back((*body)["name"].value_or(std::string()));
    if (known.back() == name) return body;
  }
  return nullptr;
}

toml::table* material_of(const std::string& name, toml::table& document, std::vector<std::string>& known) {
  toml::table* materials = document["material"].as_table();
  if (!materials) return nullptr;
  for (auto&& [key, node] : *materials) {
    known.emplace_back(key.str());
    if (key.str() == name) return node.as_table();
  }
  return nullptr;
}

}  // namespace

toml::table parsed_value(const std::string& subject, const std::string& value) {
  try {
    return toml::parse(std::string(value_key) + " = " + value);
  } catch (const toml::parse_error&) {
    throw Error(ErrorKind::usage,
                subject + ": '" + value + "' is no TOML value; texts need quotes: '\"" + value + "\"'");
  }
}

void apply(const Override& change, const std::filesystem::path& file, toml::table& document) {
  const toml::table parsed = parsed_value(change.key, change.value);
  const std::vector<std::string> steps = steps_of(change.key);
  const bool named = !steps.empty() && (steps[0] == "body" || steps[0] == "material");
  if (steps.empty() || (steps.size() == 3) != named)
    throw Error(ErrorKind::usage, "'" + change.key +
                                      "' is no key of a scene; keys are written 'scene.seed', 'fracture.spline' or "
                                      "'body.<name>.velocity'");
  toml::table* section = nullptr;
  if (named) {
    std::vector<std::string> known;
    section = steps[0] == "body" ? body_of(steps[1], document, known) : material_of(steps[1], document, known);
    if (!section)
      throw Error(ErrorKind::usage, change.key + ": " + file.string() + " has no " + steps[0] + " '" + steps[1] + "'" +
                                        (known.empty() ? "" : suggestion(steps[1], known)));
  } else {
    document.emplace<toml::table>(steps[0]);
    section = document[steps[0]].as_table();
    if (!section) throw Error(ErrorKind::usage, change.key + ": '" + steps[0] + "' is no section of " + file.string());
  }
  section->insert_or_assign(steps.back(), *parsed.get(value_key));
}

}  // namespace sunder::pipeline::detail
