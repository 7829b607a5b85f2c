#include "pipeline/lifecycle.h"

namespace sunder::pipeline {

SizeClass size_class(double share, const FractureSettings& settings) {
  if (share < settings.tiny_volume) return SizeClass::tiny;
  if (share < settings.small_volume) return SizeClass::small;
  return share < settings.nearly_whole_volume ? SizeClass::large : SizeClass::nearly_whole;
}

const char* name_of(SizeClass size) {
  switch (size) {
    case SizeClass::tiny:
      return "tiny";
    case SizeClass::small:
      return "small";
    case SizeClass::large:
      return "large";
    case SizeClass::nearly_whole:
      return "nearly whole";
  }
  return "";
}

geometry::ConvexPartsSettings collision_detail(SizeClass size) {
  switch (size) {
    case SizeClass::tiny:
      return {.max_parts = 2, .excess = 0.1, .max_hull_vertices = 24};
    case SizeClass::small:
      return {.max_parts = 4, .excess = 0.1, .max_hull_vertices = 24};
    case SizeClass::large:
      return {.max_parts = 8, .excess = 0.1, .max_hull_vertices = 24};
    case SizeClass::nearly_whole:
      return {.max_parts = 16, .excess = 0.05, .max_hull_vertices = 32};
  }
  return {};
}

double minimum_volume(const FractureSettings& settings) {
  return settings.minimum_volume.value_or(settings.tiny_volume);
}

}  // namespace sunder::pipeline
