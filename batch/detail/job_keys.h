#pragma once
/// What the parameters of jobs mean.
#include <optional>
#include <string>
#include <vector>

#include "batch/plan.h"
#include "pipeline/detail/toml_reader.h"
#include "pipeline/scene.h"
#include "pipeline/still.h"

namespace sunder::batch::detail {

/// A job of mode fracture.
struct FractureJob {
  pipeline::FractureOptions options;
  std::optional<double> random_impact;  ///< largest angle between its flight and the surface's normal [rad]
};

/// Names that the parameters of mode fracture may have.
std::vector<std::string> fracture_parameters();

/// That mode fracture can take the value for the parameter. Errors: ErrorKind::usage at its place.
void check_fracture_value(const std::string& parameter, const pipeline::detail::Value& value);

/// What is wrong with a set of parameters of mode fracture; empty: nothing.
std::string conflict(const std::vector<std::string>& parameters);

/// Errors: ErrorKind::usage.
FractureJob fracture_job(const Plan& plan, const Job& job);

/// The scene of a job of mode run. Errors: those of load_scene.
pipeline::Scene scene_of(const Plan& plan, const Job& job);

/// The file of a mesh or scene that a plan names; not set for a mesh that is neither a file's name nor in the
/// catalogue.
std::optional<std::filesystem::path> subject_file(const Plan& plan, const std::string& subject);

/// JSON text as it is.
std::string text_of(const std::string& json);

}  // namespace sunder::batch::detail
