/// What a scene asks of effects, what comes of it, and that nothing comes of those that are off.
#include "pipeline/effects.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "geometry/primitives.h"
#include "pipeline/detail/effect_keys.h"
#include "pipeline/fracture.h"
#include "pipeline/scene.h"

namespace sunder::pipeline {
namespace {

constexpr double body_size = 0.1;

/// Glass with a look, for a second, at preview quality.
Scene glass_scene() {
  Scene scene;
  scene.duration = 1;
  scene.bodies.resize(2);
  Material& glass = scene.bodies[0].material;
  glass.name = "glass";
  glass.weibull_modulus = 8;
  glass.surface_look = "glass";
  scene.bodies[1].material.name = "steel";
  scene.bodies[1].material.breakable = false;
  return scene;
}

EffectPlan plan_of(const Scene& scene) { return plan_effects(scene, {body_size, 10 * body_size}); }
bool runs(const Scene& scene, Effect effect) { return plan_of(scene).runs(effect); }

TEST(EffectRegistry, HasARowForEachEffectInTheirOrder) {
  int index = 0;
  for (const EffectInfo& info : effect_registry()) EXPECT_EQ(static_cast<int>(info.effect), index++) << info.name;
  EXPECT_EQ(info_of(Effect::energy_ledger).name, "energy_ledger");
}

TEST(EffectRegistry, EveryNameAndParameterIsAKeyOfTheScene) {
  const std::vector<std::string> keys = detail::key_names(detail::effect_keys());
  const auto is_key = [&](std::string_view name) { return std::find(keys.begin(), keys.end(), name) != keys.end(); };
  for (const EffectInfo& info : effect_registry()) {
    EXPECT_TRUE(is_key(info.name)) << info.name;
    for (const std::string_view parameter : info.parameters) EXPECT_TRUE(parameter.empty() || is_key(parameter));
    EXPECT_TRUE(info.needs.empty() ||
                std::find(info.parameters.begin(), info.parameters.end(), info.needs) != info.parameters.end());
  }
}

TEST(EffectPlan, AutoRunsWhatCostsNothingThatWasNotAskedFor) {
  const EffectPlan plan = plan_of(glass_scene());
  for (const Effect effect : {Effect::fracture, Effect::secondary_fracture, Effect::flaws, Effect::energy_ledger})
    EXPECT_TRUE(plan.runs(effect)) << plan.decisions[effect].why;
  for (const Effect effect : {Effect::two_velocity_fields, Effect::surface_detail, Effect::hairlines, Effect::debris})
    EXPECT_FALSE(plan.runs(effect)) << plan.decisions[effect].why;
}

TEST(EffectPlan, NothingRunsWhereNothingCanBreak) {
  Scene scene = glass_scene();
  scene.bodies[0].breakable = false;
  for (const EffectInfo& info : effect_registry()) EXPECT_FALSE(runs(scene, info.effect)) << info.name;
  scene = glass_scene();
  scene.fracture.maximum_fractures = 0;
  for (const EffectInfo& info : effect_registry()) EXPECT_FALSE(runs(scene, info.effect)) << info.name;
}

TEST(EffectPlan, FragmentsBreakWhenTheyHaveTheTimeAndTheRight) {
  Scene scene = glass_scene();
  scene.duration = scene.fracture.refracture_delay;
  EXPECT_FALSE(runs(scene, Effect::secondary_fracture));
  scene.duration = 2 * scene.fracture.refracture_delay;
  EXPECT_TRUE(runs(scene, Effect::secondary_fracture));
  scene.fracture.maximum_fractures = 1;
  EXPECT_FALSE(runs(scene, Effect::secondary_fracture));
}

TEST(EffectPlan, FlawsNeedAModulus) {
  Scene scene = glass_scene();
  scene.bodies[0].material.weibull_modulus = 0;
  scene.bodies[1].material.weibull_modulus = 8;  // of steel, which does not break
  EXPECT_FALSE(runs(scene, Effect::flaws));
  scene.effects.asked[Effect::flaws] = Ask::on;
  EXPECT_FALSE(runs(scene, Effect::flaws));
}

TEST(EffectPlan, TwoFieldsAreForTheFinalQualityAndCrackFronts) {
  Scene scene = glass_scene();
  scene.quality = Quality::final;
  EXPECT_TRUE(runs(scene, Effect::two_velocity_fields));
  scene.fracture.damage = DamageModel::local;
  scene.effects.asked[Effect::two_velocity_fields] = Ask::on;
  EXPECT_FALSE(runs(scene, Effect::two_velocity_fields));
  scene.quality = Quality::draft;
  scene.fracture.damage = DamageModel::front;
  EXPECT_TRUE(runs(scene, Effect::two_velocity_fields));
}

TEST(EffectPlan, LooksComeFromTheSceneOrOnRequestFromTheMaterial) {
  Scene scene = glass_scene();
  const auto look = [&] { return crack_choice(scene, plan_of(scene), scene.bodies[0].material, body_size).detail; };
  EXPECT_EQ(look(), "");
  scene.effects.asked[Effect::surface_detail] = Ask::on;
  EXPECT_EQ(look(), "glass");
  scene.effects.surface_look = "rock";
  EXPECT_EQ(look(), "rock");
  scene.effects.asked[Effect::surface_detail] = Ask::automatic;
  EXPECT_EQ(look(), "rock");
  scene.effects.asked[Effect::surface_detail] = Ask::off;
  EXPECT_EQ(look(), "");
}

TEST(EffectPlan, SmallBodiesGetNoDetailByThemselves) {
  Scene scene = glass_scene();
  EffectSettings& effects = scene.effects;
  effects.surface_look = "rock";
  effects.hairline_width = 1e-4;
  effects.debris_size = effects.smallest_detail = 0.05;
  const auto choice = [&](double size) { return crack_choice(scene, plan_of(scene), scene.bodies[0].material, size); };
  EXPECT_EQ(choice(body_size).detail, "rock");
  EXPECT_EQ(choice(body_size).hairline_width, 1e-4);
  EXPECT_EQ(choice(body_size).debris_size, 0.05);
  EXPECT_EQ(choice(0.01).detail, "");
  EXPECT_EQ(choice(0.01).hairline_width, 0);
  EXPECT_EQ(choice(0.01).debris_size, 0);
  for (const Effect effect : {Effect::surface_detail, Effect::hairlines, Effect::debris})
    effects.asked[effect] = Ask::on;
  EXPECT_EQ(choice(0.01).detail, "rock");
  EXPECT_EQ(choice(0.01).hairline_width, 1e-4);
  EXPECT_EQ(choice(0.01).debris_size, 0.05);
}

Scene any_scene() {
  Scene scene = glass_scene();
  for (Ask& ask : scene.effects.asked.values) ask = *rc::gen::element(Ask::automatic, Ask::off, Ask::on);
  scene.quality = *rc::gen::element(Quality::draft, Quality::preview, Quality::final);
  scene.fracture.damage = *rc::gen::element(DamageModel::front, DamageModel::local);
  scene.fracture.maximum_fractures = *rc::gen::inRange(0, 4);
  scene.duration = *rc::gen::element(0.01, 1.0);
  scene.bodies[0].breakable = *rc::gen::arbitrary<bool>();
  scene.bodies[0].material.weibull_modulus = *rc::gen::element(0.0, 8.0);
  scene.effects.surface_look = *rc::gen::element<std::string>("", "rock");
  scene.effects.hairline_width = *rc::gen::element(0.0, 1e-4);
  scene.effects.debris_size = *rc::gen::element(0.0, 0.01, 1.0);
  scene.effects.smallest_detail = *rc::gen::element(0.0, 0.01, 1.0);
  return scene;
}

RC_GTEST_PROP(EffectPlan, OffNeverRunsOnRunsWhereverAutoDoesAndEverythingHasAReason, ()) {
  const Scene scene = any_scene();
  const EffectPlan plan = plan_of(scene);
  for (const EffectInfo& info : effect_registry()) {
    RC_ASSERT(!plan.decisions[info.effect].why.empty());
    RC_ASSERT(!plan.runs(info.effect) || plan.runs(Effect::fracture));
    const auto runs_when = [&](Ask ask) {
      Scene other = scene;
      other.effects.asked[info.effect] = ask;
      return runs(other, info.effect);
    };
    RC_ASSERT(!runs_when(Ask::off));
    RC_ASSERT(!runs_when(Ask::automatic) || runs_when(Ask::on));
  }
}

RC_GTEST_PROP(EffectPlan, WhatDoesNotRunIsNotInTheInputOfAFracture, ()) {
  const Scene scene = any_scene();
  const EffectPlan plan = plan_of(scene);
  FractureInput input;
  input.mesh = geometry::box(Vec3::Constant(body_size));
  input.material = scene.bodies[0].material;
  input = as_asked(std::move(input), scene, plan);
  RC_ASSERT(input.solve.two_fields == plan.runs(Effect::two_velocity_fields));
  RC_ASSERT(input.solve.energy_ledger == plan.runs(Effect::energy_ledger));
  RC_ASSERT((input.material.weibull_modulus > 0) == plan.runs(Effect::flaws));
  RC_ASSERT(input.crack.detail.empty() || plan.runs(Effect::surface_detail));
  RC_ASSERT(input.crack.hairline_width == 0 || plan.runs(Effect::hairlines));
  RC_ASSERT(input.crack.debris_size == 0 || plan.runs(Effect::debris));
}

// ---- work ---------------------------------------------------------------------------------------------------------

/// A glass cube that a steel ball hits off its middle, with every effect of a single fracture.
struct Hit {
  Scene scene = glass_scene();
  FractureInput input;

  explicit Hit(double speed = 10) {
    Material& glass = scene.bodies[0].material;
    glass = {"glass", 2500, 70e9, 0.22, 40e6, 8, 5.5e9, 8, 0.4, 0.4, true, "", "glass"};
    for (Ask& ask : scene.effects.asked.values) ask = Ask::on;
    scene.effects.hairline_width = 1e-4;
    scene.effects.debris_size = 0.01;
    scene.effects.surface_look = "clay";
    constexpr double size = 0.04, ball = 0.018;
    input.mesh = geometry::box(Vec3::Constant(size));
    input.material = glass;
    input.particles = 6000;
    mpm::Load load;
    load.point = Vec3(0.003, size / 2, 0.002);
    load.approach_speed = speed;
    load.pair = {ball, mpm::effective_modulus(glass.youngs_modulus, glass.poisson_ratio, 210e9, 0.3), 5.5e9};
    input.loads = {load};
    input.partners = {{7800 * 4.19 * ball * ball * ball}};
  }

  EffectWork work() const {
    SilentProgress progress;
    return work_of(fracture(as_asked(input, scene, plan_of(scene)), progress));
  }
};

/// Those that one fracture can show.
const std::vector<Effect> of_one_fracture = {Effect::flaws,          Effect::two_velocity_fields,
                                             Effect::surface_detail, Effect::hairlines,
                                             Effect::debris,         Effect::energy_ledger};

TEST(EffectWork, EveryEffectThatIsOnIsCounted) {
  const EffectWork work = Hit().work();
  for (const Effect effect : of_one_fracture) {
    EXPECT_GT(work[effect].count, 0) << info_of(effect).name;
    EXPECT_GT(work[effect].seconds, 0) << info_of(effect).name;
  }
  EXPECT_EQ(work[Effect::fracture].count, 1);
}

class SwitchedOff : public testing::TestWithParam<Effect> {};

TEST_P(SwitchedOff, DoesNoWork) {
  Hit hit;
  hit.scene.effects.asked[Effect::surface_detail] = Ask::off;  // which takes most of the time
  hit.scene.effects.asked[GetParam()] = Ask::off;
  const Effort effort = hit.work()[GetParam()];
  EXPECT_EQ(effort.count, 0);
  EXPECT_EQ(effort.seconds, 0);
}

INSTANTIATE_TEST_SUITE_P(EffectWork, SwitchedOff, testing::ValuesIn(of_one_fracture),
                         [](const auto& effect) { return std::string(info_of(effect.param).name); });

TEST(EffectWork, NoStepIsMadeWithTwoFieldsBeforeThereIsACrack) {
  Hit hit(0.5);
  SilentProgress progress;
  const FractureOutcome outcome = fracture(as_asked(hit.input, hit.scene, plan_of(hit.scene)), progress);
  ASSERT_EQ(outcome.solve.failures, 0);
  EXPECT_GT(outcome.solve.steps, 0);
  EXPECT_EQ(outcome.solve.two_field_steps.count, 0);
}

TEST(EffectWork, TwoFieldsBeginWithTheFirstCrack) {
  Hit hit;
  hit.scene.effects.asked[Effect::surface_detail] = Ask::off;
  SilentProgress progress;
  const FractureOutcome outcome = fracture(as_asked(hit.input, hit.scene, plan_of(hit.scene)), progress);
  EXPECT_GT(outcome.solve.two_field_steps.count, 0);
  EXPECT_LT(outcome.solve.two_field_steps.count, outcome.solve.steps);
}

TEST(EffectWork, WithoutALedgerTheReportHasNone) {
  Hit hit(0.5);
  SilentProgress progress;
  EXPECT_TRUE(fracture(as_asked(hit.input, hit.scene, plan_of(hit.scene)), progress).solve.energy);
  hit.scene.effects.asked[Effect::energy_ledger] = Ask::off;
  EXPECT_FALSE(fracture(as_asked(hit.input, hit.scene, plan_of(hit.scene)), progress).solve.energy);
}

TEST(EffectRecords, SayWhatWasAskedWhatRanAndWhy) {
  Scene scene = glass_scene();
  scene.effects.asked[Effect::hairlines] = Ask::off;
  EffectWork work;
  work[Effect::fracture] = {2, 0.5};
  const std::vector<EffectRecord> records = effect_records(plan_of(scene), work);
  ASSERT_EQ(records.size(), effect_count);
  const auto record = [&](Effect effect) { return records[static_cast<std::size_t>(effect)]; };
  EXPECT_TRUE(record(Effect::fracture).ran);
  EXPECT_EQ(record(Effect::fracture).work.count, 2);
  EXPECT_EQ(record(Effect::fracture).why, "1 of 2 bodies can break");
  EXPECT_FALSE(record(Effect::flaws).ran);
  EXPECT_EQ(record(Effect::flaws).why, "weibull_modulus of glass, but nothing came of it");
  EXPECT_EQ(record(Effect::hairlines).asked, Ask::off);
  EXPECT_EQ(record(Effect::hairlines).why, "switched off");
}

}  // namespace
}  // namespace sunder::pipeline
