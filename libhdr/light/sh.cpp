#include "libhdr/light/sh.h"
