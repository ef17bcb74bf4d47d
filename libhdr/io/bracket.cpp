#include "libhdr/io/bracket.h"
