/// Particle-steps per second of the whole damage solve, on one thread and on all, and the ratio to a naive step with
/// the same physics measured in the same run.
#include <chrono>
#include <thread>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "tests/mpm/bodies.h"
#include "tests/mpm/reference_step.h"

namespace {

using namespace sunder;
using namespace sunder::mpm;

constexpr double half_edge = 0.05;

fixture::Body cube(std::int64_t particles) {
  const double side = std::cbrt(static_cast<double>(particles));
  return fixture::block(Vec3::Constant(half_edge), 2 * half_edge / std::round(side), 0.25);
}

/// Particle-steps per second of the plain reference on one thread.
double naive_rate(std::int64_t particles) {
  const fixture::Body body = cube(particles);
  const Material material = fixture::glass();
  const double volume = body.volume / static_cast<double>(body.points.size()), h = 2 * std::cbrt(volume);
  const int nodes = static_cast<int>(2 * half_edge / h) + 8;
  fixture::ReferenceStep step(material, volume, h, 0.35 * h / material.p_wave_speed(), 0.1,
                              Vec3::Constant(-half_edge - 3.2 * h), {nodes, nodes, nodes});
  std::vector<Particle> state(body.points.size());
  for (std::size_t p = 0; p < state.size(); ++p) {
    state[p].material_position = body.points[p];
    state[p].velocity = 1e-3 * body.points[p];
    state[p].threshold = state[p].strength = 1e15;
  }
  // Long enough for the clock, whatever the size.
  const int steps = 3 + static_cast<int>(500000 / particles);
  const auto start = std::chrono::steady_clock::now();
  for (int n = 0; n < steps; ++n) step(state);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return steps * static_cast<double>(state.size()) / seconds.count();
}

SolveResult solve_cube(const fixture::Body& body, const Material& material, double speed) {
  SolveSettings settings;
  settings.most_transits = 2;
  return fixture::run(body, material, {fixture::steel_ball_on_glass({0, half_edge, 0}, Vec3::UnitY(), speed)},
                      {{fixture::steel_ball_mass(0.01)}}, settings);
}

void report(benchmark::State& state, const Material& material, double speed) {
  const fixture::Body body = cube(state.range(0));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(1)));
  const double naive = naive_rate(state.range(0));
  double work = 0, damaged = 0;
  const auto start = std::chrono::steady_clock::now();
  for (auto _ : state) {
    const SolveResult result = solve_cube(body, material, speed);
    work += static_cast<double>(result.steps) * static_cast<double>(result.particles.size());
    damaged = result.damaged_share;
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  state.counters["particle_steps_per_s"] = work / seconds.count();
  state.counters["naive_per_s"] = naive;
  state.counters["ratio_to_naive"] = work / seconds.count() / naive;
  state.counters["damaged_share"] = damaged;
}

void Sound(benchmark::State& state) { report(state, fixture::sound_glass(), 10); }
void Fracture(benchmark::State& state) { report(state, fixture::glass(), 120); }

void sizes(benchmark::internal::Benchmark* bench) {
  const auto all = static_cast<std::int64_t>(std::thread::hardware_concurrency());
  bench->ArgNames({"particles", "threads"})->Unit(benchmark::kMillisecond)->Iterations(1);
  for (std::int64_t particles : {4096, 32768}) {
    bench->Args({particles, 1});
    if (all > 1) bench->Args({particles, all});
  }
}

BENCHMARK(Sound)->Apply(sizes)->UseRealTime();
BENCHMARK(Fracture)->Apply(sizes)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
