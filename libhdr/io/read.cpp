#include "libhdr/io/read.h"
