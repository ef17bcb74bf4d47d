#include "libhdr/io/write.h"
