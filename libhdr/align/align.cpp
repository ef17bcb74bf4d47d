#include "libhdr/align/align.h"
