#include "rigid/world.h"
