#include "libhdr/response/expose.h"
