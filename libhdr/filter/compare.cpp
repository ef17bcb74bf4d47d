#include "libhdr/filter/compare.h"
