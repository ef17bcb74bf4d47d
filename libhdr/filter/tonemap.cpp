#include "libhdr/filter/tonemap.h"
