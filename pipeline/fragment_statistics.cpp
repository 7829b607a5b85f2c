#include "pipeline/fragment_statistics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "geometry/mass_properties.h"
#include "pipeline/handover.h"

namespace sunder::pipeline {
namespace {

bool is_fragment(const output::Piece& piece) { return piece.parent >= 0; }
bool exists_at_end(const output::Piece& piece) { return std::isinf(piece.death_time); }

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

VolumeSummary summary_of(const std::vector<double>& volumes) {
  const auto [smallest, largest] = std::minmax_element(volumes.begin(), volumes.end());
  return {*smallest, median(volumes), sum(volumes) / static_cast<double>(volumes.size()), *largest};
}

std::vector<VolumeClosure> closures(const output::Sequence& sequence) {
  std::map<std::string, double> left;
  for (const output::Piece& piece : sequence.pieces)
    if (exists_at_end(piece)) left[piece.body] += piece.volume;
  std::vector<VolumeClosure> result;
  for (const output::Piece& piece : sequence.pieces) {
    if (is_fragment(piece) || exists_at_end(piece)) continue;
    const double fragments = left[piece.body];
    result.push_back({piece.body, piece.volume, fragments, (fragments - piece.volume) / piece.volume});
  }
  return result;
}

std::vector<FragmentCount> counts(const output::Sequence& sequence) {
  std::map<std::string, std::size_t> order;
  for (const output::Piece& piece : sequence.pieces) order.emplace(piece.body, order.size());
  std::map<std::pair<double, std::size_t>, FragmentCount> events;
  for (const output::Piece& piece : sequence.pieces)
    if (is_fragment(piece)) {
      FragmentCount& event = events[{piece.birth_time, order.at(piece.body)}];
      event.time = piece.birth_time;
      event.body = piece.body;
      ++event.born;
    }
  std::vector<FragmentCount> result;
  for (auto& [when, event] : events) {
    event.alive = static_cast<int>(
        std::count_if(sequence.pieces.begin(), sequence.pieces.end(), [&, time = event.time](const output::Piece& p) {
          return is_fragment(p) && p.body == event.body && p.birth_time <= time && p.death_time > time;
        }));
    result.push_back(event);
  }
  return result;
}

// The solve that broke a piece; none for cuts that no solve made.
const FractureRecord* fracture_of(const Report& report, int piece) {
  const auto found = std::find_if(report.fractures.begin(), report.fractures.end(),
                                  [&](const FractureRecord& f) { return f.piece == piece && f.fragments > 0; });
  return found == report.fractures.end() ? nullptr : &*found;
}

std::vector<BreakupSizes> breakups(const Report& report, const output::Sequence& sequence) {
  std::map<int, std::vector<double>> volumes;
  std::map<int, double> birth;
  for (const output::Piece& piece : sequence.pieces)
    if (is_fragment(piece)) {
      volumes[piece.parent].push_back(piece.volume);
      birth[piece.parent] = piece.birth_time;
    }
  std::vector<BreakupSizes> result;
  for (const auto& [parent, parts] : volumes) {
    const FractureRecord* fracture = fracture_of(report, parent);
    result.push_back({fracture ? fracture->time : birth.at(parent),
                      sequence.pieces[static_cast<std::size_t>(parent)].name, static_cast<int>(parts.size()),
                      median(parts), largest_share(parts)});
  }
  return result;
}

double kinetic_energy_of(const output::Piece& piece, const output::PiecePose& pose) {
  if (!(piece.volume > 0)) return 0;
  const Mat3 turn = pose.pose.orientation.toRotationMatrix();
  const Mat3 inertia = piece.mass / piece.volume * geometry::mass_properties(piece.mesh).inertia;
  return kinetic_energy({{piece.mass, Vec3::Zero(), turn * inertia * turn.transpose()}}, {pose.twist});
}

EnergyBalance energy_balance(const Report& report, const output::Sequence& sequence) {
  EnergyBalance balance;
  for (const output::Piece& piece : sequence.pieces)
    if (!is_fragment(piece)) balance.kinetic_start += piece.birth_energy;
  if (!sequence.frames.empty()) {
    balance.kinetic_end = 0;
    for (const output::PiecePose& pose : sequence.frames.back().poses)
      *balance.kinetic_end += kinetic_energy_of(sequence.pieces[static_cast<std::size_t>(pose.piece)], pose);
  }
  for (const FractureRecord& f : report.fractures) {
    balance.fracture += f.crack_energy;
    balance.lost_in_fractures += f.kinetic_before - f.kinetic_after;
  }
  return balance;
}

// Fragments smaller than the cube of the damage band of the solve that made them.
std::size_t unresolved(const Report& report, const std::vector<const output::Piece*>& fragments) {
  return static_cast<std::size_t>(std::count_if(fragments.begin(), fragments.end(), [&](const output::Piece* piece) {
    const FractureRecord* fracture = fracture_of(report, piece->parent);
    return fracture && piece->volume < std::pow(fracture->band_width, 3);
  }));
}

std::string sentence(bool applies, const std::string& text) { return applies ? text + " " : ""; }

std::string note(const Report& report, const std::vector<const output::Piece*>& fragments,
                 const FragmentStatistics& s) {
  const statistics::FitSettings settings;
  const std::size_t n = positive_volumes(fragments).size(), small = unresolved(report, fragments);
  const auto text = [](std::size_t k) { return std::to_string(k); };
  std::set<std::string> bodies;
  for (const output::Piece* piece : fragments) bodies.insert(piece->body);
  if (n < settings.smallest_sample)
    return "No laws are fitted to fewer than " + text(settings.smallest_sample) + " fragments.";
  if (s.fits.empty()) return "No laws are fitted: all fragments have the same volume.";
  const bool none_holds = std::none_of(s.fits.begin(), s.fits.end(), [](const auto& f) { return f.p_value > 0.05; });
  std::string all =
      sentence(n < settings.smallest_power_law_sample,
               "With fewer than " + text(settings.smallest_power_law_sample) +
                   " fragments the tests reject little, and no power law is fitted.") +
      sentence(none_holds, "The fragments contradict every law (p-values up to 0.05).") +
      sentence(small > 0, "Smaller than the cube of the damage band, so decided by the grid: " + text(small) + " of " +
                              text(fragments.size()) + " fragments.") +
      sentence(n < fragments.size(), "Left out, as they have no volume: " + text(fragments.size() - n) + " of " +
                                         text(fragments.size()) + " fragments.") +
      sentence(bodies.size() > 1, "Fragments of " + text(bodies.size()) + " bodies are in one sample.");
  if (!all.empty() && all.back() == ' ') all.pop_back();
  return all;
}

}  // namespace

std::vector<const output::Piece*> living_fragments(const output::Sequence& sequence) {
  std::vector<const output::Piece*> living;
  for (const output::Piece& piece : sequence.pieces)
    if (is_fragment(piece) && exists_at_end(piece)) living.push_back(&piece);
  return living;
}

std::vector<double> positive_volumes(const std::vector<const output::Piece*>& fragments) {
  std::vector<double> volumes;
  for (const output::Piece* piece : fragments)
    if (piece->volume > 0) volumes.push_back(piece->volume);
  return volumes;
}

double largest_share(const std::vector<double>& volumes) {
  return *std::max_element(volumes.begin(), volumes.end()) / sum(volumes);
}

FragmentStatistics fragment_statistics(const Report& report, const output::Sequence& sequence) {
  const std::vector<const output::Piece*> fragments = living_fragments(sequence);
  const std::vector<double> volumes = positive_volumes(fragments);
  FragmentStatistics result;
  result.fragments = fragments.size();
  if (!volumes.empty()) {
    result.largest_share = largest_share(volumes);
    result.volume = summary_of(volumes);
  }
  result.closure = closures(sequence);
  result.counts = counts(sequence);
  result.fits = statistics::fit_laws(volumes);
  result.fits_note = note(report, fragments, result);
  result.per_fracture = breakups(report, sequence);
  result.energy = energy_balance(report, sequence);
  return result;
}

}  // namespace sunder::pipeline
