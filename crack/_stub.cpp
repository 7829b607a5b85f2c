#include "crack/extract.h"
