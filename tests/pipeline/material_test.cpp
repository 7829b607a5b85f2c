/// The presets, and the strictness of their reader.
#include "pipeline/material.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {
namespace {

TEST(Materials, PresetsAreCompleteAndPossible) {
  const MaterialLibrary library = load_materials(default_assets().materials);
  for (const char* name :
       {"glass", "porcelain", "terracotta", "plaster", "concrete", "marble", "brick", "ice", "stone", "steel"})
    EXPECT_TRUE(library.contains(name)) << name;
  for (const auto& [name, material] : library) {
    EXPECT_EQ(material.name, name);
    EXPECT_FALSE(material.source.empty()) << name;
    EXPECT_GT(material.restitution, 0) << name;
    EXPECT_LE(material.restitution, 1) << name;
    EXPECT_GT(material.friction, 0) << name;
    if (!material.breakable) continue;
    EXPECT_EQ(material.weibull_modulus, 8) << name;
    // A contact crushes at far more than the strength in tension, and both are far below the stiffness.
    EXPECT_GT(material.contact_pressure, 3 * material.tensile_strength) << name;
    EXPECT_LT(material.contact_pressure, material.youngs_modulus / 5) << name;
  }
}

// Irwin's length E G_f / sigma_f^2 says how brittle a material is: millimetres for glass, decimetres for concrete.
TEST(Materials, BrittlenessIsInTheRightOrder) {
  const MaterialLibrary library = load_materials(default_assets().materials);
  const auto length = [&](const char* name) {
    const Material& m = library.at(name);
    return m.youngs_modulus * m.fracture_energy / (m.tensile_strength * m.tensile_strength);
  };
  EXPECT_LT(length("glass"), 1e-3);
  EXPECT_LT(length("glass"), length("porcelain"));
  EXPECT_LT(length("porcelain"), length("terracotta"));
  EXPECT_LT(length("terracotta"), length("concrete"));
  EXPECT_GT(length("concrete"), 0.1);
}

std::string complaint(const std::string& text) {
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("sunder_materials_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << text;
  std::string message = "accepted";
  try {
    load_materials(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    message = error.what();
  }
  std::filesystem::remove(file);
  return message;
}

TEST(Materials, MistakesNameTheirLine) {
  EXPECT_NE(complaint("[a]\ndensty = 3\n").find(".toml:2: material 'a': unknown key 'densty'; did you mean 'density'?"),
            std::string::npos);
  EXPECT_NE(complaint("[a]\ndensity = 3\n").find(".toml:1: material 'a': missing key"), std::string::npos);
  EXPECT_NE(complaint("a = 3\n").find(".toml:1: 'a' is not a [section]"), std::string::npos);
  EXPECT_NE(complaint("[a]\nrestitution = 1.5\n").find("from 0 to 1, found 1.5"), std::string::npos);
}

}  // namespace
}  // namespace sunder::pipeline
