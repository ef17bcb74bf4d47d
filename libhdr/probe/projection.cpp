#include "libhdr/probe/projection.h"
