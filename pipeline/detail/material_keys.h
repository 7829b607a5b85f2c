#pragma once
/// What a material section holds: a preset, or a `[material.<name>]` of a scene.
#include "pipeline/detail/toml_reader.h"
#include "pipeline/material.h"

namespace sunder::pipeline::detail {

/// Every value of a material; `base` of a scene's material is read before these.
std::span<const Key<Material>> material_keys();

/// A name that crack::detail_preset knows.
std::string read_surface_look(const Value& value);

/// Throws when a value that a material needs is missing: density and elasticity always, strength and toughness if it
/// can break.
void check_complete(const Section& section, const Material& material);

}  // namespace sunder::pipeline::detail
