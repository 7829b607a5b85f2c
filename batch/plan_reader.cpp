#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <set>

#include <glob.h>
#include <nlohmann/json.hpp>

#include "batch/detail/job_keys.h"
#include "batch/plan.h"
#include "pipeline/detail/quality_words.h"
#include "pipeline/detail/toml_reader.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using pipeline::detail::Key;
using pipeline::detail::Section;
using pipeline::detail::Value;

constexpr std::int64_t most_samples = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t most_points = 1'000'000;
constexpr double whole_number_slack = 1e-9;

void read_mode(const Value& value, Plan& plan) {
  constexpr std::array<std::pair<std::string_view, Mode>, 2> kModes = {
      {{"fracture", Mode::fracture}, {"run", Mode::run}}};
  plan.mode = value.word<Mode>(kModes);
}

void read_keep(const Value& value, Plan& plan) {
  constexpr std::array<std::pair<std::string_view, bool Keep::*>, 6> kKinds = {{{"dataset", &Keep::dataset},
                                                                                {"still", &Keep::still},
                                                                                {"obj", &Keep::obj},
                                                                                {"glb", &Keep::glb},
                                                                                {"cracks", &Keep::cracks},
                                                                                {"sequence", &Keep::sequence}}};
  plan.keep = {};
  for (const Value& kind : value.list()) plan.keep.*kind.word<bool Keep::*>(kKinds) = true;
}

void read_time_limit(const Value& value, Plan& plan) {
  if (!value.is_text()) {
    plan.job_time_limit = value.positive();
    return;
  }
  const auto seconds = pipeline::duration_of(value.text());
  if (!seconds) value.fail("expected seconds, or a text such as \"90 s\", \"5 min\" or \"2 h\"");
  plan.job_time_limit = *seconds;
}

constexpr std::array<Key<Plan>, 6> kPlanKeys = {{
    {"mode", read_mode},
    {"seed", [](const Value& value, Plan& plan) { plan.seed = pipeline::detail::read_seed_value(value); }},
    {"samples",
     [](const Value& value, Plan& plan) { plan.samples = static_cast<std::uint64_t>(value.integer(1, most_samples)); }},
    {"job_time_limit", read_time_limit},
    {"keep", read_keep},
    {"points", [](const Value& value, Plan& plan) { plan.points = static_cast<int>(value.integer(0, most_points)); }},
}};

Json json_of(const toml::node& node, const Value& value) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return number->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* flag = node.as_boolean()) return flag->get();
  const toml::array* array = node.as_array();
  if (!array) value.fail("expected numbers, texts, true or false, or arrays of those");
  Json list = Json::array();
  for (const toml::node& element : *array) list.push_back(json_of(element, value));
  return list;
}

/// Whether a value can be what it is given for.
using Check = std::function<void(const Value&)>;

std::string checked(const Value& value, const Check& check) {
  check(value);
  return json_of(value.node(), value).dump();
}

void add_value(Axis& axis, const Value& value, const std::string& json) {
  if (std::find(axis.values.begin(), axis.values.end(), json) != axis.values.end())
    value.fail(json + " is given twice");
  axis.values.push_back(json);
}

void read_values(Axis& axis, const Value& value, const Check& check) {
  const std::vector<Value> list = value.list();
  if (list.empty()) value.fail("an empty list gives no jobs");
  for (const Value& element : list) add_value(axis, element, checked(element, check));
}

/// `{ from, to, steps, log }`, or of whole numbers `{ from, to }`.
struct Steps {
  double from = 0, to = 0;
  std::int64_t steps = 0;
  bool logarithmic = false, whole = true;
};

constexpr std::array<Key<Steps>, 4> kStepKeys = {{
    {"from",
     [](const Value& value, Steps& steps) {
       steps.from = value.number();
       steps.whole &= value.is_integer();
     },
     true},
    {"to",
     [](const Value& value, Steps& steps) {
       steps.to = value.number();
       steps.whole &= value.is_integer();
     },
     true},
    {"steps", [](const Value& value, Steps& steps) { steps.steps = value.integer(2, 1'000'000'000); }},
    {"log", [](const Value& value, Steps& steps) { steps.logarithmic = value.flag(); }},
}};

void read_steps(Axis& axis, const Value& value, const Section& section, const Check& check) {
  Steps steps;
  pipeline::detail::read_section<Steps>(section, kStepKeys, steps);
  if (!(steps.to > steps.from)) value.fail("'to' has to be above 'from'");
  if (steps.logarithmic && !(steps.from > 0)) value.fail("a logarithmic axis starts above 0");
  if (steps.steps == 0 && !steps.whole) value.fail("missing key 'steps'; only whole numbers go without");
  const std::int64_t count =
      steps.steps > 0 ? steps.steps : static_cast<std::int64_t>(steps.to) - static_cast<std::int64_t>(steps.from) + 1;
  for (const char* end : {"from", "to"}) check(section.value(end));
  for (std::int64_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(count - 1);
    const double x =
        steps.logarithmic ? steps.from * std::pow(steps.to / steps.from, t) : steps.from + t * (steps.to - steps.from);
    const bool whole = steps.whole && std::abs(x - std::round(x)) < whole_number_slack;
    axis.values.push_back(whole ? std::to_string(std::llround(x)) : Json(x).dump());
  }
}

void read_range(Axis& axis, const Value& ends, const Check& check) {
  const std::vector<Value> list = ends.list();
  if (list.size() != 2) ends.fail("expected the two ends [low, high]");
  for (const Value& end : list) check(end);
  axis.low = list[0].number();
  axis.high = list[1].number();
  if (!(axis.high > axis.low)) ends.fail("the second end has to be above the first");
  if (axis.kind == Axis::Kind::log_uniform && !(axis.low > 0)) ends.fail("a logarithmic axis starts above 0");
  if (axis.kind == Axis::Kind::integer && !(list[0].is_integer() && list[1].is_integer()))
    ends.fail("expected whole numbers");
}

/// One name a line; empty lines and those that begin with # say nothing.
void read_list_file(Axis& axis, const Value& value) {
  const fs::path file = value.file().parent_path() / value.text();
  std::ifstream in(file);
  if (!in) value.fail("there is no file " + file.string());
  for (std::string line; std::getline(in, line);) {
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (!line.empty() && line.front() != '#') add_value(axis, value, Json(line).dump());
  }
  if (axis.values.empty()) value.fail("the file " + file.string() + " names nothing");
}

Axis read_axis(const std::string& name, const Value& value, const Check& check) {
  Axis axis{name, Axis::Kind::grid, {}, 0, 0};
  if (value.is_list()) {
    read_values(axis, value, check);
  } else if (!value.is_table()) {
    axis.values = {checked(value, check)};
  } else {
    const Section section = value.section();
    if (section.has("from") || section.has("to")) {
      read_steps(axis, value, section, check);
      return axis;
    }
    const std::vector<std::string> ways = {"uniform", "log_uniform", "integer", "choice", "list"};
    check_keys(section, ways);
    if (section.table.size() != 1)
      value.fail(
          "expected one of { from, to, steps }, { uniform }, { log_uniform }, { integer }, { choice }, { list }");
    const std::string way(section.table.begin()->first.str());
    const Value inner = section.value(way);
    if (way == "list") {
      read_list_file(axis, inner);
    } else if (way == "choice") {
      axis.kind = Axis::Kind::choice;
      read_values(axis, inner, check);
    } else {
      axis.kind = way == "uniform"       ? Axis::Kind::uniform
                  : way == "log_uniform" ? Axis::Kind::log_uniform
                                         : Axis::Kind::integer;
      read_range(axis, inner, check);
    }
  }
  return axis;
}

std::vector<std::string> matching(const fs::path& folder, const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> names;
  if (glob((folder / pattern).c_str(), GLOB_NOSORT, nullptr, &found) == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i)
      names.push_back(fs::path(found.gl_pathv[i]).lexically_relative(folder).string());
  globfree(&found);
  std::sort(names.begin(), names.end());
  return names;
}

/// Patterns become the files that they match.
void expand_patterns(const Plan& plan, Axis& subjects, const Value& value) {
  const fs::path folder = plan.file.has_parent_path() ? plan.file.parent_path() : fs::path(".");
  std::vector<std::string> expanded;
  for (const std::string& json : subjects.values) {
    const std::string name = detail::text_of(json);
    if (name.find_first_of("*?[") == std::string::npos) {
      expanded.push_back(json);
      continue;
    }
    const std::vector<std::string> files = matching(folder, name);
    if (files.empty()) value.fail("no file matches " + name);
    for (const std::string& file : files) expanded.push_back(Json(file).dump());
  }
  subjects.values = std::move(expanded);
  std::set<std::string> once(subjects.values.begin(), subjects.values.end());
  if (once.size() != subjects.values.size()) value.fail("a file is named twice");
}

void check_subjects(const Plan& plan, const Axis& subjects, const Value& value) {
  if (subjects.kind != Axis::Kind::grid) value.fail("meshes and scenes are listed, not drawn");
  std::error_code ignored;
  for (const std::string& json : subjects.values) {
    if (!json.starts_with('"')) value.fail("expected names of files, found " + json);
    const auto file = detail::subject_file(plan, detail::text_of(json));
    if (!file) value.fail("unknown mesh " + json + "; a file has a folder or an extension");
    if (plan.mode == Mode::run && !fs::is_regular_file(*file, ignored))
      value.fail("there is no scene file " + file->string());
  }
}

std::vector<std::string> written_order(const toml::table& table) {
  std::vector<std::pair<toml::source_position, std::string>> keys;
  for (const auto& [key, node] : table) keys.emplace_back(key.source().begin, key.str());
  std::sort(keys.begin(), keys.end());
  std::vector<std::string> names;
  for (const auto& [place, name] : keys) names.push_back(name);
  return names;
}

void read_job(const Section& section, Plan& plan) {
  const bool fracture = plan.mode == Mode::fracture;
  const std::string subject = fracture ? "mesh" : "scene";
  if (!section.has(subject)) section.fail("missing key '" + subject + "': what is broken?");
  if (fracture) check_keys(section, detail::fracture_parameters());
  std::vector<std::string> names;
  for (const std::string& name : written_order(section.table)) {
    const Value value = section.value(name);
    const Check check = [&](const Value& given) {
      if (fracture) detail::check_fracture_value(name, given);
    };
    Axis axis = read_axis(name, value, check);
    if (axis.kind != Axis::Kind::grid && plan.samples == 1)
      value.fail("a drawn parameter needs samples in [plan]: how many are drawn for each combination");
    if (name == subject) {
      expand_patterns(plan, axis, value);
      check_subjects(plan, axis, value);
      plan.axes.insert(plan.axes.begin(), std::move(axis));
    } else {
      plan.axes.push_back(std::move(axis));
    }
    names.push_back(name);
  }
  if (const std::string why = fracture ? detail::conflict(names) : ""; !why.empty()) section.fail(why);
}

/// Every value of every parameter once, so that a slip is found before a night of jobs.
void check_scene_values(const Plan& plan, const Section& section) {
  const auto try_job = [&](const Job& job) {
    try {
      detail::scene_of(plan, job);
    } catch (const Error& error) {
      section.fail(std::string("a job cannot be read: ") + error.what());
    }
  };
  std::uint64_t stride = plan.samples;
  for (std::size_t a = plan.axes.size(); a-- > 0;) {
    if (plan.axes[a].kind != Axis::Kind::grid) continue;
    for (std::size_t i = 0; i < plan.axes[a].values.size(); ++i) try_job(plan.job(i * stride));
    stride *= plan.axes[a].values.size();
  }
}

void check_keep(const Plan& plan, const Section& section) {
  if (plan.mode == Mode::fracture && plan.keep.sequence)
    section.fail_at("keep", "keep: a sequence comes of mode = \"run\"");
  if (plan.mode == Mode::run && (plan.keep.dataset || plan.keep.obj || plan.keep.glb || plan.keep.cracks))
    section.fail_at("keep", "keep: of a scene \"sequence\" (all that it writes) and \"still\" can be kept");
  if (plan.points > 0 && !plan.keep.dataset) section.fail_at("points", "points: are part of keep = [\"dataset\"]");
}

}  // namespace

Plan load_plan(const fs::path& file) {
  const toml::table document = pipeline::detail::parse_file(file);
  pipeline::detail::check_keys({file, document, "plan"}, {"plan", "job"});
  Plan plan;
  plan.file = file;
  plan.name = file.stem().string();
  const toml::table none;
  const toml::table* settings = document["plan"].as_table();
  const Section section{file, settings ? *settings : none, "[plan]"};
  if (document.contains("plan") && !settings) pipeline::detail::fail(file, 1, "expected a section [plan]");
  pipeline::detail::read_section<Plan>(section, kPlanKeys, plan);
  if (!section.has("keep")) {
    plan.keep.still = true;
    (plan.mode == Mode::fracture ? plan.keep.dataset : plan.keep.sequence) = true;
  }
  check_keep(plan, section);
  const toml::table* job = document["job"].as_table();
  if (!job) pipeline::detail::fail(file, 1, "the plan has no section [job], which says what is broken and how");
  const Section jobs{file, *job, "[job]"};
  read_job(jobs, plan);
  if (plan.mode == Mode::run) check_scene_values(plan, jobs);
  return plan;
}

}  // namespace sunder::batch
