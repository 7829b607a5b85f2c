#include "pipeline/detail/statistics_json.h"

namespace sunder::pipeline::detail {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

/// One element for each value.
template <class Values, class ToJson>
Json array_of(const Values& values, const ToJson& to_json) {
  Json array = Json::array();
  for (const auto& value : values) array.push_back(to_json(value));
  return array;
}

Json volume_json(const std::optional<VolumeSummary>& volume) {
  if (!volume) return {{"minimum", nullptr}, {"median", nullptr}, {"mean", nullptr}, {"maximum", nullptr}};
  return {
      {"minimum", volume->minimum}, {"median", volume->median}, {"mean", volume->mean}, {"maximum", volume->maximum}};
}

Json closure_json(const VolumeClosure& c) {
  return {{"body", c.body}, {"original", c.original}, {"fragments", c.fragments}, {"relative_error", c.relative_error}};
}

Json count_json(const FragmentCount& c) {
  return {{"time", c.time}, {"body", c.body}, {"new", c.born}, {"alive", c.alive}};
}

Json parameter_json(const statistics::Parameter& p) {
  return {{"name", p.name}, {"value", p.value}, {"low", p.low}, {"high", p.high}};
}

Json fit_json(const statistics::Fit& f) {
  return {{"law", f.law},
          {"of", "volume"},
          {"count", f.count},
          {"parameters", array_of(f.parameters, parameter_json)},
          {"ks", f.ks},
          {"p_value", f.p_value},
          {"log_likelihood", f.log_likelihood},
          {"aic", or_null(f.aic)},
          {"above", or_null(f.above)}};
}

Json breakup_json(const BreakupSizes& b) {
  return {{"time", b.time},
          {"body", b.piece},
          {"new", b.fragments},
          {"median_volume", b.median_volume},
          {"largest_share", b.largest_share}};
}

}  // namespace

Json statistics_json(const FragmentStatistics& s) {
  return {{"fragments", s.fragments},
          {"largest_share", or_null(s.largest_share)},
          {"volume", volume_json(s.volume)},
          {"closure", array_of(s.closure, closure_json)},
          {"counts", array_of(s.counts, count_json)},
          {"fits", array_of(s.fits, fit_json)},
          {"fits_note", s.fits_note},
          {"per_fracture", array_of(s.per_fracture, breakup_json)},
          {"energy",
           {{"kinetic_start", s.energy.kinetic_start},
            {"kinetic_end", or_null(s.energy.kinetic_end)},
            {"fracture", s.energy.fracture},
            {"lost_in_fractures", s.energy.lost_in_fractures}}}};
}

}  // namespace sunder::pipeline::detail
