#include "batch/manifest.h"

#include <fstream>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "batch/detail/database.h"
#include "batch/detail/parameters_json.h"
#include "batch/results.h"
#include "core/error.h"
#include "output/atomic_file.h"
#include "pipeline/version.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using detail::Database;
using detail::quoted;
using detail::Statement;

/// A column of the table of jobs: where its value stands in a job's result, or in what was measured.
struct Column {
  const char* name;
  const char* type;
  Json::json_pointer place;
};

const std::vector<Column>& columns() {
  using P = Json::json_pointer;
  static const std::vector<Column> list = {
      {"outcome", "TEXT", P("/outcome")},
      {"error_code", "INTEGER", P("/error/code")},
      {"error", "TEXT", P("/error/message")},
      {"fragments", "INTEGER", P("/fragments")},
      {"largest_share", "REAL", P("/largest_share")},
      {"crack_area", "REAL", P("/crack_area")},
      {"work", "REAL", P("/work")},
      {"damaged_share", "REAL", P("/damaged_share")},
      {"impact_x", "REAL", P("/impact/at/0")},
      {"impact_y", "REAL", P("/impact/at/1")},
      {"impact_z", "REAL", P("/impact/at/2")},
      {"direction_x", "REAL", P("/impact/direction/0")},
      {"direction_y", "REAL", P("/impact/direction/1")},
      {"direction_z", "REAL", P("/impact/direction/2")},
      {"impact_impulse", "REAL", P("/impact/impulse")},
      {"impact_speed", "REAL", P("/impact/speed")},
      {"impact_energy", "REAL", P("/impact/energy")},
      {"original", "TEXT", P("/original")},
      {"build", "TEXT", P("/build")},
      {"seconds", "REAL", P("/measured/seconds")},
      {"processor_seconds", "REAL", P("/measured/processor_seconds")},
      {"peak_memory_mb", "REAL", P("/measured/peak_memory_mb")},
      {"host", "TEXT", P("/measured/host")},
  };
  return list;
}

void bind_json(Statement& statement, const Json& value) {
  if (value.is_null())
    statement.bind_nothing();
  else if (value.is_string())
    statement.bind(value.get<std::string>());
  else if (value.is_boolean())
    statement.bind(std::int64_t{value.get<bool>()});
  else if (value.is_number_integer())
    statement.bind(value.get<std::int64_t>());
  else if (value.is_number())
    statement.bind(value.get<double>());
  else
    statement.bind(value.dump());
}

Json read_json(const fs::path& file) {
  std::ifstream in(file);
  if (!in) return nullptr;
  return Json::parse(in, nullptr, false);
}

/// Everything of a job on one line.
Json line_of(const Job& job, const Results& results) {
  const fs::path folder = results.folder(job.id);
  Json line = {{"job", job.index}, {"id", job.id}};
  Json result = read_json(folder / "result.json");
  if (!result.is_object()) {
    line["outcome"] = "missing";
    line["parameters"] = detail::parameters_json(job);
    return line;
  }
  for (auto& [key, value] : result.items()) line[key] = std::move(value);
  line["folder"] = "jobs/" + job.id.substr(0, 2) + "/" + job.id;
  if (Json measured = read_json(folder / "measured.json"); measured.is_object()) line["measured"] = std::move(measured);
  return line;
}

/// Rows go into a file of their own beside the manifest, which it replaces in the end.
class Writer {
 public:
  Writer(const Plan& plan, const fs::path& file, const std::vector<std::string>& parameters)
      : parameters_(parameters), database_(file, Database::Use::write) {
    database_.run("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN");
    std::string names = "number INTEGER PRIMARY KEY, id TEXT NOT NULL", marks = "?, ?";
    for (const Column& column : columns()) {
      names.append(", ").append(column.name).append(" ").append(column.type);
      marks += ", ?";
    }
    for (const std::string& parameter : parameters_) {
      names += ", " + quoted(parameter);
      marks += ", ?";
    }
    database_.run("CREATE TABLE plan (key TEXT PRIMARY KEY, value); CREATE TABLE job (" + names +
                  "); CREATE TABLE piece (job INTEGER NOT NULL REFERENCES job, piece INTEGER NOT NULL, name TEXT, "
                  "volume REAL, mass REAL, area REAL, inside_area REAL, closed INTEGER, PRIMARY KEY (job, piece)) "
                  "WITHOUT ROWID; CREATE TABLE file (job INTEGER NOT NULL REFERENCES job, name TEXT NOT NULL, bytes "
                  "INTEGER, sha256 TEXT, PRIMARY KEY (job, name)) WITHOUT ROWID");
    job_.emplace(database_.prepare("INSERT INTO job VALUES (" + marks + ")"));
    piece_.emplace(database_.prepare("INSERT INTO piece VALUES (?, ?, ?, ?, ?, ?, ?, ?)"));
    file_.emplace(database_.prepare("INSERT INTO file VALUES (?, ?, ?, ?)"));
    describe(plan);
  }

  void add(const Json& line) {
    const auto number = line.at("job").get<std::int64_t>();
    job_->bind(number).bind(line.at("id").get<std::string>());
    for (const Column& column : columns()) {
      const bool there = line.contains(column.place);
      bind_json(*job_, there ? line.at(column.place) : Json());
    }
    for (const std::string& parameter : parameters_) bind_json(*job_, line.at("parameters").value(parameter, Json()));
    job_->run();
    std::int64_t piece = 0;
    for (const Json& p : line.value("pieces", Json::array())) {
      piece_->bind(number).bind(piece++);
      for (const char* key : {"name", "volume", "mass", "area", "inside_area", "closed"})
        bind_json(*piece_, p.value(key, Json()));
      piece_->run();
    }
    for (const Json& f : line.value("files", Json::array())) {
      file_->bind(number);
      for (const char* key : {"name", "bytes", "sha256"}) bind_json(*file_, f.value(key, Json()));
      file_->run();
    }
  }

  void finish(const Plan& plan) {
    database_.run("CREATE INDEX job_by_id ON job (id); CREATE INDEX job_by_outcome ON job (outcome)");
    database_.run(
        "CREATE VIEW outcomes AS SELECT outcome, count(*) AS jobs, sum(seconds) AS seconds FROM job GROUP BY outcome");
    database_.run(
        "CREATE VIEW failures AS SELECT error_code, error, count(*) AS jobs, min(number) AS first_job FROM job WHERE "
        "outcome = 'failed' GROUP BY error_code, error ORDER BY jobs DESC");
    for (const Axis& axis : plan.axes) {
      if (axis.values.size() < 2) continue;
      const std::string name = quoted(axis.name);
      database_.run("CREATE VIEW " + quoted("by_" + axis.name) + " AS SELECT " + name +
                    ", count(*) AS jobs, sum(outcome = 'failed') AS failed, avg(outcome = 'broken') AS broken_share, "
                    "avg(fragments) AS mean_fragments, max(fragments) AS most_fragments, avg(largest_share) AS "
                    "mean_largest_share, sum(work) / sum(crack_area) AS work_per_crack_area, avg(seconds) AS "
                    "mean_seconds FROM job WHERE outcome != 'missing' GROUP BY " +
                    name);
    }
    database_.run("COMMIT");
    job_.reset();
    piece_.reset();
    file_.reset();
    database_.close();
  }

 private:
  void describe(const Plan& plan) {
    Statement row = database_.prepare("INSERT INTO plan VALUES (?, ?)");
    row.bind(std::string("name")).bind(plan.name).run();
    row.bind(std::string("mode")).bind(std::string(plan.mode == Mode::fracture ? "fracture" : "run")).run();
    row.bind(std::string("jobs")).bind(static_cast<std::int64_t>(plan.size())).run();
    row.bind(std::string("samples")).bind(static_cast<std::int64_t>(plan.samples)).run();
    row.bind(std::string("seed")).bind(static_cast<std::int64_t>(plan.seed)).run();
    row.bind(std::string("build")).bind(pipeline::build_name()).run();
    Json axes = Json::array();
    for (const Axis& axis : plan.axes)
      if (axis.kind != Axis::Kind::grid || axis.values.size() > 1) axes.push_back(axis.name);
    row.bind(std::string("varied")).bind(axes.dump()).run();
  }

  std::vector<std::string> parameters_;
  Database database_;
  std::optional<Statement> job_, piece_, file_;
};

void count(Tally& tally, const std::string& outcome) {
  if (outcome == "broken")
    ++tally.broken;
  else if (outcome == "whole")
    ++tally.whole;
  else
    ++(outcome == "failed" ? tally.failed : tally.missing);
}

/// A file under another name until it is whole.
class Draft {
 public:
  explicit Draft(fs::path file)
      : file_(std::move(file)), draft_(file_.string() + "." + std::to_string(getpid()) + ".tmp") {
    std::error_code ignored;
    fs::remove(draft_, ignored);
  }
  ~Draft() {
    std::error_code ignored;
    fs::remove(draft_, ignored);
  }
  const fs::path& path() const { return draft_; }
  void keep() {
    std::error_code error;
    fs::rename(draft_, file_, error);
    if (error) throw Error(ErrorKind::io, file_.string() + ": " + error.message());
  }

 private:
  fs::path file_, draft_;
};

}  // namespace

Tally collect(const Plan& plan, const fs::path& out, Progress& progress) {
  const Results results(out);
  Draft database(out / "manifest.sqlite"), lines(out / "manifest.jsonl");
  Tally tally;
  std::vector<std::string> parameters;
  for (const Parameter& parameter : plan.job(0).parameters) parameters.push_back(parameter.name);
  Writer writer(plan, database.path(), parameters);
  std::ofstream text(lines.path(), std::ios::binary);
  const std::uint64_t size = plan.size();
  for (std::uint64_t index = 0; index < size; ++index) {
    const Json line = line_of(plan.job(index), results);
    writer.add(line);
    text << line.dump() << '\n';
    count(tally, line.at("outcome").get<std::string>());
    if (index % 64 == 0) progress.checkpoint("collect", static_cast<double>(index) / static_cast<double>(size));
  }
  if (!text.flush()) throw Error(ErrorKind::io, lines.path().string() + ": cannot be written; is the disk full?");
  writer.finish(plan);
  database.keep();
  lines.keep();
  return tally;
}

}  // namespace sunder::batch
