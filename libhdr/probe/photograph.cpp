#include "libhdr/probe/photograph.h"
