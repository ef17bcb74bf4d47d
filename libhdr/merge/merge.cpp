#include "libhdr/merge/merge.h"
