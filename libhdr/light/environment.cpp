#include "libhdr/light/environment.h"
