#include "libhdr/response/calibrate.h"
