#include "libhdr/io/exposure_list.h"
