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

// Collision cost grows with the product of the parts of two bodies. A whole body may be a ball, which takes many
// vertices to roll; a vessel takes many parts to hold something.
geometry::ConvexPartsSettings collision_detail(SizeClass size) {
  switch (size) {
    case SizeClass::tiny:
      return {.max_parts = 4, .gap = 0.01, .max_hull_vertices = 32};
    case SizeClass::small:
      return {.max_parts = 10, .gap = 0.01, .max_hull_vertices = 48};
    case SizeClass::large:
      return {.max_parts = 20, .gap = 0.005, .max_hull_vertices = 64};
    case SizeClass::nearly_whole:
      return {.max_parts = 40, .gap = 0.005, .max_hull_vertices = 256};
  }
  return {};
}

double minimum_volume(const FractureSettings& settings) {
  return settings.minimum_volume.value_or(settings.tiny_volume);
}

}  // namespace sunder::pipeline
