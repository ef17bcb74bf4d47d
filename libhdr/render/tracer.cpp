#include "libhdr/render/tracer.h"
