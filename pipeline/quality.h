#pragma once
/// Where on the accuracy/time curve a run sits.
#include "pipeline/scene.h"

namespace sunder::pipeline {

struct QualitySettings {
  int particles;      ///< of a body of the scene
  double rigid_rate;  ///< rigid steps per second, rounded up to a multiple of the frame rate [1/s]
};

constexpr QualitySettings settings_of(Quality quality) {
  switch (quality) {
    case Quality::draft:
      return {6000, 240};
    case Quality::preview:
      return {20000, 480};
    case Quality::final:
      return {60000, 960};
  }
  return {20000, 480};
}

constexpr const char* name_of(Quality quality) {
  switch (quality) {
    case Quality::draft:
      return "draft";
    case Quality::preview:
      return "preview";
    case Quality::final:
      return "final";
  }
  return "";
}

}  // namespace sunder::pipeline
