#include "core/error.h"
#include "core/progress.h"
#include "core/random.h"
#include "core/types.h"
