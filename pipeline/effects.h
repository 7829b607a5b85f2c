#pragma once
/// The parts of a run that a scene can call for or leave out: which there are, when they run, and what they did.
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/stopwatch.h"

namespace sunder::pipeline {

struct CrackChoice;
struct FractureInput;
struct FractureOutcome;
struct Cracked;
struct Material;
struct Scene;

enum class Effect {
  fracture,             ///< bodies may break
  secondary_fracture,   ///< their fragments too
  flaws,                ///< strength varies from place to place
  two_velocity_fields,  ///< the sides of a crack part and rub while the solve goes on
  surface_detail,       ///< crack faces have the look of a material
  hairlines,            ///< cracks that separate nothing show as gaps
  debris,               ///< crushed lumps fall into pieces
  energy_ledger,        ///< a solve books where the work of its contacts goes
};
constexpr std::size_t effect_count = 8;

/// A value for each effect.
template <class Value>
struct PerEffect {
  std::array<Value, effect_count> values{};
  Value& operator[](Effect effect) { return values[static_cast<std::size_t>(effect)]; }
  const Value& operator[](Effect effect) const { return values[static_cast<std::size_t>(effect)]; }
};

/// What a scene says of an effect; `automatic` leaves it to the rest of the scene.
enum class Ask { automatic, off, on };
const char* name_of(Ask ask);

/// The section [effects] of a scene.
struct EffectSettings {
  PerEffect<Ask> asked;
  std::string surface_look;              ///< of crack faces (crack::detail_preset); empty: that of the material
  double hairline_width = 0;             ///< of the gaps [m]; 0: not given
  double debris_size = 0;                ///< of the pieces of crushed lumps [m]; 0: not given
  double smallest_detail = 0.01;         ///< smaller bodies get no detail and no hairlines by themselves [m]
  std::optional<double> scatter_length;  ///< over which the strength varies [m]; not set: three cells
};

/// Whether an effect runs, and why, as the end of a sentence.
struct Decision {
  bool runs = false;
  std::string why;
};

/// What decides: the scene, the largest extent of each of its bodies [m], and whether the scene says `on`.
struct EffectQuestion {
  const Scene& scene;
  const std::vector<double>& sizes;
  bool wanted;
};

/// A row of the registry.
struct EffectInfo {
  Effect effect;
  std::string_view name;                       ///< its key in [effects]
  std::string_view work;                       ///< what its counter counts, a key of the report
  std::array<std::string_view, 2> parameters;  ///< keys beside its own; empty: none
  std::string_view needs;                      ///< the one of these that it cannot be switched on without
  Decision (*decide)(const EffectQuestion&);   ///< for `on` and `auto`, in a scene in which bodies break
};
std::span<const EffectInfo> effect_registry();
const EffectInfo& info_of(Effect effect);

/// What runs in a scene.
struct EffectPlan {
  EffectSettings settings;
  PerEffect<Decision> decisions;
  bool runs(Effect effect) const { return decisions[effect].runs; }
};

/// `sizes`: largest extent of each body's bounding box [m].
EffectPlan plan_effects(const Scene& scene, const std::vector<double>& sizes);

/// How one body cracks: by the scene's [fracture], and by the effects that run for a body of this material and size
/// [m].
CrackChoice crack_choice(const Scene& scene, const EffectPlan& plan, const Material& material, double size);

/// The input of one fracture with what the scene asks of it: its [fracture], and the effects that run for the body.
FractureInput as_asked(FractureInput input, const Scene& scene, const EffectPlan& plan);

using EffectWork = PerEffect<Effort>;
EffectWork& operator+=(EffectWork& sum, const EffectWork& other);

/// What was done in one fracture, or in a cut without one.
EffectWork work_of(const FractureOutcome& outcome);
EffectWork work_of(const Cracked& cracked);

/// For the report. An effect `ran` when it did some work.
struct EffectRecord {
  Effect effect;
  Ask asked;
  bool ran;
  std::string why;
  Effort work;
};
std::vector<EffectRecord> effect_records(const EffectPlan& plan, const EffectWork& work);

}  // namespace sunder::pipeline
