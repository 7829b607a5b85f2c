// The headers are inline; this file makes them a library and compiles each of them once on its own.
#include "core/error.h"
#include "core/hash.h"
#include "core/optional_effects.h"
#include "core/progress.h"
#include "core/random.h"
#include "core/stopwatch.h"
#include "core/types.h"
