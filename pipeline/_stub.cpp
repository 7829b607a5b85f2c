#include "pipeline/scene.h"
#include "pipeline/sequence.h"
#include "pipeline/progress_display.h"
#include "pipeline/material.h"
