#pragma once
/// What the section [effects] holds.
#include "pipeline/detail/toml_reader.h"
#include "pipeline/effects.h"

namespace sunder::pipeline::detail {

std::span<const Key<EffectSettings>> effect_keys();

/// Fails for a parameter of which every effect is off, and for an effect that is on without the parameter it needs.
void check_effects(const Section& section, const EffectSettings& settings);

}  // namespace sunder::pipeline::detail
