#include "libhdr/probe/unwrap.h"
