#pragma once
/// Whether optional effects are compiled in. A test compares the program with one that was built without them: effects
/// that are switched off must cost nothing. Only .cpp files, and headers that only they include, may ask.

namespace sunder {

#ifdef SUNDER_WITHOUT_EFFECTS
constexpr bool with_optional_effects = false;
#else
constexpr bool with_optional_effects = true;
#endif

}  // namespace sunder
