#pragma once
/// What a batch does: a plan file names meshes or scenes and the parameters to vary (docs/batch.md).
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sunder::batch {

enum class Mode {
  fracture,  ///< one hit on one mesh, without motion (pipeline/still.h)
  run        ///< a scene (pipeline/run.h)
};

/// What is kept of a job beside its result.
struct Keep {
  bool dataset = false;   ///< pieces, labels and transforms as arrays for NumPy
  bool still = false;     ///< a small picture
  bool obj = false;       ///< a file for each piece
  bool glb = false;       ///< all pieces in one file
  bool cracks = false;    ///< the crack surface, as PLY
  bool sequence = false;  ///< all that a scene writes
};

/// How one parameter of the jobs is chosen. Values are JSON, which is TOML too.
struct Axis {
  enum class Kind {
    grid,         ///< every one of `values`
    uniform,      ///< drawn from [low, high) for each sample
    log_uniform,  ///< the same, its logarithm uniform
    integer,      ///< drawn from the whole numbers low to high
    choice        ///< one of `values` drawn for each sample
  };
  std::string name;
  Kind kind = Kind::grid;
  std::vector<std::string> values;
  double low = 0, high = 0;
};

struct Parameter {
  std::string name;
  std::string value;  ///< JSON
  bool operator==(const Parameter&) const = default;
};

struct Job {
  std::uint64_t index = 0;
  std::string id;                     ///< 16 hexadecimal digits: a hash of all that decides the result
  std::string content;                ///< the same of what the subject's files hold, and of the materials
  std::vector<Parameter> parameters;  ///< the subject ("mesh" or "scene") first
};

class Plan {
 public:
  std::filesystem::path file;
  std::string name;
  Mode mode = Mode::fracture;
  std::uint64_t seed = 1;     ///< of all that is drawn
  std::uint64_t samples = 1;  ///< jobs for each combination of grid values
  double job_time_limit = 0;  ///< after which a job is given up [s]; 0: never
  int points = 0;             ///< labelled points on the pieces of a data set
  Keep keep;
  std::vector<Axis> axes;  ///< the subject first

  /// The number of jobs; the largest number that there is when they are more.
  std::uint64_t size() const;

  /// Grids count like digits, the subject slowest, samples fastest. What is drawn depends on the plan's seed, the
  /// parameter's name and the sample alone: sample 7 hits every mesh and material in the same way. The id covers the
  /// content of the subject's files and of the materials, which are read when they are first asked for. Not safe to
  /// call from several threads. `index` below size(). Errors: those of load_scene, for mode run.
  Job job(std::uint64_t index) const;

 private:
  const std::string& content_of(const std::string& subject) const;

  mutable std::map<std::string, std::string> contents_;  ///< hashes of what subjects hold
};

/// Reads and checks a plan: unknown keys, parameters that the mode does not have, values that they cannot take and
/// values that are given twice are Errors (usage) "file:line: ..."; patterns of mesh files are expanded in the order
/// of their names. A mesh file that is missing is an error of its jobs only.
Plan load_plan(const std::filesystem::path& file);

/// JSON value of a parameter, empty when the job has none of the name.
std::string value_of(const Job& job, const std::string& name);

}  // namespace sunder::batch
