#include "libhdr/response/response.h"
