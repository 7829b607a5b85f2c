#pragma once
/// Materials in SI units and their named presets (assets/materials.toml).
#include <filesystem>
#include <map>
#include <string>

namespace sunder::pipeline {

struct Material {
  std::string name;
  double density = 0;             ///< [kg/m^3]
  double youngs_modulus = 0;      ///< E [Pa]
  double poisson_ratio = 0;       ///< nu in (-1, 0.5)
  double tensile_strength = 0;    ///< sigma_f [Pa]
  double fracture_energy = 0;     ///< G_f [J/m^2]
  double contact_pressure = 0;    ///< mean pressure at which a contact crushes instead of growing elastically [Pa]
  double weibull_modulus = 0;     ///< scatter of the strength; 0: none
  double restitution = 0;         ///< of the pair: product of both
  double friction = 0;            ///< of the pair: geometric mean of both
  bool breakable = true;          ///< presets such as steel never break
  std::string source;             ///< where the numbers come from
  std::string surface_look = {};  ///< of its crack faces (crack::detail_preset); empty: none of its own
};

/// What one crack right through a body of the volume [m^3] takes at least: fracture_energy times volume^(2/3) [J].
double crack_through_energy(const Material& material, double volume);

using MaterialLibrary = std::map<std::string, Material>;

/// Reads the presets. Errors: ErrorKind::usage with file and line.
MaterialLibrary load_materials(const std::filesystem::path& file);

}  // namespace sunder::pipeline
