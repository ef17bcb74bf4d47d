#include "libhdr/render/render.h"
